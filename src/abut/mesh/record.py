"""What a mesh holds: points, cell blocks, named bodies, surfaces and node sets."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from abut import checks
from abut.brief import listed
from abut.cells import CELLS, MAX_FACET_NODES
from abut.errors import InputError, nearest
from abut.mesh.cell_block import CellBlock
from abut.mesh.surface import Surface


@dataclass(frozen=True)
class MeshRecord:
    """What ``Mesh`` holds, and what can be asked of it; what reads and checks meshes needs no more."""

    points: NDArray[np.float64]
    blocks: tuple[CellBlock, ...]
    bodies: Mapping[str, NDArray[np.int64]]
    surfaces: Mapping[str, NDArray[np.int64]] = field(default_factory=dict)
    node_sets: Mapping[str, NDArray[np.int64]] = field(default_factory=dict)
    axisymmetric: bool = False
    notes: tuple[str, ...] = ()
    shells: tuple[str, ...] = ()  # bodies that are shells made solid: their cells go once through the thickness
    beams: tuple[str, ...] = ()  # bodies that are beams and trusses made solid: hex20 one behind the other

    def __post_init__(self) -> None:
        points = checks.numbers(self.points, "mesh: points", (None, None))
        if points.shape[1] not in (2, 3):
            raise InputError(f"mesh: points: expected 2 or 3 coordinates each, got {points.shape[1]}")
        object.__setattr__(self, "points", points)
        blocks = checks.listed(self.blocks, "mesh: blocks", "cell blocks")
        for i, block in enumerate(blocks):
            checks.instance(block, CellBlock, f"mesh: blocks[{i}]", "a cell block (abut.mesh.mesh.CellBlock)")
        object.__setattr__(self, "blocks", blocks)
        for kind, shape in (("bodies", (None,)), ("surfaces", (None, 2)), ("node_sets", (None,))):
            given = checks.mapping(getattr(self, kind), f"mesh: {kind}", "arrays of numbers")
            parts = {
                name: checks.whole_numbers(part, f"mesh: {kind}: '{name}'", np.int64, shape)
                for name, part in given.items()
            }
            object.__setattr__(self, kind, parts)

    def __repr__(self) -> str:
        kinds = ", ".join(dict.fromkeys(block.kind for block in self.blocks))
        where = " (r, z)" if self.axisymmetric else ""
        return "\n".join(
            [
                f"Mesh: {len(self.points)} points in {self.dim}D{where}, {self.n_cells} cells ({kinds})",
                *(
                    f"  {what}: {listed(names)}"
                    for what, names in (
                        ("bodies", self.bodies),
                        ("surfaces", self.surfaces),
                        ("node sets", self.node_sets),
                    )
                    if names
                ),
            ]
        )

    @property
    def dim(self) -> int:
        """2 or 3, the length of a point."""
        return int(self.points.shape[1])

    @property
    def n_cells(self) -> int:
        """Number of cells in all blocks."""
        return sum(len(block.nodes) for block in self.blocks)

    @property
    def starts(self) -> NDArray[np.int64]:
        """First cell number of each block, and the total at the end."""
        return np.concatenate([[0], np.cumsum([len(block.nodes) for block in self.blocks])]).astype(np.int64)

    def cells_of(self, body: str) -> list[tuple[str, NDArray[np.int32], NDArray[np.int64]]]:
        """Cells of a body by block: (kind, connectivity (n, n_nodes), cell numbers (n,)). InputError: unknown name."""
        if body not in self.bodies:
            raise InputError(f"no body named {body!r} in the mesh{nearest(body, self.bodies)}")
        cells, starts = self.bodies[body], self.starts
        result = []
        for block, first, last in zip(self.blocks, starts, starts[1:]):
            here = cells[(cells >= first) & (cells < last)]
            if len(here):
                result.append((block.kind, block.nodes[here - first], here))
        return result

    def surface(self, name: str) -> Surface:
        """The facets of a named surface, over this mesh's own points array. Raises InputError for an unknown name."""
        if name not in self.surfaces:
            raise InputError(f"no surface named {name!r} in the mesh{nearest(name, self.surfaces)}")
        return self.facets(self.surfaces[name], name)

    def facets(self, rows: NDArray[np.int64], name: str = "surface") -> Surface:
        """Facets given as rows (cell number, local facet number)."""
        cells, local = rows[:, 0], rows[:, 1]
        kinds = np.zeros(len(rows), dtype=np.uint8)
        nodes = np.full((len(rows), MAX_FACET_NODES), -1, dtype=np.int32)
        starts = self.starts
        for block, first, last in zip(self.blocks, starts, starts[1:]):
            inside = (cells >= first) & (cells < last)
            for number, (kind, local_nodes) in enumerate(CELLS[block.kind].facets):
                pick = np.flatnonzero(inside & (local == number))
                kinds[pick] = CELLS[kind].code
                nodes[pick, : len(local_nodes)] = block.nodes[cells[pick] - first][:, local_nodes]
        return Surface(self.points, kinds, nodes, cells.copy(), local.copy(), name, self.axisymmetric)

    def nodes_of(self, name: str) -> NDArray[np.int64]:
        """Sorted point numbers of a surface, node set or body. Raises InputError for an unknown name."""
        if name in self.surfaces:
            return self.surface(name).node_ids
        if name in self.node_sets:
            return self.node_sets[name]
        if name in self.bodies:
            used = np.zeros(len(self.points), dtype=bool)
            for _, nodes, _ in self.cells_of(name):
                used[nodes] = True
            return np.flatnonzero(used)
        known = [*self.surfaces, *self.node_sets, *self.bodies]
        raise InputError(f"no surface, node set or body named {name!r} in the mesh{nearest(name, known)}")

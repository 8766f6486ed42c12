"""The deforming bodies of a mesh as their kernels see them: one record, and its cells in groups that are treated alike."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace
from functools import cached_property
from typing import Any

import numpy as np
from numpy.typing import NDArray

from abut._core import Cells, block_pattern, node_pattern, shape_functions
from abut.bodies.corner_pressures import KIND, CornerPressures, numbered
from abut.cells import CELLS
from abut.materials.kernel import Kernel
from abut.materials.material import Material, compiled
from abut.materials.places import is_local, uniform_expansion
from abut.materials.volume_split import VolumeSplit, volume_split
from abut.mesh.mesh import Mesh
from abut.mesh.patches import Patches, patches
from abut.mesh.quadrature import PRESSURES, Rule, cell_rule

Array = NDArray[np.float64]
PORTION = 2**17  # integration points that a material evaluates at once; their tangents take 300 bytes each


@dataclass(frozen=True)
class Solids:
    """Bodies of a mesh and what they are made of; bodies without a material have no stiffness.

    plane: "strain", "stress" or "axisymmetric" (as the mesh then is) in 2D; integration: by body, as in ``Solid``,
    "full" for those not named, theory (E1), (E2), (E3); kinematics: as in ``Model``."""

    mesh: Mesh
    materials: Mapping[str, Material]
    plane: str | None = None
    integration: Mapping[str, str] = field(default_factory=dict)
    kinematics: str = "small"

    @cached_property
    def points(self) -> Array:
        """(n_points, dim), contiguous."""
        return np.ascontiguousarray(self.mesh.points)

    @cached_property
    def pattern(self) -> tuple[NDArray[np.int64], NDArray[np.int32]]:
        """CSR (indptr, indices) of which nodes share a cell."""
        blocks = self.mesh.blocks
        counts = [np.full(len(b.nodes), b.nodes.shape[1]) for b in blocks]
        start = np.concatenate([[0], np.cumsum(np.concatenate(counts))]).astype(np.int64)
        return node_pattern(len(self.points), start, np.concatenate([b.nodes.ravel() for b in blocks]).astype(np.int32))

    @cached_property
    def rows(self) -> tuple[NDArray[np.integer[Any]], NDArray[np.int32]]:
        """CSR (indptr, indices) of matrices on displacements, which share it: a tangent brings its values only. Not to be
        written to."""
        indptr, indices = block_pattern(*self.pattern, self.mesh.dim)
        if len(indices) < 2**31:
            indptr = indptr.astype(np.int32)
        indptr.flags.writeable = indices.flags.writeable = False
        return indptr, indices

    @property
    def constant(self) -> bool:
        """Whether forces are linear in displacements: ``stiffness`` is then all there is to know."""
        return self.kinematics == "small" and all(material.constant for material in self.materials.values())

    @cached_property
    def body_of(self) -> NDArray[np.int32]:
        """Number of each cell's body in ``materials``, -1 without; (n_cells,)."""
        result = np.full(self.mesh.n_cells, -1, dtype=np.int32)
        for number, body in enumerate(self.materials):
            result[self.mesh.bodies[body]] = number
        return result

    @cached_property
    def patches(self) -> Patches:
        """Over which stresses are recovered."""
        return patches(self.mesh, self.body_of)

    def groups(self) -> Sequence[Group]:
        """All cells that have a material."""
        return self._groups

    @cached_property
    def _groups(self) -> tuple[Group, ...]:
        return tuple(self.cellwise._found())

    @cached_property
    def cellwise(self) -> Solids:
        """What is integrated cell by cell: all but ``pressures``. The same object where there are none."""
        if not self._split:
            return self
        rest = {body: split.rest for body, split in self._split.items()}
        full = {**self.integration, **dict.fromkeys(rest, "full")}
        return replace(self, materials={**self.materials, **rest}, integration=full)

    @cached_property
    def pressures(self) -> CornerPressures | None:
        """Those that are continuous, theory (E8), None where there are none."""
        if not self._split:
            return None
        parts = [self.mesh.cells_of(body)[0] for body in self._split]  # of one type each
        body = np.repeat(np.arange(len(parts)), [len(cells) for _, _, cells in parts])
        nodes = np.ascontiguousarray(np.concatenate([nodes for _, nodes, _ in parts]), dtype=np.int32)
        corner, owner = numbered(nodes, body)
        laws = [split.volume for split in self._split.values()]
        return CornerPressures(
            self.points, nodes, np.concatenate([cells for _, _, cells in parts]), corner, laws, owner
        )

    @cached_property
    def _split(self) -> dict[str, VolumeSplit]:
        """Bodies whose pressures are continuous."""
        result = {}
        for body, material in self.materials.items():
            if self.integration.get(body) == "mixed" and KIND in {kind for kind, _, _ in self.mesh.cells_of(body)}:
                split = volume_split(material, self.kinematics == "finite")
                assert split is not None, f"body '{body}': checked by the model"
                result[body] = split
        return result

    def _found(self) -> Iterator[Group]:
        kernels, keys = {}, {}
        for body, material in self.materials.items():
            known = compiled(material, self.kinematics == "finite")
            kernel = None if known is None else known.kernel
            alone = "" if kernel is not None and kernel.together else body
            keys[body] = alone, "" if kernel is None else kernel.name, self.integration.get(body, "full")
            kernels[keys[body]] = kernel
        distinct = sorted(set(keys.values()))
        number = np.array([-1, *(distinct.index(key) for key in keys.values())])
        used = dict.fromkeys(distinct, 0)
        for block, first in zip(self.mesh.blocks, self.mesh.starts.tolist()):
            body_numbers = number[1 + self.body_of[first : first + len(block.nodes)]]
            for i in np.unique(body_numbers[body_numbers >= 0]).tolist():
                rows = np.flatnonzero(body_numbers == i)
                nodes = np.ascontiguousarray(block.nodes[rows], dtype=np.int32)
                body, _, integration = distinct[i]
                group = Group(
                    block.kind, nodes, first + rows, body, integration, used[distinct[i]], kernels[distinct[i]]
                )
                yield group
                used[distinct[i]] += len(rows) * len(group.rule[1])

    def by_cell(self, group: Group, values: Mapping[str, tuple[float, ...]]) -> Array:
        """A row for every cell of a group, from those of all bodies."""
        return np.array([values[body] for body in self.materials], dtype=float)[self.body_of[group.cells]]


@dataclass(frozen=True)
class Group:
    """Cells of one type that are integrated alike: nodes (n, n_nodes), cells (n,) their numbers. body: whose material it is;
    empty for bodies that go together. first: row of its first point in the history of its body. kernel: that integrates it,
    None: the material is evaluated in Python."""

    kind: str
    nodes: NDArray[np.int32]
    cells: NDArray[np.int64]
    body: str
    integration: str
    first: int
    kernel: Kernel | None = None

    @cached_property
    def rule(self) -> Rule:
        """With which stresses are integrated."""
        return cell_rule(self.kind, self.integration)

    def arrays(self, solids: Solids, rule: Rule) -> Cells:
        """These cells with an integration rule, for the compiled core."""
        xi, weights = rule
        shapes, derivatives = shape_functions(CELLS[self.kind].code, np.ascontiguousarray(xi))
        axisymmetric, mean = solids.mesh.axisymmetric, self.integration == "b-bar"
        pressures = PRESSURES.get(self.kind, 0) if self.integration == "mixed" else 0
        return Cells(solids.points, self.nodes, shapes, derivatives, weights, axisymmetric, mean, pressures)

    def portions(self, rule: Rule) -> Iterator[Group]:
        """Some cells after the other."""
        size = max(PORTION // len(rule[1]), 1)
        for i in range(0, len(self.cells), size):
            nodes, cells = self.nodes[i : i + size], self.cells[i : i + size]
            yield replace(self, nodes=nodes, cells=cells, first=self.first + i * len(rule[1]))


@dataclass(frozen=True)
class TemperatureChange:
    """Degrees: uniform by body (0 for those not named), and at the nodes (n_points,), which the shape functions interpolate,
    but count with their mean in cells of first order, theory (F10); both add up. elapsed: time since the history, as in
    ``Places``."""

    bodies: Mapping[str, float] = field(default_factory=dict)
    nodes: Array | None = None
    elapsed: float = 0.0

    def strain(self, solids: Solids, group: Group) -> Array | None:
        """Thermal strain of a group's cells at their nodes, (cells, n_nodes), alike in all directions; None where there is
        none."""
        table = {body: (uniform_expansion(material),) for body, material in solids.materials.items()}
        if not any(expansion for (expansion,) in table.values()):
            return None
        degrees = self.degrees(solids, group)
        return None if degrees is None else np.ascontiguousarray(solids.by_cell(group, table) * degrees)

    def degrees(self, solids: Solids, group: Group) -> Array | None:
        """Change of a group's cells at their nodes, (cells, n_nodes); None where there is none."""
        heated = self.nodes is not None and self.nodes.any()
        if not (heated or any(self.bodies.get(body) for body in solids.materials)):
            return None
        uniform = solids.by_cell(group, {body: (self.bodies.get(body, 0.0),) for body in solids.materials})
        change = (
            np.broadcast_to(uniform, group.nodes.shape) if self.nodes is None else uniform + self.nodes[group.nodes]
        )
        if CELLS[group.kind].degree == 1:  # whose strains cannot follow what varies within a cell
            change = np.broadcast_to(change.mean(axis=1, keepdims=True), group.nodes.shape)
        return np.ascontiguousarray(change)

    def acts(self, solids: Solids) -> bool:
        """Whether some body may be strained."""
        for group in solids.groups():
            local = group.body and is_local(solids.materials[group.body])
            if (self.degrees if local else self.strain)(solids, group) is not None:
                return True
        return False


UNHEATED = TemperatureChange()

"""Meshes of other codes, in whatever order they number the nodes of a cell, as meshes of abut."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

import abut
from abut._core import shape_functions
from abut.cells import CELLS
from abut.mesh.cell_block import CellBlock
from abut.mesh.facets import corner_keys, facet_keys, number_keys
from abut.mesh.reference import reference_nodes

FLIPPED = {
    "tri": (0, 2, 1), "quad": (0, 3, 2, 1), "tet": (0, 2, 1, 3), "hex": (0, 3, 2, 1, 4, 7, 6, 5),
    "wedge": (0, 2, 1, 3, 5, 4),
}  # fmt: skip


class NotReadable(Exception):
    """A case says what these scripts, or abut, do not know; the text says what."""


@dataclass(frozen=True)
class Part:
    """Cells or facets of one kind: names (n,) that the file gives them, nodes (n, k) rows of the points."""

    kind: str
    names: Sequence[str]
    nodes: NDArray[np.int64]


@dataclass
class ForeignMesh:
    """points: (n, dim); names: of the points; groups of cells and of nodes: by name, names of their members."""

    points: NDArray[np.float64]
    names: Sequence[str]
    parts: list[Part]
    cell_groups: dict[str, list[str]] = field(default_factory=dict)
    node_groups: dict[str, list[str]] = field(default_factory=dict)

    def __post_init__(self) -> None:
        self.row = {name: i for i, name in enumerate(self.names)}
        self.place = {name: (p, i) for p, part in enumerate(self.parts) for i, name in enumerate(part.names)}

    def rows(self, names: Sequence[str]) -> NDArray[np.int64]:
        """Of points."""
        return np.array([self.row[n] for n in names], dtype=np.int64)

    def nodes_of_cells(self, names: Sequence[str]) -> NDArray[np.int64]:
        """Rows of the points of some cells or facets."""
        found = [self.parts[p].nodes[i] for p, i in (self.place[n] for n in names)]
        return np.unique(np.concatenate([np.zeros(0, np.int64), *found])).astype(np.int64)


def in_order(kind: str, nodes: NDArray[np.int64], points: NDArray[np.float64]) -> NDArray[np.int64]:
    """Nodes (n, k) of cells in abut's order: corners so that volumes are positive, others where their edge, face or cell has
    its middle."""
    cell = CELLS[kind]
    corners = nodes[:, : cell.corners].copy()
    linear = next(
        name for name, c in CELLS.items() if c.corners == cell.corners and c.degree == 1 and c.dim == cell.dim
    )
    middle = _places(linear).mean(axis=0)
    _, slopes = shape_functions(CELLS[linear].code, np.ascontiguousarray(middle[None]))
    jacobian = np.einsum("kd,nkx->ndx", np.asarray(slopes)[0], points[corners])
    wrong = np.linalg.det(jacobian) < 0.0
    corners[wrong] = corners[wrong][:, FLIPPED[linear.rstrip("0123456789")]]
    if cell.nodes == cell.corners:
        return corners
    values = np.asarray(shape_functions(CELLS[linear].code, np.ascontiguousarray(_places(kind)[cell.corners :]))[0])
    expected = np.einsum("ak,nkx->nax", values, points[corners])
    rest = nodes[:, cell.corners :]
    distance = np.linalg.norm(points[rest][:, None] - expected[:, :, None], axis=3)
    return np.hstack([corners, np.take_along_axis(rest, distance.argmin(axis=2), axis=1)])


def _places(kind: str) -> NDArray[np.float64]:
    """Reference coordinates of the nodes of a cell, (k, dim)."""
    return np.asarray(reference_nodes(kind), dtype=float)


def build(
    mesh: ForeignMesh, bodies: Mapping[str, Sequence[str]], surfaces: Mapping[str, Sequence[str]],
    node_sets: Mapping[str, NDArray[np.int64]], dim: int,
) -> tuple[abut.Mesh, NDArray[np.int64]]:  # fmt: skip
    """A mesh, and the number in it of each point of the file (n,), -1 for those of no body, which are left out. bodies,
    surfaces: names of cells and facets; node_sets: rows of points."""
    owner: dict[tuple[int, int], str] = {mesh.place[name]: body for body, names in bodies.items() for name in names}
    blocks, of_body, first = [], {body: [] for body in bodies}, 0
    for p, part in enumerate(mesh.parts):
        taken = [i for i in range(len(part.names)) if (p, i) in owner]
        if not taken:
            continue
        if CELLS[part.kind].dim != dim:
            raise NotReadable(f"cells {part.kind} in a model of dimension {dim}")
        blocks.append((part.kind, in_order(part.kind, part.nodes[taken], mesh.points[:, :dim])))
        for k, i in enumerate(taken):
            of_body[owner[p, i]].append(first + k)
        first += len(taken)
    used = np.unique(np.concatenate([nodes.ravel() for _, nodes in blocks]))
    new = np.full(len(mesh.points), -1)
    new[used] = np.arange(len(used))
    sets = {name: new[rows][new[rows] >= 0] for name, rows in node_sets.items()}
    made = abut.Mesh(
        points=mesh.points[used, :dim],
        blocks=tuple(CellBlock(kind, new[nodes].astype(np.int32)) for kind, nodes in blocks),
        bodies={name: np.sort(np.array(cells, dtype=np.int64)) for name, cells in of_body.items()},
        node_sets={name: np.unique(rows) for name, rows in sets.items() if len(rows)},
    )
    found = {name: _facets(mesh, made, new, members) for name, members in surfaces.items()}
    return abut.Mesh(made.points, made.blocks, made.bodies, found, made.node_sets), new


LAYERED = {
    "line2": ("quad4", (1, 0)),
    "line3": ("quad8", (1, 0)),
    "tri3": ("wedge6", (0, 1, 2)),
    "quad4": ("hex8", (0, 1, 2, 3)),
}


def layer(
    mesh: ForeignMesh, facets: Sequence[str], beside: NDArray[np.float64], name: str
) -> tuple[list[str], NDArray[np.int64]]:
    """Add a layer of cells behind facets, on the side away from a point: names of the cells, rows of the points that are
    new."""
    kinds = {mesh.parts[mesh.place[n][0]].kind for n in facets}
    if len(kinds) != 1 or not kinds <= LAYERED.keys():
        raise NotReadable(f"a rigid target of {', '.join(sorted(kinds))}")
    kind, (cell, order) = next(iter(kinds)), LAYERED[next(iter(kinds))]
    own = np.array([mesh.parts[p].nodes[i] for p, i in (mesh.place[n] for n in facets)])
    used, local = np.unique(own, return_inverse=True)
    local = local.reshape(own.shape)
    x = mesh.points[used]
    corners = own[:, : CELLS[kind].corners if kind in CELLS else 2]
    size = float(np.linalg.norm(mesh.points[corners[:, 0]] - mesh.points[corners[:, 1]], axis=1).mean())
    _, _, axes = np.linalg.svd(
        x[:, : 2 if kind.startswith("line") else 3] - x[:, : 2 if kind.startswith("line") else 3].mean(axis=0)
    )
    normal = np.zeros(mesh.points.shape[1])
    normal[: axes.shape[0]] = axes[-1]
    away = -np.sign((beside - x.mean(axis=0)) @ normal) or 1.0
    shift = away * size * normal
    first = len(mesh.points)
    behind = first + local[:, list(order)]
    cells = np.hstack([corners, behind])
    fresh = [x + shift]
    if kind == "line3":
        middle = first + len(used)
        halves, half = np.unique(corners, return_inverse=True)
        half = half.reshape(corners.shape)
        fresh.append(mesh.points[halves] + 0.5 * shift)
        cells = np.column_stack(
            [corners, behind, own[:, 2], middle + half[:, 1], first + local[:, 2], middle + half[:, 0]]
        )
    added = np.vstack(fresh)
    names = [f"{name}-{i}" for i in range(len(cells))]
    mesh.points = np.vstack([mesh.points, added])
    mesh.names = [*mesh.names, *(f"{name}-point-{i}" for i in range(len(added)))]
    mesh.parts.append(Part(cell, names, cells))
    mesh.__post_init__()
    return names, np.arange(first, first + len(added))


def _facets(mesh: ForeignMesh, made: abut.Mesh, new: NDArray[np.int64], names: Sequence[str]) -> NDArray[np.int64]:
    """Rows (n, 2) of the facets that named parts of the boundary are."""
    wanted = [np.zeros((0, 4), np.int64)]
    for p, part in enumerate(mesh.parts):
        chosen = [i for n in names for q, i in [mesh.place[n]] if q == p]
        if chosen:
            corners = CELLS[part.kind].corners if part.kind in CELLS else 2
            wanted.append(corner_keys(new[part.nodes[chosen][:, :corners]]))
    keys = np.concatenate(wanted)
    keys = keys[keys[:, 0] >= 0]  # points of no body come first
    own, rows = facet_keys(made, np.unique(keys[keys >= 0]))
    first, second = number_keys(keys, own)
    return rows[np.isin(second, first)]

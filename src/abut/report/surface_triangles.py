"""Surface triangles of a mesh: the boundary of each body and the facets of contact surfaces, as points, triangles, edges."""

from __future__ import annotations

from dataclasses import dataclass, field, replace
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray

from abut._core import shape_functions
from abut.cells import BY_CODE, CELLS, CellType
from abut.contact.geometry import area_vectors, nodal_normals
from abut.errors import InputError
from abut.mesh.exterior import outside_of_body
from abut.mesh.facets import row_codes
from abut.mesh.mesh import Mesh
from abut.mesh.surface import Surface

CREASE = np.cos(np.deg2rad(35.0))  # edges where facets meet at a larger angle are drawn always

# Triangles between a facet's own nodes: its curve is followed, and the nodes keep their values.
_TRIANGLES: dict[str, tuple[tuple[int, int, int], ...]] = {
    "tri3": ((0, 1, 2),),
    "tri6": ((0, 3, 5), (3, 1, 4), (5, 4, 2), (3, 4, 5)),
    "quad4": ((0, 1, 2), (0, 2, 3)),
    "quad8": ((0, 4, 7), (4, 1, 5), (5, 2, 6), (6, 3, 7), (4, 5, 6), (4, 6, 7)),
    "quad9": tuple(t for i in range(4) for t in ((i, 4 + i, 8), (i, 8, 4 + (i - 1) % 4))),
}


@dataclass(frozen=True)
class Skin:
    """Points by their numbers in the mesh (n,), triangles (m, 3) and edges (k, 2) between them; the first ``features``
    edges are borders and creases. inside: tetrahedra (t, 4) that fill the body, between points of their own as well."""

    nodes: NDArray[np.int64]
    triangles: NDArray[np.int64]
    edges: NDArray[np.int64]
    features: int
    inside: NDArray[np.int64] = field(default_factory=lambda: np.empty((0, 4), np.int64))

    def filled(self, tetrahedra: NDArray[np.int64]) -> Skin:
        """The same with tetrahedra between points of the mesh; points that only these have come last."""
        more = np.setdiff1d(tetrahedra, self.nodes)
        nodes = np.concatenate([self.nodes, more])
        order = np.argsort(nodes)
        return replace(self, nodes=nodes, inside=order[np.searchsorted(nodes, tetrahedra, sorter=order)])


@dataclass(frozen=True)
class Patch:
    """Facets of a surface, each divided finely enough to show a quadratic pressure; facets share no points.

    samples: by facet type, (facets (f,), shape functions (p, nodes)), in the order of the points.
    cells: triangles (m, 3), in 2D lines (m, 2); edges (k, 2) are the facets' own; normals (n, dim) unit, outward.
    """

    surface: Surface
    samples: tuple[tuple[NDArray[np.int64], NDArray[np.float64]], ...]
    cells: NDArray[np.int64]
    edges: NDArray[np.int64]

    def __len__(self) -> int:
        return sum(len(facets) * len(shapes) for facets, shapes in self.samples)

    def nodal(self, values: NDArray[np.float64]) -> NDArray[np.float64]:
        """Values at the facets' own nodes, (n_facets, 9, ...), at the points of the patch."""
        return np.concatenate(
            [
                np.einsum("pn,fn...->fp...", shapes, values[facets, : shapes.shape[1]]).reshape(-1, *values.shape[2:])
                for facets, shapes in self.samples
            ]
        )

    def within(self, values: NDArray[np.float64]) -> NDArray[np.float64]:
        """The same of values (n_facets, 9) that cannot be beyond the smallest and largest of all nodes; parabolas are."""
        known = values[np.isfinite(values)]
        return self.nodal(values).clip(known.min(), known.max()) if len(known) else self.nodal(values)

    def of_points(self, values: NDArray[np.float64]) -> NDArray[np.float64]:
        """Values at the mesh's points, (n_points, ...), at the points of the patch."""
        return self.nodal(values[np.maximum(self.surface.nodes, 0)])

    @property
    def points(self) -> NDArray[np.float64]:
        return self.of_points(self.surface.points)

    @property
    def normals(self) -> NDArray[np.float64]:
        try:
            vectors = self.nodal(nodal_normals(self.surface))
        except InputError:  # a target may have points without a normal: its facets are shaded each by itself
            vectors = self.nodal(area_vectors(self.surface))
        return vectors / np.maximum(np.linalg.norm(vectors, axis=1, keepdims=True), 1e-300)


def skin(mesh: Mesh, body: str, without: NDArray[np.int64]) -> Skin:
    """The skin of a body (in 2D all of it), leaving out facets given as rows (cell, local facet)."""
    if mesh.dim == 2:
        faces = [(kind, nodes.astype(np.int64)) for kind, nodes, _ in mesh.cells_of(body)]
    else:
        rows = outside_of_body(mesh, body)
        width = 1 + max(int(rows[:, 1].max(initial=0)), int(without[:, 1].max(initial=0)) if len(without) else 0)
        kept = ~np.isin(rows @ [width, 1], without @ [width, 1]) if len(without) else np.ones(len(rows), dtype=bool)
        surface = mesh.facets(rows[kept])
        faces = [
            (BY_CODE[code].name, surface.nodes[surface.kinds == code, : BY_CODE[code].nodes].astype(np.int64))
            for code in np.unique(surface.kinds)
        ]
    triangles = [nodes[:, np.array(_TRIANGLES[kind])].reshape(-1, 3) for kind, nodes in faces]
    edges, features = _edges(mesh, faces)
    every = np.concatenate([*triangles, np.empty((0, 3), np.int64)])
    seen = np.zeros(len(mesh.points), dtype=bool)
    seen[every] = seen[edges] = True
    number = np.cumsum(seen) - 1
    return Skin(np.flatnonzero(seen), number[every], number[edges], features)


def _edges(mesh: Mesh, faces: list[tuple[str, NDArray[np.int64]]]) -> tuple[NDArray[np.int64], int]:
    """Lines along the faces' edges, each once, those on borders and creases first, and how many these are."""
    ends, middles, normals = [np.empty((0, 2), np.int64)], [np.empty(0, np.int64)], [np.empty((0, 3))]
    for kind, nodes in faces:
        cell = CELLS[kind]
        x = np.pad(mesh.points, ((0, 0), (0, 3 - mesh.dim)))[nodes[:, : cell.corners]]
        normal = np.cross(x[:, 1] - x[:, 0], x[:, -1] - x[:, 0])
        normal /= np.maximum(np.linalg.norm(normal, axis=1, keepdims=True), 1e-300)
        for i in range(cell.corners):
            ends.append(np.sort(nodes[:, [i, (i + 1) % cell.corners]], axis=1))
            middles.append(nodes[:, cell.corners + i] if cell.degree == 2 else np.full(len(nodes), -1))
            normals.append(normal)
    pair, middle, side = np.concatenate(ends), np.concatenate(middles), np.concatenate(normals)
    code = row_codes(pair)
    order = np.argsort(code, kind="stable")
    pair, middle, side = pair[order], middle[order], side[order]
    first = np.concatenate([[True], np.diff(code[order]) != 0])[: len(pair)]
    count = np.diff(np.append(np.flatnonzero(first), len(pair)))
    at = np.flatnonzero(first)
    smooth = count == 2
    smooth[smooth] = np.einsum("ij,ij->i", side[at[smooth]], side[at[smooth] + 1]) > CREASE
    pair, middle = pair[at], middle[at]
    lines = []
    for chosen in (~smooth, smooth):
        curved = chosen & (middle >= 0)
        straight = pair[chosen & (middle < 0)]
        halves = [np.stack([pair[curved, i], middle[curved]], axis=1) for i in (0, 1)]
        lines.append(np.concatenate([straight, *halves]))
    return np.concatenate(lines), len(lines[0])


def patch(surface: Surface, most: int = 4) -> Patch:
    """A surface divided: at most ``most`` lines along an edge (one where the facet is a straight line or triangle)."""
    samples, cells, edges = [], [np.empty((0, surface.dim), np.int64)], [np.empty((0, 2), np.int64)]
    first = 0
    for code in np.unique(surface.kinds):
        cell = BY_CODE[code]
        facets = np.flatnonzero(surface.kinds == code)
        lines = 1 if cell.name in ("line2", "tri3") else most
        xi, triangles, border = _lattice(cell, lines)
        shapes, _ = shape_functions(cell.code, xi)
        start = first + len(xi) * np.arange(len(facets))[:, None, None]
        cells.append((start + triangles).reshape(-1, surface.dim))
        edges.append((start + border).reshape(-1, 2))
        samples.append((facets, np.asarray(shapes)))
        first += len(xi) * len(facets)
    return Patch(surface, tuple(samples), np.concatenate(cells), np.concatenate(edges))


def _lattice(cell: CellType, n: int) -> tuple[NDArray[np.float64], NDArray[np.int64], NDArray[np.int64]]:
    """Reference points of a facet divided n times, triangles (lines) between them, lines along its border."""
    if cell.dim == 1:
        lines = np.array(list(pairwise(range(n + 1))))
        return np.linspace(-1.0, 1.0, n + 1)[:, None], lines, np.empty((0, 2), np.int64)
    triangle = cell.corners == 3
    inside = [(i, j) for j in range(n + 1) for i in range(n + 1 - (j if triangle else 0))]
    number = {place: k for k, place in enumerate(inside)}
    triangles = []
    for i, j in inside:
        here = [number.get(p) for p in ((i, j), (i + 1, j), (i + 1, j + 1), (i, j + 1))]
        for corners in ((0, 1, 3), (1, 2, 3)):
            corners_here = [here[c] for c in corners]
            if None not in corners_here:
                triangles.append(corners_here)
    span = range(n)
    border = [((i, 0), (i + 1, 0)) for i in span] + [((0, i), (0, i + 1)) for i in span]
    if triangle:
        border += [((n - i, i), (n - i - 1, i + 1)) for i in span]
    else:
        border += [((i, n), (i + 1, n)) for i in span] + [((n, i), (n, i + 1)) for i in span]
    xi = np.array(inside, dtype=float) / n
    lines = np.array([[number[a], number[b]] for a, b in border])
    return (xi if triangle else 2.0 * xi - 1.0), np.array(triangles, dtype=np.int64), lines

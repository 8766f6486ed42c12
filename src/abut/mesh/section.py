"""Sections inside bodies: where a plane or a surface between cells goes through, and the mesh cut open there."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
import scipy.sparse as sp
from numpy.typing import NDArray
from scipy.sparse.csgraph import connected_components

from abut.errors import InputError
from abut.mesh.exterior import facets_of
from abut.mesh.facets import corner_keys, row_codes, single
from abut.mesh.mesh import Mesh

SLENDER = 1.2  # extent of a body along its axis over the next one, from which on the axis is known
THIN = 1.05  # area of a section over the smallest up to which it is one of the shank
ALIKE = 0.9  # cosine of the angle between the axis of a body and that of its shank
PLACES = 200  # along the axis at which sections are tried

Array = NDArray[np.float64]
Numbers = NDArray[np.int64]


@dataclass(frozen=True)
class Inside:
    """Facets between two cells of a body. first, second: (n, 2) rows (cell, local facet) of both sides; area: (n, dim)
    vectors out of the first cell; centre: (n, dim) of the facets."""

    first: Numbers
    second: Numbers
    area: Array
    centre: Array


def inside_facets(mesh: Mesh, body: str) -> Inside:
    """The facets between any two cells of a body."""
    corners, rows = facets_of(mesh.cells_of(body))
    code = row_codes(corner_keys(corners.astype(np.int64)))
    order = np.argsort(code, kind="stable")
    pair = np.flatnonzero(np.diff(code[order]) == 0)
    one, two = order[pair], order[pair + 1]
    return Inside(rows[one], rows[two], *_areas(mesh, corners[one].astype(np.int64)))


def _areas(mesh: Mesh, nodes: Numbers) -> tuple[Array, Array]:
    """Area vectors (n, dim) and centres (n, dim) of facets by their corners (n, 4), padded with -1."""
    there = nodes >= 0
    x = mesh.points[np.where(there, nodes, nodes[:, :1])]
    centre = np.where(there[:, :, None], x, 0.0).sum(axis=1) / there.sum(axis=1)[:, None]
    if mesh.dim == 2:
        along = x[:, 1] - x[:, 0]
        return np.column_stack([along[:, 1], -along[:, 0]]), centre
    last = np.where(there[:, 3, None], x[:, 3], x[:, 0])  # of triangles the fourth corner is the first again
    return 0.5 * np.cross(x[:, 2] - x[:, 0], last - x[:, 1]), centre


def plane_rows(mesh: Mesh, body: str, point: Array, normal: Array, where: str) -> Numbers:
    """Rows (n, 2) of facets whose cells lie on different sides of a plane, by their centres, each of the cell before it: the
    connected part next to ``point``. Raises InputError, beginning with ``where``, for a plane that misses the body."""
    inside = inside_facets(mesh, body)
    beyond = (_centres(mesh) - point) @ normal > 0.0
    one, two = beyond[inside.first[:, 0]], beyond[inside.second[:, 0]]
    crossed = np.flatnonzero(one != two)
    if not len(crossed):
        along = (mesh.points[mesh.nodes_of(body)] - point) @ normal
        low, high = along.min(), along.max()
        raise InputError(
            f"{where}: the plane through {np.round(point, 6).tolist()} goes through no cells of body '{body}', which "
            f"reaches from {low:.6g} to {high:.6g} along the normal from there; move the point into it"
        )
    rows = np.where(one[crossed, None], inside.second[crossed], inside.first[crossed])
    surface = mesh.facets(rows)
    used = surface.nodes >= 0
    facet = np.repeat(np.arange(len(rows)), used.sum(axis=1))
    shared = sp.csr_matrix((np.ones(len(facet)), (facet, surface.nodes[used])), shape=(len(rows), len(mesh.points)))
    _, label = connected_components(shared @ shared.T, directed=False)
    nearest = int(np.argmin(np.linalg.norm(inside.centre[crossed] - point, axis=1)))
    return rows[label == label[nearest]]


def shank(mesh: Mesh, body: str, avoid: Numbers, where: str) -> tuple[Array, Array]:
    """Point and normal of a section through the middle of the longest part of a body where its section is smallest, away
    from points ``avoid``. Raises InputError, beginning with ``where``, for a body that is not slender."""
    x = mesh.points[mesh.nodes_of(body)]
    centre = _centres(mesh)[mesh.bodies[body]]
    axis, inside = _axis(mesh, x, centre, body, where), inside_facets(mesh, body)
    held = x[np.isin(mesh.nodes_of(body), avoid)]
    first, last = _thin(mesh, inside, held, axis, where)
    axis = _along_sides(mesh, body, axis, first, last)
    first, last = _thin(mesh, inside, held, axis, where)
    middle = 0.5 * (first + last)
    between = np.abs(centre @ axis - middle) <= max(0.5 * (last - first), np.ptp(x @ axis) / PLACES)
    mean = (centre[between] if between.any() else centre).mean(axis=0)
    return mean + (middle - mean @ axis) * axis, axis


def _thin(mesh: Mesh, inside: Inside, held: Array, axis: Array, where: str) -> tuple[float, float]:
    """The longest stretch along an axis on which sections are smallest, and free of points ``held`` (n, dim) if any are."""
    along = _centres(mesh) @ axis
    one, two = along[inside.first[:, 0]], along[inside.second[:, 0]]
    low, high, signed = np.minimum(one, two), np.maximum(one, two), np.sign(two - one) * (inside.area @ axis)
    if not len(low):
        raise InputError(f"{where}: the body is one cell; give point and normal, or mesh it finer")
    places = np.linspace(low.min(), high.max(), PLACES + 2)[1:-1]
    area = np.array([signed[(low <= t) & (high > t)].sum() for t in places])
    reach, there = float((high - low).max()), np.sort(held @ axis)
    apart = np.searchsorted(there, places - reach) == np.searchsorted(there, places + reach)
    there_are = area > 0.0
    usable = there_are & apart if (there_are & apart).any() else there_are
    if not usable.any():
        raise InputError(f"{where}: the body is one cell long; give point and normal, or mesh it finer")
    run = _longest(usable & (area <= THIN * area[usable].min()))
    return float(places[run[0]]), float(places[run[1]])


def _along_sides(mesh: Mesh, body: str, axis: Array, first: float, last: float) -> Array:
    """The direction that the outside of a body between two places along an axis runs in, the axis where it has none."""
    corners, _ = facets_of(mesh.cells_of(body))
    code = row_codes(corner_keys(corners.astype(np.int64)))
    area, centre = _areas(mesh, corners[single(code)].astype(np.int64))
    size = np.linalg.norm(area, axis=1)
    here = (centre @ axis > first) & (centre @ axis < last) & (np.abs(area @ axis) < 0.5 * size)
    if mesh.axisymmetric or not here.any():
        return axis
    turned = np.linalg.eigh((area[here] / size[here, None]).T @ area[here])[1][:, 0]
    turned = np.where(np.abs(turned) < 1e-9, 0.0, turned) * np.sign(turned @ axis)
    return turned / np.linalg.norm(turned) if turned @ axis > ALIKE else axis


def cut_open(mesh: Mesh, rows: Numbers, sides: tuple[str, str], where: str) -> Mesh:
    """The mesh with points of its own for the cells beyond facets ``rows`` (n, 2) of the cells before them; node sets
    ``sides``: the points before and beyond, in the same order. Raises InputError, beginning with ``where``, for facets that
    cells of other bodies share, or that do not part the cells next to them."""
    nodes = mesh.facets(rows).node_ids.astype(np.int64)
    beyond = _beyond(mesh, rows, nodes, where)
    first = len(mesh.points)
    double = np.full(first, -1, dtype=np.int64)
    double[nodes] = first + np.arange(len(nodes))
    blocks = []
    for block, start in zip(mesh.blocks, mesh.starts):
        moved = block.nodes.copy()
        here = np.isin(start + np.arange(len(moved)), beyond)
        hit = here[:, None] & (double[moved] >= 0)
        moved[hit] = double[moved[hit]]
        blocks.append(replace(block, nodes=moved))
    sets = {
        name: np.unique(np.concatenate([own, double[own[double[own] >= 0]]])) if len(own) > 1 else own
        for name, own in mesh.node_sets.items()
    }
    return replace(
        mesh, points=np.concatenate([mesh.points, mesh.points[nodes]]), blocks=tuple(blocks),
        node_sets={**sets, sides[0]: nodes, sides[1]: double[nodes]},
    )  # fmt: skip


def _beyond(mesh: Mesh, rows: Numbers, nodes: Numbers, where: str) -> Numbers:
    """Cells at the section that are reached from those beyond it, without crossing it."""
    touching, at = [], np.zeros(len(mesh.points), dtype=bool)
    at[nodes] = True
    for block, start in zip(mesh.blocks, mesh.starts):
        near = np.flatnonzero(at[block.nodes].any(axis=1))
        touching.append((block.kind, block.nodes[near], start + near))
    corners, own = facets_of([part for part in touching if len(part[2])])
    code = row_codes(corner_keys(corners.astype(np.int64)))
    wall = np.isin(own[:, 0] * 8 + own[:, 1], rows[:, 0] * 8 + rows[:, 1])
    walls = code[wall]
    order = np.argsort(code, kind="stable")
    pair = np.flatnonzero(np.diff(code[order]) == 0)
    one, two = order[pair], order[pair + 1]
    crossing = np.isin(code[one], walls)
    if crossing.sum() < len(rows):
        raise InputError(f"{where}: the surface lies on the outside of a body somewhere; it must run between its cells")
    cells = np.unique(own[:, 0])
    place = np.searchsorted(cells, own[:, 0])
    links = (np.ones((~crossing).sum()), (place[one[~crossing]], place[two[~crossing]]))
    _, label = connected_components(sp.csr_matrix(links, shape=(len(cells),) * 2), directed=False)
    before = np.unique(label[np.searchsorted(cells, rows[:, 0])])
    other = np.where(np.isin(own[one[crossing], 0], rows[:, 0]), own[two[crossing], 0], own[one[crossing], 0])
    after = np.unique(label[np.searchsorted(cells, other)])
    if np.intersect1d(before, after).size:
        raise InputError(f"{where}: the section does not cut the body in two; it must go right through")
    stray = ~np.isin(label, np.concatenate([before, after]))
    if stray.any():
        raise InputError(
            f"{where}: {int(stray.sum())} cells of another body share points with the section; move it to where one body "
            "has points of its own"
        )
    return cells[np.isin(label, after)]


def _centres(mesh: Mesh) -> Array:
    return np.concatenate([mesh.points[block.nodes].mean(axis=1) for block in mesh.blocks])


def _axis(mesh: Mesh, x: Array, centre: Array, body: str, where: str) -> Array:
    """Along which a body is longest."""
    if mesh.axisymmetric:
        return np.array([0.0, 1.0])
    about = x - 0.5 * (x.min(axis=0) + x.max(axis=0))
    _, _, axes = np.linalg.svd(centre - centre.mean(axis=0))
    extents = np.ptp(about @ axes.T, axis=0)
    longest = int(np.argmax(extents))
    if extents[longest] < SLENDER * np.delete(extents, longest).max():
        raise InputError(
            f"{where}: body '{body}' is hardly longer than wide ({extents[longest]:.4g} by "
            f"{np.delete(extents, longest).max():.4g}): its axis is not known; give point and normal"
        )
    axis = np.where(np.abs(axes[longest]) < 1e-9, 0.0, axes[longest])
    axis = axis / np.linalg.norm(axis)
    return axis * np.sign(axis[np.argmax(np.abs(axis))])


def _longest(mask: NDArray[np.bool_]) -> tuple[int, int]:
    """First and last number of the longest run of what is true."""
    ends = np.flatnonzero(np.diff(np.concatenate([[0], mask.astype(np.int8), [0]])))
    runs = ends.reshape(-1, 2)
    best = runs[np.argmax(runs[:, 1] - runs[:, 0])]
    return int(best[0]), int(best[1]) - 1

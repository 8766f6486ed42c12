"""The nodal normals of a contactor that moves, with their derivatives by its points: theory (T2)."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np
import scipy.sparse as sp
from numpy.typing import NDArray

from abut._core import shape_functions
from abut.cells import CELLS
from abut.contact.block_rows import block_rows
from abut.contact.geometry import (
    REFERENCE_AREA,
    Smoothing,
    area_vectors,
    by_kind,
    check_normals,
    node_coordinates,
    smoothing,
)
from abut.contact.turned_images import Images
from abut.mesh.surface import Surface
from abut.types import Array, Sparse


@dataclass(frozen=True)
class MovingNormals:
    """Nodal normals at one place of a surface. numbers: (n_facets, 9) of the m that differ, -1 where padded; values:
    (n_facets, 9, dim) unit, out of the surface, zero where padded; blocks: of their derivatives, (value (n, dim, dim),
    column (n,), start (m + 1,)), a column being a point."""

    numbers: NDArray[np.int32]
    values: NDArray[np.float64]
    blocks: tuple[Array, Array, Array]

    def turning(self, n_points: int) -> Sparse:
        """The derivatives by all points, (dim m, dim n_points) in blocks."""
        return block_rows(self.blocks, n_points)


@dataclass(frozen=True)
class NormalPattern:
    """What the nodal normals of a surface depend on, wherever its points are; ``normal_pattern``.

    numbers: as in ``MovingNormals``; sums: (m, n_visits) which facets' area vectors make each normal (a visit is a node of a
    facet, as in ``Smoothing``, images among them); gather: (n_blocks, n_rates) which derivatives of area vectors by a point
    make each block; row, column: (n_blocks,) normal and point; on_planes, inside: (k,) normals in planes of symmetry, (k,
    dim, dim) projections on these; images, image_rates: the images, and of which derivatives theirs are, turned, with the
    number of the image, (n_image_rates,)."""

    numbers: NDArray[np.int32]
    sums: Sparse
    gather: Sparse
    row: NDArray[np.int64]
    column: NDArray[np.int32]
    on_planes: NDArray[np.int32]
    inside: NDArray[np.float64]
    images: Images | None
    image_rates: tuple[NDArray[np.int64], NDArray[np.int64]]

    @cached_property
    def _start(self) -> NDArray[np.int32]:
        return np.searchsorted(self.row, np.arange(self.sums.shape[0] + 1)).astype(np.int32)

    def at(self, surface: Surface) -> MovingNormals:
        """At the surface's points. Raises InputError for a facet without a normal at one of its nodes."""
        dim, used = surface.dim, surface.nodes >= 0
        areas = area_vectors(surface)
        total = self.sums @ (areas[used] if self.images is None else self.images.with_images(areas[used]))
        total[self.on_planes] = np.einsum("kab,kb->ka", self.inside, total[self.on_planes])
        length = np.linalg.norm(total, axis=1)
        check_normals(surface, areas, length[self.numbers[used], None])
        unit = total / length[:, None]
        values = np.zeros_like(areas)
        values[used] = unit[self.numbers[used]]
        rates = np.concatenate([part.reshape(-1, dim * dim) for part in _all_rates(surface)])
        if self.images is not None:
            rate, turn = self.image_rates
            turned = self.images.turns[turn] @ rates[rate].reshape(-1, dim, dim)
            rates = np.concatenate([rates, turned.reshape(-1, dim * dim)])
        swelling = (self.gather @ rates).reshape(-1, dim, dim)
        across = (np.eye(dim) - unit[:, :, None] * unit[:, None, :]) / length[:, None, None]
        across[self.on_planes] = across[self.on_planes] @ self.inside
        return MovingNormals(self.numbers, values, (across[self.row] @ swelling, self.column, self._start))


def normal_pattern(surface: Surface, across: Smoothing | None = None) -> NormalPattern:
    """Of a surface whose creases are those of another configuration, or its own."""
    across = across or smoothing(surface)
    numbers, first = _distinct(surface, across)
    of_image = np.zeros(0, dtype=np.int64) if across.images is None else across.images.source
    m, own_visits = len(first), len(numbers[surface.nodes >= 0])
    visits = own_visits + len(of_image)
    kept = np.isin(across.here, first)
    own = numbers[surface.nodes >= 0][across.here[kept]]
    sums = sp.csr_matrix((np.ones(len(own)), (own, across.other[kept])), shape=(m, visits))
    visit, node = _rate_places(surface)
    image_rates = _image_rates(visit, of_image)
    visit = np.concatenate([visit, own_visits + image_rates[1]])
    node = np.concatenate([node, node[image_rates[0]]])
    rates = sp.csr_matrix((np.ones(len(visit)), (visit, np.arange(len(visit)))), shape=(visits, len(visit)))
    both = (sums @ rates).tocoo()
    n_points = len(surface.points)
    keys, place = np.unique(both.row.astype(np.int64) * n_points + node[both.col], return_inverse=True)
    gather = sp.csr_matrix((both.data, (place.ravel(), both.col)), shape=(len(keys), len(visit)))
    on_planes, inside = _in_planes(surface, across, numbers)
    return NormalPattern(
        numbers, sums, gather, keys // n_points, (keys % n_points).astype(np.int32), on_planes, inside, across.images,
        image_rates,
    )  # fmt: skip


def _image_rates(visit: NDArray[np.int64], source: NDArray[np.int64]) -> tuple[NDArray[np.int64], NDArray[np.int64]]:
    """Which derivatives those of images are, turned, and the number of each one's image. visit: of every derivative; source:
    (n_images,) the visit that each is of."""
    if not len(source):
        return source, source
    order = np.argsort(visit, kind="stable")
    first, last = (np.searchsorted(visit[order], source, side) for side in ("left", "right"))
    image = np.repeat(np.arange(len(source)), last - first)
    place = np.arange(len(image)) - np.repeat(np.cumsum(last - first) - last, last - first)
    return order[place], image


def _in_planes(
    surface: Surface, across: Smoothing, numbers: NDArray[np.int32]
) -> tuple[NDArray[np.int32], NDArray[np.float64]]:
    """Numbers (k,) of the normals in planes of symmetry, and projections (k, dim, dim) on these."""
    if across.planes is None:
        return np.zeros(0, dtype=np.int32), np.zeros((0, surface.dim, surface.dim))
    own, first = np.unique(numbers[surface.nodes >= 0][across.planes.visits], return_index=True)
    return own, across.planes.inside[first]


def _distinct(surface: Surface, across: Smoothing) -> tuple[NDArray[np.int32], NDArray[np.int64]]:
    """Numbers of the nodal normals that differ, (n_facets, 9), and the first visit that has each."""
    used = surface.nodes >= 0
    images = 0 if across.images is None else len(across.images.source)
    keys = np.random.default_rng(0).integers(0, 2**63, int(used.sum()) + images, dtype=np.uint64)
    total = np.zeros(int(used.sum()), dtype=np.uint64)  # the same where the same facets are averaged
    np.add.at(total, across.here, keys[across.other])
    _, first, number = np.unique(total, return_index=True, return_inverse=True)
    numbers = np.full(surface.nodes.shape, -1, dtype=np.int32)
    numbers[used] = number.ravel()
    return numbers, first


def _rate_places(surface: Surface) -> tuple[NDArray[np.int64], NDArray[np.int64]]:
    """Visit and point of every derivative of ``_all_rates``."""
    visit = np.full(surface.nodes.shape, -1)
    used = surface.nodes >= 0
    visit[used] = np.arange(int(used.sum()))
    rows, columns = [], []
    for kind, facets in by_kind(surface):
        n = CELLS[kind].nodes
        shape = len(facets), n, n
        rows.append(np.broadcast_to(visit[facets, :n, None], shape).ravel())
        columns.append(np.broadcast_to(surface.nodes[facets, None, :n], shape).ravel())
    return np.concatenate(rows), np.concatenate(columns).astype(np.int64)


def _all_rates(surface: Surface) -> list[NDArray[np.float64]]:
    """Derivatives of the area vectors at each facet's nodes by its points, (facets, nodes, nodes, dim, dim) by kind."""
    return [_area_rates(surface, kind, surface.nodes[facets, : CELLS[kind].nodes]) for kind, facets in by_kind(surface)]


def _area_rates(surface: Surface, kind: str, nodes: Array) -> NDArray[np.float64]:
    """Of facets of one kind."""
    cell = CELLS[kind]
    _, slopes = shape_functions(cell.code, np.ascontiguousarray(node_coordinates(kind)))  # (at, node, direction)
    if surface.dim == 2:
        turn = np.array([[0.0, 1.0], [-1.0, 0.0]])
        return np.broadcast_to(slopes[None, :, :, 0, None, None] * turn, (len(nodes), *slopes.shape[:2], 2, 2))
    tangents = np.einsum("pja,fjd->fpad", slopes, surface.points[nodes])
    along, up = crossing(tangents[:, :, 0]), crossing(tangents[:, :, 1])
    first, second = slopes[None, :, :, 0, None, None], slopes[None, :, :, 1, None, None]
    return REFERENCE_AREA[cell.corners] * (second * along[:, :, None] - first * up[:, :, None])


def crossing(v: Array) -> NDArray[np.float64]:
    """The matrices (..., 3, 3) of w -> v x w."""
    result = np.zeros((*v.shape, 3))
    for a, b, c in ((0, 1, 2), (1, 2, 0), (2, 0, 1)):
        result[..., a, c], result[..., c, a] = v[..., b], -v[..., b]
    return result

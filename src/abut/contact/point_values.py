"""The reported pressure: values at the facets' nodes from averages over corner functions, as in theory (P18) and after."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from abut.cells import CELLS
from abut.contact.geometry import by_kind
from abut.contact.nodal_recovery import Averages, at_facet_nodes
from abut.contact.star_fits import (
    Polynomials,
    StarFits,
    Supports,
    corner_weights,
    neighbours,
    of_second_order,
    star_fits,
    summed,
    supports,
)
from abut.mesh.surface import Surface

CLOSED = 1e-3  # average over the largest from which on a point counts as in contact
WHOLE = 1e-2  # a support covered to within this share is fully covered
ROUNDS = 3  # after which points that turn out to lie beyond the edge of contact are taken for open
PASSES = 8  # at the edge of contact, each half of the way: values change by 1e-3 of the largest in the last
TAKEN = 2.0 / np.pi * np.arctan(2.0)  # theory (P20), of the force over an open point's function
SWING = 1.0  # of the range of averages around a point: values farther from the average are no correction

Array = NDArray[np.float64]
Flags = NDArray[np.bool_]
Ids = NDArray[np.int64]


@dataclass(frozen=True)
class Places:
    """Where a contactor's pressure is known to be smooth. normals: (n_points, dim) unit; across: (n_points, 2, dim) unit
    normals of planes of symmetry through points, zero where there are none; rim: (n_points,) bool, the contactor ends there
    without one; ends: (n_points,) bool, of these the ones where the pressure may have no bound."""

    normals: Array
    across: Array
    rim: Flags
    ends: Flags

    @property
    def along(self) -> Array:
        """Projections on the directions in which there may be a slope, (n_points, dim, dim): along the surface, and not
        across planes of symmetry."""
        square = np.concatenate([self.normals[:, None], self.across], axis=1)
        return np.eye(square.shape[2]) - np.einsum("nia,nib->nab", square, square)


@dataclass(frozen=True)
class PointValues:
    """A field at the corner points of a surface. value: (n_points,); slope: (n_points, dim); square_slope: the same of its
    square; known: (n_points,) where there are slopes; edge: (n_points,) at and next to the edge of contact, where the square
    is smooth and the field is not."""

    value: Array
    slope: Array
    square_slope: Array
    known: Flags
    edge: Flags

    def at_facet_nodes(self, surface: Surface, signed: bool = False) -> Array:
        """At every node of each facet, (n_facets, 9), NaN where padded; theory (P21), (P22). signed: it may be negative."""
        result = at_facet_nodes(surface, self.value)
        for kind, facets in by_kind(surface):
            cell = CELLS[kind]
            if cell.degree == 1:
                continue
            corners = surface.nodes[facets, : cell.corners].astype(np.int64)
            ends = [(0, 1)] if cell.dim == 1 else [(i, (i + 1) % cell.corners) for i in range(cell.corners)]
            for k, (i, j) in enumerate(ends):
                result[facets, cell.corners + k] = self._between(surface, corners[:, i], corners[:, j], signed)
            if cell.nodes == 9:
                edges, at_corners = result[facets, 4:8].sum(axis=1), result[facets, :4].sum(axis=1)
                middle = 0.5 * edges - 0.25 * at_corners
                result[facets, 8] = middle if signed else np.maximum(middle, 0.0)
        return result

    def _between(self, surface: Surface, a: Ids, b: Ids, signed: bool) -> Array:
        """In the middle between points a and b, (m,)."""
        step, one, other = surface.points[b] - surface.points[a], self.value[a], self.value[b]
        known = self.known[a] & self.known[b]
        plain = 0.5 * (one + other)
        bulge, of_square = ((((s[a] - s[b]) * step).sum(axis=1) / 8.0) for s in (self.slope, self.square_slope))
        if signed:
            return np.where(known, plain + bulge, plain)
        root = np.sqrt(np.maximum(0.5 * (one**2 + other**2) + of_square, 0.0))
        result = np.where(known, np.where(self.edge[a] | self.edge[b], root, plain + bulge), plain)
        for near, far, way in ((a, b, step), (b, a, -step)):  # from the last point in contact outwards
            out = self.known[near] & ~self.known[far] & (self.value[far] <= CLOSED * self.value[near])
            found = np.sqrt(np.maximum(self.value[near] ** 2 + 0.5 * (self.square_slope[near] * way).sum(axis=1), 0.0))
            result = np.where(out, np.clip(found, 0.25 * self.value[near], 0.75 * self.value[near]), result)
        return np.maximum(result, 0.25 * (np.sqrt(np.maximum(one, 0.0)) - np.sqrt(np.maximum(other, 0.0))) ** 2)


@dataclass(frozen=True)
class Recovery:
    """A contact's pressure at points and facets' nodes, and other fields there in the same way.

    pressure: at points; nodal: (n_facets, 9) at the facets' nodes, NaN where padded; average: (n_points,) what it was
    recovered from; the rest is how."""

    at: Averages
    average: Array
    pressure: PointValues
    nodal: Array
    stars: _Stars
    fits: StarFits | None
    of: Supports
    across: Array

    def field(self, values: Array) -> Array:
        """A field that is at most in proportion to the pressure, of facet-wise coefficients (9 n_facets,), at the facets'
        nodes, (n_facets, 9): next to the edge of contact with the pressure's ratio of value to average, theory (P23)."""
        average, surface, edge = self.at.of(values), self.at.surface, self.pressure.edge
        if self.fits is None:
            return at_facet_nodes(surface, average)
        found = _smooth(surface, average, _untouched(average), self.stars, self.fits, self.of, self.across)
        ratio = _divided(average, self.average)
        value = np.where(edge, ratio * self.pressure.value, found.value)
        result = replace(found, value=value, known=found.known & ~edge).at_facet_nodes(surface, signed=True)
        some = (self.pressure.value > 0.0).astype(float)
        mean = _divided(at_facet_nodes(surface, ratio * some), at_facet_nodes(surface, some))
        middle = at_facet_nodes(surface, edge.astype(float))
        here = (middle > 0.0) & (np.arange(surface.nodes.shape[1]) >= _corners(surface)[:, None])
        return np.where(here, mean * self.nodal, result)


def recovered(at: Averages, average: Array, plain: Array, places: Places, tied: bool = False) -> Recovery:
    """The pressure of averages (n_points,) at the points of ``at.surface``, theory (P18), (P19), (P20); ``plain``
    (n_points,) where it is not known any better: on facets of first order, of whose cells the nodal averages are values at
    the nodes already, at points that facets without target belong to, and at ends of the contactor. tied: a tie, which may
    pull."""
    closed = at.weight > 0.0 if tied else average > CLOSED * average.max(initial=0.0)
    stars, of = _stars(at, closed, places), supports(at.surface, places.across)
    for _ in range(ROUNDS):
        values, fits = _untouched(plain), None
        if not stars.inner.any():
            break
        fits = star_fits(at.surface, np.flatnonzero(stars.inner), places.normals, places.across, of)
        values = _smooth(at.surface, average, values, stars, fits, of, places.across)
        if not stars.edge.any():
            break
        values = _at_edge(at, average, values, stars, fits, places.across)
        if (values.value[stars.edge] > 0.0).all():
            break
        stars = _stars(at, closed & ~(stars.edge & (values.value <= 0.0)), places)
    low, high = _range(stars, average)
    value = np.clip(values.value, average - SWING * (high - low), average + SWING * (high - low))
    values = replace(values, value=np.where(values.known, value if tied else np.maximum(value, 0.0), values.value))
    return Recovery(at, average, values, values.at_facet_nodes(at.surface, tied), stars, fits, of, places.across)


def _untouched(average: Array) -> PointValues:
    nothing, none = np.zeros((len(average), 1)), np.zeros(len(average), dtype=bool)
    return PointValues(average, nothing, nothing, none, none)


def _divided(values: Array, by: Array) -> Array:
    return np.asarray(np.where(by > 0.0, values / np.where(by > 0.0, by, 1.0), 0.0))


def _corners(surface: Surface) -> Ids:
    """How many corners each facet has, (n_facets,)."""
    count = np.zeros(len(surface), dtype=np.int64)
    for kind, facets in by_kind(surface):
        count[facets] = CELLS[kind].corners
    return count


@dataclass(frozen=True)
class _Stars:
    """one, other: pairs of neighbours; inner, edge, outer: (n_points,) points in contact all of whose neighbours are, those
    with an open neighbour, and further ones; the last two next to inner ones; near: inner ones next to the edge; open: the
    rest."""

    one: Ids
    other: Ids
    inner: Flags
    edge: Flags
    outer: Flags
    near: Flags
    open: Flags

    def models(self, points: Flags, across: Array) -> tuple[Ids, Ids]:
        """Pairs of a point and an inner neighbour whose polynomial holds there; on planes of symmetry one that lies there
        too, if there is such a neighbour: only these are even."""
        use = points[self.one] & self.inner[self.other]
        one, other = self.one[use], self.other[use]
        same = np.abs((across[one][:, :, None] * across[other][:, None]).sum(axis=-1)).max(axis=(1, 2)) > 0.5
        keep = same | ~_any(one, same, len(points))[one]
        return one[keep], other[keep]


def _any(one: Ids, flags: Flags, n: int) -> Flags:
    return np.asarray(np.bincount(one, flags, n) > 0.0)


def _stars(at: Averages, closed: Flags, places: Places) -> _Stars:
    one, other = neighbours(at.surface)
    n, c = len(closed), at.surface.dim - 1
    usable = closed & (np.abs(at.share - 1.0) <= WHOLE) & of_second_order(at.surface, at.exact)
    count = np.bincount(one, _images(places.across, one, other), n)  # those on a plane are their own images
    enough = count >= c + c * (c + 1) // 2
    even = ~_any(one, (~usable | places.ends)[other], n)  # an average beside a pressure without bound is no quadratic's
    inner = usable & enough & ~places.rim & even & (np.bincount(one, minlength=n) > 0)
    further = usable & ~inner & ~places.ends & _any(one, inner[other], n)
    edge = further & _any(one, ~closed[other], n)
    near = inner & _any(one, edge[other], n)
    return _Stars(one, other, inner, edge, further & ~edge, near, ~closed)


def _range(stars: _Stars, average: Array) -> tuple[Array, Array]:
    """Least and largest average among each point and its neighbours, (n_points,) each."""
    low, high = average.copy(), average.copy()
    np.minimum.at(low, stars.one, average[stars.other])
    np.maximum.at(high, stars.one, average[stars.other])
    return low, high


def _smooth(
    surface: Surface, average: Array, before: PointValues, stars: _Stars, fits: StarFits, of: Supports, across: Array
) -> PointValues:
    """By theory (P18), (P19): at inner points, and at outer ones with the polynomials of inner neighbours."""
    value, slope, points = before.value.copy(), np.zeros_like(surface.points), fits.points
    found = fits.to_averages(average)
    value[points], slope[points] = found.value, found.gradient
    use = stars.outer[stars.one] & stars.inner[stars.other]
    here, other = stars.one[use], stars.other[use]
    model = found.some(np.searchsorted(points, other))
    gradient = model.slope(surface.points[here], surface.points[other])
    less = (gradient * of.mean[here]).sum(axis=1) + 0.5 * (model.curvature * of.square[here]).sum(axis=(1, 2))
    each = _mean(here, np.column_stack([less, gradient]), len(value), _images(across, here, other))
    value[stars.outer], slope[stars.outer] = (average - each[:, 0])[stars.outer], each[stars.outer, 1:]
    for normal in np.moveaxis(across, 1, 0):  # the mean with images
        slope[stars.outer] -= ((slope * normal).sum(axis=1, keepdims=True) * normal)[stars.outer]
    known = stars.inner | stars.outer
    return PointValues(value, slope, 2.0 * value[:, None] * slope, known, before.edge)


def _at_edge(
    at: Averages, average: Array, before: PointValues, stars: _Stars, fits: StarFits, across: Array
) -> PointValues:
    """By theory (P20): at the edge of contact and next to it."""
    surface, points, own = at.surface, fits.points, np.flatnonzero(stars.near)
    edge, other = stars.models(stars.edge, across)
    here, model = np.concatenate([own, edge]), np.concatenate([own, other])
    number, some = np.searchsorted(points, model), stars.near | stars.edge
    value = np.where(some, average, before.value)
    for _ in range(PASSES):
        squares = fits.to_values(value**2)
        root = np.sqrt(np.maximum(squares.some(number).at(surface.points[here][:, None], surface.points[model]), 0.0))[
            :, 0
        ]
        held = _root_averages(
            surface, here, model, squares.some(number), stars.open, np.maximum(average, 0.0) * at.weight
        )
        more = _mean(here, (root - held)[:, None], len(value))[:, 0]
        value = np.where(some, 0.5 * (value + np.maximum(average + more, 0.0)), value)
    squares = fits.to_values(value**2)
    of_square, slope = before.square_slope.copy(), before.slope.copy()
    of_square[points] = squares.gradient
    gradient = squares.some(number).slope(surface.points[here], surface.points[model])
    of_square[some] = _mean(here, gradient, len(value))[some]
    safe = some & (value > CLOSED * average.max())
    slope[safe] = of_square[safe] / (2.0 * value[safe, None])
    return PointValues(value, slope, of_square, before.known | stars.edge, some)


def _mean(here: Ids, values: Array, n: int, weight: Array | None = None) -> Array:
    """Means (n, c) of values (m, c) by point, 0 for none."""
    if weight is None:
        return summed(here, values, n) / np.maximum(np.bincount(here, minlength=n), 1)[:, None]
    return summed(here, weight[:, None] * values, n) / np.maximum(np.bincount(here, weight, n), 1)[:, None]


def _images(across: Array, here: Ids, other: Ids) -> Array:
    """How often points ``other`` are neighbours of points ``here``, (m,): with images beyond planes through these alone."""
    both = np.abs((across[here][:, :, None] * across[other][:, None]).sum(axis=-1)).max(axis=2) > 0.5
    return np.asarray(np.prod(np.where(across[here].any(axis=2) & ~both, 2.0, 1.0), axis=1))


def _root_averages(
    surface: Surface, here: Ids, model: Ids, squares: Polynomials, opened: Flags, carried: Array
) -> Array:
    """Averages (m,) over the functions of points ``here`` of the roots of polynomials at points ``model``, zero where these
    are negative; with what these points take over from open ones beside them, (n_points,) bool, but for what those carry
    themselves, (n_points,) a force."""
    load, weight, seen = np.zeros(len(here)), np.zeros(len(here)), np.zeros(len(opened))
    order = np.argsort(here, kind="stable")
    first, last = (np.searchsorted(here[order], np.arange(len(surface.points)), side=s) for s in ("left", "right"))
    parts = []
    for kind, facets in by_kind(surface):
        corners = surface.nodes[facets, : CELLS[kind].corners].astype(np.int64)
        touched = (first[corners] < last[corners]).any(axis=1)
        x, force = corner_weights(surface, kind, facets[touched])
        parts.append((corners[touched], x, force))
        seen += np.bincount(corners[touched].ravel(), force.sum(axis=1).ravel(), len(seen))
    for corners, x, force in parts:
        beyond = opened[corners]
        share = TAKEN / np.maximum((~beyond).sum(axis=1), 1)
        theirs = carried[corners] * force.sum(axis=1) / np.maximum(seen[corners], 1e-300)
        for k, point in enumerate(corners.T):
            count = last[point] - first[point]
            facet = np.repeat(np.arange(len(point)), count)
            use = order[np.arange(len(facet)) - np.repeat(np.cumsum(count) - count, count) + first[point][facet]]
            root = np.sqrt(np.maximum(squares.some(use).at(x[facet], surface.points[model[use]]), 0.0))
            over = np.maximum(np.einsum("mqk,mq->mk", force[facet], root) - theirs[facet], 0.0)
            taken = share[facet] * (over * beyond[facet]).sum(axis=1)
            load += np.bincount(use, (force[facet, :, k] * root).sum(axis=1) + taken, len(load))
            weight += np.bincount(use, force[facet, :, k].sum(axis=1), len(load))
    return load / np.where(weight > 0.0, weight, 1.0)

"""Nodal recovery: pressure and gap at the facets' nodes, on both sides, from the multiplier."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from abut._core import shape_functions
from abut.cells import BY_CODE, CELLS, MAX_FACET_NODES
from abut.contact.coupling import Coupling
from abut.contact.geometry import (
    by_kind,
    corner_functions,
    full_moments,
    function_count,
    node_coordinates,
    pressure_kind,
    split_at_creases,
)
from abut.dofs import n_components, place_of
from abut.mesh.surface import Surface
from abut.types import Sparse

NO_SUPPORT = 1e-9  # covered share of a point's support below which there is nothing to average
ON_AXIS = 1e-9  # radius over the contactor's largest
FLAT_STAR = 1e-3  # eigenvalue of a star of facets' second moments over the largest below which it has no extent
FOUND = 1e-13  # step in reference coordinates after which a foot is found
SINGULAR = 1e-14  # of the metric's trace


@dataclass(frozen=True)
class Averages:
    """Averages of facet-wise fields over the corner functions N_i of the contactor, theory (P10).

    surface: the contactor, split at its creases: a point on one has an average for each smooth side, theory (P13);
    corners: (n_facets, 9) point of each corner of the facets, -1 where padded; moments: (n_facets, 9, 9) int N_i H_k over
    the covered part, mass: (n_facets, 9, 9) int N_i N_j; weight: (n_points,) int N_i there, area; share: (n_points,) the
    same over int N_i on the whole contactor, 0 at points that are no corners of it; shared: (n_points,) the point whose
    average each one shows, itself but on the axis of linear cells; exact: (n_facets,) facets of first
    order with nodal forces as accurate as on those of second.
    """

    surface: Surface
    corners: NDArray[np.int64]
    moments: NDArray[np.float64]
    mass: NDArray[np.float64]
    weight: NDArray[np.float64]
    share: NDArray[np.float64]
    shared: NDArray[np.int64]
    exact: NDArray[np.bool_]

    def loads(self, values: NDArray[np.float64]) -> NDArray[np.float64]:
        """int N_i f of a field given by its coefficients (9 n_facets, ...), at the points, (n_points, ...)."""
        table = values.reshape(len(self.corners), MAX_FACET_NODES, -1)
        return self._sum(np.matmul(self.moments, table)).reshape(-1, *values.shape[1:])

    def of(self, values: NDArray[np.float64]) -> NDArray[np.float64]:
        """Their averages at the points, (n_points, ...), 0 where nothing is covered."""
        loads, weight = np.zeros((len(self.weight), *values.shape[1:])), np.zeros(len(self.weight))
        np.add.at(loads, self.shared, self.loads(values))
        np.add.at(weight, self.shared, self.weight)
        return _divided(loads, weight)[self.shared]

    def sharpened(
        self, average: NDArray[np.float64], x: NDArray[np.float64], along: NDArray[np.float64] | None = None
    ) -> NDArray[np.float64]:
        """Averages (n_points,) of a field on all of the contactor at points x (n_points, dim), without what averaging takes
        from a linear field: theory (P12). Of the same resultant, since what one point gains another loses. along:
        (n_points, dim, dim) projections on the directions in which there may be a slope, all of them if None."""
        rows, mass = self._masses()
        slope, used = np.zeros_like(x), np.unique(self.corners[self.corners >= 0])
        slope[used] = self.slopes(average, used, along)
        g, away = slope[rows], x[rows][:, :, None] - x[rows][:, None]
        gain = 0.5 * np.einsum("fij,fijd,fijd->fi", mass, away, g[:, :, None] + g[:, None])
        return np.asarray(average + _divided(self._sum(gain), self.weight))

    def slopes(
        self, average: NDArray[np.float64], points: NDArray[np.int64], along: NDArray[np.float64] | None = None
    ) -> NDArray[np.float64]:
        """Slope at some points (n,), (n, dim), fitted to the averages (n_points,) there and at their neighbours, each taken
        at the point X_i of theory (P12) where it holds. along: as in ``sharpened``; images of neighbours beyond planes of
        symmetry change nothing but what is across them."""
        rows, mass = self._masses()
        at = _divided(self._sum(np.matmul(mass, self.surface.points[rows])), self.weight)
        if along is not None:
            x = self.surface.points
            at = x + np.einsum("nab,nb->na", along, at - x)
        used = (mass != 0.0).astype(float)
        apart, rise = at[rows][:, None] - at[rows][:, :, None], average[rows][:, None] - average[rows][:, :, None]
        square = (apart**2).sum(axis=-1)
        close = used / np.maximum(square, 1e-300)
        if along is not None:
            apart = np.einsum("fiab,fijb->fija", along[rows], apart)
        metric = self._sum(np.einsum("fij,fija,fijb->fiab", close, apart, apart))[points]
        if along is not None:  # none is left where planes meet
            left, all_of_it = metric.trace(axis1=1, axis2=2), self._sum((close * square).sum(axis=2))[points]
            metric[left < FLAT_STAR * all_of_it] = 0.0
        rate = self._sum(np.einsum("fij,fija,fij->fia", close, apart, rise)).reshape(len(average), -1, 1)[points]
        return np.asarray((np.linalg.pinv(metric, rcond=FLAT_STAR, hermitian=True) @ rate)[..., 0])

    def _masses(self) -> tuple[NDArray[np.int64], NDArray[np.float64]]:
        """Points of the facets' corners (n_facets, k), 0 where padded, and ``mass`` of them, (n_facets, k, k)."""
        k = int((self.corners >= 0).any(axis=0).sum())
        return np.maximum(self.corners[:, :k], 0), self.mass[:, :k, :k]

    def _sum(self, values: NDArray[np.float64]) -> NDArray[np.float64]:
        """Values at the corners of facets (n_facets, up to 9, ...) added up at the points."""
        corners = self.corners[:, : values.shape[1]]
        used = corners >= 0
        at, parts = corners[used], values[used].reshape(int(used.sum()), -1)
        total = np.zeros((len(self.weight), parts.shape[1]))
        for component, part in enumerate(parts.T):
            total[:, component] = np.bincount(at, part, len(self.weight))
        return total.reshape(len(self.weight), *values.shape[2:])


def _divided(values: NDArray[np.float64], weight: NDArray[np.float64]) -> NDArray[np.float64]:
    """Values (n, ...) over weights (n,), 0 where the weight is."""
    weight = weight.reshape(-1, *[1] * (values.ndim - 1))
    return np.asarray(np.where(weight > 0.0, values / np.where(weight > 0.0, weight, 1.0), 0.0))


def averages(contactor: Surface, coupling: Coupling, exact: NDArray[np.bool_] | None = None) -> Averages:
    """What it takes to average fields on a contactor; coupling: of degree 1 or 2; exact: as in ``Averages``, none if
    None."""
    exact = np.zeros(len(contactor), dtype=bool) if exact is None else exact
    contactor, _ = split_at_creases(contactor)
    corners = np.full(contactor.nodes.shape, -1, dtype=np.int64)
    moments, mass = np.zeros_like(coupling.mass), np.zeros_like(coupling.mass)
    for kind, facets in by_kind(contactor):
        n = CELLS[kind].corners
        corners[facets, :n] = contactor.nodes[facets, :n]
        functions = corner_functions(kind, coupling.degree)
        moments[facets[:, None], np.arange(n)] = np.einsum(
            "ki,fkl->fil", functions, coupling.mass[facets, : len(functions)]
        )
        mass[facets, :n, :n] = moments[facets, :n, : len(functions)] @ functions
    used = corners >= 0
    weight, whole = (
        np.bincount(corners[used], values[used], minlength=len(contactor.points))
        for values in (moments.sum(axis=2), full_moments(contactor, 1))
    )
    share = np.where(whole > 0.0, weight / np.where(whole > 0.0, whole, 1.0), 0.0)
    return Averages(
        contactor,
        corners,
        moments,
        mass,
        np.where(share > NO_SUPPORT, weight, 0.0),
        share,
        _shared(contactor, exact),
        exact,
    )


def _shared(contactor: Surface, exact: NDArray[np.bool_]) -> NDArray[np.int64]:
    """Points on the axis of a body of revolution with linear cells show the average of their neighbour and themselves: their
    own nodal force is wrong by the order of h / a, since no linear cell has the radial displacement c(z) r, while the
    pressure is even in r."""
    shared = np.arange(len(contactor.points))
    if contactor.axisymmetric:
        for _, facets in ((k, f) for k, f in by_kind(contactor) if CELLS[k].degree == 1):
            first, second = contactor.nodes[facets[~exact[facets]], :2].T.astype(np.int64)
            radius = contactor.points[:, 0]
            touching = ON_AXIS * radius[contactor.node_ids].max()
            for here, other in ((first, second), (second, first)):
                axis = radius[here] <= touching
                shared[here[axis]] = other[axis]
    return shared


def at_facet_nodes(surface: Surface, values: NDArray[np.float64]) -> NDArray[np.float64]:
    """Values at a surface's corner points (n_points,) at every node of each facet, linear between the corners,
    (n_facets, 9), NaN where padded."""
    result = np.full(surface.nodes.shape, np.nan)
    for kind, facets in by_kind(surface):
        cell = CELLS[kind]
        functions, _ = shape_functions(CELLS[pressure_kind(kind, 1)].code, node_coordinates(kind))
        result[facets, : cell.nodes] = values[surface.nodes[facets, : cell.corners]] @ functions.T
    return result


def facet_node_values(contactor: Surface, degree: int, values: NDArray[np.float64]) -> NDArray[np.float64]:
    """Facet-wise coefficients (9 n_facets,) evaluated at every node of each facet, (n_facets, 9), NaN where padded; in the
    unit of the coefficients."""
    table = values.reshape(-1, MAX_FACET_NODES)
    result = np.full(table.shape, np.nan)
    for kind, facets in by_kind(contactor):
        n = function_count(kind, degree)
        functions, _ = shape_functions(CELLS[pressure_kind(kind, degree)].code, node_coordinates(kind))
        result[facets, : CELLS[kind].nodes] = table[facets, :n] @ functions.T
    return result


def at_points(surface: Surface, values: NDArray[np.float64]) -> NDArray[np.float64]:
    """Values at the facets' nodes (n_facets, 9) that agree where facets meet, at the points, (n_points,), 0 elsewhere."""
    result = np.zeros(len(surface.points))
    used = surface.nodes >= 0
    result[surface.nodes[used]] = values[used]
    return result


def carry_to_target(
    contactor: Surface, target: Surface, pairs: Sparse, values: NDArray[np.float64]
) -> NDArray[np.float64]:
    """Pressure at the target's nodes, (n_target_facets, 9): read off the contactor at the foot of each node; zero where
    no contactor facet lies opposite, NaN where padded.

    values: (n_contactor_facets, 9) at the facets' nodes, between them by the facets' own functions, but not below the
    least of the facet; pairs: (9 n_contactor_facets, n_points or dim n_points) sparse ``target_part`` of the coupling: it
    knows which contactor facets see which target nodes.
    """
    width = max(n_components(pairs.shape[1], len(target.points)), 1)
    entries = pairs.tocoo()
    facet_and_point = np.unique(
        entries.row // MAX_FACET_NODES * np.int64(len(target.points)) + place_of(entries.col, width)
    )
    seen = np.stack(np.divmod(facet_and_point, len(target.points)), axis=1)
    best = np.full(len(target.points), np.inf)
    pressure = np.zeros(len(target.points))
    for code in np.unique(contactor.kinds):
        kind = BY_CODE[code].name
        rows = seen[contactor.kinds[seen[:, 0]] == code]
        xi, outside = _foot(contactor, kind, rows[:, 0], target.points[rows[:, 1]])
        shape, _ = shape_functions(CELLS[kind].code, np.ascontiguousarray(xi))
        of_facet = values[rows[:, 0], : CELLS[kind].nodes]
        value = np.maximum(np.einsum("pn,pn->p", shape, of_facet), of_facet.min(axis=1, initial=np.inf))
        order = np.argsort(-outside)  # the nearest to a facet's inside is written last
        inside = order[outside[order] < 0.05]
        better = outside[inside] < best[rows[inside, 1]]
        best[rows[inside[better], 1]] = outside[inside[better]]
        pressure[rows[inside[better], 1]] = value[inside[better]]
    return np.where(target.nodes >= 0, pressure[np.maximum(target.nodes, 0)], np.nan)


def _foot(
    surface: Surface, kind: str, facets: NDArray[np.int64], points: NDArray[np.float64]
) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Reference coordinates of the nearest points of given facets (Gauss-Newton), and how far outside they lie."""
    cell = CELLS[kind]
    x = surface.points[surface.nodes[facets, : cell.nodes]]
    triangle = cell.corners == 3 and cell.dim == 2
    xi = np.full((len(facets), cell.dim), 1 / 3 if triangle else 0.0)
    for _ in range(8):
        shape, derivative = shape_functions(cell.code, np.ascontiguousarray(xi))
        miss = np.einsum("pn,pnd->pd", shape, x) - points
        tangent = np.einsum("pna,pnd->pda", derivative, x)
        normal = np.einsum("pda,pdb->pab", tangent, tangent)
        # Far from a bent facet its map may be singular; a step along what is left of it does no harm there.
        size = np.trace(normal, axis1=1, axis2=2)[:, None, None]
        regular = normal + np.where(size > 0.0, SINGULAR * size, 1.0) * np.eye(cell.dim)
        step = np.linalg.solve(regular, np.einsum("pda,pd->pa", tangent, miss)[..., None])[..., 0]
        xi = np.clip(xi - step, -3.0, 3.0)
        if np.abs(step).max(initial=0.0) < FOUND:
            break
    if triangle:
        outside = np.max(np.column_stack([-xi, xi.sum(axis=1) - 1.0]), axis=1)
    else:
        outside = 0.5 * (np.abs(xi).max(axis=1) - 1.0)
    return xi, np.maximum(outside, 0.0)

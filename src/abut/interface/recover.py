"""Pressure and gap where a person wants to see them: at the facets' nodes, on both sides."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from abut._core import shape_functions
from abut.cells import BY_CODE, CELLS
from abut.interface.geometry import by_kind, function_count, node_coordinates, pressure_kind
from abut.mesh.surface import Surface

FOUND = 1e-13  # step in reference coordinates after which a foot is found
SINGULAR = 1e-14  # of the metric's trace


def facet_node_values(contactor: Surface, degree: int, values: NDArray[np.float64]) -> NDArray[np.float64]:
    """Facet-wise coefficients (9 n_facets,) evaluated at every node of each facet, (n_facets, 9), NaN where padded; in the
    unit of the coefficients."""
    table = values.reshape(-1, 9)
    result = np.full(table.shape, np.nan)
    for kind, facets in by_kind(contactor):
        n = function_count(kind, degree)
        if degree == 0:
            result[facets, : CELLS[kind].nodes] = table[facets, :1]
            continue
        own, _ = shape_functions(CELLS[pressure_kind(kind, degree)].code, node_coordinates(kind))
        result[facets, : CELLS[kind].nodes] = table[facets, :n] @ own.T
    return result


def carry_to_target(
    contactor: Surface, target: Surface, pairs: Any, degree: int, values: NDArray[np.float64]
) -> NDArray[np.float64]:
    """Pressure at the target's nodes, (n_target_facets, 9): read off the contactor at the foot of each node; zero where
    no contactor facet lies opposite, NaN where padded.

    pairs: (9 n_contactor_facets, n_points or dim n_points) sparse ``target_part`` of the coupling: it knows which
    contactor facets see which target nodes.
    """
    width = pairs.shape[1] // len(target.points) if pairs.shape[1] >= len(target.points) else 1
    entries = pairs.tocoo()
    facet_and_point = np.unique(entries.row // 9 * np.int64(len(target.points)) + entries.col // width)
    seen = np.stack(np.divmod(facet_and_point, len(target.points)), axis=1)
    best = np.full(len(target.points), np.inf)
    pressure = np.zeros(len(target.points))
    table = values.reshape(-1, 9)
    for code in np.unique(contactor.kinds):
        kind = BY_CODE[code].name
        own = seen[contactor.kinds[seen[:, 0]] == code]
        xi, outside = _foot(contactor, kind, own[:, 0], target.points[own[:, 1]])
        if degree == 0:
            value = table[own[:, 0], 0]
        else:
            carrier = CELLS[pressure_kind(kind, degree)]
            shape, _ = shape_functions(carrier.code, np.ascontiguousarray(xi))
            value = np.einsum("pn,pn->p", shape, table[own[:, 0], : carrier.nodes])
        order = np.argsort(-outside)  # the nearest to a facet's inside is written last
        inside = order[outside[order] < 0.05]
        better = outside[inside] < best[own[inside, 1]]
        best[own[inside[better], 1]] = outside[inside[better]]
        pressure[own[inside[better], 1]] = value[inside[better]]
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

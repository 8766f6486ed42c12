"""Initial gaps that jump within a facet: what ``adjust`` leaves beside what it takes away, and steps of the target.

A gap that jumps cannot be averaged over a function: beside a closed node the mean is that of the step, however high, and of
a dual function, negative at the facet's other end, it even has the wrong sign."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from abut.cells import CELLS, MAX_FACET_NODES
from abut.contact.bases import block_diagonal, sound_facets
from abut.contact.bulge import bulging
from abut.contact.corner_fit import fit_functions, fitted
from abut.contact.coupling import Coupling, IntegrationPoints
from abut.contact.geometry import by_kind, corner_functions, facet_sizes, function_count, nodal_normals
from abut.contact.node_to_segment import feet
from abut.mesh.surface import Surface
from abut.types import Sparse

STEP = 1e-3  # of the facet's size: gaps of neighbouring target facets that differ by less are one smooth gap


def partly_adjusted(
    contactor: Surface,
    target: Surface,
    closed: Coupling,
    adjust: float,
    reach: float,
    without: Callable[[], Coupling],
    normals: NDArray[np.float64] | None = None,
) -> Coupling:
    """``closed``, in which gaps and overlaps up to ``adjust`` are none, mended on facets that have larger ones too: there
    the contactor's nodes are moved on to the target one by one, without strain, so that the gap stays continuous.

    adjust, reach: lengths; closed: with gap samples; without: the same coupling with nothing adjusted; normals: at the
    contactor's facets' nodes, (n_facets, 9, dim), as both have them."""
    if not adjust or closed.gap_samples is None:
        return closed
    gap, facets = closed.gap_samples.gap, np.arange(len(contactor))
    partly = np.isin(facets, closed.gap_samples.facet[gap == 0.0]) & np.isin(
        facets, closed.gap_samples.facet[gap != 0.0]
    )
    if not partly.any():
        return closed
    plain = without()
    normals = nodal_normals(contactor) if normals is None else normals
    move = _on_to_target(contactor, normals, target, partly, adjust, reach)
    whole = np.zeros(plain.contactor_part.shape[1])
    whole[: move.size] = move.ravel()
    rows = np.repeat(partly, MAX_FACET_NODES)
    result = replace(closed, gap=np.where(rows, plain.gap + plain.contactor_part @ whole, closed.gap))
    if plain.gap_samples is not None:
        at = plain.gap_samples
        nodes = np.maximum(contactor.nodes[at.facet], 0)
        moved = at.gap + np.einsum("ij,ijd,id->i", at.contactor_shapes, move[nodes], at.normal)
        result = replace(result, gap_samples=replace(closed.gap_samples, gap=np.where(partly[at.facet], moved, gap)))
    if plain.points is not None and closed.points is not None:
        moved = plain.points.gap + plain.points.gap_operator @ whole
        gaps = np.where(partly[plain.points.facet], moved, closed.points.gap)
        result = replace(result, points=replace(closed.points, gap=gaps))
    return result


def _on_to_target(
    contactor: Surface,
    normals: NDArray[np.float64],
    target: Surface,
    partly: NDArray[np.bool_],
    adjust: float,
    reach: float,
) -> NDArray[np.float64]:
    """How nodes of some facets move, (n_points, dim): corners along their normal where their gap is at most ``adjust``, the
    others linearly between them (a parabola through two closed nodes and an open one would cut into the target)."""
    move = np.zeros_like(contactor.points)
    for kind, facets in by_kind(contactor):
        chosen, n = facets[partly[facets]], CELLS[kind].corners
        nodes, first = np.unique(contactor.nodes[chosen, :n], return_index=True)
        normal = normals[chosen, :n].reshape(-1, contactor.dim)[first]
        facet, _, gap = feet(contactor.points[nodes], normal, target, reach)
        near = (facet >= 0) & (np.abs(gap) <= adjust)
        move[nodes[near]] = gap[near, None] * normal[near]
    for kind, facets in by_kind(contactor):
        chosen, between = facets[partly[facets]], corner_functions(kind, CELLS[kind].degree)
        nodes = contactor.nodes[chosen, : len(between)]
        move[nodes] = np.einsum("kc,fcd->fkd", between, move[nodes[:, : between.shape[1]]])
    return move


def of_corners(contactor: Surface, target: Surface, coupling: Coupling) -> Coupling:
    """The coupling of the corners' functions, degree 1, with the weighted gap of a fit to the gap's values at the corners.

    On each facet the gap is fitted by the functions of ``coupling``, of degree 1 or 2, in the mean; its values at the
    corners take the gap's place. Of a gap with a step the fit undershoots, by up to a third of the step, and is kept
    within the gaps that are there; slivers keep the gap as it is. Where facets of first order bulge the fit is of second
    order too, from the coupling's integration points. coupling: with gap samples, without which nothing is fitted, and
    where facets bulge with its points (``CouplingOptions``)."""
    n_rows = coupling.contactor_part.shape[0]
    result = coupling if coupling.degree == 1 else _restricted(contactor, coupling)
    if coupling.gap_samples is None or not len(coupling.gap_samples.gap):
        return result
    stepped, low, high = _steps(contactor, coupling)
    gap, integrals = result.gap.reshape(-1, MAX_FACET_NODES).copy(), coupling.gap.reshape(-1, MAX_FACET_NODES)
    for kind, facets in by_kind(contactor):
        n, m = CELLS[kind].corners, function_count(kind, coupling.degree)
        chosen = facets if m > n else facets[stepped[facets]]
        chosen = chosen[sound_facets(coupling.mass[chosen][:, :m, :m])]
        fit = np.linalg.solve(coupling.mass[chosen][:, :m, :m], integrals[chosen, :m, None])[:, :n]
        kept = np.clip(fit, low[chosen, None, None], high[chosen, None, None])
        gap[chosen, :n] = (result.mass[chosen][:, :n, :n] @ kept)[..., 0]
    if coupling.points is not None:
        gap = _over_bulges(contactor, target, coupling.points, low, high, gap)
    return replace(result, gap=gap.reshape(n_rows))


def _over_bulges(
    contactor: Surface,
    target: Surface,
    at: IntegrationPoints,
    low: NDArray[np.float64],
    high: NDArray[np.float64],
    gap: NDArray[np.float64],
) -> NDArray[np.float64]:
    """``gap``, int N_k g, (n_facets, 9), with that of fits of second order where facets of first order bulge, or the target
    does. low, high: (n_facets,) range of g. A linear fit lies below a parabola by 2/3 of its sagitta at the corners: a punch
    would rest on the rounding of its edge."""
    result = gap.copy()
    curved = bulging(contactor, target, at.facet, at.target_facet)
    for kind, _ in by_kind(contactor):
        chosen = np.flatnonzero(curved & (contactor.kinds == CELLS[kind].code))
        if CELLS[kind].degree == 2 or not len(chosen):
            continue
        n = CELLS[kind].corners
        number = np.full(len(contactor), -1)
        number[chosen] = np.arange(len(chosen))
        here = np.flatnonzero(number[at.facet] >= 0)
        functions, corners = fit_functions(kind, _local_values(at.pressure[here], at.facet[here]))
        group = number[at.facet[here]]
        sound, fit, mass, _ = fitted(functions, corners, at.weight[here], at.gap[here], group, len(chosen))
        chosen = chosen[sound]
        kept = np.clip(fit, low[chosen, None], high[chosen, None])
        result[chosen, :n] = (mass @ kept[..., None])[..., 0]
    return result


def _local_values(pressure: Sparse, facet: NDArray[np.int64]) -> NDArray[np.float64]:
    """Values (n, 9) of the functions of the facet on which each point lies, of those (n, 9 n_facets) of all."""
    entries = pressure.tocoo()
    result = np.zeros((len(facet), MAX_FACET_NODES))
    result[entries.row, entries.col - MAX_FACET_NODES * facet[entries.row]] = entries.data
    return result


def _restricted(contactor: Surface, coupling: Coupling) -> Coupling:
    """The coupling of degree 2 in terms of the corners' functions."""
    blocks, mass = {}, np.zeros_like(coupling.mass)
    for kind, facets in by_kind(contactor):
        functions = corner_functions(kind, 2)
        m, n = functions.shape
        blocks[kind] = np.zeros((m, m))
        blocks[kind][:, :n] = functions
        mass[facets[:, None, None], np.arange(n)[:, None], np.arange(n)] = (
            functions.T @ coupling.mass[facets][:, :m, :m] @ functions
        )
    corners = block_diagonal(contactor, blocks)
    points = coupling.points
    return replace(
        coupling,
        degree=1,
        operator=(corners.T @ coupling.operator).tocsr(),
        contactor_part=(corners.T @ coupling.contactor_part).tocsr(),
        target_part=(corners.T @ coupling.target_part).tocsr(),
        gap=corners.T @ coupling.gap,
        weight=corners.T @ coupling.weight,
        mass=mass,
        points=points if points is None else replace(points, pressure=(points.pressure @ corners).tocsr()),
    )


def _steps(
    contactor: Surface, coupling: Coupling
) -> tuple[NDArray[np.bool_], NDArray[np.float64], NDArray[np.float64]]:
    """Facets whose gap jumps from one target facet to the next, and the smallest and largest gap of each, (n_facets,).

    The range of a continuous gap is at most the sum of its ranges over the pieces."""
    at = coupling.gap_samples
    assert at is not None
    n = len(contactor)
    pieces, of = np.unique(np.stack([at.facet, at.target_facet], axis=1), axis=0, return_inverse=True)
    of = of.ravel()
    bounds = []
    for number, index in ((len(pieces), of), (n, at.facet)):
        low, high = np.full(number, np.inf), np.full(number, -np.inf)
        np.minimum.at(low, index, at.gap)
        np.maximum.at(high, index, at.gap)
        bounds.append((low, high))
    (piece_low, piece_high), (low, high) = bounds
    smooth = np.bincount(pieces[:, 0], piece_high - piece_low, minlength=n)
    with np.errstate(invalid="ignore"):
        stepped = (high - low) - smooth > STEP * facet_sizes(contactor)
    return stepped, low, high

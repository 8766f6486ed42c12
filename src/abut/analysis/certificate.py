"""The evidence that comes with every result: checks of a contact pair at the end of a step, each with its limit."""

from __future__ import annotations

import itertools
from typing import Any

import numpy as np
import scipy.sparse as sp
from numpy.typing import NDArray

from abut.analysis.faceting import faceting
from abut.cells import CELLS
from abut.discretization.pairs import Pair
from abut.interface.geometry import by_kind, full_moments
from abut.state import Check

BALANCE = 1e-9  # of forces, over the contact force; of moments, over force times the contactor's extent
PENETRATION = 1e-2  # over the facet size; the constraint function lets pressure points give way by about p h / (30 E)
OVERLAP = 1.0  # over theory (L10); docs/verification/README.md has what was seen
FLAT = 1e-9  # of the facet size: overlaps below are none, however small the pressure
FACETING = 0.2  # seen: the pressure is off by about half of that
LESSER = 0.05  # a pair's pressure over the largest of the model from which down its overlap and facets matter less
TENSION = 0.05  # over the largest pressure
COMPLEMENTARITY = 1e-6
OSCILLATION = 0.06
MOMENTS = 1e-3  # on plane facets 1e-14; on curved ones the chords of edges decide which segments there are
WHOLE = 1e-2  # a facet covered to within this share is fully covered
BARE = 0.5
REMOVED = 0.95  # a contactor almost all of which sees no target is hardly what was meant
COVERED_TWICE = 1e-3  # share of a facet
NOTHING = 1e-6  # pressure over the largest so far that is taken for none, after unloading
CLOSED = 1e-3  # pressure over the largest from which on a node counts as in contact


def certificate(pair: Pair, values: NDArray[np.float64], nodal: NDArray[np.float64], penetration: float,
                residual: float, reference: float = 0.0, overlap: NDArray[np.float64] | None = None,
                beside: float = 0.0) -> tuple[Check, ...]:  # fmt: skip
    """All checks of one pair.

    values: (9 n_facets,) facet-wise pressure coefficients, (9 n_facets, dim) those of a tie's traction;
    nodal: (n_facets, 9) pressure at the facets' nodes; penetration: largest, a length;
    residual: of the contact law, relative to the largest pressure; reference: largest
    pressure of the steps before; overlap: (n_facets,) largest of each at a
    point, over its size; beside: largest pressure of all pairs, now and before.
    """
    name = pair.contact.name
    largest = max(float(np.nanmax(np.abs(nodal), initial=0.0)), NOTHING * max(reference, beside), 1e-300)
    matters = max(largest, LESSER * beside)
    checks = []

    def add(what: str, value: float, limit: float, meaning: str) -> None:
        checks.append(Check(name, what, float(value), limit, meaning))

    areas = full_moments(pair.contactor, 0)[:, 0]
    share = pair.coupling.covered / areas
    force, moment = balance(pair, values)
    add("force balance", force, BALANCE, "force on the contactor plus force on the target, over the force")
    if not pair.tied:
        add("moment balance", moment, BALANCE, "the same of moments, over force times extent")
        add("penetration", penetration / pair.size, PENETRATION, "largest weighted penetration over the facet size")
        pressed_in = max(pair.compliance * matters / np.pi, FLAT)
        hidden = (np.zeros(len(areas)) if overlap is None else overlap) / pressed_in
        add("overlap", hidden.max(initial=0.0), OVERLAP,
            "largest penetration at a point, over what the largest pressure presses in between nodes")  # fmt: skip
        add("faceting", faceting(pair, nodal, CLOSED * largest) / matters, FACETING,
            "pressure that facets make by standing for a curved surface, over the largest pressure")  # fmt: skip
        tension = max(0.0, -float(np.nanmin(nodal, initial=0.0))) / largest
        add("tension", tension, TENSION, "largest negative pressure over the largest pressure")
        add("complementarity", residual, COMPLEMENTARITY, "violation of the contact law over the largest pressure")
        add("oscillation", _oscillation(pair, nodal, largest, share), OSCILLATION,
            "alternating part of the pressure inside the contact over the largest pressure")  # fmt: skip
    if pair.contact.method == "segment-to-segment":
        add("facet moments", _moment_error(pair, areas, share, np.nanmax(nodal, axis=1) > CLOSED * largest), MOMENTS,
            "integration error of int H over loaded facets that are fully covered, over their area")  # fmt: skip
    loaded = np.nanmax(nodal, axis=1) > CLOSED * largest
    bare = 1.0 - float(pair.coupling.covered[loaded].sum() / areas[loaded].sum()) if loaded.any() else 0.0
    add("bare area", max(bare, 0.0), BARE, "share of the loaded facets' area with no target opposite")
    total = pair.space.removed + len(pair.space)
    add("removed multipliers", pair.space.removed / max(total, 1), REMOVED,
        "share of the contactor's multipliers without target or held by supports")  # fmt: skip
    # Where a layer behind is counted as well, the gap in the mean may stay open though the one in front is cut into.
    counts = loaded if pair.tied else loaded | (hidden > OVERLAP)
    add("covered twice", max(float(share[counts].max(initial=0.0)) - 1.0, 0.0), COVERED_TWICE,
        "share of a loaded facet with two layers of target opposite, both counted")  # fmt: skip
    return tuple(checks)


def balance(pair: Pair, values: NDArray[np.float64]) -> tuple[float, float]:
    """Relative errors of force and moment between the two sides, from their nodal forces under the facet-wise coefficients
    ``values`` of the pressure (9 n_facets,) or of a tie's traction (9 n_facets, dim).

    Moments of ties on curved surfaces do not balance: tangential traction acts at two distances from the axis."""
    dim, axisymmetric = pair.contactor.dim, pair.contactor.axisymmetric
    sides = []
    for surface, part in ((pair.contactor, pair.coupling.contactor_part), (pair.target, pair.coupling.target_part)):
        force = np.asarray(part.T @ values).reshape(-1, dim)
        x = surface.points - pair.contactor.points[pair.contactor.node_ids].mean(axis=0)
        if dim == 2:
            turn = np.array([0.0 if axisymmetric else (x[:, 0] * force[:, 1] - x[:, 1] * force[:, 0]).sum()])
        else:
            turn = np.cross(x, force).sum(axis=0)
        sides.append((force.sum(axis=0), turn, np.abs(force).sum()))
    (own, own_turn, size), (other, other_turn, _) = sides
    extent = float(np.ptp(pair.contactor.points[pair.contactor.node_ids], axis=0).max())
    size = max(float(size), 1e-300)
    return float(np.abs(own - other).max()) / size, float(np.abs(own_turn - other_turn).max()) / (size * extent)


def _moment_error(
    pair: Pair, areas: NDArray[np.float64], share: NDArray[np.float64], loaded: NDArray[np.bool_]
) -> float:
    """Largest error of int H_k over the area, of facets that are fully covered and carry pressure."""
    whole = loaded & (np.abs(share - 1.0) < WHOLE)
    if not whole.any():
        return 0.0
    exact = full_moments(pair.contactor, pair.coupling.degree)
    miss = np.abs(pair.coupling.weight.reshape(exact.shape) - exact) / areas[:, None]
    return float(miss[whole].max())


def _oscillation(pair: Pair, nodal: NDArray[np.float64], largest: float, share: NDArray[np.float64]) -> float:
    """Root mean square of that part of p - (mean of its neighbours) that changes sign from neighbour to neighbour, over
    the largest pressure. Neighbours are nodes along facet edges, for P0 facets; only those with nothing but closed
    neighbours count, since the pressure has a kink at the edge of contact. Of other discontinuous spaces: of the jumps.
    share: of each facet that is covered."""
    continuous = bool((pair.space.node >= 0).all())
    if not continuous and pair.coupling.degree:
        return _jumps(pair, nodal, CLOSED * largest) / largest
    graph, value = _node_graph(pair, nodal) if continuous else _facet_graph(pair, nodal)
    closed = value > CLOSED * largest
    if continuous:
        closed &= ~_near_corners(pair, graph, share)
    degree = np.asarray(graph.sum(axis=1)).ravel()
    inside = closed & (graph @ (value > CLOSED * largest).astype(float) == degree) & (degree > 1)
    ripple = np.where(inside, value - graph @ value / np.maximum(degree, 1.0), 0.0)
    edges = sp.triu(graph, 1).tocoo()
    both = inside[edges.row] & inside[edges.col]
    if not both.any():
        return 0.0
    product = ripple[edges.row[both]] * ripple[edges.col[both]]
    return float(np.sqrt(np.maximum(-product, 0.0).mean())) / largest


def _near_corners(pair: Pair, graph: Any, share: NDArray[np.float64]) -> NDArray[np.bool_]:
    """Points within a facet of the contactor's rim, or of facets that are only partly covered: the pressure of a body with
    corners is singular there, and no mesh shows that without a swing."""
    near = _rim(pair)
    partly = pair.contactor.nodes[np.abs(share - 1.0) > WHOLE]
    near[partly[partly >= 0]] = True
    for _ in range(pair.coupling.degree):
        near |= graph @ near.astype(float) > 0.0
    return near


def _jumps(pair: Pair, nodal: NDArray[np.float64], closed: float) -> float:
    """Root mean square distance of facets' values at common nodes from their mean, where all of them are closed."""
    used = pair.contactor.nodes >= 0
    node, value = pair.contactor.nodes[used], nodal[used]
    count = np.maximum(np.bincount(node), 1)
    mean, open_ = np.bincount(node, value) / count, np.bincount(node, value <= closed)
    inside = (open_ == 0)[node] & (count > 1)[node]
    return float(np.sqrt(np.mean((value - mean[node])[inside] ** 2))) if inside.any() else 0.0


def _rim(pair: Pair) -> NDArray[np.bool_]:
    """Points on the rim of the contactor: ends of facet edges (2D: facets) that belong to one facet only."""
    surface = pair.contactor
    rim = np.zeros(len(surface.points), dtype=bool)
    ends = []
    for kind, facets in by_kind(surface):
        cell, nodes = CELLS[kind], surface.nodes[facets]
        if cell.dim == 1:
            ends.append(np.stack([nodes[:, :2].ravel(), nodes[:, :2].ravel()], axis=1))
        else:
            ends += [np.sort(nodes[:, [i, (i + 1) % cell.corners]], axis=1) for i in range(cell.corners)]
    edges, count = np.unique(np.concatenate(ends), axis=0, return_counts=True)
    rim[edges[count == 1]] = True
    return rim


def _node_graph(pair: Pair, nodal: NDArray[np.float64]) -> tuple[Any, NDArray[np.float64]]:
    surface = pair.contactor
    n = len(surface.points)
    used = surface.nodes >= 0
    value = np.zeros(n)
    value[surface.nodes[used]] = nodal[used]
    ends = []
    for kind, facets in by_kind(surface):
        cell = CELLS[kind]
        corners = cell.corners
        edges = [(0, 1)] if cell.dim == 1 else [(i, (i + 1) % corners) for i in range(corners)]
        for i, (a, b) in enumerate(edges):
            chain = (a, b) if cell.degree == 1 or pair.coupling.degree < 2 else (a, corners + i, b)
            ends += [surface.nodes[facets][:, list(step)] for step in itertools.pairwise(chain)]
    return _graph(np.concatenate(ends), n), value


def _facet_graph(pair: Pair, nodal: NDArray[np.float64]) -> tuple[Any, NDArray[np.float64]]:
    surface = pair.contactor
    facet, local = np.nonzero(surface.nodes >= 0)
    shares = sp.csr_matrix(
        (np.ones(len(facet)), (facet, surface.nodes[facet, local])), shape=(len(surface), len(surface.points))
    )
    corners = sp.csr_matrix(shares @ shares.T)
    corners.data = (corners.data >= surface.dim - 1).astype(float)
    corners.setdiag(0.0)
    corners.eliminate_zeros()
    return corners, np.nanmean(nodal, axis=1)


def _graph(ends: NDArray[np.int32], n: int) -> Any:
    graph = sp.csr_matrix((np.ones(len(ends)), (ends[:, 0], ends[:, 1])), shape=(n, n))
    graph = graph + graph.T
    graph.data[:] = 1.0
    return graph

"""The evidence that comes with every result: checks of a contact pair at the end of a step, each with its limit."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from abut.analysis.faceting import faceting
from abut.analysis.oscillation import CLOSED, WHOLE, oscillation
from abut.analysis.resolution import resolution
from abut.contact.geometry import full_moments, split_at_creases
from abut.contact.nodal_recovery import at_points
from abut.problem.contact_pairs import Pair
from abut.solution import Check

BALANCE = 1e-9  # of forces, over the contact force; of moments, over force times the contactor's extent
PENETRATION = 1e-2  # over the facet size; the constraint function lets pressure points give way by about p h / (30 E)
OVERLAP = 1.0  # over theory (L10); docs/verification/README.md has what was seen
FLAT = 1e-9  # of the facet size: overlaps below are none, however small the pressure
FACETING = 0.1  # seen: the pressure is off locally by two or three times that
LESSER = 0.05  # a pair's pressure over the largest of the model from which down its overlap and facets matter less
TENSION = 0.05  # over the largest pressure
COMPLEMENTARITY = 1e-6
OSCILLATION = 0.08
RESOLUTION = 0.4  # three facets to each side of the middle
MOMENTS = 1e-3  # on plane facets 1e-14; on curved ones the chords of edges decide which segments there are
BARE = 0.5
REMOVED = 0.95  # a contactor almost all of which sees no target is hardly what was meant
COVERED_TWICE = 1e-3  # share of a facet
NOTHING = 1e-6  # pressure over the largest so far that is taken for none, after unloading


def certificate(pair: Pair, values: NDArray[np.float64], nodal: NDArray[np.float64], penetration: float,
                residual: float, reference: float = 0.0, overlap: NDArray[np.float64] | None = None,
                share: NDArray[np.float64] | None = None, beside: float = 0.0,
                free: NDArray[np.bool_] | None = None,
                elsewhere: NDArray[np.float64] | None = None) -> tuple[Check, ...]:  # fmt: skip
    """All checks of one pair.

    values: (9 n_facets,) facet-wise pressure coefficients, (9 n_facets, dim) those of a tie's traction;
    nodal: (n_facets, 9) reported pressure at the facets' nodes; penetration: largest, a length;
    share: the same of the covered share of each node's support, all of it by default;
    residual: of the contact law, relative to the largest pressure; reference: largest
    pressure of the steps before; overlap: (n_facets,) largest of each at a
    point, over its size; beside: largest pressure of all pairs, now and before; free: (dim,) axes along
    which a side may shift, all by default; elsewhere: (n_facets, 2) shares of each that other contacts cover,
    and load.
    """
    name = pair.contact.name
    largest = max(float(np.nanmax(np.abs(nodal), initial=0.0)), NOTHING * max(reference, beside), 1e-300)
    matters = max(largest, LESSER * beside)
    checks = []

    def add(what: str, value: float, limit: float, meaning: str, last: bool = False) -> None:
        checks.append(Check(name, what, float(value), limit, meaning, last))

    areas = full_moments(pair.contactor, 0)[:, 0]
    cover = pair.coupling.covered / areas
    force, moment = balance(pair, values)
    add("force balance", force, BALANCE, "force on the contactor plus force on the target, over the force")
    if not pair.tied:
        add("moment balance", moment, BALANCE, "the same of moments, over force times extent")
        add("penetration", penetration / pair.size, PENETRATION, "largest weighted penetration over the facet size")
        pressed_in = max(pair.compliance * matters / np.pi, FLAT)
        hidden = (np.zeros(len(areas)) if overlap is None else overlap) / pressed_in
        add("overlap", hidden.max(initial=0.0), OVERLAP,
            "largest penetration at a point, over what the largest pressure indents between nodes")  # fmt: skip
        shifts = np.ones(pair.contactor.dim, dtype=bool) if free is None else free
        add("faceting", faceting(pair, nodal, CLOSED * largest, shifts) / matters, FACETING,
            "pressure caused by faceting of curved surfaces, over the largest pressure")  # fmt: skip
        tension = max(0.0, -float(np.nanmin(nodal, initial=0.0))) / largest
        add("tension", tension, TENSION, "largest negative pressure over the largest pressure")
        add("complementarity", residual, COMPLEMENTARITY, "violation of the contact law over the largest pressure")
        smooth, _ = split_at_creases(pair.contactor)
        pressure = at_points(smooth, nodal)
        support = np.ones(len(pressure)) if share is None else at_points(smooth, share)
        alternating = oscillation(pair, values, pressure, support, largest) * largest / matters
        add("oscillation", alternating, OSCILLATION,
            "largest alternating part of the pressure inside the contact over the largest pressure")  # fmt: skip
        facets = resolution(pair, pressure, support, largest) if largest > LESSER * beside else 0.0
        add("resolution", facets, RESOLUTION,
            "one over the number of facets from the edge of contact to its middle, at the end", last=True)  # fmt: skip
    if pair.contact.method == "segment-to-segment":
        add("facet moments", _moment_error(pair, areas, cover, np.nanmax(nodal, axis=1) > CLOSED * largest), MOMENTS,
            "integration error of int H over loaded facets that are fully covered, over their area")  # fmt: skip
    loaded = np.nanmax(nodal, axis=1) > CLOSED * largest
    others = np.zeros((len(areas), 2)) if elsewhere is None else elsewhere
    covered = (np.minimum(cover + others[:, 0], np.maximum(cover, 1.0)) * areas)[loaded].sum()
    bare = 1.0 - float(covered / areas[loaded].sum()) if loaded.any() else 0.0
    add("loaded area without target", max(bare, 0.0), BARE, "share of the loaded facets' area with no target opposite")
    total = pair.space.removed + (len(pair) if pair.tied else len(pair.space))
    add("removed multipliers", pair.space.removed / max(total, 1), REMOVED,
        "share of the contactor's multipliers removed: no target opposite, or constrained")  # fmt: skip
    # Where a layer behind is counted as well, the gap in the mean may stay open though the one in front is cut into.
    counts = loaded if pair.tied else loaded | (hidden > OVERLAP)
    every = (cover + others[:, 1])[counts]
    add("covered twice", max(float(every.max(initial=0.0)) - 1.0, 0.0), COVERED_TWICE,
        "share of a loaded facet with two layers of target opposite, both counted, here or by another contact")  # fmt: skip
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
    pair: Pair, areas: NDArray[np.float64], cover: NDArray[np.float64], loaded: NDArray[np.bool_]
) -> float:
    """Largest error of int H_k over the area, of facets that are fully covered and carry pressure."""
    whole = loaded & (np.abs(cover - 1.0) < WHOLE)
    if not whole.any():
        return 0.0
    exact = full_moments(pair.contactor, pair.coupling.degree)
    miss = np.abs(pair.coupling.weight.reshape(exact.shape) - exact) / areas[:, None]
    return float(miss[whole].max())

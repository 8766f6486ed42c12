"""The evidence that comes with every result: checks of a contact pair at the end of a step, each with its limit."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from abut.analysis.edge_load import edge_load
from abut.analysis.faceting import faceting
from abut.analysis.oscillation import CLOSED, oscillation
from abut.analysis.overlap import meant
from abut.analysis.peaks import Peaks, peaks_of
from abut.analysis.pressure_error import pressure_error
from abut.analysis.resolution import resolution, resolution_between_ends
from abut.analysis.sharp_edge import SharpEdge
from abut.analysis.thin_give import SHARE
from abut.contact.contactor_choice import Side
from abut.contact.geometry import facet_sizes, full_moments, split_at_creases
from abut.contact.nodal_recovery import at_points
from abut.contact.rim import rim
from abut.contact.sides import words
from abut.model.contact import KINDS
from abut.problem.pair import WHOLE, Pair
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
BETWEEN_ENDS = 0.5  # two, between edges of a body: four across
MOMENTS = 1e-3  # on plane facets 1e-14; on curved ones the chords of edges decide which segments there are
ERROR, NOTICED = 0.3, 0.05  # of the pressure: wrong, and worth knowing
STANDS = 0.5  # of the largest pressure: a peak beside which others are not judged, theory (P24)
STANDS_NOTICED, AT_EDGE = 0.25, 0.1  # of the same, worth knowing inside, and where a body ends
SLID, SLID_NOTICED = 1.0, 0.5  # facets: from one on pressure acts on the wrong one
EDGES = 0.2  # sine of 12 degrees
BARE = 0.5
REMOVED = 0.95  # a contactor almost all of which sees no target is hardly what was meant
COVERED_TWICE = 1e-3  # share of a facet
UNSEEN = "no node of the contactor has closed neighbours only"
NARROW = "contact is less than three facets wide on each side of its middle: refine where it touches"
EDGE = "a sharp edge presses, whose contact is narrower than a facet"
FACETS = "one over the number of facets from the edge of contact to its middle, at the end"
OFF = 0.2  # of the force at a sharp edge, or of how far it moves
NOTHING = 1e-6  # pressure over the largest so far that is taken for none, after unloading


@dataclass(frozen=True)
class Surroundings:
    """What else a pair's checks are judged by. reference: its largest pressure of the steps before; beside: that of all
    pairs, now and before; overlap: (n_facets,) largest of each at a point, over its size; free: (dim,) axes along which a
    side may shift, all by default; elsewhere: (n_facets, 2) shares of each facet that other contacts cover, and load;
    support: (n_functions,) int H_k over all of the contactor where the sides may meet anywhere, so that what has no target
    opposite now is no sign of wrong surfaces; else None; stress: as from ``normal_stress``; average: (n_points,) what the
    reported pressure was recovered from, theory (P10), by default it itself; gives: the target's share of what both sides
    give way, 0 where it is held; slid: (n_facets,) motion of each along the target, in facets, None where contact follows
    it; sides: as the choice of the contactor sees them, None where it has no part in it;
    bends: how far a thin part gives way, a length, as from ``thin_give``, None where no side is one; edge: the sharp
    edge that carries most of the force; at_sides: what is not continued beyond the sides of a sector, in words."""

    reference: float = 0.0
    beside: float = 0.0
    overlap: NDArray[np.float64] | None = None
    free: NDArray[np.bool_] | None = None
    elsewhere: NDArray[np.float64] | None = None
    support: NDArray[np.float64] | None = None
    stress: NDArray[np.float64] | None = None
    average: NDArray[np.float64] | None = None
    gives: float = 1.0
    slid: NDArray[np.float64] | None = None
    sides: tuple[Side, Side] | None = None
    bends: float | None = None
    edge: SharpEdge | None = None
    at_sides: str = ""


def certificate(
    pair: Pair,
    values: NDArray[np.float64],
    nodal: NDArray[np.float64],
    penetration: float,
    residual: float,
    share: NDArray[np.float64] | None = None,
    around: Surroundings = Surroundings(),
    balanced: tuple[float, float] | None = None,
) -> tuple[Check, ...]:
    """All checks of one pair.

    values: (9 n_facets,) facet-wise pressure coefficients, (9 n_facets, dim) those of a tie's traction;
    nodal: (n_facets, 9) reported pressure at the facets' nodes; share: the same of the covered share of each node's
    support, all of it by default; penetration: largest, a length; residual: of the contact law, relative to the largest
    pressure; balanced: errors of force and moment of all that acts, by default of the pressure (or tie) alone.
    """
    case = _Case.of(pair, values, nodal, share, around)
    checks = [*_balanced(case, balance(pair, values) if balanced is None else balanced)]
    if not pair.tied:
        checks += [*_gaps(case, penetration), *_slid(case), *_law(case, residual)]
    if not (pair.decided or pair.tied):
        checks += _pressure(case)
    if pair.contact.method == "segment-to-segment":
        checks.append(
            case.check("facet moments", _moment_error(case), MOMENTS,
                "integration error of int H over loaded facets that are fully covered, over their area")
        )  # fmt: skip
    return (*checks, *_cover(case))


@dataclass(frozen=True)
class _Case:
    """A pair with its pressure. areas: (n_facets,); cover: (n_facets,) covered share of them; loaded: (n_facets,) bool;
    hidden: (n_facets,) overlap over what the pressure presses in; largest: pressure of the pair; matters: pressure that
    errors are compared with; pressing: the one that ``hidden`` is relative to."""

    pair: Pair
    values: NDArray[np.float64]
    nodal: NDArray[np.float64]
    share: NDArray[np.float64] | None
    around: Surroundings
    areas: NDArray[np.float64]
    cover: NDArray[np.float64]
    loaded: NDArray[np.bool_]
    hidden: NDArray[np.float64]
    largest: float
    matters: float
    pressing: float

    @classmethod
    def of(
        cls,
        pair: Pair,
        values: NDArray[np.float64],
        nodal: NDArray[np.float64],
        share: NDArray[np.float64] | None,
        around: Surroundings,
    ) -> _Case:
        none = NOTHING * max(around.reference, around.beside)
        largest = max(float(np.nanmax(np.abs(nodal), initial=0.0)), none, 1e-300)
        matters = max(largest, LESSER * around.beside)
        areas = full_moments(pair.contactor, 0)[:, 0]
        pressed_in = max(pair.compliance * matters / np.pi, FLAT)
        sizes = facet_sizes(pair.contactor)
        overlap = np.zeros(len(areas)) if around.overlap is None else around.overlap
        beyond = np.maximum(overlap - meant(pair, largest) / sizes, 0.0)
        of_edge = 0.0 if around.edge is None else around.edge.give
        gives = of_edge if around.bends is None else around.bends
        hidden = beyond / np.maximum(pressed_in, SHARE * gives / sizes)
        loaded = np.nanmax(np.abs(nodal) if pair.contact.kind == KINDS[2] else nodal, axis=1) > CLOSED * largest
        cover = pair.coupling.covered / areas
        pressing = pressed_in * np.pi / pair.compliance if pair.compliance > 0.0 else 0.0
        return cls(pair, values, nodal, share, around, areas, cover, loaded, hidden, largest, matters, pressing)

    def check(
        self, what: str, value: float, limit: float, meaning: str, last: bool = False, pressure: float = 0.0
    ) -> Check:
        return Check(self.pair.contact.name, what, float(value), limit, meaning, last, pressure)


def _balanced(case: _Case, errors: tuple[float, float]) -> Iterator[Check]:
    force, moment = errors
    yield case.check("force balance", force, BALANCE, "force on the contactor plus force on the target, over the force")
    if not case.pair.tied:
        yield case.check("moment balance", moment, BALANCE, "the same of moments, over force times extent")


def _gaps(case: _Case, penetration: float) -> Iterator[Check]:
    """How far the sides are in each other, and how far facets stand off what they stand for."""
    pair, free = case.pair, case.around.free
    deeper = max(penetration - meant(pair, case.largest), 0.0)
    yield case.check(
        "penetration",
        deeper / pair.size,
        PENETRATION,
        "largest weighted penetration over the facet size, beyond the law's",
    )
    yield case.check("overlap", case.hidden.max(initial=0.0), OVERLAP,
        "largest penetration at a point, over what the largest pressure indents between nodes, or a thin part gives way",
        pressure=case.pressing)  # fmt: skip
    shifts = np.ones(pair.contactor.dim, dtype=bool) if free is None else free
    yield case.check("faceting", faceting(pair, case.nodal, CLOSED * case.largest, shifts) / case.matters, FACETING,
        "pressure caused by faceting of curved surfaces, over the largest pressure", pressure=case.matters)  # fmt: skip


def _slid(case: _Case) -> Iterator[Check]:
    """Whether pressure still acts on the places that face each other: with small kinematics those of the outset."""
    if case.around.slid is not None:
        far = case.around.slid[case.loaded].max(initial=0.0)
        yield Check(case.pair.contact.name, "sliding", float(far), SLID,
            "motion along the surfaces where they press, over the facet size: small kinematics does not follow it",
            notice=SLID_NOTICED)  # fmt: skip


def _law(case: _Case, residual: float) -> Iterator[Check]:
    """Whether the pressure keeps to the law, to which tension is foreign unless contact is bilateral."""
    tension = max(0.0, -float(np.nanmin(case.nodal, initial=0.0))) / case.largest
    if not case.pair.two_way:
        yield case.check(
            "tension", tension, TENSION, "largest negative pressure over the largest pressure", pressure=case.largest
        )
    yield case.check(
        "complementarity", residual, COMPLEMENTARITY, "violation of the contact law over the largest pressure"
    )


def _pressure(case: _Case) -> Iterator[Check]:
    """What is wrong with the pressure itself, and how many facets carry it."""
    pair, largest = case.pair, case.largest
    smooth, _ = split_at_creases(pair.contactor)
    pressure = at_points(smooth, case.nodal)
    support = np.ones(len(pressure)) if case.share is None else at_points(smooth, case.share)
    average = pressure if case.around.average is None else case.around.average
    seen = peaks_of(pair, smooth, case.loaded, average, support, case.around.gives)
    matters = max(min(largest, seen.carried / STANDS), LESSER * case.around.beside)
    alternating = oscillation(pair, case.values, average, support, largest) * largest
    yield case.check("oscillation", max(alternating, seen.hole) / matters, OSCILLATION,
        "largest alternating part of the pressure inside the contact over the largest pressure",
        pressure=matters)  # fmt: skip
    counts = largest > LESSER * case.around.beside
    facets = resolution(pair, average, support, largest)
    edge = case.around.edge if counts and facets > RESOLUTION else None
    if edge is not None:
        yield from _at_edge(case, edge)
    else:
        between = resolution_between_ends(pair, average, support, largest) if counts else 0.0
        yield _resolved(case, facets if counts else 0.0, between)
    yield _of_largest(case, seen, counts)
    estimate = pressure_error(pair, pressure, support, largest, case.around.stress, seen.carried, average)
    off = estimate * largest / matters
    unknown = EDGE if edge is not None else NARROW if facets > RESOLUTION else UNSEEN if np.isnan(off) else ""
    edges = edge_load(pair, case.values, case.nodal) if counts else 0.0
    yield Check(pair.contact.name, "pressure error", np.nan if unknown else off, ERROR,
        "estimated local error of the reported pressure inside the contact, over the largest pressure",
        pressure=matters, highest=True, notice=NOTICED, unknown=unknown)  # fmt: skip
    yield Check(pair.contact.name, "contactor's edges", edges, EDGES,
        "sine of the angle between the sides where an edge of the contactor presses, mean by force",
        unknown="the target has points without a normal" if np.isnan(edges) else "")  # fmt: skip


def _at_edge(case: _Case, edge: SharpEdge) -> Iterator[Check]:
    """A sharp edge touches along a line narrower than any facet: what it presses there with is a force."""
    of = words(case.pair.contact.target if edge.of_target else case.pair.contact.contactor)
    place = ", ".join(f"{value:.4g}" for value in edge.place)
    yield Check(case.pair.contact.name, "resolution", np.nan, RESOLUTION, FACETS, last=True, unknown=EDGE)
    yield Check(case.pair.contact.name, "sharp edge", edge.off, OFF,
        f"a sharp edge of {of} presses near ({place}): share by which its force, or how far it moves, may be off; the "
        "pressure there is that of the mesh", last=True, notice=-1.0)  # fmt: skip


def _resolved(case: _Case, facets: float, between_ends: float) -> Check:
    """Thin parts touch along lines: what they press there with is a force, which no facets show as a pressure. Neither do a
    few facets between a body's edges, though its force may be right."""
    if case.around.bends is None and facets <= RESOLUTION and between_ends > BETWEEN_ENDS:
        return Check(case.pair.contact.name, "resolution", between_ends, 1.0,
            f"{FACETS}: between the ends of a body, where pressure rises, its course is unknown", last=True,
            notice=BETWEEN_ENDS)  # fmt: skip
    if case.around.bends is None:
        return case.check("resolution", facets, RESOLUTION, FACETS, last=True)
    return Check(case.pair.contact.name, "resolution", facets, 1.0,
        f"{FACETS}: where a thin part touches along a line forces are right, the largest pressure is unknown",
        last=True, notice=RESOLUTION)  # fmt: skip


def _of_largest(case: _Case, seen: Peaks, counts: bool) -> Check:
    """Whether the largest pressure is one that its surroundings carry, or that of a point or two, which no mesh gives right:
    said, no more, since forces and stresses farther off may be right all the same."""
    where = "at an edge of a body, where that of a sharp one has no limit" if seen.at_edge else "inside"
    return Check(case.pair.contact.name, "largest pressure", seen.out if counts else 0.0, 1.0,
        f"share by which the largest pressure ({where}) stands out of what lies within a facet of the coarser side",
        pressure=case.largest, highest=True, notice=AT_EDGE if seen.at_edge else STANDS_NOTICED)  # fmt: skip


def _cover(case: _Case) -> Iterator[Check]:
    """How much of the contactor has a target opposite, and how often."""
    areas, cover, loaded, pair = case.areas, case.cover, case.loaded, case.pair
    others = np.zeros((len(areas), 2)) if case.around.elsewhere is None else case.around.elsewhere
    yield case.check("loaded area without target", _bare(case, others[:, 0]), BARE,
        "share of its facet that has no target opposite, on average over the contact force")  # fmt: skip
    if case.around.support is None:
        total = pair.space.removed + (len(pair) if pair.tied else len(pair.space))
        yield case.check("removed multipliers", pair.space.removed / max(total, 1), REMOVED,
            "share of the contactor's multipliers removed: no target opposite, or constrained")  # fmt: skip
    # Where a layer behind is counted as well, the gap in the mean may stay open though the one in front is cut into.
    counts = loaded if pair.tied else loaded | (case.hidden > OVERLAP)
    every = (cover + others[:, 1])[counts]
    yield case.check("covered twice", max(float(every.max(initial=0.0)) - 1.0, 0.0), COVERED_TWICE,
        "share of a loaded facet with two layers of target opposite, both counted, here or by another contact")  # fmt: skip


def _bare(case: _Case, elsewhere: NDArray[np.float64]) -> float:
    """Share of a facet that has no target opposite, here or of another contact (elsewhere: (n_facets,) what those cover), on
    average over the force by size: facets at the target's edge count by what they carry."""
    coupling, cover = case.pair.coupling, case.cover
    values = case.values.reshape(len(coupling.weight), -1)
    force = np.abs(coupling.weight[:, None] * values).reshape(len(cover), -1).sum(axis=1)
    missing = 1.0 - np.minimum(cover + elsewhere, np.maximum(cover, 1.0))
    total = float(force.sum())
    return max(float(force @ missing) / total, 0.0) if total > 0.0 else 0.0


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
    (near, own_turn, size), (other, other_turn, _) = sides
    extent = float(np.ptp(pair.contactor.points[pair.contactor.node_ids], axis=0).max())
    size = max(float(size), 1e-300)
    return float(np.abs(near - other).max()) / size, float(np.abs(own_turn - other_turn).max()) / (size * extent)


def _moment_error(case: _Case) -> float:
    """Largest error of int H_k over the area, of facets that are fully covered, as those beside them are, and carry
    pressure: where the target ends within a facet of a slide, a hundredth of it may be missing, and so it may where a body
    that is flush with its target bulges."""
    pair, whole = case.pair, np.abs(case.cover - 1.0) < WHOLE
    at_end = np.zeros(len(pair.contactor.points), dtype=bool)
    nodes = pair.contactor.nodes
    at_end[nodes[~whole][nodes[~whole] >= 0]] = True
    if case.around.support is not None:
        at_end[rim(pair.contactor).ends] = True
    whole &= case.loaded & ~(at_end[np.maximum(nodes, 0)] & (nodes >= 0)).any(axis=1)
    if not whole.any():
        return 0.0
    exact = full_moments(pair.contactor, pair.coupling.degree)
    miss = np.abs(pair.coupling.weight.reshape(exact.shape) - exact) / case.areas[:, None]
    ends = np.zeros(len(pair.contactor.points), dtype=bool)
    ends[rim(pair.contactor).ends] = True
    beyond = (ends[np.maximum(nodes, 0)] & (nodes >= 0)).any(axis=1)  # a target that ends there by chords of its own
    miss -= np.where(beyond, np.abs(case.cover - 1.0), 0.0)[:, None]
    return max(float(miss[whole].max()), 0.0)

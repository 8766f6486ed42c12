"""Checks of contactor and target: whether they face each other, their distance, the size of the target."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray
from scipy.spatial import cKDTree

from abut.contact.coupling import CouplingOptions, couple, default_reach
from abut.contact.geometry import facet_sizes, full_moments, nodal_normals
from abut.contact.self_contact import with_kin
from abut.contact.sides import listed, words
from abut.detection import AUTO, FoundContact, find_contacts
from abut.diagnosis.finding import Finding
from abut.diagnosis.units import UNLIKE, body_size
from abut.errors import AbutError
from abut.mesh.facets import bodies_at
from abut.mesh.surface import Surface
from abut.model import Contact, Model
from abut.model.offset import smallest_offset
from abut.problem.pair import Pair
from abut.problem.sector_sides import left_out

BINS, WIDTH = 8, 30  # of the histogram: bars, and characters of the longest
DEEP = 0.5  # overlap over facet size that is hardly meant
FLAT = 1e-9  # spread of gaps over the facet size below which there is one
MISSING = 0.02  # share of the contactor that sees the target's body, but not the target
LITTLE = 0.5  # covered share of the contactor that is worth a word
MIXED = "one seems to be meshed in metres, the other in millimetres"
SAME_WAY, ACROSS = 0.5, -0.2  # cosine of the mean normals


def not_facing(model: Model, contact: Contact, error: AbutError) -> Finding:
    """Why no facet of a contactor faces the target: units, the wrong side of a body, or distance."""
    contactor, target = model.sides(contact)
    where = f"contact '{contact.name}'"
    bodies, other = (bodies_at(model.mesh, surface.cells) for surface in (contactor, target))
    distance = _distance(contactor, target)
    sizes = [body_size(model.mesh, names[0]) for names in (bodies, other)]
    if max(sizes) > UNLIKE * min(sizes):
        small, large = (bodies[0], other[0]) if sizes[0] < sizes[1] else (other[0], bodies[0])
        return Finding(
            "error",
            where,
            f"body '{small}' is {min(sizes):.3g} in size, '{large}' {max(sizes):.3g}, and they lie {distance:.3g} apart: "
            + MIXED,
            f"scale the coordinates of '{small}' by 1000 (or those of '{large}' by 0.001)",
        )
    cosine = float(_mean_normal(contactor) @ _mean_normal(target))
    found = [
        f
        for f in find_contacts(model.mesh, model.solids, bodies=[*bodies, *other])
        if set(f.bodies) <= {*bodies, *other}
    ]
    if cosine > ACROSS or found:
        how = "point the same way" if cosine > SAME_WAY else "do not point at each other"
        return Finding(
            "error",
            where,
            f"the outward normals of {words(contact.contactor)} and {words(contact.target)} {how}: one of them "
            "is on the wrong side of its body",
            _right_side(model, contact, found),
        )
    reach = default_reach(contactor, target)
    if distance > reach:
        return Finding(
            "error",
            where,
            f"{words(contact.contactor)} and {words(contact.target)} lie {distance:.3g} apart, beyond the reach of "
            f"{reach:.3g} (two facets, or a tenth of the contactor)",
            "move the bodies together in the mesh",
        )
    return Finding("error", where, f"no facet of {words(contact.contactor)} faces {words(contact.target)}", str(error))


def _right_side(model: Model, contact: Contact, found: list[FoundContact]) -> str:
    """Which surfaces would do, by name where the facets that face each other have one."""
    if not found:
        return "choose the surfaces that face each other"
    names = []
    for rows, auto in ((found[0].contactor_facets, found[0].contactor), (found[0].target_facets, found[0].target)):
        wanted = {(int(c), int(f)) for c, f in rows}
        share = {
            name: len(wanted & shared) / len(wanted | shared)
            for name, facets in model.mesh.surfaces.items()
            if (shared := {(int(c), int(f)) for c, f in facets})
        }
        best = max(share, key=lambda name: share[name], default="")
        names.append(best if best and share[best] > 0.3 else auto)
    return f"the surfaces that face each other are '{names[0]}' and '{names[1]}': use them"


def interface(model: Model, pair: Pair, outside: NDArray[np.int64]) -> list[Finding]:
    """Gaps as a histogram, deep overlaps, and what the contactor does not find opposite.

    outside: (n, 2) the facets of ``abut.mesh.exterior.exterior``."""
    return [*_gaps(model, pair), *_bulges(pair), *_at_sides(model, pair), *_cover(model, pair, outside)]


def _at_sides(model: Model, pair: Pair) -> list[Finding]:
    """What is not continued beyond the sides of a sector."""
    note = left_out(model, pair.contact) if pair.contact in model.contacts else ""
    where, cure = f"contact '{pair.contact.name}'", "cut the sector where nothing touches, if it can be"
    return [Finding("warning", where, f"it reaches both sides of a sector: {note}", cure)] if note else []


def _bulges(pair: Pair) -> list[Finding]:
    """The largest height of the smooth surface over flat facets, of both sides, and where."""
    found = [(np.abs(side.bulge), side) for side in (pair.contactor, pair.target) if side.bulge is not None]
    if not found:
        return []
    heights, side = max(found, key=lambda each: float(each[0].max()))
    facet = int(heights.max(axis=1).argmax())
    nodes = side.nodes[facet][side.nodes[facet] >= 0]
    at = ", ".join(f"{x:.4g}" for x in side.points[nodes].mean(axis=0))
    height = float(heights.max())
    what = f"flat facets of '{side.name}' stand for a curved surface: its bulge of up to {height:.3g} over them, at ({at}), "
    return [
        Finding("info", f"contact '{pair.contact.name}'", what + 'is taken off the gap (geometry = "faceted": not)')
    ]


def _gaps(model: Model, pair: Pair) -> list[Finding]:
    contact = pair.contact
    where = f"contact '{contact.name}'"
    reach = default_reach(pair.contactor, pair.target)
    options = CouplingOptions(points=2, reach=reach, keep_points=True, adjust=contact.adjust)
    # What lies deeper in a body than it is thick is seen through it: the far flank of the tooth beside.
    at = couple(*with_kin(model.mesh, pair.contactor, pair.target, True), 0, options).points
    if at is None or not len(at.gap):
        return []
    gap = at.gap + smallest_offset(contact)
    least, most = float(gap.min()), float(gap.max())
    findings = [
        Finding(
            "info",
            where,
            f"gap {least:.3g} to {most:.3g}"
            + (" (offset included)" if contact.offset else "")
            + f", facet size {pair.size:.3g}",
            details=_bars(gap, at.weight, FLAT * pair.size),
        )
    ]
    if contact.kind == "tied":
        return findings
    moved = _prescribed(model)
    if moved is not None and least > moved:
        findings.append(
            Finding(
                "warning",
                where,
                f"nothing closes the gap of {least:.3g}: there are no loads, and supports move by {moved:.3g} at most",
                "check the unit of lengths, or move the bodies together",
            )
        )
    if -least > DEEP * pair.size:
        share = float(at.weight[gap < -DEEP * pair.size].sum() / at.weight.sum())
        findings.append(
            Finding(
                "warning",
                where,
                f"the bodies overlap by up to {-least:.3g}, {-least / pair.size:.2g} times the facet size (deeper than half "
                f"of it on {share:.0%} of the area)",
                f"if no such interference is meant, move them apart in the mesh, or add offset = {-least:.3g}",
            )
        )
    return findings


def _prescribed(model: Model) -> float | None:
    """Largest prescribed displacement; None where something else may move the bodies too."""
    values = [getattr(support, name) for support in model.supports for name in ("x", "y", "z", "normal")]
    others: object = model.loads or model.referenced or model.equations
    others = others or any(solid.temperature or solid.initial_stress for solid in model.solids)
    if others or any(map(callable, values)) or any(support.amplitude for support in model.supports):
        return None
    return max((abs(float(v)) for v in values if v is not None), default=0.0)


def _bars(gap: NDArray[np.float64], area: NDArray[np.float64], flat: float) -> tuple[str, ...]:
    """Share of the area by gap, as text."""
    least, most = float(gap.min()), float(gap.max())
    if most - least <= flat:
        return ()
    share, edges = np.histogram(gap, bins=BINS, range=(least, most), weights=area / area.sum())
    return tuple(
        f"{low:10.3g} .. {high:10.3g}  {'#' * round(WIDTH * s / share.max()):{WIDTH}s} {s:6.1%}"
        for low, high, s in zip(edges, edges[1:], share)
    )


def _cover(model: Model, pair: Pair, outside: NDArray[np.int64]) -> list[Finding]:
    """A target is too small where the contactor sees facets of its body that do not belong to it, and may come near them."""
    where = f"contact '{pair.contact.name}'"
    covered, whole = pair.coupling.covered, full_moments(pair.contactor, 0)[:, 0]
    share = float(covered.sum() / whole.sum())
    bodies = bodies_at(model.mesh, pair.target.cells)
    cells = np.concatenate([model.mesh.bodies[body] for body in bodies])
    around = model.mesh.facets(outside[np.isin(outside[:, 0], cells)], "outside of the target's body")
    opposite = _opposite(pair, around, _prescribed(model))
    missing = float(np.clip(np.minimum(opposite, whole - covered), 0.0, None).sum() / whole.sum())
    whose = ("body " if len(bodies) == 1 else "bodies ") + words(bodies)
    if missing > MISSING:
        return [
            Finding(
                "warning",
                where,
                f"target {words(pair.contact.target)} is too small: {missing:.0%} of contactor "
                f"{words(pair.contact.contactor)} lies opposite facets of {whose} that do not "
                "belong to it, and would sink into them",
                _more(pair.contact),
            )
        ]
    if share == 0.0:
        return [
            Finding(
                "advice",
                where,
                f"no facet of {words(pair.contact.contactor)} faces {words(pair.contact.target)} at the outset: they touch "
                "only once they have moved there",
                "if that is not meant, check the names, the distance, and that both normals point out of their bodies",
            )
        ]
    if share < LITTLE:
        return [
            Finding(
                "info", where, f"{1.0 - share:.0%} of contactor {words(pair.contact.contactor)} has no target opposite"
            )
        ]
    return []


def _opposite(pair: Pair, around: Surface, moved: float | None) -> NDArray[np.float64]:
    """Area of each contactor facet that lies opposite facets of ``around`` that are not the target's, near enough to come
    into contact: no further than supports move bodies by (``moved``, where nothing else does), else than half a facet
    beyond where the bodies are closest. What a facet lies deep inside of is seen from behind, and does not count."""
    contactor, target = pair.contactor, pair.target
    options = CouplingOptions(points=1, reach=default_reach(contactor, target), keep_points=True)
    at = couple(contactor, around, 0, options).points
    if at is None or not len(at.gap):
        return np.zeros(len(contactor))
    half = DEEP * (facet_sizes(contactor)[at.facet] + facet_sizes(around)[at.target_facet])
    seen = -at.gap <= half
    closest = max(float(at.gap[seen].min(initial=np.inf)), 0.0)
    near = seen & (at.gap <= (closest + DEEP * facet_sizes(contactor)[at.facet] if moved is None else moved))
    named = np.isin(8 * around.cells + around.local, 8 * target.cells + target.local)
    other = near & ~named[at.target_facet]
    return np.bincount(at.facet[other], at.weight[other], minlength=len(contactor)).astype(np.float64)


def _more(contact: Contact) -> str:
    """How to make a target larger; where it was found by itself that is no advice any more."""
    if any(name.startswith(AUTO) for name in listed(contact.target)):
        return "name a larger surface of that body as the target, or give a larger reach"
    return f"add these facets to {words(contact.target)}, or let auto = true find the pair"


def _mean_normal(surface: Surface) -> NDArray[np.float64]:
    total = (nodal_normals(surface).sum(axis=1) * full_moments(surface, 0)[:, :1]).sum(axis=0)
    return np.asarray(total / max(np.linalg.norm(total), 1e-300))


def _distance(contactor: Surface, target: Surface) -> float:
    tree = cKDTree(target.points[target.node_ids])
    return float(np.min(tree.query(contactor.points[contactor.node_ids])[0]))

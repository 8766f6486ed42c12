"""What is most likely to help where a step did not converge, or where surfaces overlap."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from abut.interface.coupling import surface_degree
from abut.interface.geometry import facet_sizes
from abut.mesh.surface import Surface
from abut.model import LAWS, METHODS, Contact
from abut.sides import code, words
from abut.state import ContactResult, Solution, Step

COUNT = 3
FINER, STIFFER = (
    0.8,
    1.5,
)  # contactor's facet size over the target's, Young's modulus likewise, that tell the sides apart
LARGE_RESIDUAL = 1e-6  # of equilibrium, which a sound matrix leaves at rounding level
MOVED = 0.25  # change of the contact within a step, over all multipliers, from which on it moves a lot
UNSTABLE = ("P0", "P1-discontinuous", "P2-discontinuous")  # docs/verification/inf-sup.md


@dataclass(frozen=True)
class Remedy:
    """What to do, and why that should help here."""

    action: str
    reason: str

    def __str__(self) -> str:
        return f"{self.action}: {self.reason}"


@dataclass(frozen=True)
class Place:
    """Facets of a contactor whose contact does not settle: facets (n,) their numbers within the surface; nodes (m,) point
    numbers of the mesh; coordinates (m, dim)."""

    contact: str
    facets: NDArray[np.int64]
    nodes: NDArray[np.int64]
    coordinates: NDArray[np.float64]

    def __str__(self) -> str:
        facets = ", ".join(map(str, self.facets[:8].tolist())) + (", ..." if len(self.facets) > 8 else "")
        low, high = self.coordinates.min(axis=0), self.coordinates.max(axis=0)
        box = " to ".join("(" + ", ".join(f"{v:.4g}" for v in corner) + ")" for corner in (low, high))
        return f"contact '{self.contact}': facets [{facets}] do not settle, {len(self.facets)} in all, within {box}"


def unsettled(step: Step) -> list[Place]:
    """Where the contact of a step does not settle, contact by contact."""
    surfaces = {c.name: c.contactor for c in step.contacts}
    places = []
    for name, facets in step.cycling.items():
        nodes = surfaces[name].nodes[facets]
        own = np.unique(nodes[nodes >= 0]).astype(np.int64)
        places.append(Place(name, facets, own, surfaces[name].points[own]))
    return places


def remedies(solution: Solution) -> tuple[Remedy, ...]:
    """Three remedies, the most likely first, for a run that did not converge, or whose certificate finds surfaces that
    overlap; else none."""
    if solution.converged:
        return tuple(_by_overlap(solution))[:COUNT]
    every = [*_by_residual(solution), *_by_contact(solution), *_by_course(solution), *_always(solution)]
    first = {remedy.action: remedy for remedy in reversed(every)}
    return tuple(first[action] for action in dict.fromkeys(remedy.action for remedy in every))[:COUNT]


def _by_residual(solution: Solution) -> Iterator[Remedy]:
    residual = solution.steps[-1].iterations[-1].residual
    if residual <= LARGE_RESIDUAL:
        return
    yield Remedy(
        "check the units of Young's moduli, loads and mesh",
        f"equilibrium is missed by {residual:.1e} of the forces, as where stiffnesses lie too far apart or the matrix is "
        "nearly singular",
    )
    if "multigrid" in solution.solver:
        yield Remedy(
            'solve.linear = "direct"',
            f"multigrid left {residual:.1e} of the forces out of balance; a factorisation does not mind the shape of cells",
        )
    yield Remedy(
        "add supports that hold every body by themselves",
        "what contact alone holds is lost while the contact changes",
    )


def _by_overlap(solution: Solution) -> Iterator[Remedy]:
    """Contact narrower than the pressure functions it is averaged over: theory (L10)."""
    failed = {check.contact for check in solution.certificate if check.name == "overlap" and not check.passed}
    results = {c.name: c for c in solution.contacts}
    for contact in solution.model.contacts:
        if contact.name not in failed:
            continue
        where = f"contact '{contact.name}': "
        result = results[contact.name]
        if contact.pressure == "P1" and surface_degree(result.contactor) == 2:
            yield Remedy(
                f'{where}pressure = "auto"',
                "P2 has functions that stand on fewer facets, so that contact on one row of facets counts",
            )
        coarse = float(np.median(facet_sizes(result.contactor)) / np.median(facet_sizes(result.target)))
        if coarse > 1.0 / FINER:
            yield Remedy(
                f"{where}swap the sides (contactor = {code(contact.target)}, target = {code(contact.contactor)})",
                f"gaps are closed in the mean over the contactor's facets, and those are {coarse:.2g} times the target's",
            )
        yield Remedy(
            f"{where}refine both surfaces where they touch",
            "contact is narrower than two facets, or chords of curved surfaces cut into each other; facets that stay open "
            "may also be left out of the contactor",
        )
        if contact.law == LAWS[0] and contact.method == METHODS[0]:
            yield Remedy(
                f'{where}law = "constraint-function"',
                "it looks at points and errs the other way (too stiff): the truth lies between",
            )


def _by_contact(solution: Solution) -> Iterator[Remedy]:
    step = solution.steps[-1]
    results = {_own(c.name): c for c in step.contacts}
    for contact in solution.model.contacts:
        if contact.name not in map(_own, step.cycling):
            continue
        where = f"contact '{contact.name}': "
        if contact.method != METHODS[0]:
            yield Remedy(
                f"{where}leave method out",
                f"{contact.method} lets single nodes jump from one target facet to the next; segment-to-segment does not",
            )
        if contact.law == LAWS[1]:
            yield Remedy(
                f'{where}law = "complementarity"',
                f"the constraint function with epsilon = {contact.epsilon:g} is too sharp for Newton's method here; the "
                "active set needs no smoothing",
            )
        if contact.pressure in UNSTABLE:
            yield Remedy(
                f'{where}pressure = "auto"',
                f"{contact.pressure} can oscillate from facet to facet and then never settles",
            )
        yield from _by_sides(solution, contact, results[contact.name], where)


def _own(name: str) -> str:
    return name.removesuffix(" (second pass)")


def _by_sides(solution: Solution, contact: Contact, result: ContactResult, where: str) -> Iterator[Remedy]:
    """The contactor should be the softer side, and not much finer than the target."""
    fine = float(np.median(facet_sizes(result.contactor)) / np.median(facet_sizes(result.target)))
    stiff = _young(solution, result.contactor) / _young(solution, result.target)
    reasons = []
    if fine < FINER:
        reasons.append(
            f"the contactor's facets are {fine:.2g} of the target's in size: its pressure sees the target's kinks"
        )
    if stiff > STIFFER:
        reasons.append(f"the contactor is {stiff:.3g} times as stiff, and the softer side should carry the pressure")
    if reasons:
        yield Remedy(
            f"{where}swap the sides (contactor = {code(contact.target)}, target = {code(contact.contactor)})",
            "; ".join(reasons),
        )
    if fine < FINER:
        yield Remedy(
            f"{where}refine {words(contact.target)} {1.0 / fine:.2g} times",
            "then its facets are no larger than the contactor's",
        )


def _young(solution: Solution, surface: Surface) -> float:
    """Largest Young's modulus behind a surface; a body without a material does not give way at all."""
    young = {solid.body: solid.material.young for solid in solution.model.solids}
    bodies = solution.model.mesh.bodies
    own = [body for body, cells in bodies.items() if np.isin(surface.cells, cells).any()]
    return max((young.get(body, np.inf) for body in own), default=np.inf)


def _by_course(solution: Solution) -> Iterator[Remedy]:
    """What the iterations themselves tell."""
    step, solve = solution.steps[-1], solution.model.solve
    changed = [row.changed for row in step.iterations]
    active = [row.active for row in step.iterations]
    multipliers = max(sum(c.multipliers for c in step.contacts), 1)
    share = (max(active) - min(active)) / multipliers
    moving = Remedy(
        f"solve.steps = {4 * solve.steps}",
        f"the contact changed on {100.0 * share:.0f} % of the interface within one step; smaller steps begin closer to "
        "where they end",
    )
    if share > MOVED:
        yield moving
    if 0 < changed[-1] < min(changed[:-1], default=changed[-1] + 1):
        yield Remedy(
            f"solve.max_iterations = {4 * solve.max_iterations}",
            f"the contact was still settling at the limit of {solve.max_iterations}: {changed[-1]} multipliers changed last",
        )


def _always(solution: Solution) -> Iterator[Remedy]:
    """What is worth trying where nothing in particular stands out."""
    solve = solution.model.solve
    yield Remedy(f"solve.steps = {4 * solve.steps}", "smaller steps begin closer to where they end")
    if solution.model.contacts and all(c.law == LAWS[0] for c in solution.model.contacts):
        yield Remedy('law = "constraint-function"', "it is smooth where facets go in and out of contact for ever")
    yield Remedy(f"solve.max_iterations = {4 * solve.max_iterations}", "the last iterations may only have been too few")
    yield Remedy(
        "a finer mesh where the contact does not settle",
        "the array 'unsettled' of contact_*.vtu and summary.json show where",
    )

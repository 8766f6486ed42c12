"""Advice where a step did not converge, or where surfaces overlap."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from itertools import compress

import numpy as np
from numpy.typing import NDArray

from abut.contact.coupling import surface_degree
from abut.diagnosis.all_restraint import all_restraint
from abut.materials.material import linear
from abut.model import LAWS, METHODS, SolveOptions
from abut.problem.constraints import supports
from abut.solution import ContactResult, Solution, Step

COUNT = 3
STATUSES = ("open", "sticking", "slipping")
SPENT = 0.95  # share of the limit of a whole contact from which on friction can hardly carry more
LOOSE = 1e-9  # of a rigid motion, at a point that it moves
STRAINED = 0.1  # stress over Young's modulus from which on a linear elastic material may be what gives way
NAMED = 4  # nodes that the message names
MORE = 4  # times the iterations, and as many as are allowed without asking at least


@dataclass(frozen=True)
class Remedy:
    """What to do, and why that should help here."""

    action: str
    reason: str

    def __str__(self) -> str:
        return f"{self.action}: {self.reason}"


@dataclass(frozen=True)
class Place:
    """Facets of a contactor whose contact status keeps changing: facets (n,) their numbers within the surface; nodes (m,)
    point numbers of the mesh; coordinates (m, dim); between: with friction, (m, 3) bool, which of ``STATUSES`` each node
    takes in turn."""

    contact: str
    facets: NDArray[np.int64]
    nodes: NDArray[np.int64]
    coordinates: NDArray[np.float64]
    between: NDArray[np.bool_] | None = None

    def __str__(self) -> str:
        if self.between is not None:
            some = [
                f"node {node} at ({', '.join(f'{v:.4g}' for v in at)}) is {' and '.join(compress(STATUSES, states))} in turn"
                for node, at, states in zip(self.nodes[:NAMED], self.coordinates, self.between)
            ]
            more = f"; and {len(self.nodes) - NAMED} more" if len(self.nodes) > NAMED else ""
            return f"contact '{self.contact}': {'; '.join(some)}{more}"
        facets = ", ".join(map(str, self.facets[:8].tolist())) + (", ..." if len(self.facets) > 8 else "")
        low, high = self.coordinates.min(axis=0), self.coordinates.max(axis=0)
        box = " to ".join("(" + ", ".join(f"{v:.4g}" for v in corner) + ")" for corner in (low, high))
        return (
            f"contact '{self.contact}': the contact status of {len(self.facets)} facets keeps changing: [{facets}], "
            f"within {box}"
        )


def unsettled(step: Step) -> list[Place]:
    """Where the contact status of a step keeps changing, contact by contact."""
    surfaces = {c.name: c.contactor for c in step.contacts}
    places = []
    for name, facets in step.cycling.items():
        if flips := step.flips.get(name):
            places.append(Place(name, facets, flips.nodes, surfaces[name].points[flips.nodes], flips.between))
            continue
        nodes = surfaces[name].nodes[facets]
        used = np.unique(nodes[nodes >= 0]).astype(np.int64)
        places.append(Place(name, facets, used, surfaces[name].points[used]))
    return places


def remedies(solution: Solution) -> tuple[Remedy, ...]:
    """At most three pieces of advice, the most likely first, for a run that did not converge, or whose certificate finds
    surfaces that overlap; else none. Only such as have been seen to help: the search for the contact status converges
    independently of the mesh, the load steps and the choice of the contactor."""
    found = (
        _by_overlap(solution)
        if solution.converged
        else (
            *_by_sliding(solution),
            *_by_deformation(solution),
            *_by_law(solution),
            *_by_limit(solution),
        )
    )
    return tuple(found)[:COUNT]


def _by_overlap(solution: Solution) -> Iterator[Remedy]:
    """Contact narrower than the pressure functions it is averaged over: theory (L10)."""
    at_edges = {check.contact for check in solution.certificate if check.name == "sharp edge"}
    failed = {
        check.contact for check in solution.certificate if check.name == "overlap" and not check.passed
    } - at_edges
    results = {c.name: c for c in solution.contacts}
    for contact in solution.model.contacts:
        if contact.name not in failed:
            continue
        where = f"contact '{contact.name}': "
        result = results[contact.name]
        if contact.pressure == "P1" and surface_degree(result.contactor) == 2:
            yield Remedy(
                f'{where}pressure = "auto"',
                "the functions of P2 span fewer facets, so that contact on a single row of facets is seen",
            )
        yield Remedy(
            f"{where}refine both surfaces where they touch",
            "contact is narrower than two facets, or chords of curved surfaces cut into each other; facets that stay open "
            "may also be left out of the contactor",
        )
        if contact.law == LAWS[0] and contact.method == METHODS[0]:
            yield Remedy(
                f'{where}law = "constraint-function"',
                "it enforces contact at points and errs on the other side (too stiff): the exact result lies in between",
            )


def _by_law(solution: Solution) -> Iterator[Remedy]:
    """Of all contacts at once: what one of them does moves the others."""
    smooth = [contact for contact in solution.model.contacts if contact.law == LAWS[1] and contact.kind != "tied"]
    if smooth:
        names = _listed([contact.name for contact in smooth])
        yield Remedy(
            f'contact{"s" if len(smooth) > 1 else ""} {names}: law = "complementarity"',
            f"the constraint function with epsilon = {smooth[0].epsilon:g} is too sharp for Newton's method here; the "
            "active set needs no smoothing",
        )


def _by_sliding(solution: Solution) -> Iterator[Remedy]:
    """Of bodies that supports leave free and loads push along, where friction gave all that it can in the last state that
    converged, or where none did."""
    model, steps = solution.model, [step for step in solution.steps if step.converged]
    selves = {contact.name for contact in model.contacts if contact.contactor == contact.target}
    rubbing = [c for c in solution.steps[-1].contacts if c.friction is not None and c.name not in selves]
    if not (rubbing and model.loads) or _hurried(solution):
        return
    free = np.abs(all_restraint(model, supports(model), []).free).max(axis=1, initial=0.0)
    loose = free.reshape(-1, model.dim).max(axis=1) > LOOSE
    names = [c.name for c in rubbing if loose[c.contactor.node_ids].any() or loose[c.target.node_ids].any()]
    action = "a support, a prescribed displacement in place of the load, or more friction or pressure"
    if names and not steps:
        yield Remedy(action, f"loads may push along what friction alone holds, in contact {_listed(names)}")
    elif spent := [c for c in steps[-1].contacts if c.name in names and _spent(c)] if steps else []:
        some = [
            f"contact '{c.name}' carries {rub.force_by_area:.4g} of at most {rub.force_limit:.4g}"
            for c in spent
            if (rub := c.friction)
        ]
        yield Remedy(
            action,
            f"friction reaches its limit, and what it alone holds slides: {', '.join(some)}, at time "
            f"{steps[-1].time:.4g}",
        )


def _listed(names: Sequence[str]) -> str:
    return ", ".join(f"'{name}'" for name in names)


def _spent(contact: ContactResult) -> bool:
    rub = contact.friction
    return rub is not None and rub.force_by_area >= SPENT * rub.force_limit > 0.0


def _by_deformation(solution: Solution) -> Iterator[Remedy]:
    """Of finite deformation, where load steps have been halved in vain."""
    model, step = solution.model, solution.steps[-1]
    if not model.finite:
        return
    for solid in sorted(model.solids, key=lambda solid: f"'{solid.body}'" not in step.reason):
        at = model.mesh.nodes_of(solid.body)
        if (
            not model.small_strains
            and linear(solid.material) is solid.material
            and np.abs(step.stress[at]).max() > STRAINED * solid.material.modulus
        ):
            yield Remedy(
                f"material kind = \"neo-hooke\" of body '{solid.body}'",
                "a linear elastic one gives way when it is pressed to about half its length",
            )
            break
    if model.contacts and model.loads:
        yield Remedy(
            "prescribed displacements in place of the loads",
            "where a load finds no state near by that balances it (buckling, snapping through, sliding off) steps become "
            "too short, however many there are",
        )
    if not model.contacts:
        yield Remedy(
            f"solve.steps = {4 * len(model.ends)}",
            "steps are halved six times at most; a load that no deformation balances stays out of reach",
        )


def _hurried(solution: Solution) -> bool:
    """Whether fewer iterations were allowed than by default, and all of them taken: that alone may be why."""
    limit = solution.model.solve.max_iterations
    return limit < SolveOptions().max_iterations and len(solution.steps[-1].iterations) >= limit


def _by_limit(solution: Solution) -> Iterator[Remedy]:
    limit, taken = solution.model.solve.max_iterations, len(solution.steps[-1].iterations)
    if taken >= limit:
        yield Remedy(
            f"solve.max_iterations = {max(MORE * limit, SolveOptions().max_iterations)}",
            f"the contact status was still changing after the {limit} iterations that are allowed",
        )

"""Results of a step from its state: displacements, stresses, reactions, contact results."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from abut.analysis.certificate import Surroundings
from abut.analysis.connectors import connector_results
from abut.analysis.contact_results import PairState, contact_result
from abut.analysis.covered import covered, whole_supports
from abut.analysis.energy import Acting, energy, pressing, tractions
from abut.analysis.faceting import free_axes
from abut.analysis.flow import flow, remembered
from abut.analysis.interpolation_error import Mended
from abut.analysis.known_stress import known_stress
from abut.analysis.mean_error import with_mean
from abut.analysis.moved import slid, turned
from abut.analysis.node_fields import node_fields
from abut.analysis.overlap import covered_elsewhere, overlaps
from abut.analysis.penetrations import penetration_results
from abut.analysis.preloads import preload_results
from abut.analysis.reactions import reactions
from abut.analysis.response import beyond_rounding, grows
from abut.analysis.sharp_edge import Forces, sharp_edge
from abut.analysis.stress_error import stress_error
from abut.analysis.surface_stress import cells_around, loaded_points, normal_stress
from abut.analysis.thin_give import bends
from abut.analysis.volume_change import volume_change
from abut.bodies.averages import averages
from abut.bodies.recovery import at_points, of_shells, recovered
from abut.cells import MAX_FACET_NODES
from abut.dofs import dofs_at
from abut.mesh.surface import Surface
from abut.model import Model
from abut.model.conditions import weights
from abut.model.offset import offsets
from abut.nonlinear.attempt import Attempt
from abut.nonlinear.settings import DEFAULT
from abut.problem.assembly import Assembled
from abut.problem.balance import Balance
from abut.problem.body_terms import heated
from abut.problem.connectors import Connectors
from abut.problem.constraints import Constraints
from abut.problem.dashpots import Dashpots, dissipated
from abut.problem.follower_loads import FollowerLoads
from abut.problem.held_motions import HeldMotions, held_force
from abut.problem.holds import Holds
from abut.problem.pair import Pair
from abut.problem.penetrations import Penetrations
from abut.problem.preloads import LockedPreloads
from abut.problem.problem import ContactProblem
from abut.problem.released import Released
from abut.problem.rigid_bodies import RigidBody
from abut.problem.scales import scales
from abut.problem.sections import preload_forces
from abut.problem.sector_sides import left_out
from abut.problem.springs import Springs
from abut.problem.step_error import landed_in
from abut.problem.terms import Motion
from abut.solution import ContactResult, Energy, Flips, Flow, PreloadResult, RigidResult, Step
from abut.solution.state import State

Acted = Acting | None  # what acts at the end of a step


@dataclass(frozen=True)
class _End:
    """A model at the end of a load step. displacement, internal, loads, reaction: (dim n_points,) without rigid motions on
    springs, forces of stresses, of loads, of supports and links; following: those of loads that follow the deformation,
    and of other physics; locked, sprung: of preloads that are locked, of springs, connectors, contacts that let go and what
    holds neutral motions; damping: of dashpots, part of sprung, None without; held: of supports that come and go, part of
    the reaction; pressures: (n,) of each pair; cycling: (n,) multipliers that keep changing; supports: of each pair int H_k
    over all of the deformed contactor, (n_functions,), where it may meet the target anywhere, else None."""

    problem: ContactProblem
    balance: Balance
    state: State
    motion: Motion
    displacement: NDArray[np.float64]
    pressures: list[NDArray[np.float64]]
    internal: NDArray[np.float64]
    loads: NDArray[np.float64]
    reaction: NDArray[np.float64]
    following: NDArray[np.float64]
    locked: NDArray[np.float64]
    sprung: NDArray[np.float64]
    held: NDArray[np.float64]
    cycling: NDArray[np.bool_]
    flow: Flow | None
    supports: Sequence[NDArray[np.float64] | None]
    damping: NDArray[np.float64] | None

    @property
    def nodal(self) -> NDArray[np.float64]:
        return self.displacement.reshape(-1, self.problem.model.dim)

    @property
    def linked(self) -> NDArray[np.float64]:
        """The part of ``reaction`` that holds points together."""
        links = self.problem.constraints.links
        return np.zeros_like(self.reaction) if links is None else links.forces(self.reaction)

    @property
    def by_supports(self) -> NDArray[np.float64]:
        """The other part, (n_points, dim)."""
        return (self.reaction - self.linked).reshape(-1, self.problem.model.dim)


def step_result(
    assembled: Assembled, attempt: Attempt, before: Sequence[Step], acted: Acted = None, shown: Mended | None = None
) -> tuple[Step, Acted]:
    """Collect displacement, stress, reactions and contact results at the end of a load step, ``before`` being the others,
    and with friction or finite kinematics what acts there, for the energy of the next step; acted: the same of the step
    before; shown: what pressures and stresses are shown from.

    Raises SingularModelError for displacements that no units explain."""
    end = _end(assembled, attempt)
    problem, balance, state = end.problem, end.balance, end.state
    model, constraints = problem.model, problem.constraints
    by_supports = end.by_supports
    own = assembled.bodies.stress(end.motion) if shown is None else shown.fits.stress
    moved = end.nodal if shown is None else shown.displacement
    points = model.mesh.points if model.small_strains else model.mesh.points + end.nodal
    points, solids = np.ascontiguousarray(points), model.deformable
    change = heated(model, assembled.loaded, end.motion)
    near = own if shown is None else shown.near(cells_around(model.mesh, [p.contactor for p in balance.pairs]), change)
    contacts = _contacts(end, attempt, before, averages(solids, near), shown)
    known = known_stress(model, points, moved, state.time, change, list(zip(balance.pairs, contacts)))
    values = recovered(solids, points, own, known, None if shown is None else shown.fits, change)
    acting, work = _energy(end, attempt, acted, contacts, before)
    strained = beyond_rounding(end.internal, balance, end.displacement)
    wrong = stress_error(solids, end.nodal, own, values, contacts) if strained else None
    pushes = [float(np.abs(pair.rows.T @ p).sum()) / 2.0 for pair, p in zip(balance.pairs, end.pressures)]
    step = Step(
        number=attempt.number,
        factor=state.time,
        run_end=model.solve.end,
        converged=attempt.converged,
        reason=attempt.reason,
        iterations=attempt.iterations,
        displacement=end.nodal,
        stress=at_points(solids.patches, values, len(points)),
        own_stress=of_shells(solids, values),
        reaction=(end.reaction + end.sprung).reshape(-1, model.dim).sum(axis=0),
        **vars(reactions(model, constraints.bodies, by_supports, end.nodal)),
        load=assembled.loaded.resultant @ balance.factors + end.following.reshape(-1, model.dim).sum(axis=0),
        contacts=with_mean(contacts, model, wrong),
        axisymmetric=model.mesh.axisymmetric,
        cycling=_cycling(balance, end.cycling),
        flips=_flips(balance, attempt),
        earlier=max((step.largest_force for step in before), default=0.0),
        internal=float(np.abs(end.internal).sum()),
        pressed=max(pushes, default=0.0),
        strain=max((pair.compliance * c.max_pressure / 4.0 for pair, c in zip(balance.pairs, contacts)), default=0.0),
        rounding=_rounding(balance, state.unknowns),
        strained=strained,
        grown=not strained and grows(solids, change, balance, end.displacement),
        landed=_landed(state),
        turn=turned(model, end.nodal),
        energy=work if strained else None,
        stress_error=wrong,
        volume_change=volume_change(solids, end.nodal, own, change) if shown is None and strained else None,
        remembered={**remembered(solids, end.motion.history, before), **node_fields(problem, end.motion, state)},
        flow=end.flow,
        nodal_reaction=end.reaction.reshape(-1, model.dim),
        **_joints(end),
    )
    return step, acting


def _end(assembled: Assembled, attempt: Attempt) -> _End:
    """Forces and pressures of the state that a load step ended with."""
    bodies, state, cycling = assembled.bodies, attempt.state, attempt.cycling
    problem = assembled.problem
    displacement = problem.displacement(state)
    turned = not problem.model.finite and len(problem.springs) > 0  # small turns would strain it
    if turned:
        displacement = problem.springs.without_motions(displacement)
    balance = attempt.balance or Balance.of(problem.again(state, state), state)
    balance, state, kept = covered(problem, balance, state, displacement)
    cycling, supports = cycling[kept], whole_supports(problem, balance.pairs, kept)
    pressures = balance.split(state.multipliers)
    contact_force = np.zeros_like(displacement)
    for pair, pressure in zip(balance.pairs, pressures):
        contact_force += pair.rows.T @ pressure
    motion = replace(problem.motion(state.time, problem.values(state)), history=state.history.of(bodies.name))
    motion = replace(motion, displacement=displacement)
    known = {} if turned else balance.forces
    internal = known[bodies.name] if bodies.name in known else bodies.evaluate(motion, motion).force
    following = np.zeros_like(displacement)
    for term in problem.terms:
        if isinstance(term, (FollowerLoads, Penetrations)) or term.name in problem.own:
            following -= balance.forces[term.name][: len(following)]
    locked = np.zeros_like(displacement)
    if LockedPreloads.name in balance.forces:
        locked -= balance.forces[LockedPreloads.name]
    sprung = np.zeros_like(displacement)
    for term in problem.terms:
        if isinstance(term, Springs):
            sprung -= term.evaluate(motion, motion).force
    for name in (HeldMotions.name, Connectors.name, Released.name, Dashpots.name):
        if name in balance.forces:
            sprung -= balance.forces[name][: len(sprung)]
    damping = -balance.forces[Dashpots.name] if Dashpots.name in balance.forces else None
    held = -balance.forces.get(Holds.name, np.zeros_like(displacement))
    loads = assembled.loaded.forces @ balance.factors + following + locked + sprung
    reaction = internal - loads - contact_force
    return _End(
        problem, balance, state, motion, displacement, pressures, internal, loads, reaction, following, locked, sprung,
        held, cycling, flow(problem.model.deformable, motion.history), supports, damping,
    )  # fmt: skip


def _energy(
    end: _End, attempt: Attempt, acted: Acted, contacts: Sequence[ContactResult], steps: Sequence[Step]
) -> tuple[Acted, Energy | None]:
    """What acts at the end of a step, and the energy over it; None where it did not converge, and at small displacements
    where nothing takes any."""
    problem, balance, state, finite = end.problem, end.balance, end.state, end.problem.model.finite
    takes = finite or end.flow is not None or end.damping is not None or any(pair.frictional for pair in balance.pairs)
    if not attempt.converged or not takes:
        return None, None
    outset, factors = (weights(problem.model.histories, time) for time in (0.0, state.time))
    pressed = pressing(balance.pairs, end.pressures, len(end.internal))
    largest = max(float(np.abs(force).max(initial=0.0)) for force in (end.internal, end.loads))
    least = max(attempt.iterations[-1].residual, DEFAULT.newton.balanced)
    loads = end.loads + end.held - (0.0 if end.damping is None else end.damping)
    now = Acting(
        end.displacement, end.internal, loads, end.reaction - end.held, pressed,
        end.internal - end.loads - end.reaction - pressed, balance.energy, state.unknowns,
        problem.constraints.near(state.unknowns, factors).free, (state.largest.force if finite else largest) * least,
        state.history.drag, end.flow.work if end.flow else 0.0, state.time, tractions(balance.pairs, end.pressures),
        end.damping, dissipated(state.history.of(Dashpots.name)),
    )  # fmt: skip
    if acted is None:
        rest = np.zeros_like(state.unknowns)
        given = np.zeros_like(end.internal) if finite else problem.constraints.displacement(rest, outset)
        acted = Acting.none(given, problem.constraints.near(rest, outset).free)
    slips = [state.history.contact(pair.contact.name).slips for pair in balance.pairs]
    return now, energy(problem, balance, acted, now, slips, contacts, _largest_size(steps))


def _landed(state: State) -> tuple[float, float] | None:
    """As in ``Landed``; None without friction at large sliding."""
    if all(contact.landed is None for contact in state.history.contacts.values()):
        return None
    found = landed_in(state)
    return found.unsure, found.limit


def _largest_size(steps: Sequence[Step]) -> float:
    return max((step.energy.size for step in steps if step.energy is not None), default=0.0)


def _joints(end: _End) -> dict[str, Any]:
    """What joins, moves and holds bodies beside contacts and supports, by the names that a step has for it."""
    problem, state, by_supports = end.problem, end.state, end.by_supports
    return {
        "rigid": {body.name: _rigid(end, body, by_supports) for body in problem.constraints.bodies},
        "preloads": _preloads(end),
        "springs": _springs(end),
        "connectors": connector_results(problem, state),
        "penetrations": penetration_results(problem, state, end.displacement),
        "spring": held_force(problem.springs, state),
        "neutral": problem.springs.noise,
    }


def _rigid(end: _End, body: RigidBody, forces: NDArray[np.float64]) -> RigidResult:
    """Motion of a rigid body or coupling, and what moves it."""
    forces = body.held(forces)
    histories = end.problem.model.histories
    if end.problem.model.finite and (body.whole or body.mean):
        moved, turn = body.turned(end.nodal)
        own = end.problem.constraints.turn_of(body.nodes)
        if own is not None:  # which knows of whole turns
            vector = own.vector(end.state.unknowns, weights(histories, end.state.time))
            turn = vector if len(turn) == 3 else vector[2:]
        return RigidResult(moved, turn, *body.resultant(forces, end.nodal))
    given = body.prescribed(histories)[1] @ weights(histories, end.state.time)
    return RigidResult(*body.motion(end.nodal, given), *body.resultant(forces))


def _springs(end: _End) -> dict[str, NDArray[np.float64]]:
    """Resultant of each spring on what it is on."""
    model = end.problem.model
    nodal: dict[str, NDArray[np.float64]] = {}
    for term in end.problem.terms:
        if isinstance(term, Springs):
            nodal |= term.force_on(end.displacement)
        elif isinstance(term, Dashpots):
            nodal |= term.force_on(end.displacement, end.state.history.of(term.name))
    return {spring.name: nodal[spring.name][model.mesh.nodes_of(spring.on)].sum(axis=0) for spring in model.springs}


def _preloads(end: _End) -> dict[str, PreloadResult]:
    model = end.problem.model
    if not model.preloads:
        return {}
    drawn = preload_forces(model) @ end.balance.factors + end.locked
    return preload_results(model, end.state, end.displacement, drawn, end.linked)


def _contacts(
    end: _End, attempt: Attempt, before: Sequence[Step], stress: NDArray[np.float64], shown: Mended | None
) -> tuple[ContactResult, ...]:
    """Of all pairs; stress: (n_points, 6) nodal averages."""
    balance, model, constraints = end.balance, end.problem.model, end.problem.constraints
    references = _largest_pressures(len(balance.pairs), before)
    largest = [pair.space.transfer @ p[pair.normal] for pair, p in zip(balance.pairs, end.pressures) if not pair.tied]
    beside = max([float(np.abs(p).max(initial=0.0)) for p in largest] + references + [0.0])
    around, loaded = [], loaded_points(model)
    others = covered_elsewhere(balance.pairs, end.pressures)
    pressed = pressing(end.balance.pairs, end.pressures, len(end.internal))
    forces = Forces(end.internal, np.abs(end.loads) + np.abs(pressed))
    for pair, pressed, reference, elsewhere, support in zip(
        balance.pairs, end.pressures, references, others, end.supports
    ):
        constant, varying = offsets(model, pair.contact)
        moved = end.nodal if support is None else np.zeros_like(end.nodal)
        overlap = overlaps(pair, moved, constant + float(varying @ balance.factors))
        free, cells = free_axes(model, constraints, pair), None
        if not pair.tied:
            cells = normal_stress(model.mesh, pair.contactor, stress, loaded)
        gives = _gives(model, constraints, pair)
        along = None if model.finite or pair.tied else slid(pair, end.nodal, held=gives == 0.0)
        sides = model.measured(pair.contact) if pair.contact in model.contacts and not pair.tied else None
        beside_it = Surroundings(reference, beside, overlap, free, elsewhere, support, cells, gives=gives, slid=along)
        note = left_out(model, pair.contact) if pair.contact in model.contacts else ""
        beside_it = replace(beside_it, bends=bends(model, pair, pressed, end.nodal, end.internal), at_sides=note)
        around.append(replace(beside_it, sides=sides, edge=sharp_edge(model.mesh, pair, pressed, end.nodal, forces)))
    residual = attempt.iterations[-1].contact_residual
    found = zip(
        balance.pairs, end.pressures, balance.split(balance.gap), balance.split(end.state.status),
        [end.state.history.contact(pair.contact.name).slips for pair in balance.pairs],
    )  # fmt: skip
    earlier = before[-1].contacts if before else [None] * len(balance.pairs)
    states = (PairState.of(*state, balance.factors, _now(end, state[0])) for state in found)
    pressures = shown.pressure if shown else (None,) * len(balance.pairs)
    return tuple(
        contact_result(model.mesh, state.showing(model.mesh, pressure), residual, beside_it, one_before)
        for state, pressure, beside_it, one_before in zip(states, pressures, around, earlier)
    )


def _gives(model: Model, constraints: Constraints, pair: Pair) -> float:
    """The target's share of what both sides of a pair give way under pressure, 0 where all of it is held."""
    rows = dofs_at(pair.target.node_ids, model.dim).ravel()
    held = not (constraints.free.indptr[rows + 1] > constraints.free.indptr[rows]).any()
    return 0.0 if held else scales(model, pair.contactor, pair.target).share


def _now(end: _End, pair: Pair) -> Surface:
    """The contactor where it is: what turns takes the tractions of a tie with it."""
    model = end.problem.model
    return replace(pair.contactor, points=model.mesh.points + end.nodal) if model.finite else pair.contactor


def _cycling(balance: Balance, changing: NDArray[np.bool_]) -> dict[str, NDArray[np.int64]]:
    """The facets of each contact whose multipliers keep changing."""
    cycling = {}
    for pair, of_pair in zip(balance.pairs, balance.split(changing)):
        if of_pair.any():
            rows = np.unique(pair.transfer.tocsc()[:, of_pair].tocoo().row // MAX_FACET_NODES)
            cycling[pair.contact.name] = rows.astype(np.int64)
    return cycling


def _flips(balance: Balance, attempt: Attempt) -> dict[str, Flips]:
    """The nodes of each contact with friction whose status keeps changing, and between what."""
    if attempt.between is None:
        return {}
    flips = {}
    for pair, between, changing in zip(balance.pairs, balance.split(attempt.between), balance.split(attempt.cycling)):
        here = changing[pair.normal] & (pair.space.node >= 0) if pair.frictional else changing[:0]
        if here.any():
            bits = between[pair.normal][here, None] >> np.arange(3) & 1
            flips[pair.contact.name] = Flips(pair.space.node[here].astype(np.int64), bits.astype(bool))
    return flips


def _rounding(balance: Balance, free: NDArray[np.float64]) -> float:
    """Force that free displacements (n_free,) in double precision leave open: eps sum K_ii |u_i|."""
    return float(np.finfo(float).eps * (balance.diagonal @ np.abs(free)))


def _largest_pressures(n_pairs: int, steps: Sequence[Step]) -> list[float]:
    """Of each pair, over some steps."""
    return [max((abs(step.contacts[i].max_pressure) for step in steps), default=0.0) for i in range(n_pairs)]

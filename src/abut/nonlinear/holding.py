"""Bodies that contact alone holds, in Newton's method at large displacements: an iteration that lets go of one throws it
away."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import scipy.sparse as sp
from numpy.typing import NDArray

from abut.problem.balance import Balance
from abut.problem.linearised import Linearised
from abut.problem.pair import Pair
from abut.problem.problem import ContactProblem
from abut.problem.restraint import resistance_of_supports
from abut.problem.rigid_modes import RigidModes, free_motions, resistance_of_rows, rigid_modes
from abut.solution.state import CLOSED, State

FLIGHT = 10.0  # sizes of the model by which nothing moves in a step
ROUNDS = 3  # a nearly singular system may carry a body so far that rounding of it is more than a facet
FAR = 1.0  # facet sizes by which the sides of a contact may come apart within a step
NEAR = 0.1  # facet sizes by which an iteration may move bodies along motions that nothing resists
WEAK = 1e-3  # resistance to a rigid motion over the strongest below which contact hardly holds a body
SLIGHT = 1e-12  # resistance over the largest entry of the stiffness: beyond rounding, below what pressures resist


def sticking(problem: ContactProblem, system: Linearised, state: State, thrown: State) -> State:
    """The state for an iteration that would end at ``thrown``: where that throws a body which slips all over, all of it
    sticks, which tells the tractions that it takes; else as it is."""
    if system.restraint.by_supports or not _all_slips(system, state):
        return state
    rigid, supports = _now(problem, _at(system), system.factors)
    loose = _free(system, rigid, supports, state)
    parts = zip(system.pairs, system.split(state.status), system.split(state.slipping))
    status = [
        np.where(slips & _rubs(pair, system), CLOSED, own) if pair.frictional else own for pair, own, slips in parts
    ]
    stuck = state.with_status(np.concatenate(status).astype(np.int8))
    held = _free(system, rigid, supports, stuck)
    if held.shape[1] >= loose.shape[1]:
        return state
    way = problem.displacement(thrown) - problem.displacement(state)
    return stuck if _reach(rigid, loose - held @ (held.T @ loose), way) > NEAR * _facet(problem) else state


def resisting(problem: ContactProblem, system: Linearised, state: State) -> Linearised:
    """The system, with a slight resistance to all displacements where supports, ties, closed gaps and what sticks leave a
    body free to move: what is unbalanced moves it by ``NEAR`` of a facet. Without pressures nothing else resists."""
    if system.restraint.by_supports:
        return system
    rigid, supports = _now(problem, _at(system), system.factors)
    free = _free(system, rigid, supports, state)
    if not free.shape[1]:
        return system
    assert system.about is not None
    motions = problem.constraints.near(system.about.at, system.factors).free.T @ (rigid.modes @ free)
    forces = np.abs(motions.T @ system.unbalanced(state)) / (motions**2).sum(axis=0)
    least = SLIGHT * float(np.abs(system.stiffness.diagonal()).max())
    resistance = max(float(forces.max()) / (NEAR * _facet(problem)), least)
    more = resistance * sp.identity(system.stiffness.shape[0], format="csr")
    return replace(system, stiffness=(system.stiffness + more).tocsr())


def loosely_held(problem: ContactProblem, balance: Balance, state: State) -> bool:
    """Whether supports, ties, closed gaps and what sticks hardly resist some rigid motion: a ball on one node may spin."""
    if problem.restraint.by_supports:
        return False
    rigid, supports = _now(problem, state.unknowns, balance.factors)
    return bool(free_motions([supports, *_closed(balance, rigid, state)], WEAK).shape[1])


def not_adrift(problem: ContactProblem, system: Linearised, state: State, there: State) -> State:
    """The end of an iteration, without what carries a body far along motions that nothing resists while it touches nothing:
    its linear system knows nothing of them."""
    way = problem.displacement(there) - problem.displacement(state)
    if system.restraint.by_supports or np.abs(way).max() <= NEAR * _facet(problem):
        return there
    rigid, supports = _now(problem, _at(system), system.factors)
    rows = sum(_closed(system, rigid, state), np.zeros_like(supports))
    touched = np.repeat(rows.diagonal().reshape(-1, rigid.per_group).any(axis=1), rigid.per_group)
    axes = free_motions([supports, rows, np.diag(touched.astype(float))])
    assert system.about is not None
    near = problem.constraints.near(system.about.at, system.factors)
    for _ in range(ROUNDS):
        drift = _along(rigid, axes, problem.displacement(there) - problem.displacement(state))
        if np.abs(drift).max() <= NEAR * _facet(problem):
            break
        there = replace(there, unknowns=there.unknowns - near.coordinates(drift))
    return there


def _along(rigid: RigidModes, axes: NDArray[np.float64], way: NDArray[np.float64]) -> NDArray[np.float64]:
    """The share (dim n_points,) of displacements in some rigid motions, orthonormal axes (n_modes, k)."""
    share = np.linalg.lstsq(rigid.modes, way, rcond=None)[0]
    return np.asarray(rigid.modes @ (axes @ (axes.T @ share)))


def _reach(rigid: RigidModes, motions: NDArray[np.float64], way: NDArray[np.float64]) -> float:
    """How far displacements (dim n_points,) take a point along some of the rigid motions, (n_modes, k)."""
    axes, size, _ = np.linalg.svd(motions, full_matrices=False)
    return float(np.abs(_along(rigid, axes[:, size > 1e-6], way)).max(initial=0.0))


def _facet(problem: ContactProblem) -> float:
    return max(pair.size for pair in problem.pairs)


def _rubs(pair: Pair, system: Linearised) -> NDArray[np.bool_]:
    """(n,) multipliers with friction."""
    return pair.of_functions(np.broadcast_to(~np.asarray(pair.friction(system.factors).none), len(pair.space)))


def _all_slips(system: Linearised, state: State) -> bool:
    """Whether there is a contact in which nothing sticks."""
    parts = zip(system.pairs, system.split(state.slipping), system.split(state.closed))
    return any(pair.frictional and slips.any() and not (closed & ~slips).any() for pair, slips, closed in parts)


def _now(
    problem: ContactProblem, at: NDArray[np.float64], factors: NDArray[np.float64]
) -> tuple[RigidModes, NDArray[np.float64]]:
    """Rigid motions of the bodies at free displacements ``at``, and how supports resist them."""
    mesh = problem.model.mesh
    moved = problem.constraints.displacement(at, factors).reshape(mesh.points.shape)
    rigid = rigid_modes(replace(mesh, points=mesh.points + moved))
    return rigid, resistance_of_supports(rigid, problem.constraints.near(at, factors))


def _at(system: Linearised) -> NDArray[np.float64]:
    """The free displacements that a system is about."""
    assert system.about is not None
    return system.about.at


def _free(system: Linearised, rigid: RigidModes, supports: NDArray[np.float64], state: State) -> NDArray[np.float64]:
    """Motions (n_modes, k) that neither supports, ties, closed gaps nor what sticks resists."""
    return free_motions([supports, *_closed(system, rigid, state)])


def _closed(system: Linearised | Balance, rigid: RigidModes, state: State) -> list[NDArray[np.float64]]:
    """Resistance of ties, closed gaps and what sticks, by pair."""
    grams = []
    for pair, closed, slips in zip(system.pairs, system.split(state.closed), system.split(state.slipping)):
        resists = closed & ~slips
        resists[pair.normal] = closed[pair.normal]
        grams.append(resistance_of_rows(rigid, pair.rows[np.ones(len(pair), bool) if pair.tied else resists]))
    return grams


def flies_off(problem: ContactProblem, before: State, now: State) -> str:
    """Why the state ``now`` has lost a body, which is far beyond where the last converged one ``before`` had it; empty where
    it has not."""
    mesh = problem.model.mesh
    way = np.abs(problem.displacement(now) - problem.displacement(before)).reshape(mesh.points.shape).max(axis=1)
    if way.max(initial=0.0) <= FLIGHT * np.ptp(mesh.points, axis=0).max():
        return ""
    body = max(mesh.bodies, key=lambda name: float(way[mesh.nodes_of(name)].max(initial=0.0)))
    return f"body '{body}' flies off: hold it by a support, by friction, or in steps that its contact follows"


def lifted(system: Linearised, before: State) -> str:
    """Which body the loads of a step carry off all that it touches at the converged state ``before``, and what to do; empty
    where none. It is at rest next only where it meets something again, which may be far."""
    motion = system.restraint.lifted(system.forces, before.closed)
    if not motion:
        return ""
    return f"the loads carry it off what it touches: {motion}; hold it by a support, or move it to where it rests"


def overcome(system: Linearised) -> str:
    """Which body the loads of ``system`` move although contact pushes and rubs all that it can, where the mesh has it; empty
    where none."""
    motion = system.restraint.at(system.factors).unbalanced(system.forces)
    if not motion:
        return ""
    return f"the loads at time {system.time:.4g} are more than contact bears where the mesh has it: {motion}"


def thrown_apart(system: Linearised, before: State, now: State) -> str:
    """Why the state ``now`` does not follow from the converged state ``before``; empty where it may.

    Without friction or pressure a body that supports leave free is in equilibrium anywhere: Newton's method ends there when
    an iteration has thrown it out of its contact."""
    if system.restraint.by_supports:
        return ""
    parts = zip(system.pairs, system.split(before.closed), system.split(now.closed), system.split(system.gap(now)))
    for pair, was, closed, gap in parts:
        if pair.two_way or not was[pair.normal].any() or closed[pair.normal].any():
            continue
        if _clearance(pair, gap) > FAR:
            return f"contact '{pair.contact.name}' comes apart at once, and it is what holds a body"
    return ""


def _clearance(pair: Pair, gap: NDArray[np.float64]) -> float:
    """The least gap over the facet size; infinite where nothing is opposite."""
    weight = pair.space.weight
    opposite = weight > 0.0
    return float((gap[pair.normal][opposite] / weight[opposite]).min(initial=np.inf) / pair.size)

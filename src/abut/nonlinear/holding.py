"""Bodies that contact alone holds, in Newton's method at large displacements: an iteration that lets go of one throws it
away."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import scipy.sparse as sp
from numpy.typing import NDArray

from abut.problem.contact_pairs import Pair
from abut.problem.linearised import Linearised
from abut.problem.problem import ContactProblem
from abut.problem.rigid_modes import RigidModes, free_motions, resistance_of_rows, resistance_of_supports, rigid_modes
from abut.solution.state import CLOSED, State

EASY = 0.1  # facet sizes by which forces move a body that nothing resists, in an iteration
SLIGHT = (
    1e-12  # resistance over the largest entry of the stiffness: more than rounding, less than what pressures resist
)
FAR = 1.0  # facet sizes by which the sides of a contact may come apart within a step, and bodies move in an iteration


def sticking(problem: ContactProblem, system: Linearised, before: State, state: State, thrown: State) -> State:
    """The state for an iteration that would end at ``thrown``: where that throws a body which slips all over, all of it
    sticks, which tells the tractions that it takes; else as it is. before: the last converged state."""
    if system.restraint.by_supports or not _all_slips(system, state) or not _far(problem, before, state, thrown):
        return state
    rigid, supports = _now(problem, system)
    if not _free(system, rigid, supports, state):
        return state
    parts = zip(system.pairs, system.split(state.status), system.split(state.slipping))
    status = [
        np.where(slips & _rubs(pair, system), CLOSED, own) if pair.frictional else own for pair, own, slips in parts
    ]
    stuck = state.with_status(np.concatenate(status).astype(np.int8))
    return stuck if _free(system, rigid, supports, stuck) < _free(system, rigid, supports, state) else state


def resisting(problem: ContactProblem, system: Linearised, state: State) -> Linearised:
    """The system, with a slight resistance to all displacements where supports, ties, closed gaps and what sticks leave a
    body free to move: what is unbalanced moves it by ``EASY`` of a facet. Without pressures nothing else resists."""
    if system.restraint.by_supports:
        return system
    rigid, supports = _now(problem, system)
    assert system.about is not None
    free = _free_motions(system, rigid, supports, state)
    if not free.shape[1]:
        return system
    motions = problem.constraints.near(system.about.at, system.factors).free.T @ (rigid.modes @ free)
    inertia = (motions**2).sum(axis=0)
    force = np.abs(motions.T @ system.unbalanced(state))
    size = max(pair.size for pair in system.pairs)
    needed = float((force / inertia).max()) / (EASY * size)
    resistance = max(needed, SLIGHT * float(np.abs(system.stiffness.diagonal()).max()))
    more = resistance * sp.identity(system.stiffness.shape[0], format="csr")
    return replace(system, stiffness=(system.stiffness + more).tocsr())


def _far(problem: ContactProblem, before: State, state: State, thrown: State) -> bool:
    """Whether an iteration moves points by more than a facet, and twice as far as any have moved in the step."""
    start, here, there = (problem.displacement(each) for each in (before, state, thrown))
    size = max(pair.size for pair in problem.pairs)
    return bool(np.abs(there - here).max() > FAR * size + 2.0 * np.abs(here - start).max())


def _rubs(pair: Pair, system: Linearised) -> NDArray[np.bool_]:
    """(n,) multipliers with friction."""
    return pair.of_functions(np.broadcast_to(~np.asarray(pair.friction(system.factors).none), len(pair.space)))


def _all_slips(system: Linearised, state: State) -> bool:
    """Whether there is a contact in which nothing sticks."""
    parts = zip(system.pairs, system.split(state.slipping), system.split(state.closed))
    return any(pair.frictional and slips.any() and not (closed & ~slips).any() for pair, slips, closed in parts)


def _now(problem: ContactProblem, system: Linearised) -> tuple[RigidModes, NDArray[np.float64]]:
    """Rigid motions of the bodies where they are now, and how supports resist them."""
    assert system.about is not None
    mesh, at = problem.model.mesh, system.about.at
    moved = problem.constraints.displacement(at, system.factors).reshape(mesh.points.shape)
    rigid = rigid_modes(replace(mesh, points=mesh.points + moved))
    return rigid, resistance_of_supports(rigid, problem.constraints.near(at, system.factors))


def _free(system: Linearised, rigid: RigidModes, supports: NDArray[np.float64], state: State) -> int:
    """How many motions neither supports, ties, closed gaps nor what sticks resists."""
    return int(_free_motions(system, rigid, supports, state).shape[1])


def _free_motions(
    system: Linearised, rigid: RigidModes, supports: NDArray[np.float64], state: State
) -> NDArray[np.float64]:
    """(n_modes, k) motions that neither supports, ties, closed gaps nor what sticks resists."""
    grams = [supports]
    for pair, closed, slips in zip(system.pairs, system.split(state.closed), system.split(state.slipping)):
        resists = closed & ~slips
        resists[pair.normal] = closed[pair.normal]
        grams.append(resistance_of_rows(rigid, pair.rows[np.ones(len(pair), bool) if pair.tied else resists]))
    return free_motions(grams)


def thrown_apart(system: Linearised, before: State, now: State) -> str:
    """Why the state ``now`` does not follow from the converged state ``before``; empty where it may.

    Without friction or pressure a body that supports leave free is in equilibrium anywhere: Newton's method ends there when
    an iteration has thrown it out of its contact."""
    if system.restraint.by_supports:
        return ""
    parts = zip(system.pairs, system.split(before.closed), system.split(now.closed), system.split(system.gap(now)))
    for pair, was, closed, gap in parts:
        if pair.tied or not was[pair.normal].any() or closed[pair.normal].any():
            continue
        if _clearance(pair, gap) > FAR:
            return f"contact '{pair.contact.name}' comes apart at once, and it is what holds a body"
    return ""


def _clearance(pair: Pair, gap: NDArray[np.float64]) -> float:
    """The least gap over the facet size; infinite where nothing is opposite."""
    weight = pair.space.weight
    opposite = weight > 0.0
    return float((gap[pair.normal][opposite] / weight[opposite]).min(initial=np.inf) / pair.size)

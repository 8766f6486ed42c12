"""Bodies that contact alone holds, in Newton's method at large displacements: an iteration that lets go of one throws it
away."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import scipy.sparse as sp
from numpy.typing import NDArray

from abut.bodies.rigid_modes import RigidModes, free_motions, resistance_of_rows, rigid_modes
from abut.nonlinear.settings import Settings
from abut.problem.linearised import Linearised
from abut.problem.pair import Pair
from abut.problem.problem import ContactProblem
from abut.problem.restraint import resistance_of_supports
from abut.solution.state import CLOSED, State


def sticking(problem: ContactProblem, system: Linearised, state: State, thrown: State, near: float) -> State:
    """The state for an iteration that would end at ``thrown``: where that throws a body which slips all over, all of it
    sticks, which tells the tractions that it takes; else as it is.
    near: facets by which an iteration may move bodies along motions that nothing resists. Without it
    ``test_a_wheel_rolls`` fails."""
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
    return stuck if _reach(rigid, loose - held @ (held.T @ loose), way) > near * _facet(problem) else state


def resisting(problem: ContactProblem, system: Linearised, state: State, settings: Settings) -> Linearised:
    """The system, with a slight resistance to all displacements where supports, ties, closed gaps and what sticks leave a
    body free to move: what is unbalanced moves it by ``near`` of a facet. Without pressures nothing else resists.
    Without it ``test_pin_that_falls`` fails, after 935 iterations instead of 25."""
    if system.restraint.by_supports:
        return system
    rigid, supports = _now(problem, _at(system), system.factors)
    free = _free(system, rigid, supports, state)
    if not free.shape[1]:
        return system
    assert system.about is not None
    motions = problem.constraints.near(system.about.at, system.factors).free.T @ (rigid.modes @ free)
    forces = np.abs(motions.T @ system.unbalanced(state)) / (motions**2).sum(axis=0)
    least = settings.newton.rounding * float(np.abs(system.stiffness.diagonal()).max())
    resistance = max(float(forces.max()) / (settings.holding.near * _facet(problem)), least)
    more = resistance * sp.identity(system.stiffness.shape[0], format="csr")
    return replace(system, stiffness=system.stiffness + more)


def not_adrift(problem: ContactProblem, system: Linearised, state: State, there: State, near: float) -> State:
    """The end of an iteration, without what carries a body far along motions that nothing resists while it touches nothing:
    its linear system knows nothing of them. A nearly singular system may carry a body so far that rounding of it is more
    than a facet: three rounds. Without it ``test_sound_models`` (flows, is unloaded and loaded) fails.

    One that touches along a flat place slides freely, too, whatever its own normals: what takes it farther than all of the
    mesh is large is rounding (``test_rounding_throws_no_ring_out``)."""
    way = problem.displacement(there) - problem.displacement(state)
    if system.restraint.by_supports or np.abs(way).max() <= near * _facet(problem):
        return there
    rigid, supports = _now(problem, _at(system), system.factors)
    rows = sum(_closed(system, rigid, state), np.zeros_like(supports))
    touched = np.repeat(rows.diagonal().reshape(-1, rigid.per_group).any(axis=1), rigid.per_group)
    aloft = free_motions([supports, rows, np.diag(touched.astype(float))])
    everything = float(np.ptp(problem.model.mesh.points, axis=0).max())
    for axes, most in ((aloft, near * _facet(problem)), (free_motions([supports]), everything)):
        there = _without_drift(problem, system, state, there, rigid, axes, most)
    return there


def _without_drift(
    problem: ContactProblem, system: Linearised, state: State, there: State, rigid: RigidModes, axes: NDArray[np.float64],
    most: float,
) -> State:  # fmt: skip
    """``there``, from ``state`` on, without its share in rigid motions, orthonormal axes (n_modes, k), if that takes a point
    farther than ``most``."""
    assert system.about is not None
    free = problem.constraints.near(system.about.at, system.factors)
    for _ in range(3):
        drift = _along(rigid, axes, problem.displacement(there) - problem.displacement(state))
        if np.abs(drift).max() <= most:
            break
        there = replace(there, unknowns=there.unknowns - free.coordinates(drift))
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


def _closed(system: Linearised, rigid: RigidModes, state: State) -> list[NDArray[np.float64]]:
    """Resistance of ties, closed gaps and what sticks, by pair."""
    grams = []
    for pair, closed, slips in zip(system.pairs, system.split(state.closed), system.split(state.slipping)):
        resists = closed & ~slips
        resists[pair.normal] = closed[pair.normal]
        grams.append(
            resistance_of_rows(rigid, pair.rows[np.ones(len(pair), bool) if pair.tied and pair.two_way else resists])
        )
    return grams


def lifted(system: Linearised, before: State) -> str:
    """Which body the loads of a step carry off all that it touches at the converged state ``before``, and what to do; empty
    where none. It is at rest next only where it meets something again, which may be far."""
    motion = system.restraint.lifted(system.forces, before.closed)
    if not motion:
        return ""
    return f"the loads carry it off what it touches: {motion}; hold it by a support, or move it to where it rests"


def overcome(system: Linearised, time: float) -> str:
    """Which body the loads of ``system``, at a ``time`` of the run, move although contact pushes and rubs all that it can,
    where the mesh has it; empty where none."""
    motion = system.restraint.at(system.factors).unbalanced(system.forces)
    if not motion:
        return ""
    return f"the loads at time {time:.4g} are more than contact bears where the mesh has it: {motion}"

"""Records of converged steps for a restart, and their attempts from these."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from abut.errors import InputError
from abut.model.conditions import weights
from abut.nonlinear.attempt import Attempt
from abut.problem.balance import Balance
from abut.problem.holds import Holds
from abut.problem.linearised import NOTHING, Linearised
from abut.problem.preloads import LockedPreloads
from abut.problem.problem import ContactProblem
from abut.problem.released import Released
from abut.solution import Saved, SavedPart
from abut.solution.state import State

TAKEN = 1e-6  # of forces and pressures: what steps of another job may be off balance; solved ones are at 1e-9 and below


def saved_step(parts: Sequence[Attempt], linear: str, problem: ContactProblem) -> Saved:
    """Of the parts that a step of a problem was taken in. linear: the solver that was used, "direct" or "amg"."""
    last, iterations = parts[-1], tuple(row for part in parts for row in part.iterations)
    histories, constraints = problem.model.histories, problem.constraints
    moved = [constraints.linear(part.state.unknowns, weights(histories, part.state.time)) for part in parts]
    earlier = tuple(
        SavedPart(part.state, part.inside, len(part.iterations), here) for part, here in zip(parts[:-1], moved)
    )
    return Saved(last.number, last.state, last.inside, linear, iterations, earlier, displacement=moved[-1])


def check_order(resume: Sequence[Saved], n_free: int, n_multipliers: int) -> None:
    """Raise InputError unless the records are those of steps 1, 2, ... of a model of this size."""
    for number, saved in enumerate(resume, start=1):
        sizes = len(saved.state.unknowns), len(saved.state.multipliers)
        if saved.taken and sizes[1] != n_multipliers:
            raise InputError(
                f"start: this job has {n_multipliers} multipliers on its contacts, step {saved.number} of the job before "
                f"{sizes[1]}: supports hold other nodes of contactors than they did; give supports on contactors as there"
            )
        if saved.number != number or sizes != (n_free, n_multipliers):
            raise InputError(
                f"resume: expected step {number} with {n_free} displacements and {n_multipliers} multipliers, got step "
                f"{saved.number} with {sizes[0]} and {sizes[1]}; give all steps done before, of the same model, in order"
            )


def restored(saved: Saved, before: State, problem: ContactProblem) -> list[Attempt]:
    """The parts of a load step as they were when they converged; before: the converged state that it began with."""
    none = np.zeros(len(saved.state.status), dtype=bool)
    left = sum(part.iterations for part in saved.parts)
    parts = [*saved.parts, SavedPart(saved.state, saved.inside, len(saved.iterations) - left)]
    ends = np.cumsum([part.iterations for part in parts])
    rows = [saved.iterations[end - part.iterations : end] for part, end in zip(parts, ends)]
    attempts = []
    for part, row in zip(parts, rows):
        own = problem.with_ordinary(part.inside) if part.inside.any() else problem
        system, state = _held(own, before, part.state) if saved.taken else (own.again(before, part.state), part.state)
        if saved.taken:
            require_equilibrium(system, state, saved.number, problem.model.solve.time(state.time))
        balance = Balance.of(system, state)
        attempts.append(Attempt(saved.number, state, True, row, none, part.inside, state.time, balance=balance))
        before = state
    return attempts


def _held(problem: ContactProblem, before: State, state: State) -> tuple[Linearised, State]:
    """The problem near a state that was reached in another job, where preloads may have been locked at other times, and
    contacts have let go, and where supports may have held what are holds here: these have the forces of those, and remember
    them. Raises InputError where points are elsewhere."""
    system, history = problem.again(before, state), state.history
    for term in problem.terms:
        if isinstance(term, LockedPreloads):
            history = history.with_term(term.name, system.shares[term.name].history)
        elif isinstance(term, Released):
            history = term.remembered(history, state, system)
    state = replace(state, history=history)
    holds = next((term for term in problem.terms if isinstance(term, Holds)), None)
    if holds is None:
        return system, state
    given = holds.with_forces(problem.constraints.free @ system.unbalanced(state), state.time)
    terms = [given if term is holds else term for term in problem.terms]
    system = replace(problem, terms=terms).again(before, state)
    displacement, share = problem.displacement(state), system.shares[holds.name]
    off, end = TAKEN * float(np.abs(displacement).max(initial=0.0)), problem.model.solve.end
    holds.require_places(displacement, share, state.time, off, end)
    return system, replace(state, history=state.history.with_term(holds.name, share.history))


def require_equilibrium(system: Linearised, state: State, number: int, time: float) -> None:
    """Raise InputError unless a state taken over, at a ``time`` of the run, is in balance under the loads, supports and
    contacts of the model."""
    forces = np.abs(system.relative(system.unbalanced(state), state.largest.force)).max(initial=0.0)
    overlap, parts = 0.0, (system.gap(state), state.multipliers, state.closed)
    for pair, g, p, closed in zip(system.pairs, *(system.split(values) for values in parts)):
        rows = slice(None) if pair.tied else pair.normal
        if pair.away:  # what does not act here has no pressure
            overlap = max(overlap, float(np.abs(p).max(initial=0.0)) / max(state.largest.pressure, NOTHING))
            continue
        wrong = np.where(closed[rows] | pair.two_way, np.abs(g[rows]), np.maximum(-g[rows], 0.0)) / pair.scale[rows]
        size = max(state.largest.pressure, float(np.abs(p[rows]).max(initial=0.0)))
        overlap = max(overlap, float(wrong.max(initial=0.0)) / size if size > 0.0 else 0.0)
    if max(float(forces), overlap) > TAKEN:
        raise InputError(
            f"start: step {number} of the job before is not in balance at time {time:.6g} of this one (to "
            f"{max(float(forces), overlap):.2g}); loads, supports and contacts must be there what they were then: give "
            "them amplitudes that pass through these values, and let a support go by a hold that acts until this time"
        )

"""solve(model): the whole way from a model to its solution on one page."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import replace
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from abut.analysis.results import step_result
from abut.analysis.step_records import begin_after, check_order, restored, saved_step
from abut.errors import SingularModelError
from abut.linear.choice import Prepared, expected_seconds
from abut.linear.iterative import NotConverged
from abut.model import Model
from abut.model.conditions import weights
from abut.nonlinear.active_set import following, start
from abut.nonlinear.load_step import load_step, with_plain
from abut.probing import find_places, read
from abut.problem.assembly import problem
from abut.problem.clock import Clock
from abut.problem.restraint import require_balance
from abut.problem.rigid_modes import near_null
from abut.problem.system import Outcome, Stage, System
from abut.solution import Observer, OnStep, Phase, Saved, Solution, Step

if TYPE_CHECKING:
    from abut.parallel.team import Team

ABSURD = 1e6  # displacement over model size that no units explain


def _silent(*_: object) -> None:
    return None


def solve(
    model: Model,
    observer: Observer | None = None,
    on_step: OnStep | None = None,
    resume: Sequence[Saved] = (),
    team: Team | None = None,
) -> Solution:
    """Solve a model step by step.

    ``observer`` is called with every iteration (``abut.solution.Iteration``), with stages that begin
    (``abut.solution.Phase``) and with notes as text while it runs; what it raises ends the run. ``on_step`` gets the
    solution so far after each converged step, and what it takes to go on from there; ``resume``: such records of all steps
    done before, in order, of the same model: the run goes on after the last of them. ``team``: processes that share the
    work (``abut.parallel.lead``); ``solve.linear`` "petsc" takes this one alone where there is none.
    A run that does not converge is returned with its last state (``solution.converged`` is False).
    Raises InputError for a model that cannot be used, SingularModelError for one without a unique solution.
    """
    observe: Observer = observer or _silent
    keep: OnStep = on_step or _silent
    notes: list[str] = []

    def note(text: str) -> None:
        notes.append(text)
        observe(text)

    clock = Clock()
    places = find_places(model)
    for text in (text for place in places for text in place.notes):
        note(text)
    if team is None and model.solve.linear == "petsc":
        from abut.parallel.team import start_team

        team = start_team()
    own = problem(model, observe, note, clock, team)
    held, system = own.held, own.system
    steps: list[Step] = []

    def linear_solver(kind: str) -> Prepared:
        what = "factorising" if kind == "direct" else "setting up multigrid for"
        size = f"{own.n_free:,}".replace(",", " ")
        observe(Phase(f"{what} {size} displacements", expected_seconds(kind, own.n_free, model.dim)))
        loose = held.coordinates(own.held_by.free)
        result = own.volume.prepare(kind, system, held, near_null(model.mesh, own.held_by.rigid), loose)
        note(result.note)
        return result

    def result(outcome: Outcome, system: System, stage: Stage, time: float) -> Step:
        displacement = held.free @ outcome.unknowns.displacement + held.prescribed @ stage.weights
        spring = own.idle.force(outcome.unknowns.displacement) if len(own.idle) else None
        displacement = own.idle.without_motions(displacement)
        _check_size(model, displacement, note)
        step = step_result(model, own.volume, own.loaded, displacement, system, outcome, stage, time, steps, held)
        return replace(step, spring=spring, probes=tuple(read(place, step) for place in places))

    def so_far(complete: bool) -> Solution:
        return Solution(model, tuple(steps), own.n_free, solver.name, tuple(notes), dict(clock.timings), complete)

    times = [t for t in model.solve.ends if not resume or t > resume[-1].factor * (1.0 + 1e-12)]
    check_order(resume, own.n_free, system.operator.shape[0])
    kind = own.volume.choose(system, held)
    if resume and model.solve.linear in ("auto", "petsc"):
        kind = resume[-1].linear
    solver = linear_solver(kind)
    state = start(solver.system)
    force = pressure = 0.0
    if resume:
        observe(Phase("restoring the steps done before"))
        for saved in resume:
            stage = Stage(saved.number, weights(model.histories, saved.factor), force, pressure)
            inner = with_plain(model, held, system, saved.inside) if saved.inside.any() else system
            steps.append(result(restored(saved), inner, stage, saved.factor))
            force, pressure = saved.largest_force, saved.largest_pressure
        state = begin_after(resume[-1], state, note)
        clock.mark("results")
    count = len(steps) + len(times)
    for number, time in enumerate(times, start=len(steps) + 1):
        observe(Phase(f"step {number} of {count}", None, number - 1, count))
        stage = Stage(number, weights(model.histories, time), force, pressure)
        when = f" in step {number}" if count > 1 else ""
        require_balance(own.held_by, held, held.free.T @ (own.loaded.forces @ stage.weights), when)
        try:
            reached = load_step(model, held, system, solver, state, stage, observe)
        except NotConverged as reason:
            note(f"step {number}: {reason}: going on with the direct solver")
            kind = "direct"
            solver = linear_solver(kind)
            reached = load_step(model, held, system, solver, start(solver.system), stage, observe)
        outcome = reached.outcome
        state = outcome.unknowns
        after = following(reached.solver.system, stage, outcome, stage.weights)
        force, pressure = after.force, after.pressure
        outcome = reached.solver.finish(outcome, stage.weights)
        clock.mark("solve")
        observe(Phase(f"stresses and checks of step {number}", None, number - 1, count))
        steps.append(result(outcome, reached.system, stage, time))
        clock.mark("results")
        if not outcome.converged:
            note(f"step {number} did not converge in {len(outcome.iterations)} iterations")
            break
        keep(so_far(complete=False), saved_step(outcome, state, after, time, kind, reached.inside))
        clock.mark("writing")
    if solver.count is not None:
        note(f"{solver.count.iterations} linear iterations in all")
    return so_far(complete=True)


def _check_size(model: Model, displacement: NDArray[np.float64], note: Callable[[str], None]) -> None:
    """Displacements beyond the size of the model mean wrong units, or a matrix that is singular in all but name."""
    extent = float(np.ptp(model.mesh.points, axis=0).max())
    largest = float(np.abs(displacement).max(initial=0.0))
    if not largest < ABSURD * extent:
        raise SingularModelError(
            f"displacements of {largest:.2g} in a model of size {extent:.2g} make no sense: check the units of Young's "
            "moduli, loads and mesh, and that supports hold every body"
        )
    if largest > extent:
        note(
            f"displacements of {largest:.2g} exceed the model's size {extent:.2g}: check units (displacements must be small)"
        )

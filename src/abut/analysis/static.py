"""solve(model): the whole way from a model to its solution on one page."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import replace
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from abut.analysis.linear_solvers import assembled_bodies, linear_solver, setting_up, solver_kind
from abut.analysis.results import step_result
from abut.analysis.step_records import check_order, restored, saved_step
from abut.errors import SingularModelError
from abut.linear.solver import LinearSolver, NotConverged
from abut.model import Model
from abut.model.conditions import weights
from abut.nonlinear.load_step import Attempt
from abut.nonlinear.stepping import Automatic, Control, Fixed, Schedule, march
from abut.probing import find_places, read
from abut.problem.assembly import assemble, prescribed
from abut.problem.clock import Clock
from abut.problem.restraint import require_balance
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

    Two stacked blocks with meshes that do not match, pressed together:

    >>> import abut
    >>> from abut.mesh import make
    >>> lower = make.rectangle([0, 2], [0, 1], cells=[4, 2])
    >>> upper = make.rectangle([0, 2], [1, 2], cells=[3, 2])
    >>> steel = abut.LinearElastic(young=210e3, poisson=0.3)
    >>> model = abut.Model(
    ...     make.join({"lower": lower, "upper": upper}),
    ...     plane="strain",
    ...     solids=[abut.Solid("lower", steel), abut.Solid("upper", steel)],
    ...     supports=[abut.Support("lower.bottom", y=0), abut.Support("lower.left", x=0), abut.Support("upper.left", x=0)],
    ...     loads=[abut.Pressure("upper.top", 3.0)],
    ...     contacts=[abut.Contact("upper.bottom", "lower.top")],
    ... )
    >>> solution = abut.solve(model)
    >>> contact = solution.contacts[0]
    >>> print(f"pressure {contact.max_pressure:.6f} over a width of {contact.area:.6f}, force {contact.force[1]:.6f}")
    pressure 3.000000 over a width of 2.000000, force 6.000000
    >>> all(check.passed for check in solution.certificate)
    True
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
    held, loaded = prescribed(model)
    clock.mark("set-up")
    backend = assembled_bodies(model, observe, note, clock, team)
    assembled = assemble(model, held, loaded, backend, observe, note, clock)
    problem = assembled.problem
    check_order(resume, problem.n_free, int(problem.operator.shape[0]))
    kind = solver_kind(problem, team)
    if resume and model.solve.linear in ("auto", "petsc"):
        kind = resume[-1].linear
    solver = linear_solver(kind, problem, team)
    steps: list[Step] = []

    def result(attempt: Attempt) -> Step:
        step = step_result(assembled, attempt, steps)
        _check_size(model, step.displacement, note)
        return replace(step, probes=tuple(read(place, step) for place in places))

    def so_far(complete: bool) -> Solution:
        return Solution(model, tuple(steps), problem.n_free, solver.name, tuple(notes), dict(clock.timings), complete)

    state = problem.start()
    if resume:
        observe(Phase("restoring the steps done before"))
        for saved in resume:
            steps.append(result(restored(saved)))
        state = resume[-1].state
        clock.mark("results")
    times = [t for t in model.solve.ends if not resume or t > state.time * (1.0 + 1e-12)]
    count = len(steps) + len(times)

    def begins(number: int, time: float) -> None:
        of_all = max(count, number)
        observe(Phase(f"step {number} of {of_all}", None, number - 1, of_all))
        loads = held.free.T @ (loaded.forces @ weights(model.histories, time))
        require_balance(problem.restraint, loads, f" in step {number}" if count > 1 else "")

    def prepares(what: LinearSolver) -> None:
        observe(Phase(*setting_up(what, problem)))

    def fallback(number: int, reason: NotConverged) -> LinearSolver:
        nonlocal solver, kind
        note(f"step {number}: {reason}: going on with the direct solver")
        solver, kind = linear_solver("direct", problem, team), "direct"
        return solver

    def halves(attempt: Attempt, time: float) -> None:
        note(
            f"step {attempt.number} did not converge in {len(attempt.iterations)} iterations: it goes to time {time:.6g} "
            f"first, not to {attempt.state.time:.6g}"
        )

    friction = any(pair.frictional for pair in problem.pairs)
    schedule: Schedule = Automatic(times, state.time) if friction else Fixed(times)
    control = Control(model.solve.max_iterations, observe, begins, prepares, note, fallback, halves)
    for attempt in march(problem, state, schedule, solver, control, len(steps) + 1):
        clock.mark("solve")
        observe(Phase(f"stresses and checks of step {attempt.number}", None, attempt.number - 1, count))
        steps.append(result(attempt))
        clock.mark("results")
        if attempt.converged:
            keep(so_far(complete=False), saved_step(attempt, kind))
            clock.mark("writing")
        else:
            note(f"step {attempt.number} did not converge in {len(attempt.iterations)} iterations")
    if solver.count is not None:
        note(f"{solver.count.iterations} linear iterations in all")
    return so_far(complete=True)


def _check_size(model: Model, displacement: NDArray[np.float64], note: Callable[[str], None]) -> None:
    """Displacements beyond the size of the model mean wrong units, or a matrix that is singular in all but name."""
    extent = float(np.ptp(model.mesh.points, axis=0).max())
    largest = float(np.abs(displacement).max(initial=0.0))
    if not largest < ABSURD * extent:
        raise SingularModelError(
            f"displacements of {largest:.2g} exceed {ABSURD:g} times the model size {extent:.2g}: check the "
            "units of Young's moduli, loads and mesh, and that supports constrain every body"
        )
    if largest > extent:
        note(
            f"displacements of {largest:.2g} exceed the model size {extent:.2g}: check units (displacements must be small)"
        )

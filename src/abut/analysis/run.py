"""A run: a model set up, marched through its load steps, and what is told on the way."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, field, replace
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from abut.analysis.deadline import Deadline
from abut.analysis.interpolation_error import Mended, is_mended, mended
from abut.analysis.limit_load import limit_load, near_limit, yields
from abut.analysis.linear_solvers import assembled_bodies, linear_solver, setting_up, solver_kind
from abut.analysis.modes import check_modes, eigensolver, massless, modes
from abut.analysis.parts import whole
from abut.analysis.results import Acted, step_result
from abut.analysis.step_records import check_order, restored, saved_step
from abut.errors import ConvergenceError, SingularModelError, Unsound
from abut.linear.solver import LinearSolver, NotConverged
from abut.model import Model
from abut.model.conditions import weights
from abut.model.offset import offsets
from abut.model.side_choice import choices
from abut.model.step_ends import SAME
from abut.nonlinear.again import Again
from abut.nonlinear.attempt import Attempt
from abut.nonlinear.large_steps import LargeSteps
from abut.nonlinear.march import Control, Stepper, march
from abut.nonlinear.one_step import stride
from abut.nonlinear.pace import Pace, Slips, given_pace, pace_of
from abut.nonlinear.settings import DEFAULT, Settings
from abut.nonlinear.stepping import SmallSteps, prepared
from abut.probing import Place, find_places, read
from abut.problem.assembly import Assembled, assemble, prescribed
from abut.problem.clock import Clock
from abut.problem.onset import Most, Onset, onset
from abut.problem.restraint import require_balance
from abut.problem.stabilising import is_dragged
from abut.problem.step_error import landed_in
from abut.solution import Iteration, ModesResult, Observer, OnStep, Phase, ResponseResult, Saved, Solution, Step
from abut.solution.flow import GO_ON
from abut.solution.run_checks import JUMPED
from abut.solution.state import State

if TYPE_CHECKING:
    from abut.parallel.team import Team


@dataclass
class Told:
    """What a run says: to whom, and the notes so far."""

    observe: Observer
    notes: list[str] = field(default_factory=list)

    def note(self, text: str) -> None:
        self.notes.append(text)
        self.observe(text)


@dataclass
class Run:
    """A model ready to be solved; ``steps`` grows, and the linear solver may be replaced. kind: "direct" or "amg"."""

    model: Model
    told: Told
    deadline: Deadline
    keep: OnStep
    team: Team | None
    clock: Clock
    places: Sequence[Place]
    assembled: Assembled
    kind: str
    solver: LinearSolver
    settings: Settings = DEFAULT
    steps: list[Step] = field(default_factory=list)
    acted: Acted = None  # what acted at the end of the last step, with friction or finite kinematics
    parts: list[tuple[Attempt, Step]] = field(default_factory=list)  # of the step that is being solved
    ended: tuple[State, Attempt] | None = None  # the last one that converged, and where it began
    looked: dict[float, tuple[State, Attempt]] = field(default_factory=dict)  # the same, where modes are asked for
    modes: tuple[ModesResult, ...] = ()
    responses: tuple[ResponseResult, ...] = ()
    again: Callable[[], Again] | None = None  # what solves steps again, once there is something that solves them

    @classmethod
    def of(
        cls, model: Model, observe: Observer, keep: OnStep, team: Team | None, resume: Sequence[Saved],
        settings: Settings = DEFAULT,
    ) -> Run:  # fmt: skip
        """Set a run up. Raises InputError and SingularModelError for a model that cannot be solved."""
        told, clock, deadline = Told(observe), Clock(), Deadline(model.solve.seconds)
        check_modes(model, team is not None or model.solve.linear == "petsc")
        places = find_places(model)
        for text in (*choices(model.contacts), *(text for place in places for text in place.notes)):
            told.note(text)
        if team is None and model.solve.linear == "petsc":
            from abut.parallel.team import start_team

            team = start_team()
        constraints, loaded = prescribed(model)
        clock.mark("set-up")
        backend = assembled_bodies(model, observe, told.note, clock, team)
        assembled = assemble(model, constraints, loaded, backend, observe, told.note, clock)
        problem = assembled.problem
        check_order(resume, problem.n_free, int(problem.operator.shape[0]))
        kind = solver_kind(problem, team)
        if resume and model.solve.linear in ("auto", "petsc"):
            kind = resume[-1].linear
        return cls(
            model,
            told,
            deadline,
            keep,
            team,
            clock,
            places,
            assembled,
            kind,
            linear_solver(kind, problem, team),
            settings,
        )

    def restore(self, done: Sequence[Saved]) -> State:
        """Take up the steps done before; the state to go on from."""
        if not done:
            return self.assembled.problem.start()
        self.told.observe(Phase("restoring the steps done before"))
        before = self.assembled.problem.start()
        for saved in done:
            for part in restored(saved, before, self.assembled.problem):
                self.parts.append((part, self._result(part)))
                before = part.state
            self.steps.append(self._taken())
        self.clock.mark("results")
        return before

    def march(self, first: State, done: Sequence[Saved] = ()) -> None:
        """Solve the steps that are left, each told and kept as it ends. done: those before."""
        problem, observe, solve = self.assembled.problem, self.told.observe, self.model.solve
        times = [t for t in self.model.ends if not self.steps or t > first.time * (1.0 + 1e-12)]
        count = len(self.steps) + len(times)

        def begins(number: int, time: float) -> None:
            self.deadline.begins()
            if self.model.finite:  # bodies have moved: whether contact holds them there, the solver finds
                behind = self.steps[-1].factor if self.steps else 0.0
                observe(Phase(f"step {number}, to time {solve.time(time):.4g}", share=behind))
                return
            of_all = max(count, number)
            observe(Phase(f"step {number} of {of_all}", None, number - 1, of_all))
            factors = weights(self.model.histories, time)
            loads = problem.constraints.free.T @ (self.assembled.loaded.forces @ factors)
            require_balance(problem.restraint.at(factors), loads, f" in step {number}" if count > 1 else "")

        def iterated(item: Iteration) -> None:
            observe(item)
            self.deadline.iterated()

        def prepares(what: LinearSolver) -> None:
            observe(Phase(*setting_up(what, problem)))

        def halves(attempt: Attempt, time: float) -> None:
            self.told.note(
                f"step {attempt.number} did not converge in {len(attempt.iterations)} iterations{_why(attempt)}: it goes to "
                f"time {solve.time(time):.6g} first, not to {solve.time(attempt.time):.6g}"
            )

        def refines(attempt: Attempt, time: float) -> None:
            self.told.note(
                f"step {attempt.number} to time {solve.time(attempt.time):.6g} jumps over the onset of slip: it goes to "
                f"time {solve.time(time):.6g} first"
            )

        control = Control(
            solve.max_iterations, iterated, begins, prepares, self.told.note, self._fallback, halves, self._onset, refines,
            self.settings,
        )  # fmt: skip
        states = [*(problem.start(), *(saved.state for saved in done))[:-1], first]
        pace = self._pace(states, done)
        stepper: Stepper
        if self.model.finite:
            stepper = LargeSteps(problem, self.solver, control)
        else:
            stepper = SmallSteps(problem, first, self.solver, control)
            self.again = stepper.again
        for attempt in march(stepper, states, pace, control):
            self.clock.mark("solve")
            ends = (0, 0) if self.model.finite else (attempt.number - 1, count)
            observe(Phase(f"stresses and checks of step {attempt.number}", None, *ends))
            self._end(attempt)
        if self.solver.effort:
            self.told.note(self.solver.effort)

    def vibrate(self) -> None:
        """What the model asks for about the states at ends of steps, if all are there."""
        if not self.model.modes or not all(step.converged for step in self.steps):
            return
        self.told.observe(Phase("frequencies and buckling"))
        for text in massless(self.model):
            self.told.note(text)
        self.modes, self.responses = modes(self.assembled, self.looked, self.places, eigensolver(self.team))
        self.clock.mark("modes")

    def _onset(self, earlier: State | None, before: State, now: State) -> Onset:
        steps, factors = self.settings.steps, weights(self.model.histories, now.time)
        most = Most(1.0 / steps.points, steps.aim * steps.missed)
        return onset(self.assembled.problem.pairs, earlier, before, now, factors, most)

    def _pace(self, states: Sequence[State], done: Sequence[Saved]) -> Pace:
        """After the steps ``done``, which ended in ``states`` but for the first, that of the start."""
        pace = self._begun()
        for earlier, before, saved in zip((None, *states), states, done):
            led = stride(self.settings) if is_dragged(saved.state) else None
            begun = self._onset(earlier if pace.goes_on else None, before, saved.state)
            share = landed_in(saved.state).share
            pace.repeat(saved.state.time, len(saved.iterations), share, begun, led)
        return pace

    def _begun(self) -> Pace:
        """Before the first step. Large sliding finds its own steps; with friction, flow or large displacements those of the
        user are taken in parts where they fail, and where there are none the onset of slip has steps of its own."""
        model, pairs, solve = self.model, self.assembled.problem.pairs, self.model.solve
        rubs = any(pair.frictional for pair in pairs)
        slips = Slips(self._fits()) if rubs and solve.finds_steps else None
        if model.finite and pairs:
            return pace_of(solve.steps, solve.times, (*model.histories, *model.locking), slips, self.settings)
        return given_pace(model.ends, model.finite or rubs or yields(model), slips, self.settings)

    def _fits(self) -> bool:
        """Whether surfaces with friction press from the outset, and loads act besides."""
        problem, at = self.assembled.problem, weights(self.model.histories, self.model.ends[0])
        moves = (problem.constraints.prescribed @ at).any() or problem.constraints.turns is not None
        acts = moves or (self.assembled.loaded.forces @ at).any()
        rubs = [pair.contact for pair in problem.pairs if pair.frictional]
        return bool(acts) and any(offsets(self.model, contact)[0] < 0.0 for contact in rubs)

    def so_far(self, complete: bool) -> Solution:
        """The steps up to here; complete: there are no more to come."""
        n_free, timings = self.assembled.problem.n_free, dict(self.clock.timings)
        return Solution(
            self.model, tuple(self.steps), n_free, self.solver.name, tuple(self.told.notes), timings, complete,
            modes=self.modes, responses=self.responses,
        )  # fmt: skip

    def _result(self, attempt: Attempt, sized: bool = True) -> Step:
        before = [*self.steps, *(step for _, step in self.parts)]
        step, self.acted = step_result(self.assembled, attempt, before, self.acted, self._mended(attempt))
        if sized:
            _check_size(self.model, step.displacement, self.told.note, self.settings.holding.absurd)
        if attempt.converged:
            began = self.assembled.problem.start() if self.ended is None else self.ended[1].state
            self.ended = began, replace(attempt, balance=None)
            at = [wanted.share for wanted in self.model.modes if abs(wanted.share - attempt.time) <= SAME]
            self.looked |= dict.fromkeys(at, self.ended)
        return replace(step, probes=tuple(read(place, step) for place in self.places))

    def _mended(self, attempt: Attempt) -> Mended | None:
        """What is shown of a step with triangles or tetrahedra of first order."""
        problem = self.assembled.problem
        if not attempt.converged or not is_mended(problem):
            return None
        if self.again is None:
            ready = prepared(problem, self.solver, attempt.state, self.settings)
            self.again = lambda: ready
        try:
            found = mended(self.assembled, attempt, self.again().under)
        except (NotConverged, SingularModelError):
            found = None
        if found is None:
            self.told.note(
                f"step {attempt.number}: pressures and stresses of triangles and tetrahedra of first order are shown as "
                "they are solved: contact was not found again under the forces that their straight displacements leave"
            )
        return found

    def _end(self, attempt: Attempt) -> None:
        """Results of an attempt; those of the parts of a step when it is whole, or when nothing follows them."""
        if attempt.converged:
            self.parts.append((replace(attempt, balance=None), self._result(attempt)))
            self.clock.mark("results")
            if attempt.whole:
                self._keep()
            return
        if self.parts:
            attempt = replace(attempt, number=attempt.number + 1)
            self._keep()
        if not attempt.iterations:  # there is no state to show
            raise ConvergenceError(f"step {attempt.number} cannot be begun, however short: {attempt.reason}")
        try:
            limit = limit_load(self.assembled, self.steps, attempt)
            last = self._result(attempt, sized=limit is None)
            self.steps.append(last if last.flow is None else replace(last, flow=replace(last.flow, limit=limit)))
        except Unsound as reason:
            raise ConvergenceError(f"step {attempt.number} did not converge; in its last state {reason}") from None
        self.clock.mark("results")
        count = len(attempt.iterations)
        self.told.note(f"step {attempt.number} did not converge in {count} iterations{_why(attempt)}")
        if limit is not None:
            self.told.note(f"{limit.where}; {GO_ON}")

    def _taken(self) -> Step:
        """The step that the parts so far make; there are none left then."""
        steps = [step for _, step in self.parts]
        self.parts.clear()
        return whole(steps)

    def _keep(self) -> None:
        """Keep the step that the parts so far make, and tell of it."""
        attempts = [attempt for attempt, _ in self.parts]
        self.steps.append(self._taken())
        taken, end = self.steps[-1].energy, self.steps[-1].time
        if is_dragged(attempts[-1].state) and taken is not None:
            self.told.note(
                f"step {attempts[-1].number} was led to time {end:.6g} by a drag on all motion, in "
                f"{len(attempts)} parts: it took {taken.stabilisation:.3g} of energy, and is gone at the end"
            )
        elif len(attempts) > 1:
            times = ", ".join(f"{self.model.solve.time(attempt.time):.6g}" for attempt in attempts)
            self.told.note(f"step {attempts[-1].number} was taken in {len(attempts)} parts, to times {times}")
            self._tell_of_limit(attempts)
        if taken is not None and taken.jumped > JUMPED:
            self.told.note(
                f"step {attempts[-1].number} to time {end:.6g} jumps to another equilibrium: no way of stable "
                f"states from its beginning explains {taken.unexplained:.3g} of energy, {taken.jumped:.0%} of its work; "
                "give more steps, or prescribe a displacement instead of the force"
            )
        self.keep(self.so_far(complete=False), saved_step(attempts, self.kind, self.assembled.problem))
        self.clock.mark("writing")

    def _tell_of_limit(self, parts: Sequence[Attempt]) -> None:
        """Of a run that ends near a limit load."""
        last, end = self.steps[-1], self.model.ends[-1]
        if last.flow is None or not np.isclose(parts[-1].time, end):
            return
        limit = near_limit(self.assembled, self.steps, [part.time for part in parts])
        if limit is not None:
            self.steps[-1] = replace(last, flow=replace(last.flow, limit=limit))
            self.told.note(f"{limit.where}; {GO_ON}")

    def _fallback(self, number: int, reason: NotConverged) -> LinearSolver:
        direct = linear_solver("direct", self.assembled.problem, self.team)
        if self.model.finite:
            self.told.note(f"step {number}: {reason}: the direct solver takes this step")
            return direct
        self.told.note(f"step {number}: {reason}: going on with the direct solver")
        self.solver, self.kind = direct, "direct"
        return self.solver


def _why(attempt: Attempt) -> str:
    return f" ({attempt.reason})" if attempt.reason else ""


def _check_size(model: Model, displacement: NDArray[np.float64], note: Callable[[str], None], most: float) -> None:
    """Displacements beyond the size of the model mean wrong units, or a matrix that is singular in all but name."""
    extent = float(np.ptp(model.mesh.points, axis=0).max())
    largest = float(np.abs(displacement).max(initial=0.0))
    if not largest < most * extent:
        raise SingularModelError(
            f"displacements of {largest:.2g} exceed {most:g} times the model size {extent:.2g}: check the "
            "units of Young's moduli, loads and mesh, and that supports constrain every body"
        )
    if largest > extent and not model.finite:
        note(
            f"displacements of {largest:.2g} exceed the model size {extent:.2g}: check units (displacements must be small)"
        )

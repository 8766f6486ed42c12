"""One load step at large displacements: semi-smooth Newton on geometry, material, contact and friction together, by
theory (G7), (G8)."""

from __future__ import annotations

import time as clocks
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field, replace

import numpy as np
from numpy.typing import NDArray

from abut.errors import SingularModelError, Unsound
from abut.linear.solver import LinearSolver, Prepared
from abut.nonlinear.drag import Drag, dragged
from abut.nonlinear.exchange import exchanged
from abut.nonlinear.finite_laws import (
    following_status,
    laws_of,
    left_open,
    nearest_kept,
    status_of,
    wanted_status,
    without_pulling,
    yielding,
)
from abut.nonlinear.forcing import forcing
from abut.nonlinear.friction import solve_linearised
from abut.nonlinear.holding import not_adrift, resisting, sticking
from abut.nonlinear.iteration import Found, Increment, advance, largest_pressure, largest_so_far, part_of, report
from abut.nonlinear.laws import Asked, barely_covered, friction_laws
from abut.nonlinear.line_search import shortened
from abut.nonlinear.newton import End, Method, newton
from abut.nonlinear.settings import Settings
from abut.nonlinear.unsettled import circling, most_at
from abut.problem.expanded import SLIGHT
from abut.problem.frame import Frame
from abut.problem.laws import LawRows
from abut.problem.linearised import NOTHING, Linearised
from abut.problem.problem import ContactProblem
from abut.solution import Iteration
from abut.solution.state import CLOSED, State

Vector = NDArray[np.float64]


@dataclass(frozen=True)
class Trial:
    """What a state leaves open. own: the problem near it; system: with the drag of the step; forces: (n_unknowns,) over the
    largest; broken: (n,) laws over the largest pressure; size: all of it together, infinite where the material is no more;
    rounding: of forces over the largest; unsound: what is wrong with the material."""

    own: Linearised
    system: Linearised
    state: State
    laws: Sequence[LawRows]
    forces: Vector
    broken: Vector
    size: float
    changed: NDArray[np.bool_]
    rounding: float
    unsound: str = ""

    @property
    def force(self) -> float:
        return float(np.abs(self.forces).max(initial=0.0))

    @property
    def law(self) -> float:
        return float(np.abs(self.broken).max(initial=0.0))

    @property
    def error(self) -> float:
        return max(self.force, self.law)


@dataclass
class Step:
    """A load step to solve. before: the last converged state, its multipliers by the functions of ``frame``; limit: of
    iterations; careful: with a line search; drag: that it is led by, None without; asked: which laws hold. prepared: the
    linear solver as it was last set up; done: its iterations, which grow, and the state reached by the last one; failed: why
    it ended without a solution; unsound: what was wrong with the material where it became careful."""

    problem: ContactProblem
    before: State
    frame: Frame
    solver: LinearSolver
    increment: Increment
    limit: int
    observe: Callable[[Iteration], None]
    careful: bool = False
    asked: Asked = field(default_factory=Asked)
    drag: Drag | None = None
    prepared: Prepared | None = None
    done: list[Iteration] = field(default_factory=list)
    failed: str = ""
    unsound: str = ""
    reached: State | None = None

    @property
    def rubs(self) -> bool:
        """Whether a contact has friction, whose statuses may go round."""
        return any(pair.frictional for pair in self.problem.pairs)

    @property
    def settings(self) -> Settings:
        """Thresholds."""
        return self.increment.settings

    def advanced(self, system: Linearised, state: State, laws: Sequence[LawRows], accuracy: float) -> State:
        """One Newton step, whose linear system is solved to ``accuracy`` where that is done iteratively."""
        self.prepared = self.solver.prepare(system, self.prepared)
        return advance(self.prepared, state, yielding(system, laws), accuracy)


def solve_finite(step: Step, guess: State | None, time: float) -> Found:
    """The state at ``time``, from a guess there; None: from the last converged state, whose tangent carries what is
    prescribed further.

    Laws of one's own begin from the solution of complementarity where nothing has pressed yet (two blocks without other
    supports on a soft contact, ``tests/decks/test_deck_soft.py``, fly apart otherwise), and where they do not converge
    otherwise. The constraint function does in any case; its smoothing goes with the largest pressure there."""
    pairs = [pair for pair in step.problem.pairs if pair.smooth]
    own = any(not isinstance(pair.contact.law, str) for pair in pairs)
    ways = [_solved, _by_complementarity] if own else [_solved]
    if own and step.before.largest.pressure == 0.0:
        ways.reverse()
    for way in ways:
        step.failed = ""
        found = way(step, guess, time)
        if found.converged:
            break
    if found.converged and any(isinstance(pair.contact.law, str) for pair in pairs):
        reference = largest_pressure(found.state, step.increment)
        if reference > step.settings.newton.rounding * max(pair.stiffness * pair.size for pair in pairs):
            found = _solved_again(step, Asked(reference=reference), found.state, time)
    return found


def _by_complementarity(step: Step, guess: State | None, time: float) -> Found:
    """With laws of one's own from the solution of complementarity, whose pressures they meet to begin with. Without it
    ``test_a_layer_that_loads_press`` fails."""
    found = _solved_again(step, Asked(own=False), guess, time)
    return _solved_again(step, Asked(by_pressure=True), found.state, time) if found.converged else found


def _solved(step: Step, guess: State | None, time: float) -> Found:
    """With the laws that the step asks for."""
    none = np.zeros(len(step.before.status), dtype=bool)
    try:
        here = _newton(step, guess, time)
    except (SingularModelError, Unsound) as reason:
        step.failed = str(reason)
        if not step.done and step.before.time > 0.0:  # what is left open where it began
            begun, state = clocks.perf_counter(), replace(step.before, time=time)
            _report(step, _judged(step, step.problem.ahead(step.before, step.frame, time), state), begun)
        return Found(step.before, tuple(step.done), False, none, friction_laws, reached=step.reached)
    changing = here.changed if step.failed else none
    return Found(here.state, tuple(step.done), not step.failed, changing, friction_laws, system=here.own)


def _solved_again(step: Step, asked: Asked, guess: State | None, time: float) -> Found:
    """With other laws, and as many iterations more; by a line search where they are smooth."""
    careful = step.careful or asked.reference is not None
    again = replace(step, asked=asked, limit=step.limit + len(step.done), careful=careful, failed="")
    found = _solved(again, guess, time)
    step.failed, step.prepared = again.failed, again.prepared
    return found


def _newton(step: Step, guess: State | None, time: float) -> Trial:
    begun = clocks.perf_counter()
    here = _balance(step, _carried(step, time) if guess is None else guess, step.before, guessed=guess is not None)
    if guess is None:
        begun = _report(step, here, begun)
        if _balanced(step, here, np.inf):
            return here
    state = nearest_kept(here.system, step.before, here.state, 0.1 * step.settings.holding.near)
    here = here if state is here.state else replace(here, state=state, laws=laws_of(here.system, state, step.asked))
    there, end = newton(LargeMotion(step, here, begun), here, step.limit - len(step.done))
    if end is not End.SOLVED and not step.failed:
        step.failed = _unsettled(step, there)
    return there


class LargeMotion(Method[Trial]):
    """The problem linearised at every state, with the status that its laws ask for there; where that comes to nothing the
    step is careful: its linear problems are solved whole, and a line search shortens the way. begun: when it was."""

    def __init__(self, step: Step, begin: Trial, begun: float) -> None:
        self._step, self.begun, self._best = step, begun, begin
        self._closings = np.zeros(len(step.before.status), dtype=np.int64)
        self._before, self._errors, self._swapped = np.inf, list[float](), False
        self._idle, self._back = 0, False

    def advanced(self, here: Trial) -> Trial:
        """One iteration, as in ``Method``."""
        step = self._step
        accuracy = forcing(here.error, self._before, step.settings)
        following, self._swapped = _following(step, here, self._closings, accuracy)
        step.asked = replace(step.asked, by_pressure=False)
        if following is None:
            step.failed = _unsettled(step, here, "no status is what the laws ask for")
            return here
        there = _tried(step, here, following)
        self._closings += there.state.closed & ~here.state.closed
        return there

    def globalised(self, here: Trial, there: Trial) -> Trial:
        """The whole step, or the part of it that a line search finds to be better."""
        step = self._step
        if step.failed:
            return here
        if there.unsound and not step.careful and step.rubs:
            self._back, step.unsound = True, there.unsound
            return there
        if (step.careful and not self._swapped) or not np.isfinite(there.size):
            there = _shortened(step, here, there)
        if not np.isfinite(there.size):
            step.failed = there.unsound or "forces are not finite"
            return here
        self._before = here.error
        return there

    def ended(self, there: Trial) -> End | None:
        """Whether, and why, iterations end, as in ``Method``."""
        step = self._step
        if step.failed:
            return End.STALLED
        if self._back:
            return None
        self._errors.append(there.error)
        self.begun = _report(step, there, self.begun)
        if _balanced(step, there, self._before):
            return End.SOLVED
        better = there.size < self._best.size
        self._best, self._idle = (there, 0) if better else (self._best, self._idle + 1)
        gains = self._idle < step.settings.newton.patience or not step.rubs
        if circling(self._errors, step.settings) or not gains:
            if step.careful:
                return End.STALLED
            self._back = True
        return None

    def followed(self, there: Trial) -> Trial:
        """As in ``Method``; a step that becomes careful goes on from what has left least so far."""
        if not self._back:
            return there
        self._step.careful, self._errors, self._idle, self._back = True, [], 0, False
        self._before = np.inf
        return self._best


def _unsettled(step: Step, here: Trial, why: str = "iterations go round in a circle") -> str:
    """Why iterations have ended without a solution."""
    why = f"{step.limit} iterations were not enough" if len(step.done) >= step.limit else why
    most = most_at(step.problem, here.forces, here.broken)
    first = f"{step.unsound}; " if step.unsound else ""
    return (
        f"{first}{why}: {here.force:.1e} of the forces, {here.law:.1e} of the laws, {most}, and "
        f"{int(here.changed.sum())} multipliers that change"
    )


def _following(step: Step, here: Trial, closings: NDArray[np.int64], accuracy: float) -> tuple[State | None, bool]:
    """One iteration on, and whether a point has taken the place of another in it; of a careful step with the status that the
    laws ask for at its end, None where there is none. closings: as in ``exchanged``."""

    def solved(state: State) -> State:
        return step.advanced(here.system, state, laws_of(here.system, state, step.asked), accuracy)

    there = _iterated(step, here.system, here.state, here.laws, accuracy)
    other = exchanged(here.system, here.state, there, closings, step.settings.newton.patience, solved)
    if other is not there:
        return other, True
    if not step.careful:
        return there, False
    return (_whole(step, here, there) if step.rubs else _until_asked(step, here, there, solved)), False


def _whole(step: Step, here: Trial, there: State) -> State | None:
    """With friction, whose statuses may have no end: the solution of the problem near ``here``, status and all, from what an
    iteration has come to, None where none is found; with laws of one's own, which searches do not know, just that."""
    system = here.system
    if any(step.asked.of(pair, system) is not None for pair in system.pairs):
        return there
    assert step.prepared is not None
    wanted = wanted_status(system, there, step.increment, step.asked)
    found = solve_linearised(step.prepared, there.with_status(wanted), step.increment)
    if found is None:
        return None
    return not_adrift(step.problem, system, here.state, found, step.settings.holding.near)


def _until_asked(step: Step, here: Trial, there: State, solved: Callable[[State], State]) -> State:
    """Without friction: solutions of the problem near ``here``, each with the status that the laws ask for before it.
    Of several solutions of bodies that bend away this leads to the near one: ``beam-on-sharp-end-lower`` fails without."""
    seen = {here.state.status.tobytes()}
    while len(seen) < step.settings.newton.solutions:
        wanted = wanted_status(here.system, there, step.increment, step.asked)
        if wanted.tobytes() in seen:
            break
        seen.add(wanted.tobytes())
        there = solved(here.state.with_status(wanted))
    return there


def _iterated(
    step: Step, system: Linearised, state: State, laws: Sequence[LawRows], accuracy: float, begins: bool = False
) -> State:
    """One iteration on, in which no body that slips all over is thrown out of its contact."""
    if begins and step.drag is None:
        system = resisting(step.problem, system, state, step.settings)
    there = step.advanced(system, state, laws, accuracy)
    near = step.settings.holding.near
    stuck = sticking(step.problem, system, state, there, near)
    if stuck is not state:
        there = step.advanced(system, stuck, laws_of(system, stuck, step.asked), accuracy)
    return not_adrift(step.problem, system, stuck, there, near)


def _balanced(step: Step, here: Trial, before: float) -> bool:
    """Whether nothing is left but rounding. before: the error of the iteration before."""
    left = step.settings.newton
    idle = here.error > 0.5 * before and here.law <= left.stalled and here.force <= max(left.stalled, here.rounding)
    return here.error <= left.balanced or idle


def _carried(step: Step, time: float) -> State:
    """From the last converged state, what is prescribed changes with the tangent there, theory (G10); contact closes
    as far as it takes to hold every body."""
    system = dragged(step.problem.ahead(step.before, step.frame, time), step.drag)
    state = replace(step.before, time=time)
    closed, bare = state.closed, barely_covered(system)
    if step.drag is None:  # what has no target opposite is no gap of zero
        closed = system.restraint.met_first(system.forces, closed, np.where(bare, np.inf, system.gap(state)))
    closed = closed & ~bare
    state = state.with_status(np.where(closed & ~state.closed, CLOSED, state.status).astype(np.int8))
    while True:
        laws = laws_of(system, state, step.asked)
        there = _iterated(step, system, state, laws, step.settings.accuracy.fine, begins=True)
        other = without_pulling(system, state, there, step.increment)
        if other is None:
            return there
        state = other


def _balance(step: Step, state: State, since: State, guessed: bool = False) -> Trial:
    """The problem near a state, reached from another one, with the status that the laws ask for there."""
    return _judged(step, step.problem.linearise(step.before, step.frame, state, since, guessed), state, guessed)


def _judged(step: Step, own: Linearised, state: State, guessed: bool = False) -> Trial:
    """What a state leaves open. own: the problem near it."""
    system = dragged(own, step.drag)
    before = state.status
    state = state.with_status(following_status(system, state, step.increment, step.asked, guessed))
    laws = laws_of(system, state, step.asked)
    state = state.with_status(status_of(system, state, laws, step.asked))
    changed = state.status != before
    so_far = largest_so_far(system, state, step.increment)
    modulus = max((pair.stiffness * pair.size for pair in system.pairs), default=1.0)
    forces, pressures = max(so_far.force, NOTHING), max(so_far.pressure, SLIGHT * modulus)
    left = system.relative(system.unbalanced(state), forces)
    law = left_open(system, laws, step.asked) / pressures
    return Trial(
        own, system, state, laws, left, law, float(np.linalg.norm(left) + np.linalg.norm(law)), changed,
        0.0 if system.about is None else system.about.rounding / forces,
    )  # fmt: skip


def _tried(step: Step, here: Trial, state: State) -> Trial:
    """Near a trial state; under a drag, and with friction, without a size where a cell is beyond its material there, so that
    less of the way is tried."""
    try:
        return _balance(step, state, here.state)
    except Unsound as reason:
        if step.drag is None and not step.rubs:
            raise
        return replace(here, state=state, size=np.inf, unsound=str(reason))


def _shortened(step: Step, here: Trial, full: Trial) -> Trial:
    """The whole step, or the part of it that a line search finds to be better."""

    def part(share: float) -> Trial:
        return _tried(step, here, part_of(here.state, full.state, share))

    best, _ = shortened(full, part, lambda trial: trial.size, here.size, step.increment.settings)
    return best if np.isfinite(best.size) else full


def _report(step: Step, here: Trial, begun: float) -> float:
    now, left = clocks.perf_counter(), (here.force, here.law)
    changed = int(here.changed.sum())
    row = report(here.system, here.state, step.increment, len(step.done) + 1, changed, left, now - begun)
    step.done.append(row)
    step.reached = here.state
    step.observe(row)
    return now

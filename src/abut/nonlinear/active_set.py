"""Semi-smooth Newton method (primal-dual active set strategy) for one load step."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, field, replace
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray

from abut.errors import SingularModelError
from abut.linear.solver import Prepared
from abut.nonlinear.exact import Aim, Solved, finer, settled, solve_set
from abut.nonlinear.friction import solve_friction
from abut.nonlinear.iteration import Found, Increment
from abut.nonlinear.laws import active_laws
from abut.nonlinear.newton import End, Method, newton
from abut.nonlinear.search import Log, search
from abut.nonlinear.settings import Settings
from abut.nonlinear.smooth_laws import finish_smooth
from abut.solution import Iteration
from abut.solution.state import State


def solve_step(
    solver: Prepared,
    begin: State,
    increment: Increment,
    limit: int,
    observe: Callable[[Iteration], None],
    earlier: Sequence[Iteration] = (),
    aim: Aim = "solution",
    settle: bool = False,
) -> Found:
    """Find the state at the end of a load step, from the state ``begin``.

    earlier: iterations of the same step before; aim: "set" where only the active set is wanted, of laws that have one, "this
    set" to give up as soon as the set of ``begin`` changes (``cycling`` then says where); settle: the set of ``begin`` is
    likely to be the final one."""
    if any(pair.frictional for pair in solver.system.pairs):
        found = solve_friction(solver, begin, increment, limit, observe, earlier)
        if not found.converged:
            return found
        return finish_smooth(solver, found.state, increment, limit, list(found.iterations), observe)
    tied, none = solver.system.tied, np.zeros(len(begin.status), dtype=bool)
    log = Log(list(earlier), observe, len(earlier) + limit)
    method = ActiveSet(solver, increment, log, aim)
    there, end = newton(method, Trial(begin, method.first(begin, settle)), limit)
    if end is End.STALLED:
        return search(solver, begin, increment, limit, log, tied, aim)
    if end is End.SOLVED and aim == "set":
        return Found(there.state, tuple(log.done), True, none, active_laws)
    if end is End.SOLVED:
        return finish_smooth(solver, there.state, increment, limit, log.done, observe)
    return Found(there.state, tuple(log.done), False, method.cycling(there), active_laws)


@dataclass(frozen=True)
class Trial:
    """A state with the active set to solve with, or as it was solved: accuracy: asked of the solution; solved: what it left;
    singular: why there is none."""

    state: State
    accuracy: float
    solved: Solved | None = None
    singular: SingularModelError | None = None


class ActiveSet(Method[Trial]):
    """The set that the law asks for, or a better guess; ``search`` takes over where interior points are quicker."""

    def __init__(self, solver: Prepared, increment: Increment, log: Log, aim: Aim) -> None:
        self._solver, self._increment, self._log, self._aim = solver, increment, log, aim
        self._tied, self._settings = solver.system.tied, increment.settings
        self._course = Course(solver, self._tied, self._settings, self._settings.accuracy.rough)
        self._sets: list[NDArray[np.bool_]] = []
        self._before = np.inf

    def first(self, begin: State, settle: bool) -> float:
        """The reduction of the residual to ask of the first solution; settle: as for ``solve_step``."""
        if begin.closed.all() and not settle:
            return 0.1 * self._solver.accurate  # closed all over may well be the answer
        return self._settings.accuracy.stride if settle else self._settings.accuracy.rough

    def advanced(self, here: Trial) -> Trial:
        """One iteration, as in ``Method``."""
        try:
            solved = solve_set(self._solver, here.state, self._increment, self._tied, self._log.next, here.accuracy)
        except SingularModelError as reason:
            return replace(here, singular=reason)
        self._log.add(solved.row)
        self._sets.append(solved.state.closed)
        return Trial(solved.state, here.accuracy, solved)

    def ended(self, there: Trial) -> End | None:
        """Whether, and why, iterations end, as in ``Method``. Raises SingularModelError where nothing holds a body."""
        if there.solved is None:
            _check_balance(self._solver)
            decided = self._tied | self._solver.system.away
            if there.singular is not None and (decided.all() or self._aim == "this set"):
                raise there.singular
            return End.STALLED
        if there.solved.changed.any():
            return End.EXHAUSTED if self._aim == "this set" else None
        done = settled(self._solver, there.solved, self._settings, self._aim, self._before)
        return End.SOLVED if done else None

    def followed(self, there: Trial) -> Trial | None:
        """The same set, solved better where it stands still, or the one to go on with."""
        solved = there.solved
        assert solved is not None
        if not solved.changed.any():
            self._before = solved.error
            return replace(there, accuracy=finer(self._solver, solved, self._settings, self._aim))
        self._before = np.inf
        following = self._course.following(solved, len(self._sets), there.accuracy)
        return None if following is None else Trial(solved.state.with_closed(following.closed), following.accuracy)

    def cycling(self, there: Trial) -> NDArray[np.bool_]:
        """(n,) multipliers that go in and out, or are about to."""
        recent = np.stack(self._sets[-2 * self._settings.newton.patience :])
        assert there.solved is not None
        return np.asarray((recent.any(axis=0) & ~recent.all(axis=0)) | there.solved.changed)


@dataclass(frozen=True)
class Following:
    """The active set (n,) to solve with next, and the reduction of the residual to ask for."""

    closed: NDArray[np.bool_]
    accuracy: float


@dataclass
class Course:
    """The active sets of a step so far. finest: reduction of the residual asked for; seen:
    those solved with; changes, violations: of each solution, how many multipliers
    changed and the law's largest violation; lawful: what the law asked for where another set was foreseen; foresee: whether
    foresight is of use; doubtful: it was just found to be of none."""

    solver: Prepared
    tied: NDArray[np.bool_]
    settings: Settings
    finest: float
    seen: set[bytes] = field(default_factory=set)
    changes: list[int] = field(default_factory=list)
    violations: list[float] = field(default_factory=list)
    lawful: NDArray[np.bool_] | None = None
    foresee: bool = True
    doubtful: bool = False

    def following(self, solved: Solved, rows: int, accuracy: float) -> Following | None:
        """The set to solve with after one that changed; None where interior points are quicker. rows: of the step so far;
        accuracy: asked of the last solution.

        Raises SingularModelError where no contact that only pushes balances the loads."""
        active, count = solved.state.closed, int(solved.changed.sum())
        if self.lawful is not None and count > max(self.changes[-1], self.settings.status.misled * active.sum()):
            return self._back(self.lawful, active, accuracy)
        self.changes.append(count)
        self.violations.append(float(solved.violation.max()))
        system, gap = self.solver.system, self.solver.system.gap(solved.state)
        wanted = self._foreseen(solved, gap)
        stuck = np.array_equal(system.restraint.complete(system.forces, wanted, gap) | self.tied, active)
        self.seen.add(active.tobytes())
        repeated = stuck or wanted.tobytes() in self.seen
        slow = repeated or self._slow(rows)
        self.doubtful = False
        if slow:
            _check_balance(self.solver)
        if repeated and not stuck and not self.solver.exact and self.finest > self.settings.accuracy.fine:
            self.finest = self.settings.accuracy.fine  # sets may repeat because they were not solved well enough
            self.seen.clear()
        elif slow:
            return None
        return Following(wanted, self.finest)

    def _back(self, lawful: NDArray[np.bool_], active: NDArray[np.bool_], accuracy: float) -> Following:
        """Back to what the law asked for, and no more foresight. Without it the loose pin of ``test_loose_pin`` takes 77
        iterations in its load steps instead of 59 (24 cells along a quarter)."""
        self.seen.add(active.tobytes())
        self.lawful, self.foresee, self.doubtful = None, False, True
        return Following(lawful, accuracy)

    def _foreseen(self, solved: Solved, gap: NDArray[np.float64]) -> NDArray[np.bool_]:
        """The set that the law asks for, or a better guess that has not been seen yet; no guess from a state that an
        iterative solver has left too rough to tell anything. Without it ``test_counts_do_not_grow`` fails: a layer that
        lifts off takes three times as many iterations."""
        self.lawful = None
        if not self.foresee or not (self.solver.exact or solved.error <= self.settings.accuracy.told):
            return solved.wanted
        guess = self.solver.foresee(gap, solved.state.multipliers, solved.wanted, self.tied)
        if guess.tobytes() in {*self.seen, solved.state.closed.tobytes()}:
            return solved.wanted
        self.lawful = solved.wanted
        return guess

    def _slow(self, rows: int) -> bool:
        """Whether interior points would be quicker; without ``doubtful`` the beams of ``test_counts_do_not_grow`` take a
        tenth more iterations."""
        if hopeless(self.changes, rows, self.settings) and not closing(self.violations, rows, self.settings):
            return True
        return self.doubtful and self.changes[-1] >= 0.5 * self.changes[-2]


def hopeless(changes: Sequence[int], rows: int, settings: Settings) -> bool:
    """Whether the set will take too many more iterations at the pace of the last ones, or for some as many multipliers
    changed as ever before. changes: how many in each; rows: those of the step so far."""
    patience = settings.newton.patience
    if len(changes) <= patience:
        return False
    pace = np.log(changes[-1 - patience] / changes[-1]) / patience
    stalled = min(changes[-patience:]) >= min(changes[:-patience])
    return stalled or bool(np.log(changes[-1]) > max(settings.status.rows - rows, 1) * pace)


def closing(violations: Sequence[float], rows: int, settings: Settings) -> bool:
    """Whether the law's largest violation falls so evenly that it will soon be gone: an edge of contact that goes back facet
    by facet, theory (V9). rows: those of the step so far. Without it ``test_loose_pin`` takes 62 iterations instead of 57
    (12 cells along a quarter)."""
    patience = settings.newton.patience
    last = violations[-1 - patience :]
    if len(last) <= patience or any(after >= before for before, after in pairwise(last)):
        return False
    return rows + last[-1] * patience / (last[0] - last[-1]) <= 1.5 * settings.status.rows


def _check_balance(solver: Prepared) -> None:
    """Raises SingularModelError where no contact that only pushes balances the loads, and names what they move."""
    motion = solver.system.restraint.unbalanced(solver.system.forces)
    if motion:
        raise SingularModelError(
            f"{motion}: the loads pull it off its contact; constrain it by a support or reverse the load"
        )

"""One load step at small displacements: Newton's method on the bodies, each of whose linear problems is a contact problem
that a search solves whole; with "dual-P1" a second time with ordinary functions inside."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from typing import Protocol

import numpy as np
from numpy.typing import NDArray

from abut.contact.coupling import surface_degree
from abut.contact.pressure_space import DUAL_P1
from abut.linear.iterative import Iterative
from abut.linear.solver import LinearSolver, Prepared
from abut.nonlinear.attempt import Attempt as Attempt
from abut.nonlinear.exact import Aim
from abut.nonlinear.forcing import forcing
from abut.nonlinear.iteration import Found, Increment, imbalance, largest_so_far
from abut.nonlinear.newton import End, Method, newton
from abut.problem.balance import Balance
from abut.problem.frame import Frame
from abut.problem.linearised import Linearised
from abut.problem.problem import Problem
from abut.solution import Iteration
from abut.solution.state import State


class Search(Protocol):
    """How the contact status of a linearised problem is found, as ``abut.nonlinear.active_set.solve_step`` does."""

    def __call__(
        self, solver: Prepared, begin: State, increment: Increment, limit: int, observe: Callable[[Iteration], None],
        earlier: Sequence[Iteration] = (), aim: Aim = "solution", settle: bool = False,
    ) -> Found: ...  # fmt: skip


@dataclass(frozen=True)
class Task:
    """A load step to solve. before: the last converged state; limit: of iterations; observe: called with each of them;
    search: for the contact status; given: a frame other than that which begins there."""

    problem: Problem
    before: State
    solver: LinearSolver
    increment: Increment
    limit: int
    observe: Callable[[Iteration], None]
    search: Search
    given: Frame | None = None

    @cached_property
    def frame(self) -> Frame:
        """What is fixed during the step: ``given``, or that which begins at ``before``."""
        return self.problem.frame(self.before) if self.given is None else self.given


@dataclass(frozen=True)
class Trial:
    """What a search ends with, the linear solver that it had, and the problem near its state. error: of the forces there,
    over the largest."""

    found: Found
    prepared: Prepared
    system: Linearised
    error: float


class Bodies(Method[Trial]):
    """The whole contact problem near a state, and the forces where it is solved; in whole steps."""

    def __init__(self, task: Task, earlier: Sequence[Iteration], aim: Aim) -> None:
        self._task, self._earlier, self._aim = task, earlier, aim
        self._before = np.inf

    def searched(
        self,
        system: Linearised,
        previous: Prepared | None,
        begin: State,
        earlier: Sequence[Iteration],
        settle: bool,
        error: float = np.inf,
        before: float = np.inf,
    ) -> Trial:
        """The contact problem ``system`` solved from a state on, where a constant problem ends; iteratively as well as the
        linearised bodies are worth. error, before: what is left there, and was an iteration ago; infinite where unknown."""
        task = self._task
        prepared = task.solver.prepare(system, previous)
        eased = self._eased(prepared, error, before)
        left = task.limit - len(earlier) + len(self._earlier)
        found = task.search(eased, begin, task.increment, left, task.observe, earlier, self._aim, settle)
        if task.problem.constant or not found.converged:
            return Trial(found, prepared, system, 0.0)
        system = task.problem.linearise(task.before, task.frame, found.state)
        law = found.iterations[-1].contact_residual if eased is not prepared else 0.0
        return Trial(found, prepared, system, max(imbalance(system, found.state, task.increment), law))

    def advanced(self, here: Trial) -> Trial:
        """One iteration, as in ``Method``."""
        before, self._before = self._before, here.error
        return self.searched(
            here.system, here.prepared, here.found.state, here.found.iterations, True, here.error, before
        )

    def _eased(self, prepared: Prepared, error: float, before: float) -> Prepared:
        """A solver that leaves the share of ``error`` that Newton's method on the bodies has no use for (``forcing``): an
        iterative one, of laws that the search judges by what is left of them."""
        plain = not any(pair.frictional or pair.smooth for pair in prepared.system.pairs)
        if self._task.problem.constant or not (isinstance(prepared, Iterative) and plain):
            return prepared
        asked = self._task.increment.settings
        worth = error * forcing(error, before, asked) if np.isfinite(error) else asked.accuracy.rough
        return replace(prepared, accurate=max(prepared.accurate, worth))

    def ended(self, there: Trial) -> End | None:
        """Whether, and why, iterations end, as in ``Method``."""
        asked, error = self._task.increment.settings.newton, there.error
        if not there.found.converged:
            return End.STALLED
        if error <= asked.balanced or (error <= asked.stalled and error > 0.5 * self._before):
            return End.SOLVED
        left = self._task.limit - len(there.found.iterations) + len(self._earlier)
        return End.EXHAUSTED if left <= 0 or not np.isfinite(error) else None


def solved(
    task: Task,
    guess: State,
    previous: Prepared | None,
    earlier: Sequence[Iteration] = (),
    aim: Aim = "solution",
    settle: bool = False,
) -> tuple[Found, Prepared]:
    """The state at the end of a load step, from ``guess`` on, and the linear solver as it was last set up.

    A constant problem is linearised once: what remains is the search for the contact status. Any other one is linearised
    anew at each state that this search finds, until its forces are in balance there. earlier, aim, settle: as for
    ``Search``."""
    method, problem = Bodies(task, earlier, aim), task.problem
    there = method.searched(problem.linearise(task.before, task.frame, guess), previous, guess, earlier, settle)
    end = method.ended(there)
    if end is None:
        there, end = newton(method, there, task.limit)
    system = there.system if end is End.SOLVED or problem.constant else None
    return replace(there.found, converged=end is End.SOLVED, system=system), there.prepared


def load_step(task: Task, time: float, prepared: Prepared) -> Attempt:
    """Solve the load step that ends at ``time``, theory (P9). prepared: the solver for the task's problem.

    The problem has dual functions wherever the space has them. What is closed all over at the outset may stay so: that is
    tried first. Else dual functions tell where contact is closed, and there the ordinary ones take their place."""
    problem = task.problem
    pairs = prepared.system.pairs
    begin = replace(problem.restrict(task.before), time=time)
    none = np.zeros(len(begin.status), dtype=bool)
    search = any(p.space.name == DUAL_P1 and surface_degree(p.contactor) == 2 for p in pairs)
    smooth = any(p.smooth or p.frictional for p in pairs)
    earlier: tuple[Iteration, ...] = ()
    inner = problem.with_ordinary(begin.closed) if begin.closed.all() and not smooth else problem
    if inner is not problem:
        found, solver = solved(replace(task, problem=inner), begin, prepared, aim="this set")
        if found.converged:
            return _ended(replace(task, problem=inner), time, found, solver, begin.closed)
        earlier = found.iterations
        begin = found.state.with_closed(begin.closed & ~found.cycling)
    found, prepared = solved(task, begin, prepared, earlier, "set" if search else "solution")
    inside = found.state.closed
    inner = problem.with_ordinary(inside) if found.converged else problem
    if inner is problem and (not (found.converged and search) or (prepared.exact and not smooth)):
        return _ended(task, time, found, prepared, none)
    task = replace(task, problem=inner)
    found, prepared = solved(task, found.state, prepared, found.iterations, settle=True)
    if inner is not problem and found.converged:
        pressing = _pressing(task, found, prepared, inside)
        if pressing.any():
            inside = inside & ~pressing
            inner = problem.with_ordinary(inside)
            task = replace(task, problem=inner)
            found, prepared = solved(task, found.state, prepared, found.iterations, settle=True)
    return _ended(task, time, found, prepared, none if inner is problem else inside)


def _pressing(task: Task, found: Found, prepared: Prepared, inside: NDArray[np.bool_]) -> NDArray[np.bool_]:
    """Of the multipliers (n,) that were closed alone at an edge where both sides end, those that a converged state with
    ordinary functions there leaves closed, or open where the sides lie in each other: dual functions were right."""
    alone = task.problem.alone_at_edges(inside)
    if not alone.any():
        return alone
    system = prepared.system if found.system is None else found.system
    whole, _ = task.problem.expand(task.before, task.frame, found.state, found.laws, system)
    return np.asarray(alone & (found.state.closed | ~task.problem.alone_at_edges(inside, whole)))


def _ended(task: Task, time: float, found: Found, prepared: Prepared, inside: NDArray[np.bool_]) -> Attempt:
    problem: Problem = task.problem
    largest = largest_so_far(prepared.system, found.state, task.increment)
    system = prepared.system if found.system is None else found.system  # one without contact has no length
    state, whole = problem.expand(task.before, task.frame, found.state, found.laws, system)
    state = replace(state, largest=largest)
    if found.converged:
        state = problem.accepted(task.before, task.frame, state, whole)
    return Attempt(
        task.increment.number, state, found.converged, found.iterations, found.cycling, inside, time, found.reason,
        between=found.between, balance=None if found.system is None else Balance.of(whole, state),
    )  # fmt: skip

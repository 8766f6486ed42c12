"""One load step with friction: Newton's method on contact and slip together, and where that fails interior points, then
Newton's method from their status."""

from __future__ import annotations

import time
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from abut.errors import SingularModelError
from abut.linear.solver import Prepared
from abut.nonlinear.friction_laws import Status, next_status
from abut.nonlinear.friction_newton import Course, slid
from abut.nonlinear.interior_point import Interior, Manner, Programme, begin, iterate, near
from abut.nonlinear.iteration import Found, Increment, largest_pressure, points
from abut.nonlinear.newton import End, Method, newton
from abut.problem.linearised import Linearised
from abut.problem.pair import Pair
from abut.solution import Iteration
from abut.solution.state import CLOSED, OPEN, State


def solve_friction(
    solver: Prepared,
    first: State,
    increment: Increment,
    limit: int,
    observe: Callable[[Iteration], None],
    earlier: Sequence[Iteration] = (),
) -> Found:
    """Find the state at the end of a load step, from the state ``first``; limit: of iterations of each method; earlier:
    iterations of the same step before.

    Where nothing converges it ends with the state that breaks the laws least. Raises SingularModelError where not even soft
    contact holds a body."""
    course = Course(solver, increment, list(earlier), observe)
    found, error = None, None
    try:
        found = slid(course, first.with_status(_completed(solver.system, first)), limit)
    except SingularModelError as reason:
        error = reason
    found = found or search(course, first, limit) or course.failed()
    if found is None:
        assert error is not None
        raise error
    return found


def solve_linearised(solver: Prepared, begin: State, increment: Increment) -> State | None:
    """The solution of a problem that is linearised at a state of large displacements, from ``begin`` and its status on; None
    where none is found.

    Statuses go round, points that slip come to stick and back, where all take at once what the laws ask for at the solution
    with the ones before. The linear problem has a solution all the same, with some that slip and some that stick, which
    interior points find: ``test_the_laws_are_met_from_any_status``."""
    settings = increment.settings
    course = Course(solver, increment, [], _unseen)
    try:
        found = slid(course, begin, settings.newton.solutions)
    except SingularModelError:
        found = None
    found = found or search(course, begin, settings.steps.solutions)
    return found.state if found is not None and found.converged else None


def _unseen(_: Iteration) -> None:
    return None


def _completed(system: Linearised, state: State) -> Status:
    """The status to begin with: that of the state, and as much more in contact as it takes to hold every body."""
    closed = np.concatenate([np.zeros(0, bool), *map(_whole, system.pairs, system.split(state.closed))])
    wanted = system.restraint.complete(system.forces, closed, system.gap(state)) | system.tied
    return np.where(wanted & ~state.closed, CLOSED, state.status)


def _whole(pair: Pair, closed: NDArray[np.bool_]) -> NDArray[np.bool_]:
    return np.asarray(pair.of_functions(closed[pair.normal])) if pair.frictional else closed


def search(course: Course, state: State, limit: int) -> Found | None:
    """The solution of a load step from anywhere; None where it is not found. limit: of iterations.

    Newton's method ends it as soon as interior points tell the status of most multipliers."""
    interior = course.increment.settings.interior
    manner = Manner(0.95, interior.central, least=interior.central**2)
    try:
        with np.errstate(all="ignore"):  # what is no number ends it
            programme = Programme.of(course.solver, course.increment.settings)
            here = begin(programme, state)
            method = InteriorSliding(course, programme, manner, float(np.abs(here.state.multipliers).max()))
            return newton(method, Trial(here, np.where(programme.solver.system.tied, CLOSED, OPEN)), limit)[0].found
    except SingularModelError:
        return None


@dataclass(frozen=True)
class Trial:
    """An iteration's end: inside the cones, with the status (n,) that it tells; found: a solution from there, if that is
    one; apart: whether nothing presses any more."""

    here: Interior
    status: Status
    found: Found | None = None
    apart: bool = False


class InteriorSliding(Method[Trial]):
    """Interior points, until Newton's method finds the solution from the status that they tell."""

    def __init__(self, course: Course, programme: Programme, manner: Manner, first: float) -> None:
        self._course, self._programme, self._manner = course, programme, manner
        self._first, self._short = first, 0
        self._few = max(int(course.increment.settings.status.few * len(programme.normal)), 2)

    def advanced(self, here: Trial) -> Trial:
        """As in ``Method``."""
        clock, system, increment = time.perf_counter(), self._programme.solver.system, self._course.increment
        there = iterate(near(self._programme, here.here), self._manner)
        if not np.isfinite(there.state.multipliers).all():
            return Trial(there, here.status)
        wanted = next_status(system, there.state.with_status(here.status), *increment.rounding)
        changed = points(system, wanted != here.status)
        now = there.state.with_status(wanted)
        self._course.add(now, changed, clock)
        close = near(self._programme, there).missed <= largest_pressure(there.state, increment)
        if np.abs(there.state.multipliers).max() < increment.settings.newton.rounding * self._first:
            return Trial(there, wanted, _apart(self._course, self._programme, now), apart=True)
        found = None
        if close and changed <= self._few:
            try:
                found = slid(self._course, now, increment.settings.newton.solutions)
            except SingularModelError:
                found = None
        return Trial(there, wanted, found)

    def ended(self, there: Trial) -> End | None:
        """As in ``Method``."""
        if there.found is not None:
            return End.SOLVED
        if there.apart or not np.isfinite(there.here.state.multipliers).all():
            return End.STALLED
        settings, least = self._course.increment.settings, largest_pressure(there.here.state, self._course.increment)
        self._short = self._short + 1 if there.here.length < 0.05 else 0
        mean = near(self._programme, there.here).mean
        if self._short > settings.newton.patience or mean < (settings.newton.stalled * least) ** 2:
            return End.STALLED
        return None


def _apart(course: Course, programme: Programme, state: State) -> Found | None:
    """A state in which nothing touches, if it is one: where bodies are then makes no difference. Without it
    ``test_press_fits_that_friction_alone_holds`` fails, its hubs of hex8 and tet4."""
    clock, system = time.perf_counter(), programme.solver.system
    state = replace(state, multipliers=np.zeros_like(state.multipliers), status=np.zeros_like(state.status))
    size = system.unit * float(np.abs(state.unknowns).max(initial=0.0))
    if system.tied.any() or system.gap(state)[programme.normal].min() < 0.0:
        return None
    if np.abs(system.unbalanced(state)).max(initial=0.0) > course.increment.settings.newton.balanced * size:
        return None
    course.add(state, 0, clock)
    return course.found(state)

"""One load step with friction: Newton's method on contact and slip together, and interior points where that fails."""

from __future__ import annotations

from collections.abc import Callable, Sequence

import numpy as np
from numpy.typing import NDArray

from abut.errors import SingularModelError
from abut.linear.solver import Prepared
from abut.nonlinear.friction_laws import Status
from abut.nonlinear.friction_newton import Course, newton
from abut.nonlinear.friction_search import search
from abut.nonlinear.iteration import Found, Increment
from abut.problem.linearised import Linearised
from abut.problem.pair import Pair
from abut.solution import Iteration
from abut.solution.state import CLOSED, State


def solve_friction(
    solver: Prepared,
    begin: State,
    increment: Increment,
    limit: int,
    observe: Callable[[Iteration], None],
    earlier: Sequence[Iteration] = (),
) -> Found:
    """Find the state at the end of a load step, from the state ``begin``; limit: of iterations of each method; earlier:
    iterations of the same step before.

    Where nothing converges it ends with the state that breaks the laws least. Raises SingularModelError where not even soft
    contact holds a body."""
    course = Course(solver, increment, list(earlier), observe)
    found, error = None, None
    try:
        found = newton(course, begin.with_status(_completed(solver.system, begin)), limit)
    except SingularModelError as reason:
        error = reason
    found = found or search(course, begin, limit) or course.failed()
    if found is None:
        assert error is not None
        raise error
    return found


def _completed(system: Linearised, state: State) -> Status:
    """The status to begin with: that of the state, and as much more in contact as it takes to hold every body."""
    closed = np.concatenate([np.zeros(0, bool), *map(_whole, system.pairs, system.split(state.closed))])
    wanted = system.restraint.complete(system.forces, closed, system.gap(state)) | system.tied
    return np.where(wanted & ~state.closed, CLOSED, state.status)


def _whole(pair: Pair, closed: NDArray[np.bool_]) -> NDArray[np.bool_]:
    return np.asarray(pair.of_functions(closed[pair.normal])) if pair.frictional else closed

"""Semi-smooth Newton method (primal-dual active set strategy) for one load step."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray

from abut.errors import SingularModelError
from abut.linear.solver import Prepared
from abut.nonlinear.exact import ROUGH, STRIDE, TOLD, Aim, finer, settled, solve_set
from abut.nonlinear.friction import solve_friction
from abut.nonlinear.iteration import Found, Increment, active_laws
from abut.nonlinear.search import Log, search
from abut.nonlinear.smooth_laws import finish_smooth
from abut.solution import Iteration
from abut.solution.state import State

FINE = 1e-5  # reduction of the residual asked of iterative linear solvers once sets repeat
PATIENCE = 3  # iterations without fewer changes than ever that count as a cycle
ROWS = 8  # of a step in which the set should settle, at the pace of the last three: else interior points are quicker
MISLED = 0.25  # share of the active set that changes, and more than before, where a set was foreseen wrongly
SETTLING, SETTLED = 0.1, 6  # the same below which a set that was foreseen well may settle yet, until that row of a step
LAST = 12  # row of a step by which the violation should be gone, at its pace of the last three
HALVED = 0.5  # share of the changes that may be left once a set was foreseen wrongly


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
    state, system = begin, solver.system
    if any(pair.frictional for pair in system.pairs):
        return solve_friction(solver, begin, increment, limit, observe, earlier)
    tied = system.tied
    seen: set[bytes] = set()
    history: list[NDArray[np.bool_]] = []
    log = Log(list(earlier), observe, len(earlier) + limit)
    changes: list[int] = []
    violations: list[float] = []
    foresee, doubtful = True, False
    lawful: NDArray[np.bool_] | None = None  # set that the law asked for, where another one was foreseen
    finest, before = ROUGH, np.inf
    accuracy = STRIDE if settle else ROUGH
    if state.closed.all() and not settle:
        accuracy = 0.1 * solver.accurate  # closed all over may well be the answer
    while not log.full:
        try:
            solved = solve_set(solver, state, increment, tied, log.next, accuracy)
        except SingularModelError:
            _check_balance(solver)
            if tied.all() or aim == "this set":
                raise
            return search(solver, begin, increment, limit, log, tied, aim)
        log.add(solved.row)
        state, wanted, changed = solved.state, solved.wanted, solved.changed
        active = state.closed
        history.append(active)
        if not changed.any():
            if settled(solver, solved, aim, before):
                if aim == "set":
                    return Found(state, tuple(log.done), True, changed, active_laws)
                return finish_smooth(solver, state, increment, limit, log.done, observe)
            accuracy, before = finer(solver, solved, aim), solved.error
            continue
        before = np.inf
        if aim == "this set":
            break
        count = int(changed.sum())
        misled = lawful is not None and count > max(changes[-1], MISLED * active.sum())
        if misled and lawful is not None:  # back to what the law asked for, and no more foresight
            seen.add(active.tobytes())
            state, lawful, foresee, doubtful = state.with_closed(lawful), None, False, True
            continue
        changes.append(count)
        violations.append(float(solved.violation.max()))
        gap = system.gap(state)
        rows = len(log.done) - len(earlier)
        lawful = None
        if foresee:
            guess = solver.foresee(gap, state.multipliers, wanted, tied)
            if guess.tobytes() not in {*seen, active.tobytes()}:
                told = solver.exact or solved.error <= TOLD
                lawful, wanted = wanted if told else None, guess
        accuracy = finest
        stuck = np.array_equal(system.restraint.complete(system.forces, wanted, gap) | tied, active)
        seen.add(active.tobytes())
        repeated = stuck or wanted.tobytes() in seen
        settling = foresee and count <= SETTLING * active.sum() and rows < SETTLED
        settling = settling or closing(violations, rows)
        slow = repeated or (hopeless(changes, rows) and not settling) or (doubtful and count >= HALVED * changes[-2])
        doubtful = False
        if slow:
            _check_balance(solver)
        if repeated and not stuck and not solver.exact and finest > FINE:
            accuracy = finest = FINE  # sets may repeat because they were not solved well enough
            seen.clear()
        elif slow:
            return search(solver, begin, increment, limit, log, tied, aim)
        state = state.with_closed(wanted)
    recent = np.stack(history[-6:])
    cycling = (recent.any(axis=0) & ~recent.all(axis=0)) | changed
    return Found(state.with_closed(active), tuple(log.done), False, cycling, active_laws)


def stalled(changes: Sequence[int]) -> bool:
    """Whether for some iterations as many multipliers changed as ever before. changes: how many in each."""
    return len(changes) > PATIENCE and min(changes[-PATIENCE:]) >= min(changes[:-PATIENCE])


def hopeless(changes: Sequence[int], rows: int) -> bool:
    """Whether the set will take too many more iterations, if any number is enough. rows: those of the step so far."""
    if len(changes) <= PATIENCE:
        return False
    pace = np.log(changes[-1 - PATIENCE] / changes[-1]) / PATIENCE
    return stalled(changes) or bool(np.log(changes[-1]) > max(ROWS - rows, 1) * pace)


def closing(violations: Sequence[float], rows: int) -> bool:
    """Whether the law's largest violation falls so evenly that it will soon be gone: an edge of contact that goes back facet
    by facet, theory (V9). rows: those of the step so far."""
    last = violations[-1 - PATIENCE :]
    if len(last) <= PATIENCE or any(after >= before for before, after in pairwise(last)):
        return False
    return rows + last[-1] * PATIENCE / (last[0] - last[-1]) <= LAST


def _check_balance(solver: Prepared) -> None:
    """Raises SingularModelError where no contact that only pushes balances the loads, and names what they move."""
    motion = solver.system.restraint.unbalanced(solver.system.forces)
    if motion:
        raise SingularModelError(
            f"{motion}: the loads pull it off its contact; constrain it by a support or reverse the load"
        )

"""One load step: the search for the contact status, and with "dual-P1" a second one with ordinary functions inside."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from abut.contact.coupling import surface_degree
from abut.contact.pressure_space import DUAL_P1
from abut.linear.solver import Prepared
from abut.nonlinear.attempt import Attempt as Attempt
from abut.nonlinear.iteration import Found, largest_so_far
from abut.nonlinear.newton import Task, newton
from abut.problem.balance import Balance
from abut.problem.problem import Problem
from abut.solution import Iteration


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
        found, solver = newton(replace(task, problem=inner), begin, prepared, aim="this set")
        if found.converged:
            return _ended(replace(task, problem=inner), time, found, solver, begin.closed)
        earlier = found.iterations
        begin = found.state.with_closed(begin.closed & ~found.cycling)
    found, prepared = newton(task, begin, prepared, earlier, "set" if search else "solution")
    inside = found.state.closed
    inner = problem.with_ordinary(inside) if found.converged else problem
    if inner is problem and (not (found.converged and search) or (prepared.exact and not smooth)):
        return _ended(task, time, found, prepared, none)
    task = replace(task, problem=inner)
    found, prepared = newton(task, found.state, prepared, found.iterations, settle=True)
    return _ended(task, time, found, prepared, none if inner is problem else inside)


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

"""The search that takes over where Newton's method with friction fails: interior points, then Newton from their status."""

from __future__ import annotations

import time
from dataclasses import replace

import numpy as np

from abut.errors import SingularModelError
from abut.nonlinear.friction_interior import Manner, Programme, begin, iterate, near
from abut.nonlinear.friction_newton import Course, newton, next_status
from abut.nonlinear.iteration import Found, largest_pressure, points
from abut.solution.state import CLOSED, OPEN, State

BOLD, CAREFUL, CONVEX = Manner(0.95, 1e-3), Manner(0.7, 0.05), Manner(0.95, 1e-3, dilates=True)
FEW = 0.02  # share of the multipliers that may change in an iteration for Newton's method to be worth a try
NEWTON = 15  # iterations of a try at most, as long as it gets better
CLOSE = 1.0  # difference between gaps and what they are to be, over the largest pressure, likewise
LESS = 0.3  # of the dilatancy that is left by an iteration that close
NONE = 1e-3  # dilatancy that is none
STUCK, SHORT = 4, 0.05  # iterations in a row whose steps are shorter than that
GONE = 1e-12  # of the largest pressure over that of the start, from which down nothing is pressed
FORCE_LEFT = 1e-9  # of forces over those that would hold a node where it was
FLOOR = 1e-14  # of the mean product over the largest pressure squared


def search(course: Course, state: State, limit: int) -> Found | None:
    """The solution of a load step from anywhere; None where none of the ways to it finds one. limit: of iterations of each.

    Newton's method ends it as soon as interior points tell the status of most multipliers."""
    for manner in (BOLD, CAREFUL, CONVEX):
        try:
            with np.errstate(all="ignore"):  # what is no number ends it
                found = _interior(course, state, manner, limit)
        except SingularModelError:
            continue
        if found is not None:
            return found
    return None


def _interior(course: Course, state: State, manner: Manner, limit: int) -> Found | None:
    programme = Programme.of(course.solver)
    here = begin(programme, state, manner)
    before = np.where(programme.solver.system.tied, CLOSED, OPEN)
    few = max(int(FEW * len(programme.normal)), 2)
    short, first = 0, np.abs(here.state.multipliers).max()
    for _ in range(limit):
        clock = time.perf_counter()
        here = iterate(near(programme, here), manner)
        if not np.isfinite(here.state.multipliers).all():
            return None
        wanted = next_status(programme.solver.system, here.state.with_status(before), course.increment)
        changed, before = points(programme.solver.system, wanted != before), wanted
        now = here.state.with_status(wanted)
        course.add(now, changed, clock)
        at = near(programme, here)
        largest = largest_pressure(here.state, course.increment)
        close = at.missed <= CLOSE * largest
        if close:
            here = replace(here, dilatancy=LESS * here.dilatancy if here.dilatancy > NONE else 0.0)
        if np.abs(here.state.multipliers).max() < GONE * first:
            return _apart(course, programme, now)
        if close and changed <= few and not here.dilatancy:
            try:
                found = newton(course, now, NEWTON, patience=2)
            except SingularModelError:
                found = None
            if found is not None:
                return found
        short = short + 1 if here.length < SHORT else 0
        if short >= STUCK or at.mean < FLOOR * largest**2:
            return None
    return None


def _apart(course: Course, programme: Programme, state: State) -> Found | None:
    """A state in which nothing touches, if it is one: where bodies are then makes no difference."""
    clock, system = time.perf_counter(), programme.solver.system
    state = replace(state, multipliers=np.zeros_like(state.multipliers), status=np.zeros_like(state.status))
    size = system.unit * float(np.abs(state.unknowns).max(initial=0.0))
    if system.tied.any() or system.gap(state)[programme.normal].min() < 0.0:
        return None
    if np.abs(system.unbalanced(state)).max(initial=0.0) > FORCE_LEFT * size:
        return None
    course.add(state, 0, clock)
    return course.found(state)

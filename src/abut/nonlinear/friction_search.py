"""The search that takes over where Newton's method with friction fails: interior points, then Newton from their status."""

from __future__ import annotations

import time
from dataclasses import replace

import numpy as np

from abut.errors import SingularModelError
from abut.nonlinear.friction_laws import next_status
from abut.nonlinear.friction_newton import Course, newton
from abut.nonlinear.interior_point import Manner, Programme, begin, iterate, near
from abut.nonlinear.iteration import Found, largest_pressure, points
from abut.nonlinear.settings import Settings
from abut.solution.state import CLOSED, OPEN, State


def search(course: Course, state: State, limit: int) -> Found | None:
    """The solution of a load step from anywhere; None where none of the ways to it finds one. limit: of iterations of each.

    Newton's method ends it as soon as interior points tell the status of most multipliers."""
    interior = course.increment.settings.interior
    bold = Manner(0.95, interior.central, least=interior.central**2)
    for manner in (bold, replace(bold, boundary=0.7, central=50.0 * interior.central), replace(bold, dilates=True)):
        try:
            with np.errstate(all="ignore"):  # what is no number ends it
                found = _interior(course, state, manner, limit)
        except SingularModelError:
            continue
        if found is not None:
            return found
    return None


def _interior(course: Course, state: State, manner: Manner, limit: int) -> Found | None:
    settings = course.increment.settings
    programme = Programme.of(course.solver, settings)
    here = begin(programme, state, manner)
    before = np.where(programme.solver.system.tied, CLOSED, OPEN)
    few = max(int(settings.status.few * len(programme.normal)), 2)
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
        close = at.missed <= largest
        if close:
            here = replace(here, dilatancy=_faded(here.dilatancy, settings))
        if np.abs(here.state.multipliers).max() < settings.newton.rounding * first:
            return _apart(course, programme, now)
        if close and changed <= few and not here.dilatancy:
            try:
                found = newton(course, now, settings.newton.solutions)
            except SingularModelError:
                found = None
            if found is not None:
                return found
        short = short + 1 if here.length < 0.05 else 0
        if short > settings.newton.patience or at.mean < settings.interior.floor * largest**2:
            return None
    return None


def _faded(dilatancy: float, settings: Settings) -> float:
    """What is left of it by an iteration close to what gaps and slips are to be."""
    return settings.interior.fade * dilatancy if dilatancy > settings.interior.met else 0.0


def _apart(course: Course, programme: Programme, state: State) -> Found | None:
    """A state in which nothing touches, if it is one: where bodies are then makes no difference."""
    clock, system = time.perf_counter(), programme.solver.system
    state = replace(state, multipliers=np.zeros_like(state.multipliers), status=np.zeros_like(state.status))
    size = system.unit * float(np.abs(state.unknowns).max(initial=0.0))
    if system.tied.any() or system.gap(state)[programme.normal].min() < 0.0:
        return None
    if np.abs(system.unbalanced(state)).max(initial=0.0) > course.increment.settings.newton.balanced * size:
        return None
    course.add(state, 0, clock)
    return course.found(state)

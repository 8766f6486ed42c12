"""What contacts bring into a load step, and what it leaves of them."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from abut.problem.discretised import Discretised
from abut.problem.edge_functions import handed_over
from abut.problem.frame import Frame
from abut.problem.linearised import Linearised
from abut.problem.step_error import PairEnd, landed
from abut.solution.state import ContactHistory, History, State

Array = NDArray[np.float64]


def started(problem: Discretised, rest: State) -> State:
    """The state at rest with what touches there closed, and what contacts remember of it."""
    contacts, closed = {}, [np.zeros(0, dtype=bool)]
    for kind, placed in zip(problem.kinematics, problem.placed(rest)):
        known = ContactHistory(past=kind.past(placed.displacement, placed.closed))
        part = replace(kind.frame(known, placed, None), following=None)
        closed.append(kind.touching(placed, part))
        past = kind.past(placed.displacement, closed[-1])
        contacts[kind.pair.contact.name] = ContactHistory(past=past, inner=part.inner, fit=part.fit)
    return replace(rest.with_closed(np.concatenate(closed)), history=History(contacts=contacts))


def begun(problem: Discretised, before: State, guess: State | None) -> Frame:
    """As ``Problem.frame``."""
    near = [None] * len(problem.pairs) if guess is None else problem.placed(guess)
    parts = zip(problem.kinematics, problem.placed(before), near)
    return Frame(
        tuple(kind.frame(before.history.contact(kind.pair.contact.name), here, there) for kind, here, there in parts)
    )


def settled(problem: Discretised, before: State, frame: Frame, end: State) -> Frame:
    """As ``ContactProblem.settled``."""
    parts = zip(problem.kinematics, frame.pairs, problem.placed(before), problem.placed(end))
    pairs = tuple(kind.settled(part, here, there) for kind, part, here, there in parts)
    return frame if all(new is old for new, old in zip(pairs, frame.pairs)) else replace(frame, pairs=pairs)


def ended(problem: Discretised, before: State, state: State) -> Frame:
    """The frame in which the step from ``before`` ended in ``state``."""
    parts = []
    for kind, placed in zip(problem.kinematics, problem.placed(before)):
        was, known = (each.history.contact(kind.pair.contact.name) for each in (before, state))
        parts.append(kind.ended(was, known, placed))
    return Frame(tuple(parts))


def handed(problem: Discretised, state: State, old: Frame, new: Frame) -> State:
    """As ``ContactProblem.handed``."""
    values, status, changed = [np.zeros(0)], [np.zeros(0, np.int8)], False
    parts = zip(old.pairs, new.pairs, problem.split(state.multipliers), problem.split(state.status))
    for pair, (was, now, multipliers, touching) in zip(problem.pairs, parts):
        to, known = now.following, was.following
        same = to is None or (known is not None and np.array_equal(to, known))
        changed = changed or not same
        for held, part in ((values, multipliers), (status, touching)):
            held.append(part if to is None or same else handed_over(pair, part, known, to))
    return replace(state, multipliers=np.concatenate(values), status=np.concatenate(status)) if changed else state


def remembered(
    problem: Discretised, before: State, frame: Frame, now: State, system: Linearised
) -> dict[str, ContactHistory]:
    """What contacts remember of the step from ``before`` to ``now``, near which the problem is ``system``, by name."""
    result, slid = {}, slips(problem, before, frame, now, system)
    parts = frame.pairs, problem.placed(now), problem.split(now.slipping), problem.split(~before.closed)
    for kind, part, end, slipping, opened in zip(problem.kinematics, *parts):
        share, name = None, kind.pair.contact.name
        if part.past is not None:
            closing = PairEnd(end.multipliers, end.closed, slipping, opened, part.past.shift)
            force = landed(kind.pair, closing, system.factors)
            share = force.unsure, force.limit
        past = kind.past(end.displacement, end.closed)
        result[name] = ContactHistory(slid.get(name), past, part.inner, part.following, part.fit, share, part.began)
    return result


def slips(problem: Discretised, before: State, frame: Frame, now: State, system: Linearised) -> dict[str, Array]:
    """Of each pair with friction by name, as in ``ContactHistory``."""
    if not any(pair.frictional for pair in problem.pairs):
        return {}
    result, gaps = {}, system.gap(now)
    forgotten = np.zeros(len(gaps), bool) if system.forgotten is None else system.forgotten
    gaps = np.where(forgotten, 0.0, gaps)  # what has no past has nothing to slip from
    states = problem.split(gaps), problem.split(now.closed), problem.split(forgotten), frame.pairs
    for pair, gap, closed, new, part in zip(problem.pairs, *states):
        if pair.frictional:
            step, came = gap / pair.weight, np.zeros(len(pair))
            step[pair.normal] = 0.0
            earlier = before.history.contact(pair.contact.name).slips
            total = np.zeros(len(pair)) if earlier is None else earlier[:, 1]
            if part.approached is not None:
                came[pair.tangential] = part.approached / pair.weight[pair.tangential]
            result[pair.contact.name] = np.column_stack([step, total + np.where(closed, step, 0.0), came, new])
    return result

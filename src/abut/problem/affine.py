"""Contact looked at where bodies were: gaps and slips are affine in the displacements."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from abut.model.conditions import weights
from abut.problem.approach import approach_slip
from abut.problem.discretised import Discretised, unit_of
from abut.problem.frame import Frame, PairFrame
from abut.problem.linearised import Linearised
from abut.problem.pair import TOUCHING
from abut.problem.terms import added_up
from abut.solution.state import State

Array = NDArray[np.float64]


def touching(problem: Discretised) -> NDArray[np.bool_]:
    """(n,) multipliers that touch at the outset."""
    offset = _offset(problem, np.zeros(len(problem.model.histories)), Frame(()))
    closed = [np.zeros(0, dtype=bool)]
    for pair, gap in zip(problem.pairs, problem.split(offset)):
        near = gap <= TOUCHING * pair.size * pair.weight
        closed.append(pair.of_functions(near[pair.normal]) if pair.frictional else pair.two_way | near)
    return np.concatenate(closed)


def frame(problem: Discretised, before: State) -> Frame:
    """With friction, from where the next step's slip counts, theory (R3): tangential jumps in a converged state, and what
    is open moved on until it closes."""
    if not any(pair.frictional for pair in problem.pairs):
        return Frame(tuple(PairFrame() for _ in problem.pairs))
    factors = weights(problem.model.histories, before.time)
    result, parts = [], (problem.split(before.multipliers), problem.split(before.closed))
    for pair, multipliers, closed in zip(problem.pairs, *parts):
        if not pair.frictional:
            result.append(PairFrame())
            continue
        gap = pair.gap + pair.operator @ before.unknowns + pair.prescribed @ factors
        came = approach_slip(pair, gap, multipliers, closed)
        result.append(PairFrame(slipped=gap[pair.tangential] + came, approached=came))
    return Frame(tuple(result))


def linearised(problem: Discretised, before: State, frame: Frame, now: State) -> Linearised:
    """The problem near the state ``now``."""
    began, here = (problem.values(state) for state in (before, now))
    there = problem.motion(before.time, began, before.rates)
    motion = problem.motion(now.time, here, problem.rates(before, now.time, here))
    shares = problem.shares(before, there, motion, frame)
    factors = weights(problem.model.histories, now.time)
    n, largest = problem.constraints.free.shape[0], 0.0
    force = problem.constraints.forces(added_up([share.force for share in shares], len(here)))
    if problem.stiffness is not None:
        stiffness, load = problem.stiffness, -force
    else:
        tangents = [share.tangent.reduce(problem.constraints) for share in shares if share.tangent is not None]
        stiffness = problem.springs.added_to(sum(tangents[1:], tangents[0]))
        load = stiffness @ now.unknowns - force - problem.springs.forces(now.unknowns)
        largest = max(float(np.abs(share.force[:n]).max(initial=0.0)) for share in shares)
    return Linearised(
        now.time, factors, stiffness, load, problem.pairs, problem.operator, _offset(problem, factors, frame),
        problem.motions, problem.restraint, load, problem.unit or unit_of(stiffness),
        shares={} if problem.stiffness is not None else problem.named(shares),
        sizes=problem.sizes(shares, (before, now), stiffness),
        even=problem.constraints.others is None or all(share.symmetric for share in shares),
        largest=largest,
    )  # fmt: skip


def _offset(problem: Discretised, factors: Array, frame: Frame) -> Array:
    """Weighted gaps (n,) without free displacements, theory (F9), with the histories at ``factors``, slips from where they
    count in a frame."""
    gaps = [pair.gap + pair.prescribed @ factors for pair in problem.pairs]
    for pair, gap, part in zip(problem.pairs, gaps, frame.pairs):
        if part.slipped is not None:
            gap[pair.tangential] -= part.slipped
    return np.concatenate(gaps) if gaps else np.zeros(0)


def slips(problem: Discretised, before: State, frame: Frame, now: State, system: Linearised) -> dict[str, Array]:
    """Slip of each pair with friction by name, as in ``ContactHistory``, of the step from ``before`` to ``now``, near which
    the problem is ``system``."""
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

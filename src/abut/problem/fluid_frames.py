"""Fluids of pressure penetration in the frame of a step: what it begins with, and what belongs to its end."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from abut.problem.discretised import Discretised
from abut.problem.frame import Frame
from abut.problem.penetrations import Penetrations
from abut.problem.wetting import TERM, settled
from abut.solution.state import State


def fluids(problem: Discretised) -> Penetrations | None:
    """None where there are none."""
    return next((term for term in problem.terms if isinstance(term, Penetrations)), None)


def begun(problem: Discretised, frame: Frame, state: State) -> Frame:
    """The frame with what the fluids wet in a converged state."""
    term = fluids(problem)
    return frame if term is None else replace(frame, wet=term.begun(state.history.of(TERM)))


def spread(problem: Discretised, frame: Frame, end: State) -> Frame:
    """The frame with what the fluids wet at the end of a step in ``frame``; the same object where that is what it has."""
    term = fluids(problem)
    if term is None:
        return frame
    parts = problem.split(end.multipliers), problem.split(end.closed)
    points = problem.model.mesh.points
    if problem.model.finite:
        points = points + problem.displacement(end).reshape(points.shape)
    wet = tuple(
        settled(
            wetting, problem.pairs[wetting.pair], was, parts[0][wetting.pair],
            np.asarray(parts[1][wetting.pair], dtype=bool), end.time, points,
        )
        for wetting, was in zip(term.wettings, frame.wet)
    )  # fmt: skip
    return frame if all(new is old for new, old in zip(wet, frame.wet)) else replace(frame, wet=wet)

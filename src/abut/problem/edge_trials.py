"""Ordinary functions in place of dual ones at edges where both sides end, at large sliding, theory (P26): tried, and kept
where nothing presses then. A clamp may be held as a plane of symmetry is: only that solution tells them apart."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from abut.contact.flush_edges import FlushEdges
from abut.contact.pressure_space import PressureSpace
from abut.problem.frame import Frame, PairFrame

DUAL, INNER, TRIED, REFUSED = 0.0, 1.0, 2.0, -1.0  # of a facet in ``PairFrame.inner``
Array = NDArray[np.float64]


def trials(
    space: PressureSpace, flush: FlushEdges, known: Array, closed: NDArray[np.bool_], apart: NDArray[np.bool_]
) -> Array:
    """What the end of a step makes of ``known``, both (n_facets,): dual functions that are closed alone at an edge give way,
    and come back for the rest of the step where ordinary ones press, or let the sides into each other.

    closed: (n_functions,); apart: (n_facets,) with the sides apart everywhere."""
    refused = (known == TRIED) & (flush.touched(space, closed) | ~apart)
    if refused.any():  # what else is closed then may not be with dual functions
        return np.where(refused, REFUSED, known)
    return np.where((known == DUAL) & flush.facets(space, closed), TRIED, known)


def anew(known: Array | None) -> Array | None:
    """For the next step, in which what was refused may be tried again."""
    return None if known is None else np.where(known == REFUSED, DUAL, known)


def on_trial(frame: Frame) -> bool:
    """Whether ordinary functions are tried anywhere."""
    return any(part.inner is not None and (part.inner == TRIED).any() for part in frame.pairs)


def refuses(old: Frame, new: Frame) -> bool:
    """Whether ordinary functions that were tried in a frame are refused in another."""
    return any(_refusing(one, other) is not one for one, other in zip(old.pairs, new.pairs))


def with_refused(frame: Frame, new: Frame) -> Frame:
    """A frame with the refusals of another; the same object where there are none."""
    pairs = tuple(_refusing(one, other) for one, other in zip(frame.pairs, new.pairs))
    return frame if all(one is other for one, other in zip(pairs, frame.pairs)) else replace(frame, pairs=pairs)


def _refusing(old: PairFrame, new: PairFrame) -> PairFrame:
    if old.inner is None or new.inner is None:
        return old
    refused = (old.inner == TRIED) & (new.inner == REFUSED)
    return replace(old, inner=np.where(refused, REFUSED, old.inner)) if refused.any() else old

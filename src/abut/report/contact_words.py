"""A contact's pressure and resultant in words and numbers, for the end of a run and for the report."""

from __future__ import annotations

import math
from collections.abc import Iterable

import numpy as np
from numpy.typing import NDArray

from abut.contact.sides import words
from abut.solution import ContactResult, FrictionResult

ZERO = 1e-9  # of its scale: smaller numbers are rounding, and shown as 0


def number(value: float) -> str:
    """A number as a person reads it: six digits at most."""
    return f"{value:.6g}" if math.isfinite(value) else "none"


def vector(values: Iterable[float], scale: float = 0.0) -> str:
    """Numbers in brackets; those that are rounding beside ``scale`` as 0."""
    return "(" + ", ".join(number(0.0 if abs(value) < ZERO * scale else value) for value in values) + ")"


def place(contact: ContactResult) -> str:
    """Where the largest pressure is, "none" where nothing is in contact."""
    return _point(contact.statistics.place, contact)


def centre(contact: ContactResult) -> str:
    """The centre of pressure, "none" where there is none."""
    return _point(contact.resultant.centre, contact)


def force(contact: ContactResult) -> str:
    """The resultant on the side named first; 0 where forces cancel, as round a press fit."""
    return vector(contact.force, float(np.linalg.norm(contact.contactor_forces, axis=1).sum()))


def moment(contact: ContactResult) -> str:
    """The moment on the side named first about the origin."""
    sizes = np.linalg.norm(contact.contactor_forces, axis=1)
    return vector(contact.resultant.moment, float(sizes.sum()) * _extent(contact))


def on_bodies(contact: ContactResult) -> str:
    """The forces on the bodies of the side named second, where it belongs to several; else nothing."""
    if len(contact.body_forces) < 2:
        return ""
    scale = float(np.linalg.norm(contact.contactor_forces, axis=1).sum())
    return ", ".join(f"{body} {vector(force, scale)}" for body, force in contact.body_forces.items())


def lines(contact: ContactResult) -> list[str]:
    """What comes after the force and the largest pressure, line by line."""
    s, result = contact.statistics, []
    if math.isfinite(s.mean):
        result.append(
            f"largest at {place(contact)}, mean {number(s.mean)}, below {number(s.percentile_95)} on 95 % of the area"
        )
    if math.isfinite(s.partly_covered):
        result.append(f"where nodes are less than half covered up to {number(s.partly_covered)}, which counts nowhere")
    if contact.friction is not None:
        result.append(friction_line(contact.friction))
    if np.isfinite(contact.resultant.centre).all():
        result.append(f"centre of pressure {centre(contact)}, moment about the origin {moment(contact)}")
    if some := on_bodies(contact):
        result.append(f"force on the bodies of {words(contact.named[1])}: {some}")
    return result


def friction_line(friction: FrictionResult) -> str:
    """What friction does, in a sentence."""
    limit = f" of at most {number(friction.force_limit)}" if math.isfinite(friction.force_limit) else ""
    return (
        f"sticks on {number(friction.sticking_area)} and slips on {number(friction.slipping_area)} of the area, carries "
        f"{number(friction.force_by_area)}{limit} by area, takes {number(friction.work)} of work in the step"
    )


def _point(values: NDArray[np.float64], contact: ContactResult) -> str:
    return vector(values, _extent(contact)) if np.isfinite(values).all() else "none"


def _extent(contact: ContactResult) -> float:
    """Largest coordinate of the contactor, or extent where that is more."""
    x = contact.contactor.points[contact.contactor.node_ids]
    return float(max(np.abs(x).max(), np.ptp(x, axis=0).max()))

"""What the line "pressure error" does not see from place to place: by how much pressures are too high all over, since bodies
of cells are stiffer than bodies; theory (Z8)."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

from abut.model import Model
from abut.solution import Check, ContactResult
from abut.solution.driven import forces_act
from abut.solution.stress_error import StressError

LINE = "pressure error"


def with_mean(contacts: Sequence[ContactResult], model: Model, error: StressError | None) -> tuple[ContactResult, ...]:
    """Contacts that are closed all over, of bodies that are fitted, moved or heated and not loaded, with that share of their
    mean pressure in the line; others as they are."""
    if error is None or forces_act(model):
        return tuple(contacts)
    return tuple(
        replace(c, checks=tuple(_added(check, error.stiffer * c.statistics.mean) for check in c.checks))
        if c.active == c.multipliers
        else c
        for c in contacts
    )


def _added(check: Check, pressure: float) -> Check:
    if check.name != LINE or check.unknown or not check.pressure > 0.0:
        return check
    return replace(check, value=check.value + pressure / check.pressure)

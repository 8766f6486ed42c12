"""Friction that a step leaves out, since points have only just come opposite the other side, is said."""

from __future__ import annotations

from dataclasses import replace

import abut
from models.sliding import sharp


def left_out(model: abut.Model) -> list[float]:
    solution = abut.solve(model)
    assert solution.converged
    return [check.value for check in solution.certificate if check.name.endswith("friction left out")]


def test_nodes_that_come_under_a_sharp_edge() -> None:
    """A plate's nodes carry no friction in the step in which they come under the block's edge, where the pressure peaks."""
    (share,) = left_out(sharp(0.3, 9))
    assert share > 0.02  # the limit of the line


def test_a_contactor_that_stays_opposite_its_target() -> None:
    model = sharp(0.3, 9)
    (contact,) = model.contacts
    assert not left_out(replace(model, contacts=[replace(contact, contactor=contact.target, target=contact.contactor)]))

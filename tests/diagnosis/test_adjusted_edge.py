"""``adjust`` that ends within the contact of a curved surface: its step is pressed through, and the cure says so."""

from __future__ import annotations

import numpy as np
import pytest

import abut
from abut.diagnosis.cures import cures
from abut.mesh.make import join, rectangle
from models.sliding import bent

RADIUS, PRESSED = 5.0, 0.02


def arc(adjust: float, kinematics: str = "small", cells: int = 24) -> abut.Solution:
    """A block with a round bottom pressed on another: contact is 0.28 wide to each side, where the gap was 0.008."""

    def rounded(points: np.ndarray) -> np.ndarray:
        x, y = points.T
        return np.column_stack([x, (1.0 - y) * (RADIUS - np.sqrt(RADIUS**2 - x**2)) + y])

    mesh = join({
        "arc": bent(rectangle((-1.0, 1.0), (0.0, 1.0), (cells, 8), "quad4"), rounded),
        "block": rectangle((-2.0, 2.0), (-2.0, 0.0), (2 * cells + 6, 10), "quad4"),
    })  # fmt: skip
    return abut.solve(abut.Model(
        mesh, [abut.Solid(body, abut.LinearElastic(1e3, 0.3)) for body in mesh.bodies],
        [abut.Support("block.bottom", x=0.0, y=0.0), abut.Support("arc.top", x=0.0, y=-PRESSED)],
        contacts=[
            abut.Contact(contactor="arc.bottom", target="block.top", adjust=adjust)], plane="strain", kinematics=kinematics,
    ))  # fmt: skip


def ringing(solution: abut.Solution) -> list[str]:
    return [text for check, text in cures(solution) if check.name == "oscillation"]


@pytest.mark.long
@pytest.mark.parametrize("adjust", [0.0, 0.2])
@pytest.mark.parametrize("kinematics", ["small", "finite"])
def test_no_step_within_the_contact_passes(kinematics: str, adjust: float) -> None:
    """Without ``adjust``, and with more than any gap, as if the arc had been flat."""
    assert ringing(arc(adjust, kinematics)) == []


def test_a_step_within_the_contact_is_named() -> None:
    """The pressure at the step is that of a sharp edge: it grows as facets shrink, and is no fault of the mesh."""
    solution = arc(0.005)
    (text,) = ringing(solution)
    assert text.startswith("where adjust = 0.005 ends within the contact it leaves a step")
    finer = arc(0.005, cells=48).contacts[0].max_pressure
    assert finer > 1.3 * solution.contacts[0].max_pressure > 1.7 * arc(0.0).contacts[0].max_pressure

"""The area of contact, whose edge lies within facets: theory (P30)."""

from __future__ import annotations

from dataclasses import replace
from itertools import pairwise

import numpy as np
import pytest
from scipy.integrate import quad

import abut
from abut.analysis.loaded_area import edge_average
from abut.benchmarks.punches import BENCHMARKS
from abut.solution import ContactResult
from models.stresses import HALF_WIDTH, RADIUS, hertz_ball, hertz_line


def only_contact(model: abut.Model) -> ContactResult:
    return abut.solve(model).contacts[0]


@pytest.mark.parametrize("reach", [-1.5, -0.7, -0.5, 0.0, 0.3, 0.5, 1.5, 2.7])
def test_averages_beside_the_edge_of_contact(reach: float) -> None:
    pressed = [t for t in (-1.0, 0.0, min(1.0, reach)) if t <= reach]
    pieces = pairwise(pressed)
    parts = (quad(lambda t: (1.0 - abs(t)) * np.sqrt(reach - t), *ends)[0] for ends in pieces)
    assert edge_average(np.array(reach)) == pytest.approx(sum(parts), abs=1e-9)


@pytest.mark.parametrize("cell", ["tri3", "quad4", "tri6", "quad8", "quad9"])
@pytest.mark.parametrize("n", [6, 8, 12, 24])
def test_width_of_a_line_contact(cell: str, n: int) -> None:
    """Within a fifth of a facet at each end, however much of the last facets is loaded: counted by nodes it is whole facets,
    on those of second order two more than there are."""
    contact = only_contact(hertz_line(cell, n))
    assert contact.area == pytest.approx(2.0 * HALF_WIDTH, abs=0.4 / n)
    assert contact.statistics.area == pytest.approx(contact.area, rel=1e-12)


@pytest.mark.parametrize(
    ("cell", "n"), [("hex8", 5), ("tet4", 5), ("hex20", 3), ("hex27", 3), ("tet10", 3), ("quad8", 4)]
)
def test_radius_of_contact_under_a_ball(cell: str, n: int) -> None:
    """Within a fifth of a facet, where whole facets make the area 6 to 35 % too large. 0.9 n facets on the radius."""
    turns = 1.0 if cell == "quad8" else 0.25
    radius = np.sqrt(only_contact(hertz_ball(cell, n)).area / (turns * np.pi))
    assert radius == pytest.approx(RADIUS, abs=0.2 * RADIUS / (0.9 * n))


def test_a_punch_is_loaded_all_over() -> None:
    """Its pressure is singular at the edge: points beside that carry little beside their neighbours, and are not at the edge
    of contact. A rigid flat punch of radius 1 on a half space, axisymmetric."""
    flat = next(each for each in BENCHMARKS if each.name == "punch-flat")
    contact = only_contact(flat.model(0))
    assert contact.area == pytest.approx(np.pi, rel=1e-9)


def test_stick_and_slip_make_up_the_area() -> None:
    model = hertz_line("quad4", 12)
    rough = abut.Contact("block.top", "cylinder.round", friction=0.3)
    contact = only_contact(replace(model, contacts=[rough]))
    assert contact.friction is not None
    assert contact.friction.sticking_area + contact.friction.slipping_area == pytest.approx(contact.area, rel=1e-9)

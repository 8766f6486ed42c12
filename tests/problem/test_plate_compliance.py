"""Compliance of plates that a bolt clamps, by its shortening, against the deformation cone of VDI 2230."""

from __future__ import annotations

from math import log, pi

import pytest

import abut
from abut.benchmarks.preloads import STEEL, clamped_plates, compliance

CONE = 0.05  # the cone stands for a field: VDI's fit of it, and a head that is rigid and smooth here
BOLT, CLAMPED, HEAD, HOLE = 10.0, 30.0, 14.63, 11.0  # M10


def cone(clamped: float, head: float, hole: float, outer: float) -> float:
    """Of a bolt with a nut, plates as wide as the cone or wider."""
    tangent = 0.362 + 0.032 * log(clamped / head / 2.0) + 0.153 * log(outer / head)
    wide = head + clamped * tangent
    assert outer >= wide
    ratio = (head + hole) * (wide - hole) / ((head - hole) * (wide + hole))
    return 2.0 * log(ratio) / (STEEL * pi * hole * tangent)


@pytest.mark.parametrize("outer", [30.0, HEAD + CLAMPED, 100.0, 200.0])
def test_plates_of_an_m10_bolt(outer):
    """Wider than head and clamped length together, plates count as if they were as wide: material farther out than cones of
    45 degrees takes no part, while the logarithm of VDI's fit goes on (to 28 % too stiff at 200)."""
    solution = abut.solve(clamped_plates(BOLT, CLAMPED, HEAD, HOLE, outer))
    counted = min(outer, HEAD + CLAMPED)
    assert compliance(solution, BOLT, CLAMPED) == pytest.approx(cone(CLAMPED, HEAD, HOLE, counted), rel=CONE)

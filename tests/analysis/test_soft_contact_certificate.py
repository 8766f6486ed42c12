"""Soft contact overlaps because its law says so: no error of the mesh, which the certificate would have to tell."""

from __future__ import annotations

from dataclasses import replace

import pytest

import abut
from abut.mesh.make import half_disc, join, rectangle

STEEL = abut.LinearElastic(210e3, 0.3)
MESH = join({"a": rectangle([0, 10], [0, 10], [4, 4], "quad4"), "b": rectangle([0, 10], [10, 20], [3, 3], "quad8")})
PRESSED = abut.Model(
    MESH, [abut.Solid("a", STEEL), abut.Solid("b", STEEL)],
    [*(abut.Support(f"{body}.left", x=0) for body in "ab"), abut.Support("a.bottom", y=0), abut.Support("b.top", y=-0.05)],
    contacts=[abut.Contact("a.top", "b.bottom", law=abut.PressureOverclosure([(0.0, 0.0), (0.02, 10.0), (0.04, 100.0)]))],
    plane="stress",
)  # fmt: skip


def test_an_overlap_that_the_law_asks_for_passes() -> None:
    """Two columns of height 20 in all, pressed by 0.05: overclosure o with p = 10 + 4500 (o - 0.02), o + 20 p / E = 0.05."""
    give = 20.0 / STEEL.young
    pressure = 10.0 + 4500.0 * ((0.05 - give * (10.0 - 4500.0 * 0.02)) / (1.0 + give * 4500.0) - 0.02)
    solution = abut.solve(PRESSED)
    assert solution.contacts[0].max_pressure == pytest.approx(pressure, rel=1e-9)
    assert not [check.name for check in solution.certificate if not check.passed]
    assert solution.contacts[0].max_penetration == pytest.approx(0.05 - give * pressure, rel=1e-9)


def test_what_overlaps_beyond_the_law_still_fails() -> None:
    """A round body sunk by 0.05 into the middle of a facet of 6.7, whose gap is open in the mean: no pressure anywhere."""
    mesh = join(
        {"a": rectangle([-10, 10], [0, 10], [3, 4], "quad4"), "b": half_disc(2.0, (0, 12), cells=6, cell="quad4")}
    )
    stiff = abut.PressureOverclosure([(0.0, 0.0), (1e-6, 1e3)])
    supports = [abut.Support("a.bottom", x=0, y=0), abut.Support("b.flat", x=0, y=-0.05)]
    contacts = [abut.Contact(contactor="a.top", target="b.round", law=stiff)]
    solution = abut.solve(replace(PRESSED, mesh=mesh, supports=supports, contacts=contacts))
    assert [check.passed for check in solution.certificate if check.name == "overlap"] == [False]

"""Loads that find no density or expansion are told by the check and by the run; those that find some are not."""

from __future__ import annotations

import numpy as np
import pytest

import abut
from abut.diagnosis import check
from abut.mesh.make import join, rectangle

BARE, FULL = abut.LinearElastic(210e3, 0.3), abut.LinearElastic(210e3, 0.3, density=7.85e-9, expansion=1.2e-5)
MESH = join({"a": rectangle([0, 2], [0, 1], [2, 1], "quad4"), "b": rectangle([0, 2], [1, 2], [3, 1], "quad4")})
LOADS = {
    "gravity": (abut.Gravity((0.0, -9810.0)), "loads[0]: gravity finds no density in body 'a', 'b'"),
    "centrifugal": (abut.Centrifugal(10.0, on="b"), "loads[0]: the centrifugal force finds no density in body 'b'"),
    "temperature": (abut.Temperature("b", 20.0), "loads[0]: the temperature finds no expansion in body 'b'"),
}


def model(a: abut.LinearElastic, b: abut.LinearElastic, *loads: object, warm: float = 0.0) -> abut.Model:
    return abut.Model(
        MESH, [abut.Solid("a", a), abut.Solid("b", b, temperature=warm)], [abut.Support("a.bottom", x=0, y=0)], loads,
        [abut.Contact("a.top", "b.bottom", kind="tied")], plane="strain",
    )  # fmt: skip


@pytest.mark.parametrize("name", LOADS)
def test_a_load_that_does_nothing_is_told(name: str) -> None:
    load, said = LOADS[name]
    idle, acts = model(BARE, BARE, load), model(FULL, FULL, load)
    solution = abut.solve(idle)
    assert np.abs(solution.displacement).max() == 0.0
    assert any(said in note for note in solution.notes)
    assert [finding.severity for finding in check(idle).findings if "finds no" in finding.what] == ["warning"]
    assert not any("finds no" in note for note in abut.solve(acts).notes)
    assert not any("finds no" in finding.what for finding in check(acts).findings)


def test_of_several_bodies_those_are_named_that_lack_what_it_takes() -> None:
    """Gravity names the body without density; a temperature over both strains one, which may be what is meant."""
    gravity, _ = LOADS["gravity"]
    assert any("no density in body 'a'," in note for note in abut.solve(model(BARE, FULL, gravity)).notes)
    both = abut.Temperature("a", 20.0), abut.Temperature("b", 20.0)
    told = [note for note in abut.solve(model(BARE, FULL, *both)).notes if "finds no" in note]
    assert told == [
        "loads[0]: the temperature finds no expansion in body 'a', and does nothing there; give its material an expansion"
    ]
    assert any("solids[1].temperature" in note for note in abut.solve(model(FULL, BARE, warm=20.0)).notes)

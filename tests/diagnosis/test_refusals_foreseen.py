"""What a run refuses, the check before it says in the same words."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import pytest

import abut
from abut.diagnosis import check
from abut.mesh.make import join, rectangle

MESH = join({"a": rectangle([0, 2], [0, 1], [2, 1], "quad4"), "b": rectangle([0, 2], [1, 2], [3, 1], "quad4")})
STEEL = abut.LinearElastic(210e3, 0.3)
MODEL = abut.Model(
    MESH, [abut.Solid("a", STEEL), abut.Solid("b", STEEL)],
    [abut.Support("a.bottom", x=0, y=0), abut.Support("b.top", x=0, y=-0.01)],
    contacts=[abut.Contact("a.top", "b.bottom", name="c")], plane="strain",
)  # fmt: skip
REFUSED: dict[str, tuple[dict[str, Any], str]] = {
    "frequencies of what has no mass": ({"modes": [abut.Frequencies()]}, "no body has a mass"),
    "linear buckling at large displacements": (
        {"modes": [abut.Buckling()], "kinematics": "finite"},
        "small displacements",
    ),
    "a fluid from elsewhere": ({"penetrations": [abut.Penetration("c", "a.bottom", 1.0)]}, "no point of either side"),
}


@pytest.mark.parametrize("case", REFUSED)
def test_the_check_foresees_what_the_run_refuses(case: str) -> None:
    changes, said = REFUSED[case]
    model = replace(MODEL, **changes)
    report = check(model)
    assert report.status == 2
    assert said in report.findings[0].what
    solved: list[object] = []
    with pytest.raises(abut.InputError, match=said):
        abut.analysis.solve(model, on_step=lambda *step: solved.append(step))
    assert not solved  # before it has taken time over a step
    assert check(MODEL).status == 0

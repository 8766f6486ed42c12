"""The numbers at the top of the report."""

from __future__ import annotations

from dataclasses import replace

import abut
from abut.mesh import make
from abut.report import Origin
from abut.report.page import page

STEEL = abut.LinearElastic(1000.0, 0.3)


def _pressed(*course: tuple[float, float]) -> abut.Model:
    """A block on another one, pressed by factors over time."""
    mesh = make.join(
        {"lower": make.rectangle([0, 2], [0, 1], cells=[4, 2]), "upper": make.rectangle([0, 1], [1, 2], cells=[3, 2])}
    )
    return abut.Model(
        mesh,
        plane="strain",
        solids=[abut.Solid("lower", STEEL), abut.Solid("upper", STEEL)],
        supports=[
            abut.Support("lower.bottom", x=0, y=0), abut.Support("upper.top", x=0),
            abut.Support("upper.top", y=-0.01, amplitude=abut.Amplitude(((0.0, 0.0), *course))),
        ],
        contacts=[abut.Contact(contactor="upper.bottom", target="lower.top")],
    )  # fmt: skip


def test_the_largest_pressure_of_all_steps() -> None:
    """Beside that at the end if it was more: of linear steps, twice as much where twice as much presses."""
    back = abut.solve(replace(_pressed((0.5, 1.0), (1.0, 0.5)), solve=abut.SolveOptions(steps=2)))
    text = page(back, Origin("back"))
    first, last = (step.contacts[0].max_pressure for step in back.steps)
    assert first > 1.9 * last > 0.0
    assert f"<b>{first:.6g}</b><span>largest pressure of all steps</span>" in text
    assert f"<b>{last:.6g}</b><span>largest pressure at the end</span>" in text
    on = abut.solve(replace(_pressed((1.0, 1.0)), solve=abut.SolveOptions(steps=2)))
    assert "of all steps</span>" not in page(on, Origin("on"))


def test_ties_are_no_contact() -> None:
    """What is glued on has an area of its own, which is no contact area."""
    model = _pressed((1.0, 1.0))
    base, lower, upper = (
        make.rectangle(x, y, cells=[n, 2])
        for x, y, n in (([0, 2], [-1, 0], 4), ([0, 2], [0, 1], 4), ([0, 1], [1, 2], 3))
    )
    tied = replace(
        model,
        mesh=make.join({"base": base, "lower": lower, "upper": upper}),
        solids=[*model.solids, abut.Solid("base", STEEL)],
        supports=[abut.Support("base.bottom", x=0, y=0), *model.supports[1:]],
        contacts=[*model.contacts, abut.Contact(contactor="lower.bottom", target="base.top", kind="tied")],
    )
    solution = abut.solve(tied)
    touching, tie = solution.contacts
    assert tie.area > 1.5 * touching.area
    assert f"<b>{touching.area:.6g}</b><span>contact area</span>" in page(solution, Origin("tied"))

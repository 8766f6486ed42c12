"""`abut check` of models with large sliding, whose surfaces need not face each other at the outset."""

from __future__ import annotations

from dataclasses import replace

import pytest

import abut
from abut.diagnosis import check
from abut.mesh import make


def apart(x: float, scale: float = 1.0, target: str = "plate.top") -> abut.Model:
    """A block over (or ``x`` beside) a plate, with finite kinematics: it moves over the plate, then down."""
    block = make.rectangle([1.0 + x, 3.0 + x], [1.05, 2.05], cells=[4, 2], cell="quad4")
    mesh = make.join(
        {
            "plate": make.rectangle([0, 4], [0, 1], cells=[6, 2], cell="quad4"),
            "block": replace(block, points=scale * block.points),
        }
    )
    first, then = (abut.Amplitude(points) for points in (((0, 0), (0.5, 1)), ((0.5, 0), (1, 1))))
    return abut.Model(
        mesh, plane="strain", kinematics="finite",
        solids=[abut.Solid(body, abut.LinearElastic(1e3, 0.3)) for body in ("plate", "block")],
        supports=[
            abut.Support("plate.bottom", x=0, y=0), abut.Support("block.top", x=-x, amplitude=first),
            abut.Support("block.top", y=-0.1, amplitude=then),
        ],
        contacts=[abut.Contact(contactor="block.bottom", target=target, name="c", friction=0.2)],
    )  # fmt: skip


@pytest.mark.long
def test_large_sliding_may_bring_bodies_together_later() -> None:
    """What does not face its target at the outset is no error where the run moves it there, and is said."""
    assert abut.solve(apart(5.0)).contacts[0].area > 0.0
    report = check(apart(5.0))
    assert [(f.severity, f.where) for f in report.findings if f.severity != "info"] == [("advice", "contact 'c'")]
    assert any("at the outset: they touch only once they have moved there" in f.what for f in report.findings)
    facing = check(apart(0.0))
    assert not [f for f in facing.findings if f.severity != "info"]
    (wrong,) = (f for f in check(apart(0.0, target="plate.bottom")).findings if f.severity == "warning")
    assert "target 'plate.bottom' is too small: 100%" in wrong.what
    assert any(f.severity == "error" and "millimetres" in f.what for f in check(apart(5.0, scale=1e3)).findings)


def test_a_body_that_may_touch_itself_is_no_error() -> None:
    """Detection with finite kinematics takes each body with itself, flat as it may be."""
    model = apart(0.0)
    contacts = [
        abut.Contact(contactor="plate", target="plate"),
        abut.Contact(contactor="block", target="block"),
        abut.Contact(contactor="block", target="plate"),
    ]
    assert not [f for f in check(replace(model, contacts=contacts)).findings if f.severity != "info"]

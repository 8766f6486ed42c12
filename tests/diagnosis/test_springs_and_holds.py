"""What springs and holds keep in place is not free: the check before a run sees what the run sees."""

from __future__ import annotations

from dataclasses import replace

import pytest

import abut
from abut.diagnosis import check
from abut.mesh.make import join, rectangle

STEEL = abut.LinearElastic(210e3, 0.3)
BLOCKS = join(
    {"block": rectangle([0, 4], [0, 2], [4, 2], "quad4"), "bed": rectangle([-2, 8], [-2, 0], [10, 2], "quad4")}
)
ON_BED = abut.Model(
    BLOCKS, [abut.Solid("block", STEEL), abut.Solid("bed", STEEL)], [abut.Support("bed.bottom", x=0, y=0)],
    [abut.Pressure("block.top", 10.0), abut.Traction("block.left", (5.0, 0.0))],
    [abut.Contact("block.bottom", "bed.top")], plane="strain",
)  # fmt: skip
SPRING, HOLD = abut.Spring("stop", "block.right", x=1e3), abut.Hold("block.right", x=0.0)


@pytest.mark.parametrize("helps", [{"springs": [SPRING]}, {"holds": [HOLD]}])
def test_a_body_that_a_spring_holds_is_not_free(helps: dict[str, object]) -> None:
    """It takes all of the load along x, 2 * 5, in the run; without it both say that the block slides away."""
    alone, held = check(ON_BED), check(replace(ON_BED, **helps))
    assert (alone.status, held.status) == (4, 0)
    assert "translate along x" in str(alone.findings[0])
    assert not any("along x" in str(finding) for finding in held.findings)
    force = abut.solve(replace(ON_BED, **helps)).contacts[0].force
    assert force == pytest.approx((0.0, 40.0), abs=1e-6)  # pressure 10 on a width of 4


def test_friction_beside_a_spring_is_not_alone() -> None:
    """Pushed with a quarter of its weight; with a spring nothing is said of the coefficient."""
    rubbing = replace(ON_BED, contacts=[replace(ON_BED.contacts[0], friction=0.4)])
    alone, held = (check(model) for model in (rubbing, replace(rubbing, springs=[SPRING])))
    assert any("but for friction" in str(finding) for finding in alone.findings)
    assert not any("but for friction" in str(finding) for finding in held.findings)

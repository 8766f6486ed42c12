"""Flat contact that opens nearly all over at once, at large displacements: stacked leaf springs."""

from __future__ import annotations

import pytest

import abut
from abut.mesh import make

STEEL = abut.LinearElastic(young=206e9, poisson=0.3)
LENGTHS, THICKNESS, FORCE = (0.6, 0.45, 0.3), 0.01, 100.0  # m, N


def leaves(kinematics: str, friction: float) -> abut.Model:
    """Three leaves on each other, clamped at one end, the longest pressed at its tip."""
    parts = {
        f"leaf{i}": make.rectangle(
            [0, length], [-(i + 1) * THICKNESS, -i * THICKNESS], cells=[round(40 * length), 2], cell="quad8"
        )
        for i, length in enumerate(LENGTHS)
    }
    return abut.Model(
        make.join(parts), plane="stress", kinematics=kinematics,
        solids=[abut.Solid(name, STEEL) for name in parts],
        supports=[abut.Support(f"{name}.left", x=0, y=0) for name in parts],
        loads=[abut.Force("leaf0.right", (0, -FORCE))],
        contacts=[abut.Contact(contactor=f"leaf{i}.bottom", target=f"leaf{i + 1}.top", friction=friction) for i in (0, 1)],
    )  # fmt: skip


@pytest.mark.long
@pytest.mark.parametrize("friction", [0.0, 0.1])
def test_leaves_open_as_at_small_displacements(friction: float) -> None:
    """The tip moves by a sixtieth of the thickness, where both kinematics must agree but for the pressures' functions, which
    differ at the few facets that stay closed: 2 %."""
    finite, small = (abut.solve(leaves(kinematics, friction)) for kinematics in ("finite", "small"))
    assert finite.converged
    tip = [solution.displacement[:, 1].min() for solution in (finite, small)]
    assert tip[0] == pytest.approx(tip[1], rel=0.02)

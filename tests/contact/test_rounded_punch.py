"""A flat punch with a rounded edge on a block: it rests on its flat, however coarse the facets of the rounding are."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

import abut
from abut.mesh.make import join, rectangle


def model(cell: str, n: int, **contact: object) -> abut.Model:
    """Radius 50, edge rounded by 10 over n facets, pressed by 100 on a block of 100 x 200, axisymmetric."""
    punch = rectangle((0, 50), (0, 100), (5 * n, 6 * n), cell)
    x, y = punch.points.T
    angle = np.maximum(x - 40.0, 0.0) / 10.0 * np.pi / 2
    low, up = 10.0 * (1.0 - np.cos(angle)), (y / 100.0) ** 1.8
    punch = replace(
        punch, points=np.column_stack([np.minimum(x, 40.0) + 10.0 * np.sin(angle), low + (100.0 - low) * up])
    )
    block = rectangle((0, 100), (-200, 0), (8 * n, 8 * n), cell)
    x, y = block.points.T
    x = np.where(x <= 62.5, x * 52.0 / 62.5, 52.0 + (x - 62.5) * 48.0 / 37.5)
    block = replace(block, points=np.column_stack([x, -200.0 * (y / 200.0) ** 2]))
    return abut.Model(
        replace(join({"punch": punch, "block": block}), axisymmetric=True),
        [
            abut.Solid("punch", abut.LinearElastic(210000.0, 0.3)),
            abut.Solid("block", abut.LinearElastic(70000.0, 0.3)),
        ],
        supports=[abut.Support("punch.left", x=0), abut.Support("block.left", x=0), abut.Support("block.bottom", x=0, y=0)],
        loads=[abut.Traction("punch.top", (0.0, -100.0))],
        contacts=[abut.Contact(**{"contactor": "punch.bottom", "target": "block.top", **contact})],
        plane="axisymmetric",
    )  # fmt: skip


def sinks(made: abut.Model) -> float:
    """Displacement of the block's middle."""
    points = made.mesh.points
    top = made.mesh.nodes_of("block.top")
    middle = top[(np.abs(points[top]) < 1e-9).all(axis=1)]
    return -float(abut.solve(made).displacement[middle[0], 1])


@pytest.mark.long
@pytest.mark.parametrize(
    ("contactor", "target", "most"), [("punch.bottom", "block.top", 0.05), ("block.top", "punch.bottom", 0.12)]
)
def test_a_punch_rests_on_its_flat(contactor: str, target: str, most: float) -> None:
    """Linear cells with 2 facets on the rounding come as near to quadratic ones as their size lets them (contact ends within
    a facet of the block, 5 wide), and errors fall like h at least. On its rounding the punch would sink in by 40 % less."""
    right = sinks(model("quad8", 4))
    errors = [abs(sinks(model("quad4", n, contactor=contactor, target=target)) / right - 1.0) for n in (2, 4)]
    assert errors[0] < most
    assert errors[1] < 0.6 * errors[0]


@pytest.mark.long
def test_dual_functions_at_large_displacements() -> None:
    """The same of theory (G15)."""
    right = sinks(replace(model("quad8", 4), kinematics="finite"))
    found = sinks(replace(model("quad4", 4, pressure="dual-P1"), kinematics="finite"))
    assert found == pytest.approx(right, rel=0.05)

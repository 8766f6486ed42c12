"""However a pair is looked at, its gaps and slips are those that bodies have."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

import abut
from abut.mesh import make
from abut.problem.problem import ContactProblem
from models.sliding import SOFT, finite

APART, OFFSET, DOWN, ALONG = 0.1, 0.04, -0.03, 0.02


def blocks(kinematics: str, dim: int, space: str) -> ContactProblem:
    """One above the other and ``APART``, the lower one wider all round; half of an offset counts at time 0.5."""
    made = make.rectangle if dim == 2 else make.box
    wide, narrow = [[0, 3]] * (dim - 1), [[0.6, 2.1]] * (dim - 1)
    lower = made(*wide, [0, 1], cells=[4] * (dim - 1) + [1])
    upper = made(*narrow, [1 + APART, 2], cells=[3] * (dim - 1) + [1])
    grows = abut.Amplitude(((0.0, 0.0), (1.0, 1.0)))
    contact = abut.Contact(
        contactor="upper.bottom", target="lower.top", friction=0.3, offset=2 * OFFSET, amplitude=grows, pressure=space
    )
    model = abut.Model(
        make.join({"lower": lower, "upper": upper}), kinematics=kinematics, plane="strain" if dim == 2 else None,
        solids=[abut.Solid("lower", SOFT), abut.Solid("upper", SOFT)],
        supports=[abut.Support(name, **dict.fromkeys("xyz"[:dim], 0)) for name in ("lower.bottom", "upper.top")],
        contacts=[contact],
    )  # fmt: skip
    return finite(model)


@pytest.mark.parametrize("space", ["P1", "dual"])
@pytest.mark.parametrize("dim", [2, 3])
@pytest.mark.parametrize("kinematics", ["small", "finite"])
def test_gaps_and_slips_of_a_block_that_moves(kinematics: str, dim: int, space: str) -> None:
    """Every function sees the whole motion, its weight times: no facet leaves the target, and no normal turns."""
    problem = blocks(kinematics, dim, space)
    (kind,) = problem.kinematics
    (rest,) = problem.placed(problem.start())
    step = np.zeros_like(problem.model.mesh.points)
    step[problem.model.mesh.nodes_of("upper")] = [ALONG, *[0.0] * (dim - 2), DOWN]
    frame = kind.frame(problem.start().history.contact(kind.pair.contact.name), rest, None)
    there = replace(rest, displacement=step.ravel(), offset=OFFSET)
    now = kind.at(frame, there, rest.displacement)
    weight, normal, tangential = kind.pair.weight, kind.pair.normal, kind.pair.tangential
    assert now.gap[normal] == pytest.approx((APART + OFFSET + DOWN) * weight[normal], rel=1e-12)
    slips = kind.pair.tangential_traction(now.gap / weight)
    assert np.abs(slips) == pytest.approx(np.abs(np.broadcast_to([ALONG, *[0.0] * (dim - 1)], slips.shape)), abs=1e-14)
    assert len(now.gap[tangential]) > 0
    changed = now.by_position @ step.ravel()
    before = kind.at(frame, replace(rest, offset=OFFSET), rest.displacement).gap
    assert changed == pytest.approx(now.gap - before, abs=1e-14)
    assert not np.any(now.without_history)

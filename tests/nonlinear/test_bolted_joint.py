"""A bolted joint with automatic load steps: its plates spread under the bolt, then one is drawn out until it slips."""

from __future__ import annotations

import re
from pathlib import Path

import numpy as np
import pytest

import abut
from abut.job.load import load_job
from abut.nonlinear.settings import DEFAULT

JOB = Path(__file__).parents[2] / "examples" / "bolted-joint" / "job.toml"
FRICTION = 0.2
COARSE = {"[4, 16, 2]": "[2, 8, 1]", "[6, 2]": "[4, 1]", "[4, 6]": "[2, 3]"}


def test_thirty_lines() -> None:
    """All of the joint, its mesh and its bolt, in a job of 30 lines beside comments: two ties, and contact that is found."""
    lines = [line for line in JOB.read_text(encoding="utf-8").splitlines() if line.strip() and line[0] != "#"]
    assert len(lines) <= 30
    model = load_job(JOB).model
    assert {solid.body for solid in model.solids} == {"shank", "nut", "head", "lower", "middle", "upper"}
    touching = [frozenset(side.rpartition(":")[2].partition(".")[0] for side in c.named) for c in model.contacts]
    assert len(touching) == 6
    assert [contact.kind for contact in model.contacts].count("tied") == 2
    assert {contact.friction for contact in model.contacts if contact.kind != "tied"} == {FRICTION}


@pytest.mark.long
def test_bolted_joint_slips(tmp_path: Path) -> None:
    """Both faces of the plate slip at the coefficient times the bolt's tension (Coulomb; balance of the head). Half of the
    friction that there is lies under head and nut, which go along: of eight points between stick and slip half at least."""
    text = re.sub(r"solve\.times = .*\n", "", JOB.read_text(encoding="utf-8"))
    for fine, coarse in COARSE.items():
        assert fine in text
        text = text.replace(fine, coarse)
    job = tmp_path / "job.toml"
    job.write_text(text, encoding="utf-8")
    solution = abut.solve(load_job(job).model)
    assert solution.converged
    drawn = [step for step in solution.steps if step.factor > 0.2 + 1e-9]
    force = np.array([abs(step.reactions["middle.round"][0]) for step in drawn])
    limit = 2.0 * FRICTION * solution.steps[-1].preloads["M10"].tension
    assert force[-1] == pytest.approx(limit, rel=0.01)
    assert (np.diff(force) > -1e-3 * limit).all()
    assert (force < 0.99 * limit).sum() >= DEFAULT.steps.points // 2
    assert len(force) < 3 * DEFAULT.steps.points

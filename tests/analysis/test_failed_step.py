"""A load step that fails half-way with finite kinematics: what is said, and what is left."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import pytest

from abut.analysis import run
from abut.cli import main
from abut.errors import Unsound
from abut.nonlinear.attempt import Attempt

JOB = """
schema = 1
[mesh.bodies.bar]
kind = "rectangle"
x = [0, 4]
y = [0, 1]
cells = [4, 1]
[model]
plane = "strain"
kinematics = "finite"
[materials.rubber]
kind = "linear-elastic"
young = 1e3
poisson = 0.3
[[solids]]
body = "bar"
material = "rubber"
[[supports]]
on = "bar.left"
x = 0
y = 0
[[supports]]
on = "bar.right"
x = -1e5
amplitude = [[0, 0], [0.5, 1e-6], [1, 1]]
"""


def job(folder: Path) -> str:
    """A bar pressed by a fortieth of its length, then by far more than it has."""
    path = folder / "job.toml"
    path.write_text(JOB)
    return str(path)


def test_how_far_it_came(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["run", job(tmp_path)]) == 3
    told = capsys.readouterr()
    assert "at the end of step 2, time 0.5 of 1, which did not converge:\ncertificate" in told.out
    assert "step 2, after time 0.5 of 1, did not converge: cell 0 of body 'bar' turns inside out" in told.err
    report = (tmp_path / "results" / "report.html").read_text(encoding="utf-8")
    assert "Not converged at step 2, time 0.5 of 1 reached: what follows is the last state." in report


def test_a_state_that_cannot_be_shown(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    """The steps before it are reported all the same."""
    step_result = run.step_result

    def only_sound(assembled: Any, attempt: Attempt, *arguments: Any) -> Any:
        if not attempt.converged:
            raise Unsound("cell 0 of body 'bar' turns inside out")
        return step_result(assembled, attempt, *arguments)

    monkeypatch.setattr(run, "step_result", only_sound)
    assert main(["run", job(tmp_path)]) == 3
    assert "step 2 did not converge; in its last state cell 0 of body 'bar' turns inside out" in capsys.readouterr().err
    report = (tmp_path / "results" / "report.html").read_text(encoding="utf-8")
    assert "Stopped after step 1, time 0.5 of 1 reached" in report

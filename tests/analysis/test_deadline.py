"""``solve.seconds``: a run ends in time, and keeps what is done."""

from __future__ import annotations

import itertools
import json
import re
from dataclasses import replace
from functools import partial
from pathlib import Path

import numpy as np
import pytest

import abut
from abut.analysis.deadline import Deadline
from abut.cli import main
from abut.errors import InputError, OutOfTime
from models.sliding import arched
from models.steps import job


def by_calls(monkeypatch: pytest.MonkeyPatch) -> None:
    """A clock that goes on by a second whenever a run looks at it."""
    ticks = itertools.count(0)
    monkeypatch.setattr("abut.analysis.run.Deadline", partial(Deadline, clock=lambda: float(next(ticks))))


def test_a_step_may_take_one_iteration_more() -> None:
    now = [0.0]
    deadline = Deadline(10.0, clock=lambda: now[0])
    deadline.begins()
    now[0] = 9.0
    deadline.iterated()
    now[0] = 11.0
    deadline.iterated()  # perhaps the last one
    with pytest.raises(OutOfTime, match=r"stopped after 10 s, as solve\.seconds says"):
        deadline.begins()
    with pytest.raises(OutOfTime):
        deadline.iterated()
    unlimited = Deadline(None, clock=lambda: 1e9)
    unlimited.begins()
    unlimited.iterated()
    unlimited.iterated()


@pytest.mark.long
def test_large_sliding_keeps_what_is_done(monkeypatch: pytest.MonkeyPatch) -> None:
    """The steps before the end are those of a run without one, and restart goes on from the last of them."""
    whole = abut.solve(arched(0.0))
    saved: list[abut.solution.Saved] = []
    by_calls(monkeypatch)
    short = replace(arched(0.0), solve=abut.SolveOptions(seconds=25))
    part = abut.solve(short, on_step=lambda _, step: saved.append(step))
    assert 0 < len(part.steps) < len(whole.steps)
    assert part.converged
    assert not part.complete
    assert any("solve.seconds" in note for note in part.notes)
    assert len(saved) == len(part.steps)
    assert np.array_equal(part.displacement, whole.steps[len(part.steps) - 1].displacement)
    rest = abut.analysis.solve(arched(0.0), resume=saved)
    assert rest.complete
    assert np.abs(rest.displacement - whole.displacement).max() < 1e-7
    with pytest.raises(OutOfTime):
        abut.solve(replace(short, solve=abut.SolveOptions(seconds=1)))


def test_the_command(tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]) -> None:
    path, results = job(tmp_path, steps=4, seconds=0.5), tmp_path / "results"
    by_calls(monkeypatch)
    assert main(["run", "--quiet", str(path)]) == 124
    assert "as solve.seconds says before the first step converged: nothing is written" in capsys.readouterr().err
    assert not results.exists()
    path = job(tmp_path, steps=4, seconds=10)
    assert main(["run", "--quiet", str(path)]) == 124
    told = capsys.readouterr().err
    assert "stopped after 10 s, as solve.seconds says: step" in told
    assert re.search(r"up to time 0\.\d+ of 1; go on with abut run --restart", told)
    left = json.loads((results / "summary.json").read_text())
    assert left["status"] == "incomplete"
    assert 0 < len(left["steps"]) < 4
    assert "of 1 reached: there are steps left" in (results / "report.html").read_text(encoding="utf-8")
    path = job(tmp_path, steps=4)
    assert main(["run", "--quiet", "--restart", str(path)]) == 0
    done = json.loads((results / "summary.json").read_text())
    assert (done["status"], len(done["steps"])) == ("converged", 4)
    assert done["steps"][: len(left["steps"])] == left["steps"]


@pytest.mark.parametrize("seconds", [0, -1.0, float("nan"), "soon", True])
def test_what_is_no_time_is_refused(seconds: object) -> None:
    with pytest.raises((InputError, TypeError), match=r"solve\.seconds"):
        abut.SolveOptions(seconds=seconds)  # type: ignore[arg-type]

"""What a run shows while it goes on: a live line on a terminal, plain lines elsewhere, nothing where it was told so."""

from __future__ import annotations

import json
import os
import re
import subprocess
import sys
import time
from pathlib import Path

import pytest

import abut
from abut.cli import main, progress
from abut.cli.progress import Progress
from abut.job import load_job
from abut.solution import Iteration, Phase
from models.steps import STEPS, job


def test_plain_lines(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["run", str(job(tmp_path))]) == 0
    lines = capsys.readouterr().out.splitlines()
    assert len([line for line in lines if line.split()[:2] == ["5", "1"]]) == 1
    assert not any("\x1b" in line or line.startswith("...") for line in lines)
    assert not any("factorising" in line for line in lines)  # short


@pytest.mark.parametrize("option", ["--quiet", "--json"])
def test_silent(option: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["run", option, str(job(tmp_path))]) == 0
    out, error = capsys.readouterr()
    assert error == ""
    assert (json.loads(out)["status"] == "converged") if option == "--json" else (out == "")


@pytest.mark.long
@pytest.mark.skipif(os.name != "posix", reason="needs a pseudo terminal")
def test_live_line_on_a_terminal(tmp_path: Path) -> None:
    import pty

    path = job(tmp_path, steps=30)
    ours, theirs = pty.openpty()
    process = subprocess.Popen(
        [sys.executable, "-m", "abut.cli", "run", str(path)],
        stdout=theirs, stderr=subprocess.PIPE, env={**os.environ, "TERM": "xterm", "COLUMNS": "120"},
    )  # fmt: skip
    os.close(theirs)
    text = b""
    while True:
        try:
            part = os.read(ours, 65536)
        except OSError:  # how a closed terminal ends on Linux
            break
        if not part:
            break
        text += part
    os.close(ours)
    assert process.wait(timeout=60) == 0
    shown = text.decode()
    assert re.search(r"step \d+ of 30.*\d+ of 30 steps done, about \d+ s left", shown)
    assert shown.rindex("\x1b[?25h") > shown.rindex("\x1b[?25l")  # the cursor is back
    assert "certificate" in shown


def test_long_stages_are_announced(capsys: pytest.CaptureFixture[str]) -> None:
    with Progress() as show:
        show(Phase("cutting", None))
        show(Phase("factorising 154 686 displacements", 31.4))
    assert capsys.readouterr().out == "factorising 154 686 displacements: about 31 s\n"


def test_never_silent_for_long(monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]) -> None:
    """With a patience of 0.1 s instead of 5: lines after 0.1, 0.3, 0.7 s of silence, each after twice the time."""
    monkeypatch.setattr(progress, "PATIENCE", 0.1)
    monkeypatch.setattr(progress, "REFRESH", 0.02)
    with Progress() as show:
        show(Phase("step 2 of 3", None, 1, 3))
        show(Iteration(2, 7, 1, 0, 0.0, 0.0, 0.0, 0.0))
        time.sleep(1.0)
    waiting = [line for line in capsys.readouterr().out.splitlines() if line.startswith("...")]
    assert 2 <= len(waiting) <= 4
    assert waiting[0].startswith("... step 2 of 3, iteration 8 (0 s)")


def test_time_left_goes_by_the_steps_of_this_run() -> None:
    """Two of four steps took 20 s, 3 s of the next are over: 17 s are left. A restart does not count the steps before."""
    for before in (0, 10):
        show = Progress(silent=True)
        show(Phase("step", None, before, before + 4))
        began = show._first
        show(Phase("step", None, before + 2, before + 4))
        show._since = began + 20.0
        assert "about 17 s left" in show.status(began + 23.0)


def test_steps_that_are_chosen_on_the_way(capsys: pytest.CaptureFixture[str]) -> None:
    """Nobody knows how many there will be: the time that lies behind counts. A tenth took 10 s, so that
    the rest will take 90 s; the table says where each step leads."""
    show = Progress()
    for number, (behind, ahead) in enumerate([(0.0, 0.1), (0.1, 0.25)], start=1):
        show(Phase(f"step {number}, to time {ahead}", share=behind))
        show(Phase("setting up multigrid"))
        show(Iteration(number, 1, 1, 0, 0.0, 0.0, 0.0, 0.0))
    show._since = show._first + 10.0
    assert "10% of the way done, about 1 min 30 s left" in show.status(show._since)
    lines = capsys.readouterr().out.splitlines()
    assert lines[0] == "step 1, to time 0.1"
    assert lines[3] == "step 2, to time 0.25"


def test_stages_come_in_order(tmp_path: Path) -> None:
    seen: list[str] = []

    def observe(item: object) -> None:
        if isinstance(item, Phase):
            seen.append(item.name)

    abut.solve(load_job(job(tmp_path)).model, observe)
    assert seen[:3] == [
        "assembling the stiffness", "cutting and integrating the interface", "checking for unconstrained rigid-body motions"
    ]  # fmt: skip
    assert seen[3].startswith("factorising ")
    assert [name for name in seen if name.startswith("step ")] == [f"step {k} of {STEPS}" for k in range(1, STEPS + 1)]


def test_reader_that_goes_away_does_not_cost_the_results(tmp_path: Path) -> None:
    """As in ``abut run JOB | head -1``."""
    path = job(tmp_path)
    process = subprocess.Popen(
        [sys.executable, "-u", "-m", "abut.cli", "run", str(path)], stdout=subprocess.PIPE, stderr=subprocess.PIPE
    )
    assert process.stdout is not None
    assert process.stderr is not None
    process.stdout.readline()
    process.stdout.close()
    assert process.stderr.read() == b""
    assert process.wait(timeout=60) in (0, 141)
    assert json.loads((tmp_path / "results" / "summary.json").read_text())["status"] == "converged"


def test_help_lists_the_exit_statuses(capsys: pytest.CaptureFixture[str]) -> None:
    with pytest.raises(SystemExit):
        main(["run", "--help"])
    text = capsys.readouterr().out
    for status in ("0 ", "2 ", "3 ", "4 ", "130 ", "1 "):
        assert f"\n  {status}" in text

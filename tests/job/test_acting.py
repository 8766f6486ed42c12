"""What acts in each step of a job, in words: printed by a run, in results and report."""

from __future__ import annotations

import json
from pathlib import Path

import pytest

from abut.cli import main
from abut.job.load import load_job

JOB = """schema = 1
model.plane = "strain"
solids = [{ body = "low", material = "steel" }, { body = "top", material = "steel" }]
materials.steel = { kind = "linear-elastic", young = 2e5, poisson = 0.3 }
mesh.bodies.low = { kind = "rectangle", x = [0, 2], y = [-1, 0], cells = [4, 2], cell = "quad4" }
mesh.bodies.top = { kind = "rectangle", x = [0, 2], y = [0, 4], cells = [4, 8], cell = "quad4" }
supports = [
  { on = "low.bottom", x = 0, y = 0 },
  { on = "top.left", x = 0.001, amplitude = [["close", 0], ["heat", 1]] },
]
[[steps]]
name = "close"
[[steps]]
name = "heat"
period = 2
[[steps]]
name = "rest"
[[contacts]]
name = "joint"
surfaces = ["low.top", "top.bottom"]
friction = 0.2
friction_amplitude = [["close", 1], ["heat", 0.5]]
[[loads]]
kind = "pressure"
on = "top.top"
value = 1
amplitude = [["start", 0], [0.5, 2], ["close", 1]]
[[loads]]
kind = "temperature"
on = "low"
value = 10
amplitude = [["close", 0], ["heat", 1], ["rest", 0]]
[[preloads]]
name = "M4"
body = "top"
point = [1, 2]
normal = [0, 1]
force = 3
amplitude = [["start", 0], ["close", 1]]
lock = "close"
[[holds]]
on = "top.right"
y = "stay"
since = "close"
until = "heat"
[[penetrations]]
contact = "joint"
source = "low.left"
value = 0.1
amplitude = [["heat", 0], ["rest", 1]]
"""
WANTED = (
    "step 'close' (time 0 to 1): supports 'low.bottom', 'top.left'; loads pressure on 'top.top' (0 to 2 to 1); "
    "preloads 'M4' (0 to 1); contacts 'joint' (friction 1)",
    "step 'heat' (time 1 to 3): supports 'low.bottom', 'top.left' (0 to 1); comes or goes 'top.right' (put on); "
    "loads pressure on 'top.top' (1), temperature on 'low' (0 to 1); preloads 'M4' (locked); "
    "contacts 'joint' (friction 1 to 0.5)",
    "step 'rest' (time 3 to 4): supports 'low.bottom', 'top.left' (1); comes or goes 'top.right' (let go); "
    "loads pressure on 'top.top' (1), temperature on 'low' (1 to 0), fluid in 'joint' (0 to 1); preloads 'M4' (locked); "
    "contacts 'joint' (friction 0.5)",
)


def test_what_acts_in_each_step(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    path = tmp_path / "job.toml"
    path.write_text(JOB)
    assert load_job(path).notes[-3:] == WANTED
    assert main(["check", str(path)]) in (0, 1)
    told = capsys.readouterr().out
    assert all(line in told for line in WANTED)


def test_in_results_and_report(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    short = JOB[: JOB.index('[[loads]]\nkind = "temp')].replace("friction_amplitude", "# friction_amplitude")
    path = tmp_path / "job.toml"
    path.write_text(short)
    assert main(["run", str(path)]) == 0
    wanted = "step 'rest' (time 3 to 4): supports 'low.bottom', 'top.left' (1); loads pressure on 'top.top' (1); "
    wanted += "contacts 'joint'"
    assert wanted in capsys.readouterr().out
    assert wanted in json.loads((tmp_path / "results" / "summary.json").read_text())["notes"]
    assert "step &#x27;rest&#x27; (time 3 to 4)" in (tmp_path / "results" / "report.html").read_text()


def test_none_without_steps(tmp_path: Path) -> None:
    path = tmp_path / "job.toml"
    path.write_text(JOB.split("[[steps]]")[0].replace(', amplitude = [["close", 0], ["heat", 1]]', ""))
    assert not any(note.startswith("step ") for note in load_job(path).notes)

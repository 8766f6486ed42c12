"""Connectors in job files: read, refused with their place, written and read again; what files and the report say of them."""

from __future__ import annotations

import csv
import json
from pathlib import Path

import numpy as np
import pytest

import abut
from abut.errors import InputError
from abut.job import load_job
from abut.job.convert import write_job
from abut.output.key_results import key_results

JOB = """schema = 1
[mesh.bodies.block]
kind = "rectangle"
x = [-20, -19]
y = [0, 1]
cells = [1, 1]
[mesh.bodies.lever]
kind = "rectangle"
x = [0, 10]
y = [0, 1]
cells = [4, 2]
[model]
plane = "strain"
kinematics = "finite"
[materials.steel]
kind = "linear-elastic"
young = 1000.0
poisson = 0.3
[[solids]]
body = "block"
material = "steel"
[[supports]]
on = "block.bottom"
x = 0
y = 0
[[rigid]]
body = "lever"
[[connectors]]
name = "hinge"
kind = "hinge"
on = "lever"
at = [0, 0.5]
limits = [-inf, 0.2]
stiffness = 50
load = 30
"""


def write(folder: Path, text: str = JOB) -> Path:
    path = folder / "job.toml"
    path.write_text(text, encoding="utf-8")
    return path


def test_a_job_with_a_hinge(tmp_path: Path) -> None:
    """The spring takes 50 * 0.2 at the limit, the stop the other 20 of the moment of 30."""
    job = load_job(write(tmp_path))
    assert job.model.connectors == (
        abut.Connector("hinge", "hinge", "lever", at=(0.0, 0.5), limits=(-np.inf, 0.2), stiffness=50.0, load=30.0),
    )
    solution = abut.solve(job.model)
    abut.write(solution, tmp_path / "results")
    with open(tmp_path / "results" / "forces.csv", encoding="utf-8") as file:
        (row,) = (row for row in csv.DictReader(file) if row["kind"] == "connector")
    assert row["name"] == "hinge"
    assert float(row["turn"]) == pytest.approx(0.2)
    assert float(row["stop"]) == pytest.approx(-20.0)
    assert (row["drive"], row["displacement_x"]) == ("", "")
    summary = json.loads((tmp_path / "results" / "summary.json").read_text(encoding="utf-8"))
    assert summary["steps"][-1]["connectors"]["hinge"]["motion"]["turn"] == pytest.approx(0.2)
    assert key_results(solution)["hinge: turn"] == pytest.approx(0.2)
    page = abut.write_report(solution, tmp_path / "report.html")
    text = Path(page or tmp_path / "report.html").read_text(encoding="utf-8")
    assert "What connectors do" in text
    assert "stop -20" in text


def test_written_and_read_again(tmp_path: Path) -> None:
    job = load_job(write(tmp_path))
    again = tmp_path / "again.toml"
    write_job(again, job)
    assert load_job(again).model.connectors == job.model.connectors


SPACE = (
    JOB.replace('"rectangle"', '"box"')
    .replace("cells = [1, 1]", "z = [0, 1]\ncells = [1, 1, 1]")
    .replace("cells = [4, 2]", "z = [0, 1]\ncells = [4, 2, 2]")
    .replace('plane = "strain"\n', "")
    .replace("y = 0\n[[rigid]]", 'y = 0\nz = 0\n[[loads]]\nkind = "moment"\non = "lever"\nvalue = [4, 0, 0]\n[[rigid]]')
    .replace('kind = "hinge"', 'kind = "cylindrical"\naxis = [1, 0, 0]\nlimits2 = [-0.1, 0.1]')
    .replace("at = [0, 0.5]", "at = [0, 0.5, 0.5]")
)


def test_limits_of_a_second_motion(tmp_path: Path) -> None:
    """The travel's stop has 20 of the load of 30, the turn's all of the moment of 4 about the axis; files, the report and a
    job written anew know both."""
    job = load_job(write(tmp_path, SPACE))
    assert job.model.connectors[0].limits2 == (-0.1, 0.1)
    solution = abut.solve(job.model)
    abut.write(solution, tmp_path / "results")
    with open(tmp_path / "results" / "forces.csv", encoding="utf-8") as file:
        (row,) = (row for row in csv.DictReader(file) if row["kind"] == "connector")
    assert [float(row[name]) for name in ("travel", "turn", "stop", "stop2")] == pytest.approx([0.2, 0.1, -20.0, -4.0])
    page = abut.write_report(solution, tmp_path / "report.html")
    text = Path(page or tmp_path / "report.html").read_text(encoding="utf-8")
    assert "stop -20, stop of the second -4" in text
    write_job(tmp_path / "again.toml", job)
    assert load_job(tmp_path / "again.toml").model.connectors == job.model.connectors


def test_steps_name_what_drives_connectors(tmp_path: Path) -> None:
    steps = '[[steps]]\nname = "a"\n[[steps]]\nname = "b"\n'
    notes = load_job(write(tmp_path, JOB + 'amplitude = [[0, 0], ["a", 1]]\n' + steps)).notes
    assert any("connectors 'hinge' (0 to 1)" in note for note in notes)


@pytest.mark.parametrize(
    ("old", "new", "said"),
    [
        ('on = "lever"', 'on = "lefer"', r"connectors\[0\]\.on: no rigid body or coupling named 'lefer'"),
        ("limits = [-inf, 0.2]", "limits = [0.2]", r"connector 'hinge': limits: expected \[lower, upper\]"),
        ("limits = [-inf, 0.2]", "limit = [0, 0.2]", r"connectors\[0\]\.limit: .*mean 'limits'"),
        ("load = 30", "axis = [0, 0, 1]", r"connectors\[0\]\.axis: the model is 2D"),
        ('name = "hinge"\nkind = "hinge"', 'name = "hinge"\nkind = "hing"', r"connectors\[0\]\.kind"),
    ],
)
def test_refused_with_their_place(old: str, new: str, said: str, tmp_path: Path) -> None:
    with pytest.raises(InputError, match=said):
        load_job(write(tmp_path, JOB.replace(old, new)))

"""Vibrations under loads in job files, their tables, fields and charts."""

from __future__ import annotations

import csv
import json
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

import abut
from abut.errors import InputError
from abut.job.convert import write_job
from abut.job.load import load_job
from abut.report.origin import Origin
from abut.report.page import page
from abut.report.responses import response_charts

JOB = """schema = 1
[mesh.bodies.bar]
kind = "rectangle"
x = [0, 10]
y = [0, 1]
cells = [10, 1]
[model]
plane = "stress"
[materials.steel]
kind = "linear-elastic"
young = 1000.0
poisson = 0.0
density = 1e-3
[[solids]]
body = "bar"
material = "steel"
[[supports]]
on = "bar.left"
x = 0
y = 0
[[loads]]
kind = "traction"
on = "bar.right"
value = [1, 0]
amplitude = [[0, 0], [4, 1]]
[[probes]]
name = "end"
at = [10, 0.5]
of = ["displacement"]
[solve]
end = 8
[frequencies]
count = 6
time = 4
[harmonic]
between = [0, 10]
damping = 0.05
fields = [5]
time = 4
[[harmonic.loads]]
kind = "force"
on = "bar.right"
value = [0, 2]
[transient]
period = 0.5
steps = 20
rayleigh = [0.1, 0]
time = 4
[[transient.loads]]
kind = "force"
on = "bar.right"
value = [1, 0]
amplitude = [[0, 0], [0.25, 1]]
"""


def written(folder: Path, text: str = JOB) -> abut.Model:
    (folder / "job.toml").write_text(text, encoding="utf-8")
    return load_job(folder / "job.toml").model


def test_times_are_those_of_the_job_but_for_loads_of_what_is_transient(tmp_path: Path) -> None:
    frequencies, harmonic, transient = written(tmp_path).modes
    assert frequencies.time == harmonic.time == transient.time == 0.5
    assert transient.loads[0].amplitude.points == ((0.0, 0.0), (0.5, 1.0))
    named = JOB.replace("time = 4", 'time = "pull"').replace("[solve]\nend = 8\n", "")
    steps = '[[steps]]\nname = "pull"\nperiod = 4\n[[steps]]\nname = "hold"\nperiod = 4\n'
    assert written(tmp_path, named + steps).modes == (frequencies, harmonic, transient)


def test_a_job_written_anew_is_the_same(tmp_path: Path) -> None:
    written(tmp_path)
    job = load_job(tmp_path / "job.toml")
    write_job(tmp_path / "again.toml", job)
    assert load_job(tmp_path / "again.toml").model.modes == job.model.modes


def test_files_hold_what_the_solution_does(tmp_path: Path) -> None:
    solution = abut.solve(written(tmp_path))
    folder = tmp_path / "results"
    abut.write(solution, folder)
    harmonic, transient = solution.responses
    with open(folder / "harmonic.csv", encoding="utf-8") as file:
        rows = list(csv.DictReader(file))
    np.testing.assert_allclose([float(row["frequency"]) for row in rows], harmonic.at)
    read = np.array([float(row["y_amplitude"]) * np.exp(1j * np.radians(float(row["y_phase"]))) for row in rows])
    np.testing.assert_allclose(read, harmonic.probes[0].displacement[:, 0, 1], rtol=1e-12)
    with open(folder / "transient.csv", encoding="utf-8") as file:
        rows = list(csv.DictReader(file))
    np.testing.assert_allclose([float(row["x"]) for row in rows], transient.probes[0].displacement[:, 0, 0])
    assert b"harmonic_5_imaginary" in (folder / "response.vtu").read_bytes()
    summary = json.loads((folder / "summary.json").read_text(encoding="utf-8"))
    assert [one["file"] for one in summary["responses"]] == ["harmonic.csv", "transient.csv"]
    titles = [chart.title for chart in response_charts(solution)]
    assert titles == [
        "harmonic: amplitude of displacement [length]", "harmonic: phase [degrees]", "transient: displacement [length]",
    ]  # fmt: skip
    text = page(solution, Origin("a bar"))
    assert "harmonic response: largest displacement" in text
    assert "harmonic: phase [degrees]" in text
    abut.write(replace(solution, responses=()), folder)
    assert not [path for path in folder.iterdir() if path.name.startswith(("harmonic", "transient", "response"))]


def test_without_probes_the_largest_displacement_is_listed(tmp_path: Path) -> None:
    model = replace(written(tmp_path), probes=())
    solution = abut.solve(model)
    abut.write(solution, tmp_path / "results")
    lines = (tmp_path / "results" / "transient.csv").read_text(encoding="utf-8").splitlines()
    assert lines[0] == "time,largest"
    moved = abut.solve(written(tmp_path)).responses[1]
    np.testing.assert_allclose([float(line.split(",")[1]) for line in lines[1:]], moved.largest)
    assert moved.largest.max() >= np.abs(moved.probes[0].displacement).max()


@pytest.mark.parametrize(
    ("wrong", "said"),
    [
        (JOB.replace('"force"\non = "bar.right"\nvalue = [0, 2]', '"forc"'), r"harmonic\.loads\[0\]\.kind"),
        (JOB.replace("value = [0, 2]", "value = [0, 2, 1]"), r"harmonic: loads\[0\]\.value: expected 2 components"),
        (JOB.replace("value = [0, 2]", "valu = [0, 2]"), r"harmonic\.loads\[0\]\.valu: unknown key; did you mean"),
        (JOB.replace("[frequencies]\ncount = 6\ntime = 4\n", ""), "ask for frequencies"),
        (JOB.replace("damping = 0.05\n", 'damping = "much"\n'), "harmonic.damping"),
    ],
)
def test_mistakes_are_told_with_their_place(tmp_path: Path, wrong: str, said: str) -> None:
    with pytest.raises(InputError, match=said):
        written(tmp_path, wrong)

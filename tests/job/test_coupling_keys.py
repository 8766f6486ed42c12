"""Couplings and moments in a job file: read, written back, their results listed."""

from __future__ import annotations

import csv
from pathlib import Path

import pytest

import abut
from abut.cli import main
from abut.errors import InputError
from abut.job import load_job
from abut.job.convert import write_job

JOB = """
schema = 1
solve = { steps = 2 }

[mesh.bodies.bar]
kind = "box"
x = [0, 10]
cells = [5, 1, 1]

[materials.steel]
kind = "linear-elastic"
young = 1000
poisson = 0

[[solids]]
body = "bar"
material = "steel"

[[supports]]
on = "bar.left"
x = 0
y = 0
z = 0

[[couplings]]
name = "grip"
on = "bar.right"
reference = [12, 0.5, 0.5]
y = 0
rz = 0
amplitudes = { rz = [[0, 0], [1, 1]] }

[[loads]]
kind = "force"
on = "grip"
value = [5, 0, 0]

[[loads]]
kind = "moment"
on = "grip"
value = [0.5, 0, 0]
"""


def load(folder: Path, text: str):
    (folder / "job.toml").write_text(text)
    return load_job(folder / "job.toml")


def test_results_of_a_coupling(tmp_path):
    """Stretch F L / (E A) at the reference, in history.csv and the report."""
    (tmp_path / "job.toml").write_text(JOB)
    assert main(["run", str(tmp_path / "job.toml"), "--quiet"]) == 0
    rows = list(csv.DictReader((tmp_path / "results" / "history.csv").open()))
    assert [row["rigid"] for row in rows] == ["grip", "grip"]
    assert float(rows[-1]["displacement_x"]) == pytest.approx(5.0 * 10.0 / 1000.0, rel=1e-9)
    assert float(rows[0]["rotation_x"]) == pytest.approx(0.5 * float(rows[-1]["rotation_x"]), rel=1e-9)
    report = (tmp_path / "results" / "report.html").read_text()
    assert "Couplings" in report
    assert "rigid body, coupling" in report
    assert main(["check", str(tmp_path / "job.toml")]) == 0


def test_a_model_and_its_job_are_the_same(tmp_path):
    job = load(
        tmp_path,
        JOB.replace(
            'on = "bar.right"',
            'on = "bar.right"\nfollow = ["x", "y"]\nradius = 9\naxes = { x = [0, 1, 0], xy = [1, 0, 0] }',
        ),
    )
    (coupling,) = job.model.couplings
    assert coupling.history("rz") == abut.Amplitude(((0.0, 0.0), (1.0, 1.0)))
    again = load_job(write_job(tmp_path / "again.toml", job)[0]).model
    assert again.couplings == job.model.couplings
    assert again.loads == job.model.loads


@pytest.mark.parametrize(
    ("old", "new", "message"),
    [
        (
            'on = "grip"\nvalue = [0.5',
            'on = "grp"\nvalue = [0.5',
            r"loads\[1\]\.on: no rigid body or coupling named 'grp'",
        ),
        ("value = [0.5, 0, 0]", "value = [0.5]", r"loads\[1\]\.value: expected 3 components, got 1"),
        ('name = "grip"\n', "", r"couplings\[0\]\.name"),
        (
            'name = "grip"\n',
            'name = "grip"\nkind = "rigid"\n',
            r"couplings\[0\]\.kind: expected 'kinematic' or 'distributing'",
        ),
        (
            'name = "grip"\n',
            'name = "grip"\nfollow = ["rx"]\n',
            r"couplings\[0\]\.follow\[0\]: expected 'x', 'y' or 'z'",
        ),
        ('name = "grip"\n', 'name = "grip"\nweight = [1]\n', r"couplings\[0\]\.weight: unknown key.*weights"),
        ('name = "grip"\n', 'name = "bar"\n', r"couplings\[0\]\.name: 'bar' is a body of the mesh"),
    ],
)
def test_what_is_wrong_has_its_place(old, new, message, tmp_path):
    with pytest.raises(InputError, match=message):
        load(tmp_path, JOB.replace(old, new, 1))

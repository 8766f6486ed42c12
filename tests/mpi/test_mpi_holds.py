"""Supports that come and go on two processes: forces and displacements of a serial run, and of a spring E A / L."""

from __future__ import annotations

import csv
import subprocess
from collections.abc import Callable
from pathlib import Path

import pytest

from abut.cli import main

Run = Callable[..., subprocess.CompletedProcess[str]]
JOB = """schema = 1
[mesh.bodies.bar]
kind = "box"
x = [0, 1]
y = [0, 1]
z = [0, 4]
cells = [2, 2, 8]
cell = "hex8"
[materials.m]
kind = "linear-elastic"
young = 1000
poisson = 0.0
[[solids]]
body = "bar"
material = "m"
[[supports]]
on = "bar.bottom"
x = 0
y = 0
z = 0
[[loads]]
kind = "force"
on = "bar.top"
value = [0, 0, -3]
amplitude = [[0, 0], [0.2, 0], [0.4, 1], [1, 1]]
[[holds]]
on = "bar.top"
z = 0.02
reached = 0.2
until = 0.4
released = 0.6
[[probes]]
name = "foot"
on = "bar.bottom"
of = ["reaction"]
[[probes]]
name = "top"
on = "bar.top"
of = ["reaction", "displacement"]
[solve]
times = [0.2, 0.4, 0.5, 0.6, 1.0]
"""


def _column(path: Path, column: str, **where: str) -> list[float]:
    rows = csv.DictReader(path.read_text().splitlines())
    return [float(row[column]) for row in rows if all(row[key] == value for key, value in where.items())]


def test_bar_held_loaded_and_let_go(mpirun: Run, tmp_path: Path) -> None:
    """Stiffness 250: held at 0.02, 5 and with the load 8; half of that at 0.5; none from 0.6 on. A hold gives a millionth of
    what a cell does."""
    job, serial, parts = tmp_path / "job.toml", tmp_path / "serial", tmp_path / "parts"
    job.write_text(JOB)
    assert main(["run", "--quiet", str(job), "--output", str(serial)]) == 0
    result = mpirun(2, "run", "--quiet", job, "--output", parts)
    assert result.returncode == 0, result.stderr
    for folder in (serial, parts):
        forces = folder / "forces.csv"
        assert _column(forces, "force_z", name="bar.top") == pytest.approx(
            [5.0, 8.0, 4.0, 0.0, 0.0], rel=1e-5, abs=1e-9
        )
        moved = _column(forces, "displacement_z", name="bar.top")
        assert moved == pytest.approx([0.02, 0.02, 0.004, -0.012, -0.012], rel=1e-5)
    feet = [_column(folder / "probe_foot.csv", "reaction_z") for folder in (serial, parts)]
    assert feet[1] == pytest.approx(feet[0], rel=1e-7)

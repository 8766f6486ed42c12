"""Frequencies and buckling loads on several processes are those of one, and of closed forms: tests/mpi/modes_alike.py."""

from __future__ import annotations

import json
import subprocess
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest

Run = Callable[..., subprocess.CompletedProcess[str]]
PROGRAM = str(Path(__file__).with_name("modes_alike.py"))
ALIKE = 1e-8  # eigenvalues: rounding of a stiffness, 1e-16, times its largest eigenvalue over that of the first mode
SHAPES = 1e-6  # to the root of what iterations are ended at, 1e-10, and there is a little to spare
STEEL = np.sqrt(210e3 / 7.85e-9 * 5.0**2 / 12.0) / 200.0**2 / (2.0 * np.pi)  # sqrt(E I / (rho A)) / L^2 / (2 pi)
CLAMPED, FREE = 1.87510407**2, 4.73004074**2  # of cos x cosh x = -1 and 1
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
density = 1.0
[[solids]]
body = "bar"
material = "m"
[[supports]]
on = "bar.bottom"
x = 0
y = 0
z = 0
[frequencies]
count = 3
"""


def alike(mpirun: Run, n: int, cases: list[str]) -> dict[str, dict[str, Any]]:
    result = mpirun(n, ",".join(cases), program=(PROGRAM,), timeout=200.0)
    assert result.returncode == 0, result.stderr
    found = {row["case"]: row for row in map(json.loads, result.stdout.splitlines())}
    assert list(found) == cases
    for row in found.values():
        assert row["far"] < ALIKE, row
        assert max(row["shapes"], row["effective"]) < SHAPES, row
        assert row["mass"] < 1e-12, row
        assert row["missing"] == 0, row
        assert row["certified"][0] == row["certified"][1], row
    return found


@pytest.mark.parametrize("n", [1, 2, 3])
def test_plates_bend_bonded_sliding_and_free(mpirun: Run, n: int) -> None:
    """Two plates: held, one of twice the height or each by itself; free, three motions without frequency. Shear lowers
    the frequencies of the first by .15 %."""
    found = alike(mpirun, n, ["bonded", "sliding", "sliding-finite", "free"])
    np.testing.assert_allclose(found["bonded"]["values"][0], 2.0 * CLAMPED * STEEL, rtol=2e-3)
    for case in ("sliding", "sliding-finite"):
        np.testing.assert_allclose(found[case]["values"][0], CLAMPED * STEEL, rtol=5e-4)
    assert found["free"]["values"][:3] == [0.0, 0.0, 0.0]
    np.testing.assert_allclose(found["free"]["values"][3], 2.0 * FREE * STEEL, rtol=1e-2)


@pytest.mark.parametrize("n", [1, 2, 3])
def test_columns_friction_rigid_tools_and_spin(mpirun: Run, n: int) -> None:
    """Euler's load of both plates bonded; contact that sticks here and slips there; unknowns that equations couple; a blade
    that turns, shaken near its first frequency."""
    found = alike(mpirun, n, ["columns", "pressed", "tool", "spinning"])
    euler = np.pi**2 * 210e3 * 10.0**3 / 12.0 / (4.0 * 200.0**2)
    np.testing.assert_allclose(np.array(found["columns"]["values"]) * 10.0, euler * np.array([1.0, 9.0]), rtol=2e-2)
    assert max(found["spinning"]["largest"]) < SHAPES


@pytest.mark.parametrize("n", [1, 3])
def test_pivots_count_frequencies(mpirun: Run, n: int) -> None:
    """Two plates that do not touch: each frequency comes twice, .02 to .5 % apart, so that a number a hundredth above the
    first of two has both below it, in the order of the modes."""
    result = mpirun(n, "counted", program=(PROGRAM,), timeout=100.0)
    assert result.returncode == 0, result.stderr
    row = json.loads(result.stdout)
    squares = np.array(row["squares"])
    assert row["below"] == [int((squares < 1.01 * square).sum()) for square in squares]


def test_a_job_writes_modes_as_one_process_does(mpirun: Run, tmp_path: Path) -> None:
    job = tmp_path / "job.toml"
    job.write_text(JOB)
    tables = []
    for n in (1, 2):
        result = mpirun(n, "run", job, "--output", tmp_path / str(n), "--quiet")
        assert result.returncode == 0, result.stderr
        assert {"modes.csv", "modes.vtu", "report.html"} <= {path.name for path in (tmp_path / str(n)).iterdir()}
        rows = (tmp_path / str(n) / "modes.csv").read_text().splitlines()
        tables.append([float(row.split(",")[2]) for row in rows[1:]])
    assert len(tables[0]) == 3
    np.testing.assert_allclose(*tables, rtol=ALIKE)


def test_what_is_missing_or_not_known_is_told_before_the_run(mpirun: Run, tmp_path: Path) -> None:
    job = tmp_path / "job.toml"
    job.write_text(JOB)
    result = mpirun(2, "run", job, SLEPC_DIR=str(tmp_path))
    assert result.returncode == 2
    assert "slepc4py is not installed for this Python: frequencies and buckling on several processes" in result.stderr
    job.write_text(JOB + "complex = true\n")
    result = mpirun(2, "run", job)
    assert result.returncode == 2
    assert "frequencies: complex = true: found on one process without PETSc" in result.stderr
    assert not (tmp_path / "results").exists()

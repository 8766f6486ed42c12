"""What a run on several processes leaves on disk is what a serial one leaves, in pieces."""

from __future__ import annotations

import json
import os
import re
import signal
import subprocess
import sys
import time
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from numpy.typing import NDArray
from vtkmodules.util.numpy_support import vtk_to_numpy
from vtkmodules.vtkIOHDF import vtkHDFReader

from abut.cli import main
from launcher import environment
from models.pieces import names, probe, read, volume
from models.steps import STEPS, job, stop_in

Run = Callable[..., subprocess.CompletedProcess[str]]
ROOT = Path(__file__).parents[2]
BLOCKS = ROOT / "examples" / "two-blocks" / "job.toml"


def listed(folder: Path) -> list[str]:
    return re.findall(r'file="([^"]*)"', (folder / "fields.pvd").read_text())


def test_pieces_of_a_run_are_the_whole(mpirun: Run, tmp_path: Path) -> None:
    """On three processes, then on two into the same directory, beside a serial run. Fields to 1e-8: the linear solution of
    either is accurate to about 1e-10."""
    serial, parts = tmp_path / "serial", tmp_path / "parts"
    assert main(["run", "--quiet", str(BLOCKS), "--output", str(serial)]) == 0
    for size in (3, 2):
        result = mpirun(size, "run", BLOCKS, "--output", parts, "--json")
        assert result.returncode == 0, result.stderr
        assert json.loads(result.stdout)["processes"] == size
    assert names(parts) == ["fields_0001.pvtu", "fields_0001_0000.vtu", "fields_0001_0001.vtu"]
    assert listed(parts) == ["fields_0001.pvtu"]
    one, other = read(serial / "fields_0001.vtu"), read(parts / "fields_0001.pvtu")
    assert one.GetNumberOfCells() == other.GetNumberOfCells()
    assert volume(other) == pytest.approx(volume(one), rel=1e-12)
    low, high = (np.array(one.GetBounds())[i::2] for i in (0, 1))
    places = low + (high - low) * np.random.default_rng(1).uniform(0.02, 0.98, (100, 3))
    places = places[[_inside(one, place) for place in places]]
    assert len(places) > 20
    expected, found = probe(one, places), probe(other, places)
    for key, values in expected.items():
        assert np.abs(found[key] - values).max() <= 1e-8 * np.abs(values).max(), key


def test_all_steps_in_one_file(mpirun: Run, tmp_path: Path) -> None:
    """fields.vtkhdf of two processes and of one: the same mesh, and displacements to 1e-8."""
    job = tmp_path / "job.toml"
    job.write_text(BLOCKS.read_text() + '\n[output]\nformats = ["vtkhdf"]\n')
    found = []
    for size in (1, 2):
        result = mpirun(size, "run", job, "--output", tmp_path / str(size))
        assert result.returncode == 0, result.stderr
        reader = vtkHDFReader()
        reader.SetFileName(str(tmp_path / str(size) / "fields.vtkhdf"))
        reader.Update()
        grid = reader.GetOutput()
        found.append(
            [vtk_to_numpy(grid.GetPoints().GetData()), vtk_to_numpy(grid.GetPointData().GetArray("displacement"))]
        )
    np.testing.assert_array_equal(found[0][0], found[1][0])
    assert np.abs(found[0][1] - found[1][1]).max() <= 1e-8 * np.abs(found[0][1]).max()


def _inside(grid: Any, place: NDArray[np.float64]) -> bool:
    from vtkmodules.vtkCommonDataModel import vtkStaticCellLocator

    locator = vtkStaticCellLocator()
    locator.SetDataSet(grid)
    locator.BuildLocator()
    return bool(locator.FindCell(list(place)) >= 0)


def test_restart_on_another_number_of_processes(mpirun: Run, tmp_path: Path) -> None:
    """From one process to two and back: each step keeps the files it has, and the results are those of one run."""
    whole, path = job(tmp_path / "whole"), job(tmp_path / "parts")
    assert main(["run", "--quiet", str(whole)]) == 0
    stop_in(path, 3)
    result = mpirun(2, "run", "--quiet", "--restart", path)
    assert result.returncode == 0, result.stderr
    results = path.parent / "results"
    assert listed(results) == [f"fields_{i:04d}.{'vtu' if i < 3 else 'pvtu'}" for i in range(1, STEPS + 1)]
    one, other = (json.loads((p.parent / "results" / "summary.json").read_text()) for p in (whole, path))
    forces = [[step["contacts"][0]["force"] for step in summary["steps"]] for summary in (one, other)]
    np.testing.assert_allclose(forces[1], forces[0], rtol=1e-7, atol=1e-7 * np.abs(forces[0]).max())


def started(path: Path, results: Path) -> subprocess.Popen[str]:
    """A job of two processes, which say who they are, after its second step."""
    command = ["mpiexec", "-n", "2", sys.executable, "-c", TELL, "run", str(path)]
    process = subprocess.Popen(command, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True, env=environment())
    end = time.monotonic() + 60.0
    while not (results / "fields_0002.pvtu").exists():
        assert time.monotonic() < end
        assert process.poll() is None
        time.sleep(0.02)
    return process


def running(number: int) -> bool:
    try:
        os.kill(number, 0)
    except ProcessLookupError:
        return False
    return True


def is_whole(results: Path) -> int:
    """Every file of the steps done is there and can be read, nothing else is; the number of the steps."""
    summary = json.loads((results / "summary.json").read_text())
    assert summary["status"] == "incomplete"
    done = len(summary["steps"])
    names = [f"fields_{i:04d}.pvtu" for i in range(1, done + 2)]
    assert listed(results) in (names[:-1], names)  # a process may be killed between fields.pvd and summary.json
    for name in listed(results):
        assert read(results / name).GetNumberOfCells() > 0
    return done


@pytest.mark.skipif(os.name != "posix", reason="needs signals")
def test_stopping_process_0_stops_all_in_order(tmp_path: Path) -> None:
    """SIGTERM to the process that leads: the steps done are whole, and a serial run goes on from them."""
    path, results = job(tmp_path, steps=60), tmp_path / "results"
    process = started(path, results)
    os.kill(int((tmp_path / "process0").read_text()), signal.SIGTERM)
    out, _ = process.communicate(timeout=60.0)
    assert process.returncode == 143, out
    assert f"steps 1 to {is_whole(results)} are in" in out
    assert not [p.name for p in results.iterdir() if p.name.startswith(".")]
    job(tmp_path, steps=STEPS)
    assert main(["run", "--quiet", "--restart", str(path)]) == 0


@pytest.mark.skipif(os.name != "posix", reason="needs signals")
@pytest.mark.parametrize("victim", [0, 1])
def test_a_killed_process_ends_the_job(victim: int, tmp_path: Path) -> None:
    """SIGKILL to one of them, as when memory runs out: the others end too; the steps done are whole, and a run goes on from
    them."""
    path, results = job(tmp_path, steps=60), tmp_path / "results"
    process = started(path, results)
    os.kill(int((tmp_path / f"process{victim}").read_text()), signal.SIGKILL)
    out, _ = process.communicate(timeout=60.0)
    assert process.returncode not in (None, 0), out
    end = time.monotonic() + 30.0
    while running(int((tmp_path / f"process{1 - victim}").read_text())):
        assert time.monotonic() < end
        time.sleep(0.1)
    is_whole(results)
    job(tmp_path, steps=STEPS)
    assert main(["run", "--quiet", "--restart", str(path)]) == 0
    assert not [p.name for p in results.iterdir() if p.name.startswith(".")]


TELL = """
import os, pathlib, sys
from abut.cli import main
from abut.parallel.launch import rank
pathlib.Path(sys.argv[2]).with_name(f"process{rank()}").write_text(str(os.getpid()))
sys.exit(main(sys.argv[1:]))
"""

"""Started by a real mpiexec: who speaks, what it ends with, what is left on disk."""

from __future__ import annotations

import json
import subprocess
from collections.abc import Callable
from pathlib import Path

import pytest

from models.steps import job

Run = Callable[..., subprocess.CompletedProcess[str]]

FORGETFUL = """
import sys
class Finder:
    def find_spec(self, name, *_):
        if name.split(".")[0] == "petsc4py":
            raise ModuleNotFoundError(name, name=name)
sys.meta_path.insert(0, Finder())
from abut.cli import main
sys.exit(main(sys.argv[1:]))
"""


def test_each_process_knows_its_place(mpirun: Run, tmp_path: Path) -> None:
    """Each tells it in a file of its own, since lines of several processes may mix on the way to one output."""
    tell = f"open({str(tmp_path)!r} + f'/{{rank()}}', 'w').write(str(processes()))"
    script = f"from abut.parallel.launch import *; require(); {tell}"
    result = mpirun(3, program=("-c", script))
    assert result.returncode == 0, result.stderr
    assert {path.name: path.read_text() for path in tmp_path.iterdir()} == {"0": "3", "1": "3", "2": "3"}


def test_without_petsc_one_message(mpirun: Run, tmp_path: Path) -> None:
    path = job(tmp_path)
    result = mpirun(3, "run", path, program=("-c", FORGETFUL))
    assert result.returncode == 2
    assert result.stderr.count("abut: error: petsc4py is not installed") == 1
    assert result.stderr.count("apt-get install") == 1
    assert [p.name for p in tmp_path.iterdir()] == ["job.toml"]


@pytest.mark.parametrize("arguments", [["run", "--quite"], ["run"], ["check", "-ksp_type", "minres"]])
def test_bad_arguments_one_message(mpirun: Run, arguments: list[str], tmp_path: Path) -> None:
    path = job(tmp_path, linear="direct")
    result = mpirun(2, arguments[0], path, *arguments[1:])
    assert result.returncode == 2
    assert result.stderr.count("error: ") == 1
    assert [p.name for p in tmp_path.iterdir()] == ["job.toml"]


def test_check_speaks_once(mpirun: Run, tmp_path: Path) -> None:
    result = mpirun(2, "check", "--json", job(tmp_path))
    assert result.returncode == 0, result.stderr
    assert json.loads(result.stdout)["status"] == 0


def test_options_reach_petsc_and_slips_are_named(mpirun: Run, tmp_path: Path) -> None:
    result = mpirun(2, "run", "--quiet", job(tmp_path, steps=1), "-ksp_type", "fgmres", "-ksp_tpye", "cg")
    assert result.returncode == 0, result.stderr
    assert "PETSc did not use -ksp_tpye: misspelt" in result.stderr
    notes = json.loads((tmp_path / "results" / "summary.json").read_text())["notes"]
    assert [note for note in notes if "did not use" in note] == [result.stderr.strip().removeprefix("abut: ")]


@pytest.mark.parametrize("option", ["-pc_type", "-ksp_type", "-stiffness_pc_type"])
def test_an_unknown_solver_one_message(mpirun: Run, option: str, tmp_path: Path) -> None:
    """PETSc looks for it on all processes at once, in the middle of the run: it is asked before."""
    result = mpirun(2, "run", "--quiet", job(tmp_path, steps=1), option, "gmag")
    assert result.returncode == 2
    assert result.stderr.count(f"abut: error: {option} gmag: this PETSc has no ") == 1
    assert "Traceback" not in result.stderr

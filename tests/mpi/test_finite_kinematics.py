"""Finite kinematics on several processes: the same steps, states and ends of a run as on one."""

from __future__ import annotations

import json
import os
import re
import signal
import subprocess
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from test_agree import PROGRAM, compared
from test_mpi_output import is_whole, started

from abut.cli import main
from models.steps import job, stop_in

Run = Callable[..., subprocess.CompletedProcess[str]]
MODELS = ["beam", "slid", "linear", "folds", "jaws", "cushion", "punch", "pad", "turned"]
SLID = """
schema = 1
[mesh.bodies.plate]
kind = "rectangle"
x = [0, 3]
y = [0, 1]
cells = [6, 2]
cell = "quad4"
[mesh.bodies.block]
kind = "rectangle"
x = [0.6, 1.6]
y = [1, 2]
cells = [3, 2]
cell = "quad4"
[model]
plane = "strain"
kinematics = "finite"
[materials.rubber]
kind = "neo-hooke"
young = 10
poisson = 0.4
[[solids]]
body = "plate"
material = "rubber"
[[solids]]
body = "block"
material = "rubber"
[[supports]]
on = "plate.bottom"
x = 0
y = 0
[[supports]]
on = "block.top"
x = 0.3
y = -0.1
[[contacts]]
contactor = "block.bottom"
target = "plate.top"
friction = 0.3
"""


@pytest.mark.parametrize("n", [2, 3])
def test_states_and_steps(mpirun: Run, n: int) -> None:
    """In the plane and in space: F-bar under a pressure that follows it, sliding with friction, bodies that touch
    themselves, rigid bodies that tilt, a surface that turns, a tie. Iterations are the same, so that load steps are, whose
    ends are compared too."""
    for row in compared(mpirun, n, MODELS, timeout=400.0).values():
        assert "mumps" in row["solver"]
        assert row["solutions"] == row["alone"]
    assert len(row["solutions"]) > 1


def test_one_analysis_serves_many_iterations(mpirun: Run) -> None:
    """As long as contact meets no new nodes: PETSc counts them."""
    result = mpirun(2, "punch", "-log_view", program=(PROGRAM,))
    assert result.returncode == 0, result.stderr
    symbolic, numeric = (counted(result.stdout, f"MatLUFactor{kind}") for kind in ("Sym", "Num"))
    assert numeric >= sum(json.loads(result.stdout.splitlines()[0])["solutions"])
    assert symbolic < numeric / 2


@pytest.mark.parametrize("n", [2, 3])
def test_multigrid_of_the_tangent(mpirun: Run, n: int) -> None:
    """Newton's method asks for no more accuracy than it needs, and is done when a billionth of the forces is left."""
    for row in compared(mpirun, n, ["beam", "cushion", "turned"], "-pc_type", "gamg", timeout=400.0).values():
        assert "gamg" in row["solver"]


def test_multigrid_is_set_up_once_a_step(mpirun: Run) -> None:
    """PETSc counts how often; an iteration takes a few dozen Krylov iterations, however much contact has changed."""
    result = mpirun(2, "turned", "-pc_type", "gamg", "-log_view", program=(PROGRAM,))
    assert result.returncode == 0, result.stderr
    assert counted(result.stdout, r"PCSetUp_GAMG\+") == 2
    row = json.loads(result.stdout.splitlines()[0])
    assert int(row["note"].split()[0]) < 30 * sum(row["solutions"])


def counted(log: str, event: str) -> int:
    """How often an event took place, by PETSc's -log_view."""
    found = re.search(rf"^ *{event} +(\d+)", log, re.MULTILINE)
    assert found is not None
    return int(found[1])


def summary(folder: Path) -> dict[str, Any]:
    found: dict[str, Any] = json.loads((folder / "results" / "summary.json").read_text())
    return found


def test_restart(mpirun: Run, tmp_path: Path) -> None:
    """Begun on one process, ended on two: what friction remembers of the last step travels in the restart file."""
    whole, path = (job(tmp_path / name, SLID, steps="auto") for name in ("whole", "parts"))
    assert main(["run", "--quiet", str(whole)]) == 0
    stop_in(path, 3)
    result = mpirun(2, "run", "--quiet", "--restart", path)
    assert result.returncode == 0, result.stderr
    one, other = summary(whole.parent), summary(path.parent)
    assert (one["processes"], other["processes"]) == (1, 2)
    for key in ("factor", "iterations"):
        assert [step[key] for step in one["steps"]] == [step[key] for step in other["steps"]], key
    forces = [[step["contacts"][0]["force"] for step in each["steps"]] for each in (one, other)]
    np.testing.assert_allclose(forces[1], forces[0], rtol=1e-8, atol=1e-8 * np.abs(forces[0]).max())


def changed(changes: dict[str, str]) -> str:
    """The job with other lines."""
    text = SLID
    for old, new in changes.items():
        assert old in text
        text = text.replace(old, new)
    return text


FLAT = {"y = -0.1": "y = -1.9"}  # the block is pressed flat: cells turn inside out, steps get too short
LOOSE = {  # nothing holds the block against a pressure from the side
    "x = 0.3": "", "friction = 0.3": '[[loads]]\nkind = "pressure"\non = "block.left"\nvalue = 1',
}  # fmt: skip


def inside_out(notes: list[str]) -> list[str]:
    """The first step that failed so and its cell; how far it was, and after how many iterations, is of rounding, which
    iterations that diverge enlarge."""
    told = (re.search(r"(step \d+) .*\((cell .*?) turns inside out", note) for note in notes)
    return [" ".join(found.groups()) for found in told if found][:1]


def said(text: str) -> list[str]:
    """Errors, without how far a drag was from coming to rest, for the same reason."""
    lines = [line for line in text.splitlines() if line.startswith("abut: ")]
    return [re.sub(r"not enough: .* multipliers that change", "", line) for line in lines]


@pytest.mark.parametrize(("changes", "status"), [(FLAT, 3), (LOOSE, 4)])
def test_a_run_that_fails(
    mpirun: Run, changes: dict[str, str], status: int, tmp_path: Path, capfd: pytest.CaptureFixture[str]
) -> None:
    """Same exit status, message and notes, and no process is left waiting."""
    path = job(tmp_path, changed(changes), steps="auto")
    assert main(["run", "--quiet", str(path)]) == status
    alone = capfd.readouterr().err
    notes = summary(tmp_path)["notes"] if status == 3 else []
    result = mpirun(3, "run", "--quiet", path, timeout=300.0)
    assert result.returncode == status
    assert said(result.stderr) == said(alone)
    if status == 3:
        assert inside_out(notes)
        assert inside_out(notes) == inside_out(summary(tmp_path)["notes"])


@pytest.mark.skipif(os.name != "posix", reason="needs signals")
def test_stopping_process_0_stops_all_in_order(tmp_path: Path) -> None:
    """SIGTERM in the middle: the steps done are whole, and one process goes on from them."""
    path, results = job(tmp_path, SLID, steps=60), tmp_path / "results"
    process = started(path, results)
    os.kill(int((tmp_path / "process0").read_text()), signal.SIGTERM)
    out, _ = process.communicate(timeout=60.0)
    assert process.returncode == 143, out
    assert f"steps 1 to {is_whole(results)} are in" in out
    job(tmp_path, SLID, steps="auto")
    assert main(["run", "--quiet", "--restart", str(path)]) == 0

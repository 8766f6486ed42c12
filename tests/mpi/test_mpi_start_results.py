"""Jobs that start from another one, on two processes: what one job with all steps gives on one process."""

from __future__ import annotations

import subprocess
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest

from abut.cli import main

Run = Callable[..., subprocess.CompletedProcess[str]]
TOOL = """schema = 1
[model]
plane = "strain"
kinematics = "finite"
[mesh.bodies.block]
kind = "rectangle"
x = [-2, 2]
y = [-2, 0]
cells = [8, 3]
cell = "quad4"
[mesh.bodies.tool]
kind = "rectangle"
x = [-1, 1]
y = [0, 1]
cells = [4, 2]
cell = "quad4"
[materials.soft]
kind = "hencky"
young = 1000
poisson = 0.3
[[solids]]
body = "block"
material = "soft"
[[supports]]
on = "block.bottom"
x = 0
y = 0
[[contacts]]
name = "c"
contactor = "block.top"
target = "tool.bottom"
friction = 0.2
[[rigid]]
body = "tool"
y = -0.05
x = 0.1
amplitudes.y = [["start", 0], ["assemble", 1]AND_Y]
amplitudes.x = [["start", 0], ["assemble", 0.4]AND_X]
"""
BOLT = """schema = 1
[mesh.bodies.bolt]
kind = "box"
x = [0, 1]
y = [0, 1]
z = [0, 6]
cells = [2, 2, 6]
[mesh.bodies.arm]
kind = "box"
x = [0, 4]
y = [0, 1]
z = [8, 9]
cells = [4, 1, 1]
[materials.m]
kind = "linear-elastic"
young = 1000
poisson = 0.0
[[solids]]
body = "bolt"
material = "m"
[[supports]]
on = "bolt.bottom"
x = 0
y = 0
z = 0
[[supports]]
on = "bolt.top"
z = 0.1
amplitude = [["start", 0], ["assemble", 0]AND_X]
[[preloads]]
name = "b"
body = "bolt"
force = 3
amplitude = [["start", 0], ["assemble", 1]AND_Y]
LOCK
[[rigid]]
body = "arm"
[[connectors]]
name = "hinge"
kind = "hinge"
on = "arm"
at = [0, 0, 8]
axis = [0, 1, 0]
stiffness = 5
[[loads]]
kind = "force"
on = "arm"
value = [0, 0, -1]
"""


def _text(job: str, part: str, name: str) -> str:
    """part: "first", "second" or "whole"."""
    steps = '[[steps]]\nname = "assemble"\nincrements = 3\n'
    ways = {"AND_Y": ', ["load", 1]', "AND_X": ', ["load", 1]', "LOCK": 'lock = "assemble"'}
    load = "value = [0, 0, -1]\n"
    pushed = load + 'amplitude = [["start", 0], ["assemble", 0.5]{}]\n'
    if part == "first":
        ways, pushed = dict.fromkeys(ways, ""), pushed.format("")
    else:
        steps += '[[steps]]\nname = "load"\nincrements = 3\n'
        pushed = pushed.format(', ["load", 1]')
    job = job.replace(load, pushed)
    for key, text in ways.items():
        job = job.replace(key, text)
    start = '[start]\nresults = "first"\ntime = "assemble"\n' if part == "second" else ""
    keep = "restart = true\n" if part == "first" else ""
    return f'{job}{steps}{start}[output]\ndirectory = "{name}"\n{keep}'


@pytest.mark.parametrize("job", [TOOL, BOLT], ids=["tool", "bolt"])
@pytest.mark.parametrize("before", [1, 2])
def test_two_jobs_on_two_processes(job: str, before: int, mpirun: Run, tmp_path: Path) -> None:
    """A rigid tool that slides far with friction; a locked bolt beside a hinge. The first job on one process or two, and
    the solvers of both leave 1e-9."""
    for part in ("first", "second", "whole"):
        (tmp_path / f"{part}.toml").write_text(_text(job, part, part))
    if before == 1:
        assert main(["run", "--quiet", str(tmp_path / "first.toml")]) == 0
    else:
        assert mpirun(2, "run", "--quiet", tmp_path / "first.toml").returncode == 0
    done = mpirun(2, "run", "--quiet", tmp_path / "second.toml")
    assert done.returncode == 0, done.stderr
    assert main(["run", "--quiet", str(tmp_path / "whole.toml")]) == 0
    second, whole = (_numbers(tmp_path / part / "forces.csv") for part in ("second", "whole"))
    assert len(whole) > 100
    np.testing.assert_allclose(second, whole, rtol=1e-6, atol=1e-6 * np.abs(whole).max())


def _numbers(path: Path) -> np.ndarray:
    """Of a table, text left out."""
    parts = [part for line in path.read_text().splitlines()[1:] for part in line.split(",")]
    return np.array([float(part) for part in parts if _is_number(part)])


def _is_number(text: str) -> bool:
    try:
        float(text)
    except ValueError:
        return False
    return True

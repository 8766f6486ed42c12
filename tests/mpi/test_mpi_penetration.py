"""A fluid that enters a contact, on two processes: as far, and with the forces, of a serial run."""

from __future__ import annotations

import json
import subprocess
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest

from abut.cli import main

Run = Callable[..., subprocess.CompletedProcess[str]]
JOB = """schema = 1
model.plane = "strain"
model.kinematics = "KINEMATICS"
mesh.bodies.low = { kind = "rectangle", x = [0, 10], y = [-2, 0], cells = [10, 2], cell = "quad4" }
mesh.bodies.top = { kind = "rectangle", x = [0, 10], y = [0, 2], cells = [10, 2], cell = "quad4" }
materials.rubber = { kind = "linear-elastic", young = 1000, poisson = 0.3 }
solids = [{ body = "low", material = "rubber" }, { body = "top", material = "rubber" }]
supports = [{ on = "low.bottom", x = 0, y = 0 }, { on = "top.right", x = 0 }]
loads = [{ kind = "pressure", on = "top.top", value = "1 + x", amplitude = [[0, 0], [0.5, 1]] }]
contacts = [{ name = "joint", surfaces = ["low.top", "top.bottom"] }]
penetrations = [{ contact = "joint", source = "low.left", value = 4, amplitude = [[0.5, 0], [1, 1]] }]
solve.times = [0.5, 1.0]
"""


def _last(folder: Path) -> dict[str, Any]:
    last: dict[str, Any] = json.loads((folder / "results" / "summary.json").read_text())["steps"][-1]
    return last


@pytest.mark.parametrize("kinematics", ["small", "finite"])
def test_a_fluid_in_a_joint(kinematics: str, tmp_path: Path, mpirun: Run) -> None:
    found = []
    for name in ("one", "two"):
        (tmp_path / name).mkdir()
        path = tmp_path / name / "job.toml"
        path.write_text(JOB.replace("KINEMATICS", kinematics))
        if name == "one":
            assert main(["run", "--quiet", str(path)]) == 0
        else:
            result = mpirun(2, "run", path)
            assert result.returncode == 0, result.stderr
        found.append(_last(tmp_path / name))
    one, two = found
    assert one["penetrations"]["joint"]["area"] > 0.9
    assert two["penetrations"]["joint"]["area"] == pytest.approx(one["penetrations"]["joint"]["area"], rel=1e-6)
    assert two["contacts"][0]["force"] == pytest.approx(one["contacts"][0]["force"], rel=1e-6, abs=1e-6)

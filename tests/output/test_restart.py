"""Runs that end early: what is left on disk, and that going on from it gives what the whole run gives."""

from __future__ import annotations

import json
import os
import re
import signal
import subprocess
import sys
import time
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from numpy.typing import NDArray

import abut
from abut.cli import main
from abut.job import load_job
from abut.linear import static_condensation
from abut.output.restart import FOLDER, description, differences, load_steps
from abut.output.stream import LOG
from models.steps import BALL, STEPS, arrays, job, stop_in

ROOT = Path(__file__).parents[2]


def assert_close(a: NDArray[Any], b: NDArray[Any], name: str) -> None:
    """To 1e-12 of the largest value: PARDISO itself repeats its results only up to rounding (the order of its sums goes by
    where in memory the numbers lie). Gaps that are closed are rounding in a model of size 10, whence the floor."""
    size = np.nanmax(np.abs(a), initial=1e-3)
    np.testing.assert_allclose(a, b, rtol=1e-12, atol=1e-12 * size, err_msg=name)


def table(path: Path) -> tuple[list[str], NDArray[Any]]:
    """Head and numbers of history.csv, whose fourth column is a name."""
    head, *rows = [line.split(",") for line in path.read_text().splitlines()]
    return head, np.array([[float(value) for value in row[:3] + row[4:]] for row in rows])


def assert_same_results(one: Path, two: Path) -> None:
    names = sorted(p.name for p in one.iterdir())
    assert names == sorted(p.name for p in two.iterdir())
    assert not any(name.endswith(".part") or name == FOLDER for name in names)
    for name in names:
        if name.endswith(".vtu"):
            for (key, a), (_, b) in zip(arrays(one / name), arrays(two / name)):
                assert_close(a, b, f"{name} {key}")
        elif name.endswith(".pvd"):
            assert (one / name).read_text() == (two / name).read_text()
    (head, whole), (other, parts) = table(one / "history.csv"), table(two / "history.csv")
    assert head == other
    assert len(whole) == STEPS
    for column in range(whole.shape[1]):
        assert_close(whole[:, column], parts[:, column], "history.csv")
    summaries = [json.loads((folder / "summary.json").read_text()) for folder in (one, two)]
    assert [s["status"] for s in summaries] == ["converged", "converged"]
    iterations = [[step["iterations"] for step in s["steps"]] for s in summaries]
    assert iterations[0] == iterations[1]
    logs = [[json.loads(line) for line in (folder / "run.jsonl").read_text().splitlines()] for folder in (one, two)]
    rows = [[(r["step"], r["iteration"], r["active"]) for r in log if "step" in r] for log in logs]
    assert rows[0] == rows[1]


def elimination(_: pytest.MonkeyPatch) -> dict[str, str]:
    return {"linear": "direct"}


def sparse_saddle(patch: pytest.MonkeyPatch) -> dict[str, str]:
    patch.setattr(static_condensation, "LARGEST", 0)
    return {"linear": "direct"}


def multigrid(_: pytest.MonkeyPatch) -> dict[str, str]:
    return {"linear": "amg"}


@pytest.mark.long
@pytest.mark.parametrize(("solver", "number"), [(elimination, 2), (sparse_saddle, 3), (multigrid, 4)])
def test_restarted_run_equals_the_whole_one(
    solver: Callable[[pytest.MonkeyPatch], dict[str, str]], number: int, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """In as many iterations: the next step starts from the same numbers as if the run had not stopped."""
    options = solver(monkeypatch)
    whole, parts = job(tmp_path / "whole", **options), job(tmp_path / "parts", **options)
    assert main(["run", "--quiet", str(whole)]) == 0
    stop_in(parts, number)
    results = parts.parent / "results"
    left = json.loads((results / "summary.json").read_text())
    assert left["status"] == "incomplete"
    assert len(left["steps"]) == number - 1
    assert (results / "fields.pvd").read_text().count("<DataSet") == number - 1
    assert not (results / LOG).exists()
    (results / "fields_0001.vtu").unlink()  # comes back
    assert main(["run", "--quiet", "--restart", str(parts)]) == 0
    assert_same_results(whole.parent / "results", results)


@pytest.mark.long
def test_restart_with_the_constraint_function(tmp_path: Path) -> None:
    """Its start depends on displacements and pressures, not on the active set alone."""
    text = BALL.replace('"plane.top"]', '"plane.top"]\nlaw = "constraint-function"')
    assert "constraint-function" in text
    whole, parts = job(tmp_path / "whole", text), job(tmp_path / "parts", text)
    assert main(["run", "--quiet", str(whole)]) == 0
    stop_in(parts, 3)
    assert main(["run", "--quiet", "--restart", str(parts)]) == 0
    assert_same_results(whole.parent / "results", parts.parent / "results")


@pytest.mark.long
def test_restart_with_more_steps(tmp_path: Path) -> None:
    """How it is solved may change: what is left of the load comes in smaller steps, to the same end."""
    path = job(tmp_path)
    stop_in(path, 3)
    job(tmp_path, steps=2 * STEPS)
    assert main(["run", "--quiet", "--restart", str(path)]) == 0
    steps = json.loads((tmp_path / "results" / "summary.json").read_text())["steps"]
    assert [step["factor"] for step in steps] == pytest.approx([0.2, 0.4, 0.5, 0.6, 0.7, 0.8, 0.9, 1.0])
    once = abut.solve(replace(load_job(path).model, solve=abut.SolveOptions()))
    assert steps[-1]["contacts"][0]["force"] == pytest.approx(once.contacts[0].force.tolist(), rel=1e-9, abs=1e-9)


def test_a_run_that_did_not_converge_goes_on_with_more_iterations(tmp_path: Path) -> None:
    path = job(tmp_path, steps=2, max_iterations=1)
    status = main(["run", "--quiet", str(path)])
    done = json.loads((tmp_path / "results" / "summary.json").read_text())["steps"]
    assert (status, done[-1]["converged"]) == (3, False)
    job(tmp_path, steps=2, max_iterations=50)
    if len(done) == 1:  # nothing converged: there is nothing to go on with
        assert main(["run", "--quiet", "--restart", str(path)]) == 2
    else:
        assert main(["run", "--quiet", "--restart", str(path)]) == 0


# fmt: off
CHANGES = {
    "material": ("young = ", "young = 1", ".material.young: was "),
    "mesh": ("cells = 4", "cells = 5", "mesh.points: changed"),
    "support": ("[[contacts]]", '[[supports]]\non = "ball.top"\nx = 0\n[[contacts]]', "supports["),
    "load": ("[[contacts]]", '[[loads]]\nkind = "gravity"\nvalue = [0, 0, 1]\n[[contacts]]', "loads[1]: new"),
    "contact": ("[[contacts]]", "[[contacts]]\noffset = 0.001", "contacts[0].offset: was 0.0, is 0.001"),
}
# fmt: on


@pytest.mark.parametrize("change", CHANGES)
def test_changed_model_is_refused(change: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    old, new, message = CHANGES[change]
    assert old in BALL
    text = BALL.replace(old, new, 1)
    if change == "support":
        surface = next(iter(load_job(job(tmp_path)).model.mesh.surfaces))
        text = text.replace("ball.top", surface)
    path = job(tmp_path)
    stop_in(path, 2)
    job(tmp_path, text)
    assert main(["run", "--restart", str(path)]) == 2
    error = capsys.readouterr().err
    assert "the model is not the one" in error
    assert message in error
    assert "steps in" in error or "--restart" in error


def test_restart_without_anything_to_go_on_with(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    path = job(tmp_path, steps=1)
    assert main(["run", "--restart", str(path)]) == 2
    assert "nothing to go on with" in capsys.readouterr().err
    assert not (tmp_path / "results").exists()
    assert main(["run", "--quiet", str(path)]) == 0
    assert main(["run", "--restart", str(path)]) == 2  # finished
    assert "a run there has finished" in capsys.readouterr().err


@pytest.mark.long
@pytest.mark.parametrize("keep", [0, 10, 0.5])
def test_damaged_restart_file_is_refused(keep: float, tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    path = job(tmp_path)
    stop_in(path, 3)
    file = tmp_path / "results" / FOLDER / "0002.npz"
    data = file.read_bytes()
    file.write_bytes(data[: int(keep if keep >= 1 else keep * len(data))])
    assert main(["run", "--restart", str(path)]) == 2
    assert "not a whole restart file; remove it" in capsys.readouterr().err
    file.unlink()
    assert main(["run", "--quiet", "--restart", str(path)]) == 0


def test_new_run_drops_restart_data_of_an_earlier_one(tmp_path: Path) -> None:
    path = job(tmp_path)
    stop_in(path, 5)
    stop_in(path, 3)
    assert len(load_steps(tmp_path / "results", description(load_job(path).model))) == 2


def test_differences_name_what_is_new_gone_and_changed() -> None:
    before = {"loads[0]": "Force", "loads[0].on": "'a'", "plane": "'strain'", "mesh.points": "x"}
    now = {"plane": "'stress'", "mesh.points": "y", "supports[1]": "Support", "supports[1].on": "'b'"}
    assert differences(before, now) == [
        "loads[0]: gone", "plane: was 'strain', is 'stress'", "mesh.points: changed", "supports[1]: new"
    ]  # fmt: skip


def abut_run(path: Path, *options: str) -> subprocess.Popen[str]:
    return subprocess.Popen(
        [sys.executable, "-u", "-m", "abut.cli", "run", str(path), *options],
        stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True,
    )  # fmt: skip


def wait_for_step(process: subprocess.Popen[str], number: int) -> None:
    assert process.stdout is not None
    for line in process.stdout:
        if line.split()[:2] == [str(number), "1"]:
            return
    raise AssertionError(process.communicate())


@pytest.mark.long
@pytest.mark.skipif(os.name != "posix", reason="signals as POSIX has them")
@pytest.mark.parametrize(("sent", "status"), [("SIGINT", 130), ("SIGTERM", 143)])
def test_ctrl_c_keeps_the_steps_done(sent: str, status: int, tmp_path: Path) -> None:
    path = job(tmp_path, steps=400)
    process = abut_run(path)
    wait_for_step(process, 3)
    process.send_signal(getattr(signal, sent))
    _, error = process.communicate(timeout=60)
    assert process.returncode == status
    assert "stopping after the current iteration" in error
    assert "abut run --restart" in error
    assert "Traceback" not in error
    done = int(re.search(r"steps 1 to (\d+) are in", error)[1])  # type: ignore[index]
    assert f"up to time {done / 400:.4g} of 1; go on" in error
    left = json.loads((tmp_path / "results" / "summary.json").read_text())
    assert left["status"] == "incomplete"
    assert len(left["steps"]) >= 2
    files = {".html", ".json", ".csv", ".jsonl", ".pvd", ".vtu", ""}
    assert {p.suffix for p in (tmp_path / "results").iterdir()} == files
    report = (tmp_path / "results" / "report.html").read_text(encoding="utf-8")
    assert f"Stopped after step {done}, time {done / 400:.4g} of 1 reached: there are steps left." in report


@pytest.mark.skipif(os.name != "posix", reason="signals as POSIX has them")
def test_second_ctrl_c_does_not_wait(tmp_path: Path) -> None:
    """A thread answers, so that neither has to wait for a compiled function to return."""
    script = (
        "import sys, time\n"
        "from abut.cli.interrupt import Interrupt\n"
        "with Interrupt(lambda text: print(text, file=sys.stderr, flush=True), leave=lambda: None):\n"
        "    print('ready', flush=True)\n"
        "    time.sleep(60)\n"
    )
    process = subprocess.Popen(
        [sys.executable, "-c", script], stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True
    )
    assert process.stdout is not None
    assert process.stderr is not None
    assert process.stdout.readline() == "ready\n"
    process.send_signal(signal.SIGINT)
    assert "once more: at once" in process.stderr.readline()
    began = time.monotonic()
    process.send_signal(signal.SIGINT)
    assert process.wait(timeout=30) == 130
    assert time.monotonic() - began < 20


@pytest.mark.skipif(os.name != "posix", reason="signals as POSIX has them")
def test_ctrl_c_before_the_first_step_writes_nothing(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    path = job(tmp_path)
    import abut.analysis as analysis

    solve = analysis.solve

    def interrupted(*arguments: Any, **options: Any) -> Any:
        os.kill(os.getpid(), signal.SIGINT)
        time.sleep(0.5)  # the thread that answers signals needs a moment
        return solve(*arguments, **options)

    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(analysis, "solve", interrupted)
        assert main(["run", str(path)]) == 130
    assert "stopped before the first step converged: nothing is written" in capsys.readouterr().err
    assert [p.name for p in tmp_path.iterdir()] == ["job.toml"]


def test_restart_of_a_load_history(tmp_path: Path) -> None:
    """Loaded, partly unloaded and loaded again at uneven times: what is rounding is judged by the steps before, too."""
    load = next(line for line in BALL.splitlines() if line.startswith("value"))
    history = "amplitude = [[0.0, 0.0], [0.4, 1.0], [0.6, 0.1], [1.0, 0.8]]"
    text = BALL.replace(load, f"{load}\n{history}")
    options = {"times": [0.2, 0.4, 0.6, 0.9, 1.0], "steps": 1}
    whole, parts = job(tmp_path / "whole", text, **options), job(tmp_path / "parts", text, **options)
    assert main(["run", "--quiet", str(whole)]) == 0
    stop_in(parts, 4)
    assert main(["run", "--quiet", "--restart", str(parts)]) == 0
    assert_same_results(whole.parent / "results", parts.parent / "results")


MIXED = """
schema = 1

[mesh.bodies.plate]
kind = "box"
x = [-0.5, 1.5]
y = [-0.5, 1.5]
z = [-0.2, 0]
cells = [2, 2, 1]

[mesh.bodies.block]
kind = "box"
x = [0, 1]
y = [0, 1]
z = [0, 0.5]
cells = [2, 2, 1]
cell = "tet10"

[materials.steel]
kind = "hencky"
young = 100
poisson = 0.3

[materials.soft]
kind = "plastic"
young = 3
poisson = 0.499
yield_stress = 0.05
hardening = 0.1

[[solids]]
body = "plate"
material = "steel"

[[solids]]
body = "block"
material = "soft"
integration = "mixed"

[[supports]]
on = "plate.bottom"
x = 0
y = 0
z = 0

[[supports]]
on = "block.top"
x = 0.03
y = 0
z = -0.05

[[contacts]]
name = "foot"
surfaces = ["block.bottom", "plate.top"]
friction = 0.3
"""


@pytest.mark.long
@pytest.mark.parametrize("kinematics", ["small", "finite"])
def test_restart_with_continuous_pressures(kinematics: str, tmp_path: Path) -> None:
    """Mixed tet10 of metal that flows and slips: pressures at corners follow from displacements, so that nothing of them is
    kept."""
    text = MIXED.replace("hencky", "linear-elastic") if kinematics == "small" else MIXED
    text += f'\n[model]\nkinematics = "{kinematics}"\n'
    whole, parts = job(tmp_path / "whole", text), job(tmp_path / "parts", text)
    assert main(["run", "--quiet", str(whole)]) == 0
    stop_in(parts, 3)
    assert main(["run", "--quiet", "--restart", str(parts)]) == 0
    assert_same_results(whole.parent / "results", parts.parent / "results")

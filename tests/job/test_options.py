"""Every subcommand with every combination of the options that its help lists: a set exit status, never a traceback."""

from __future__ import annotations

import argparse
import json
from itertools import combinations
from pathlib import Path

import numpy as np
import pytest

from abut.benchmarks import BENCHMARKS, Benchmark, Outcome, Reference
from abut.cli import _parser, main
from abut.job import load_job
from abut.verify import interface_patch
from models.decks import BRICKS, HELD, PAIR, PUSH, write

JOB = """schema = 1
parameters = { stiff = 1000 }
[mesh.bodies.lower]
kind = "rectangle"
x = [0, 4]
y = [0, 1]
cells = [4, 1]
cell = "quad4"
[mesh.bodies.upper]
kind = "rectangle"
x = [1, 3]
y = [1, 2]
cells = [3, 1]
cell = "quad4"
[materials.m]
kind = "linear-elastic"
young = "=stiff"
poisson = 0.3
[model]
plane = "strain"
[[solids]]
body = "lower"
material = "m"
[[solids]]
body = "upper"
material = "m"
[[supports]]
on = "lower.bottom"
x = 0
y = 0
[[supports]]
on = "upper.top"
x = 0
y = -0.01
[[contacts]]
name = "c"
contactor = "upper.bottom"
target = "lower.top"
"""
SOLID = """schema = 1
solve = { linear = "petsc" }
mesh = { bodies = { b = { kind = "box", cells = [1, 1, 1] } } }
materials = { m = { kind = "linear-elastic", young = 1000.0, poisson = 0.3 } }
solids = [{ body = "b", material = "m" }]
supports = [{ on = "b.bottom", x = 0, y = 0, z = 0 }]
"""
VALUES = {  # of options that take one; {} is the folder of the test
    ("run", "--ignore"): "FRICTION", ("run", "--output"): "{}/results", ("run", "--set"): "stiff=2e3",
    ("sweep", "--set"): "stiff=1e3,2e3", ("sweep", "--output"): "{}/sweep",
    ("mesh", "--size"): "2", ("mesh", "--contact-size"): "0.5", ("mesh", "--reach"): "0.1", ("mesh", "--cell"): "tet4",
    ("mesh", "--unit"): "m", ("mesh", "--names"): "a", ("mesh", "--hold"): "a.zmin", ("mesh", "--press"): "a.zmax=1",
    ("mesh", "--output"): "{}/part.toml", ("mesh", "--gmsh"): "gmsh", ("check", "--set"): "stiff=2e3",
    ("check", "--ignore"): "FRICTION", ("check", "--output"): "{}/motions", ("check", "--write-pairs"): "{}/pairs.toml",
    ("convert", "--ignore"): "FRICTION", ("convert", "--set"): "stiff=2e3",
    ("verify", "--set"): "stiff=2e3", ("infsup", "--set"): "stiff=2e3",
    ("verify", "--levels"): "2", ("verify", "--plot"): "{}/plot.svg", ("verify", "--job"): "{}/job.toml",
    ("verify", "--output"): "{}/swap",
    ("infsup", "--contact"): "c", ("infsup", "--levels"): "2",
    ("schema", "--output"): "{}/schema.json",
    ("fit", "--uniaxial"): "{}/tension.csv", ("fit", "--planar"): "{}/tension.csv", ("fit", "--biaxial"): "{}/tension.csv",
    ("fit", "--terms"): "2", ("fit", "--bulk"): "100", ("fit", "--poisson"): "0.499", ("fit", "--name"): "rubber",
    ("fit", "--plot"): "{}/fit.html",
}  # fmt: skip
SUBJECTS = {  # of each subcommand
    "run": (["{}/job.toml"], ["{}/deck.inp"]),
    "sweep": (["{}/job.toml"], ["{}/none.toml"]),
    "mesh": (["{}/none.step", "--size", "1"],),
    "check": (["{}/job.toml"], ["{}/auto.toml"], ["{}/deck.inp"], ["{}/loose.toml"], ["{}/petsc.toml"]),
    "convert": (["{}/deck.inp", "{}/new.toml"], ["{}/deck.inp", "{}/new.vtu"], ["{}/job.toml", "{}/new.toml"]),
    "verify": ([], ["one"], ["none"]),
    "infsup": (["{}/job.toml"], ["{}/deck.inp"]),
    "schema": ([],),
    "fit": (["yeoh"], ["ogden"]),
}

AT_ONCE = {"fit": 2, "run": 4, "check": 3, "mesh": 2}  # options of these many, which say something each on their own


def commands() -> dict[str, argparse.ArgumentParser]:
    (action,) = (own for own in _parser()._actions if isinstance(own, argparse._SubParsersAction))
    return dict(action.choices)


def options(command: str) -> list[argparse.Action]:
    return [own for own in commands()[command]._actions if own.option_strings and own.dest != "help"]


def cases() -> list[tuple[str, int, tuple[str, ...]]]:
    return [
        (command, subject, tuple(own.option_strings[-1] for own in chosen))
        for command, subjects in SUBJECTS.items()
        for subject in range(len(subjects))
        for count in range(AT_ONCE.get(command, len(options(command))) + 1)
        for chosen in combinations(options(command), count)
    ]


def _benchmark(name: str, error: float) -> Benchmark:
    """Its values are NumPy's, as those of most benchmarks."""
    return Benchmark(
        name, "told", lambda level: level, lambda level: {"q": np.float64(2.0 + error * 0.25**level)},
        {"q": Reference(2.0, 0.1, "a book", "none")}, solve=lambda level: level,
    )  # fmt: skip


@pytest.fixture
def folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    (tmp_path / "job.toml").write_text(JOB)
    (tmp_path / "tension.csv").write_text(
        "stretch,stress\n" + "".join(f"{s},{s - s**-2}\n" for s in np.linspace(0.8, 2, 9))
    )
    (tmp_path / "petsc.toml").write_text(SOLID)
    (tmp_path / "auto.toml").write_text(JOB.split('name = "c"')[0] + "auto = true\n")
    (tmp_path / "loose.toml").write_text(JOB.replace('on = "upper.top"\nx = 0', 'on = "upper.top"'))
    write(tmp_path, BRICKS + PAIR + HELD + PUSH)
    for name in list(BENCHMARKS):
        monkeypatch.delitem(BENCHMARKS, name)
    monkeypatch.setitem(BENCHMARKS, "one", _benchmark("one", 0.01))
    monkeypatch.setitem(BENCHMARKS, "two", _benchmark("two", 1.0))
    return tmp_path


def test_every_command_and_option_is_run() -> None:
    assert set(commands()) == set(SUBJECTS)
    valued = {(c, o.option_strings[-1]) for c in commands() for o in options(c) if o.nargs != 0}
    assert valued == set(VALUES)


@pytest.mark.long
@pytest.mark.parametrize(
    ("command", "subject", "chosen"), cases(), ids=lambda v: "".join(v) if isinstance(v, tuple) else str(v)
)
def test_every_combination_of_options(
    command: str, subject: int, chosen: tuple[str, ...], folder: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    words = [command, *SUBJECTS[command][subject]]
    for option in chosen:
        words += [option, VALUES[command, option]] if (command, option) in VALUES else [option]
    status = main([word.replace("{}", str(folder)) for word in words])
    out, err = capsys.readouterr()
    assert "Traceback" not in err, err
    assert "bug in abut" not in err, err
    assert status in {"verify": (0, 1, 2), "infsup": (0, 1, 2), "schema": (0,)}.get(command, (0, 2, 4))
    if status == 4:
        return
    assert (status == 2) == ("error" in err + ("" if command != "check" else out)), (status, err)
    if out and "--json" in chosen and "--list" not in chosen:
        json.loads(out)


def test_verdicts_are_plain(folder: Path) -> None:
    """Those of NumPy's values too, which JSON would not take."""
    outcome = Outcome("b", "q", (np.float64(1.0),), Reference(1.0, 0.1, "a book", "none"), None, 0.0)
    assert outcome.passed is True
    assert all(type(own.passed) is bool for own in interface_patch(load_job(folder / "job.toml").model))


def test_cost_with_petsc(folder: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["check", str(folder / "petsc.toml")]) == 0
    assert "linear solver petsc (direct): about" in capsys.readouterr().out

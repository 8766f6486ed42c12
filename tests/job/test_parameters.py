"""Parameters of a job: numbers with names, values that are worked out of them, settings of the command line."""

from __future__ import annotations

import json
import math
from pathlib import Path

import numpy as np
import pytest

from abut import InputError
from abut.cli import main
from abut.expression import with_names
from abut.job import load_job
from abut.job.parameters import read_settings
from abut.mesh.mesh import Mesh

JOB = """schema = 1
parameters = { n = 2, height = 1.5, pressed = "height/150", E = 2e5 }
solids = [{ body = "block", material = "steel" }]
supports = [{ on = "block.bottom", y = 0 }, { on = "block.left", x = 0 }, { on = "block.top", y = "= -pressed*(1 + 0*x)" }]
model.plane = "stress"

[mesh.bodies.block]
kind = "rectangle"
x = [0, "=2*height"]
y = [0, "= height"]
cells = ["=n", "=2*n"]

[materials.steel]
kind = "linear-elastic"
young = "=E"
poisson = "= 0.5 - 1/5"
"""


def write(folder: Path, text: str = JOB) -> Path:
    path = folder / "job.toml"
    path.write_text(text)
    return path


@pytest.mark.parametrize(("settings", "height", "n"), [([], 1.5, 2), (["--set", "height=3", "--set", "n=1+2"], 3.0, 3)])
def test_a_block_pressed(settings: list[str], height: float, n: int, tmp_path: Path) -> None:
    """Pressed by a share of 1/150 of its height in plane stress, free to widen: the force is E/150 times its width."""
    assert main(["run", str(write(tmp_path)), "--quiet", *settings]) == 0
    summary = json.loads((tmp_path / "results" / "summary.json").read_text())
    assert abs(summary["steps"][-1]["reactions"]["block.top"][1]) == pytest.approx(2e5 / 150 * 2 * height, rel=1e-12)
    assert f"parameter height = {height:g}{' (set)' if settings else ''}" in summary["notes"]
    job = load_job(tmp_path / "job.toml", settings=read_settings(settings[1::2]))
    assert job.parameters == {"n": n, "height": height, "pressed": height / 150, "E": 2e5}
    assert job.model.mesh.n_cells == n * 2 * n
    assert main(["check", str(tmp_path / "job.toml"), *settings]) == 0


def test_without_parameters_too(tmp_path: Path) -> None:
    """A text "=..." needs no parameters; other texts stay."""
    text = JOB.replace('"=E"', '"=2*10**5"').replace(", E = 2e5", "")
    model = load_job(write(tmp_path, text)).model
    assert model.solids[0].material.young == 2e5
    assert model.solids[0].material.poisson == pytest.approx(0.3, rel=1e-15)


@pytest.mark.parametrize(
    ("old", "new", "message"),
    [
        ('"=E"', '"=EE"', "materials.steel.young: unknown name 'EE'; did you mean 'E'?"),
        ('"=E"', '"=E/0"', "materials.steel.young: 'E/0' is no finite number"),
        ('"=E"', '"=E*x"', "materials.steel.young"),
        ('"=E"', '"=__import__(1)"', "unknown name '__import__'"),
        ('"=E"', '"=(1).real"', "is not part of an expression"),
        ('"=2*n"', '"=n/4"', "mesh.bodies.block"),
        ("n = 2", 'n = "height"', "parameters.n: unknown name 'height'"),
        ("n = 2", 'n = "x"', "parameters.n: expected a number"),
        ("n = 2", "n = true", "parameters.n: expected a number"),
        ("n = 2", "n = inf", "parameters.n: expected a number"),
        ("n = 2", "pi = 2, n = 1", "parameters.pi: not a name"),
        ("n = 2", "'a-b' = 2, n = 1", "parameters.a-b: not a name"),
        ('parameters = { n = 2, height = 1.5, pressed = "height/150", E = 2e5 }', "parameters = 3", "expected a table"),
    ],
)
def test_what_is_refused(old: str, new: str, message: str, tmp_path: Path) -> None:
    assert old in JOB
    with pytest.raises(InputError) as error:
        load_job(write(tmp_path, JOB.replace(old, new)))
    assert message in str(error.value)


@pytest.mark.parametrize(
    ("settings", "message"),
    [
        (["hight=2"], "no parameter named 'hight' in [parameters]; did you mean 'height'?"),
        (["height"], "expected NAME=VALUE"),
        (["height=1", "height=2"], "set twice"),
        (["height=tall"], "--set height: unknown name 'tall'"),
    ],
)
def test_settings_that_are_refused(
    settings: list[str], message: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    path = write(tmp_path)
    assert main(["run", str(path), *(part for text in settings for part in ("--set", text))]) == 2
    assert message in capsys.readouterr().err


def test_converted_with_parameters(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    """A job of numbers alone, and its mesh, as the settings make it; and the mesh alone."""
    path = write(tmp_path)
    assert main(["convert", str(path), str(tmp_path / "tall.toml"), "--set", "height=3", "--set", "n=1"]) == 0
    model = load_job(tmp_path / "tall.toml").model
    assert model.mesh.points[:, 1].max() == 3.0
    assert model.mesh.n_cells == 2
    assert model.supports[2].y(np.array([[1.0, 3.0]])) == pytest.approx(-0.02)
    assert main(["convert", str(path), str(tmp_path / "mesh.vtu"), "--set", "height=2"]) == 0
    assert Mesh.read(tmp_path / "mesh.vtu").points[:, 1].max() == 2.0
    assert main(["convert", str(path), str(path)]) == 2
    assert "is the job that is read" in capsys.readouterr().err
    assert main(["convert", str(tmp_path / "mesh.vtu"), str(tmp_path / "b.vtu"), "--set", "height=2"]) == 2
    assert "--set is for job files" in capsys.readouterr().err


def test_tests_of_a_job_with_parameters(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    """``infsup`` and ``verify`` look at the job that the settings make."""
    block = '[[contacts]]\nsurfaces = ["block.top", "lid.bottom"]\n[mesh.bodies.lid]\nkind = "rectangle"\n'
    block += 'x = [0, "=2*height"]\n'
    block += 'y = ["=height", "=2*height"]\ncells = ["=n", 2]\n'
    text = JOB.replace("[mesh.bodies.block]", block + "[mesh.bodies.block]")
    text = text.replace("solids = [", 'solids = [{ body = "lid", material = "steel" }, ').replace(
        'block.top", y', 'lid.top", y'
    )
    path = write(tmp_path, text)
    found = []
    for n in ("2", "5"):
        assert main(["infsup", str(path), "--json", "--set", f"n={n}"]) == 0
        found.append(json.loads(capsys.readouterr().out))
    assert found[0] != found[1]
    assert main(["verify", str(path), "--set", "n=3"]) == 0
    assert main(["verify", str(path), "--set", "m=3"]) == 2
    assert "no parameter named 'm'" in capsys.readouterr().err
    assert main(["verify", "--set", "n=3", "holds"]) == 2


def test_decks_have_none(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    (tmp_path / "a.inp").write_text("*NODE\n")
    assert main(["run", str(tmp_path / "a.inp"), "--set", "a=1"]) == 2
    assert "--set is for job files" in capsys.readouterr().err


def test_negative_numbers_in_powers() -> None:
    """Numbers in place of names keep their brackets, also where the expression is written out again."""
    assert with_names("a**2", {"a": -3.0}) == 9.0
    left = with_names("a**2 + 0*x - b", {"a": -3.0, "b": -1.0})
    assert isinstance(left, str)
    assert eval(left, {"x": 7.0}) == 10.0
    assert with_names("pi*r**2", {"r": 2.0}) == pytest.approx(4.0 * math.pi, rel=1e-15)
    rng = np.random.default_rng(1)
    a, b, c = rng.normal(size=3).tolist()
    assert with_names("max(a, b) - c/(a - b)", {"a": a, "b": b, "c": c}) == max(a, b) - c / (a - b)

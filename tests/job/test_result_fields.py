"""[fields.NAME] of a job: values of result files in expressions of supports and loads."""

from __future__ import annotations

import re
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

import abut
from abut.cli import main
from abut.errors import InputError
from abut.expression import Expression
from abut.io.vtu import write_vtu
from abut.job import load_job
from abut.job.convert import write_job
from abut.mesh.make import join, rectangle

JOB = """schema = 1
[parameters]
ambient = 20
[fields.hot]
file = "thermal.vtu"
array = "T"
[fields.across]
file = "thermal.vtu"
array = "moved"
component = "y"
[model]
plane = "stress"
[mesh.bodies.b]
kind = "rectangle"
x = [0, 4]
y = [0, 1]
cells = [8, 2]
[materials.steel]
kind = "linear-elastic"
young = 1000
poisson = 0.0
expansion = 1e-3
[[solids]]
body = "b"
material = "steel"
[[supports]]
on = "b.left"
x = 0
[[supports]]
on = "b.bottom"
y = "across"
[[loads]]
kind = "temperature"
on = "b"
value = "= hot - ambient"
[[loads]]
kind = "pressure"
on = "b.right"
value = "2*hot"
[[loads]]
kind = "traction"
on = "b.right"
value = ["2*hot", 0]
"""


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    """Another mesh, T = 20 + 5 x, moved by (0, 0.01)."""
    mesh = join({"b": rectangle((0, 4), (0, 1), (3, 1), "quad4")})
    moved = np.tile([0.0, 0.01, 0.0], (len(mesh.points), 1))
    blocks = [(block.kind, block.nodes) for block in mesh.blocks]
    write_vtu(tmp_path / "thermal.vtu", mesh.points, blocks, {"T": 20.0 + 5.0 * mesh.points[:, 0], "moved": moved})
    (tmp_path / "job.toml").write_text(JOB)
    return tmp_path


def test_bar(folder: Path, capsys: pytest.CaptureFixture[str]) -> None:
    """Without lateral contraction (nu = 0) and with pressure and traction that balance each other: the end moves by the
    integral of the expansion, 1e-3 5 x, along a line; what the file says holds the bottom."""
    assert main(["run", str(folder / "job.toml")]) in (0, 3)
    said = capsys.readouterr()
    assert "hot: 'T' of " in said.out + said.err
    solution = abut.solve(load_job(folder / "job.toml").model)
    mesh, moved = solution.model.mesh, solution.displacement
    assert moved[mesh.nodes_of("b.bottom"), 1] == pytest.approx(0.01, rel=1e-12)
    assert solution.steps[-1].load == pytest.approx([0.0, 0.0], abs=1e-9)
    mean = moved[mesh.nodes_of("b.right"), 0].mean()
    assert mean == pytest.approx(
        1e-3 * 5.0 * 4.0**2 / 2.0, rel=2e-2
    )  # warmth over a height held below bends it a little


@pytest.mark.parametrize(
    ("old", "new", "said"),
    [
        (
            'array = "T"',
            'array = "U"',
            r"fields.hot: .*no values named 'U' at its points; there are T, moved|known: T, moved",
        ),
        ('component = "y"\n', "", r"fields.across: .*'moved' has 3 components; say which one: x, y, z"),
        ("[fields.hot]", "[fields.x]", r"fields.x: not a name to use in expressions"),
        ("ambient = 20", "ambient = 20\nhot = 3", r"fields.hot: there is a parameter of that name"),
        ('"2*hot"\n', '"2*hut"\n', r"unknown name 'hut'"),
        ('"2*hot"\n', '"2*hot + z"\n', r"pressure on 'b.right': value: z: positions have x and y alone"),
        ('"2*hot"\n', '"hot(3)"\n', r"loads\[1\].value: unknown function 'hot'"),
        ("x = [0, 4]", "x = [0, 400]", r"support on 'b.bottom': y: .*lies 396 outside its mesh"),
        ('file = "thermal.vtu"', 'file = "results/thermal.vtu"', r"is in the folder of this job's own results"),
    ],
)
def test_what_cannot_be(old: str, new: str, said: str, folder: Path, capsys: pytest.CaptureFixture[str]) -> None:
    """One message, with its place, by check as by run, and the exit status of bad input."""
    (folder / "job.toml").write_text(JOB.replace(old, new, 1))
    for command in ("check", "run"):
        assert main([command, str(folder / "job.toml")]) == 2
        out = capsys.readouterr()
        assert re.search(said, (out.out + out.err).replace("\n", " ")), out
        assert "Traceback" not in out.err


def test_written_anew(folder: Path) -> None:
    """A job that `abut convert` writes, elsewhere, reads the same file: the same displacements."""
    (folder / "deep").mkdir()
    assert main(["convert", "--quiet", str(folder / "job.toml"), str(folder / "deep" / "other.toml")]) == 0
    assert 'file = "../thermal.vtu"' in (folder / "deep" / "other.toml").read_text()
    one, other = (abut.solve(load_job(path).model) for path in (folder / "job.toml", folder / "deep" / "other.toml"))
    np.testing.assert_allclose(other.displacement, one.displacement, rtol=0, atol=1e-15)


def test_names_of_two_files_are_told(folder: Path) -> None:
    job = load_job(folder / "job.toml")
    another = Expression("hot", (("hot", abut.result_field(folder / "thermal.vtu", "moved", "y")),))
    loads = [*job.model.loads, abut.Temperature("b", another)]
    with pytest.raises(InputError, match="hot: a name of two result files"):
        write_job(folder / "other.toml", replace(job, model=replace(job.model, loads=loads)))

"""Keys of finite deformation in job files: what they make, and what is wrong with others."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

import abut
from abut.errors import InputError
from abut.job import load_job
from abut.job.convert import write_job
from abut.job.pairs import write_pairs

JOB = """
schema = 1
[model]
plane = "strain"
kinematics = "finite"
[mesh.bodies.strip]
kind = "rectangle"
x = [0, 4]
y = [0, 1]
cells = [4, 1]
[mesh.bodies.tool]
kind = "rectangle"
x = [0, 4]
y = [3, 4]
[materials.rubber]
kind = "neo-hooke"
shear = 1.0
lame = 2.0
volumetric = "log-squared"
[materials.steel]
kind = "linear-elastic"
young = 100.0
poisson = 0.3
[[solids]]
body = "strip"
material = "rubber"
[[solids]]
body = "tool"
material = "steel"
[[supports]]
on = "strip.left"
x = 0
y = 0
[[rotations]]
on = "strip.right"
angle = 0.5
centre = [2, 0.5]
amplitude = [[0, 0], [1, 1]]
[[rotations]]
on = "tool"
angle = 1.0
centre = [0, 0]
[[loads]]
kind = "pressure"
on = "strip.top"
value = 0.01
follows = false
"""


@pytest.fixture
def path(tmp_path: Path) -> Path:
    file = tmp_path / "job.toml"
    file.write_text(JOB)
    return file


def test_keys(path: Path) -> None:
    model = load_job(path).model
    assert model.finite
    assert model.solids[0].material == abut.NeoHooke(shear=1.0, lame=2.0, volumetric="log-squared")
    assert model.loads == (abut.Pressure("strip.top", 0.01, follows=False),)
    ramp = abut.Amplitude(((0.0, 0.0), (1.0, 1.0)))
    assert model.rotations[0] == abut.Rotation("strip.right", 0.5, (2.0, 0.5), amplitude=ramp)
    moved = model.mesh.points + abut.solve(model).displacement
    tool = model.mesh.nodes_of("tool") if "tool" in model.mesh.node_sets else model.rotations[1].nodes(model.mesh)
    turn = np.array([[np.cos(1.0), -np.sin(1.0)], [np.sin(1.0), np.cos(1.0)]])
    assert np.abs(moved[tool] - model.mesh.points[tool] @ turn.T).max() < 1e-14


def test_written_and_read_again(path: Path, tmp_path: Path) -> None:
    job = load_job(path)
    written = load_job(write_job(tmp_path / "again.toml", job)[0]).model
    for name in ("kinematics", "rotations", "loads", "plane", "supports"):
        assert getattr(written, name) == getattr(job.model, name), name
    assert written.materials == job.model.materials


@pytest.mark.parametrize(
    ("old", "new", "words"),
    [
        ('"finite"', '"large"', "model.kinematics: expected 'small', 'finite' or 'small-strain', got 'large'"),
        (
            '"finite"',
            '"small"',
            "solids\\[0\\].material: NeoHooke of body 'strip' is for finite strains",
        ),
        (
            '"neo-hooke"',
            '"neohooke"',
            "rubber.kind: expected one of 'linear-elastic', 'orthotropic', 'anisotropic', 'over-temperature', 'neo-hooke', "
            "'hencky', 'plastic', "
            "'mooney-rivlin', 'yeoh', "
            "'ogden', 'arruda-boyce', 'viscoelastic', 'mfront', got 'neohooke'",
        ),
        ('kind = "neo-hooke"', "", "materials.rubber.kind: missing"),
        ("lame = 2.0", "lam = 2.0", "materials.rubber.lam: unknown key; did you mean 'lame'"),
        ("lame = 2.0", "", "materials.rubber.constants: expected young and poisson, shear and bulk, or shear and lame"),
        ("follows = false", 'follows = "no"', "loads\\[0\\].follows: expected a valid boolean"),
        ("angle = 1.0", "angel = 1.0", "rotations\\[1\\].angle: missing"),
    ],
)
def test_wrong(path: Path, old: str, new: str, words: str) -> None:
    path.write_text(JOB.replace(old, new))
    with pytest.raises(InputError, match=words):
        load_job(path)


def test_every_two_bodies_may_meet(tmp_path: Path) -> None:
    """auto = true: bodies far apart, the softer one the contactor, and each body with itself; entries of their own come
    first. Written out, the pairs are the same."""
    job = tmp_path / "job.toml"
    job.write_text(JOB + "[[contacts]]\nauto = true\n")
    loaded = load_job(job)
    made = [(contact.contactor, contact.target) for contact in loaded.model.contacts]
    assert made == [("strip", "strip"), ("tool", "tool"), ("strip", "tool")]
    assert len(loaded.model.sides(loaded.model.contacts[2])[0]) == 10  # its whole outside
    write_pairs(loaded, tmp_path / "pairs.toml")
    assert load_job(tmp_path / "pairs.toml").model.contacts == loaded.model.contacts
    own = '[[contacts]]\ncontactor = "strip.top"\ntarget = "tool.bottom"\n'
    job.write_text(JOB + own + "[[contacts]]\nauto = true\n")
    assert [c.name for c in load_job(job).model.contacts[1:]] == ["strip-strip", "tool-tool"]
    job.write_text(JOB + "[[contacts]]\nauto = true\nreach = 1.0\n")
    with pytest.raises(InputError, match=r"contacts\[0\]\.reach: with kinematics"):
        load_job(job)

"""[[solids]] that name no body: every body that no other table names."""

from __future__ import annotations

from pathlib import Path

import pytest

import abut
from abut.job.load import load_job

JOB = """schema = 1
[mesh.bodies]
a = { kind = "box", x = [0, 1], y = [0, 1], z = [0, 1], cells = [1, 1, 1] }
b = { kind = "box", x = [0, 1], y = [0, 1], z = [2, 3], cells = [1, 1, 1] }
c = { kind = "box", x = [0, 1], y = [0, 1], z = [4, 5], cells = [1, 1, 1] }
[materials.soft]
kind = "linear-elastic"
young = 1
poisson = 0.3
[materials.hard]
kind = "linear-elastic"
young = 2
poisson = 0.3
"""
SOFT, OPEN = '[[solids]]\nbody = "b"\nmaterial = "soft"\n', '[[solids]]\nmaterial = "hard"\n'
HELD = "".join(f'[[supports]]\non = "{body}.bottom"\nx = 0\ny = 0\nz = 0\n' for body in "abc")


def solids(folder: Path, text: str) -> dict[str, float]:
    path = folder / "job.toml"
    path.write_text(JOB + HELD + text)
    return {solid.body: solid.material.modulus for solid in load_job(path).model.solids}


@pytest.mark.parametrize("text", [SOFT + OPEN, OPEN + SOFT])
def test_the_rest(text: str, tmp_path: Path) -> None:
    assert solids(tmp_path, text) == {"a": 2.0, "b": 1.0, "c": 2.0}


def test_all(tmp_path: Path) -> None:
    assert solids(tmp_path, OPEN) == {"a": 2.0, "b": 2.0, "c": 2.0}


def test_rigid_bodies_are_none(tmp_path: Path) -> None:
    text = OPEN + '[[rigid]]\nbody = "b"\nx = 0\ny = 0\nz = 0\nrx = 0\nry = 0\nrz = 0\n'
    path = tmp_path / "job.toml"
    held = HELD.replace('[[supports]]\non = "b.bottom"\nx = 0\ny = 0\nz = 0\n', "")
    path.write_text(JOB + held + text)
    assert [solid.body for solid in load_job(path).model.solids] == ["a", "c"]


@pytest.mark.parametrize(
    ("text", "words"),
    [
        (OPEN + OPEN, r"solids\[1\]\.body: missing; only one table, here solids\[0\], may leave it out"),
        (
            SOFT + SOFT.replace('"b"', '"a"') + SOFT.replace('"b"', '"c"') + OPEN,
            r"solids\[3\]\.body: missing, and other",
        ),
    ],
)
def test_refused(text: str, words: str, tmp_path: Path) -> None:
    with pytest.raises(abut.InputError, match=words):
        solids(tmp_path, text)

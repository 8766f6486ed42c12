"""Contacts of job files that act for a part of the time: read with the names of steps, told, written and read again."""

from __future__ import annotations

from pathlib import Path

import pytest

import abut
from abut.errors import InputError
from abut.job.convert import write_job
from abut.job.load import load_job

JOB = """schema = 1
model.plane = "stress"
solids = [{ body = "left", material = "soft" }, { body = "right", material = "soft" }]
materials.soft = { kind = "linear-elastic", young = 1000, poisson = 0 }
mesh.bodies.left = { kind = "rectangle", x = [0, 1], y = [0, 1], cells = [2, 2] }
mesh.bodies.right = { kind = "rectangle", x = [1, 2], y = [0, 1], cells = [2, 3] }
[[supports]]
on = "left.left"
x = 0
y = 0
[[supports]]
on = "right.right"
x = 0.1
y = 0
amplitude = [["start", 0], ["pull", 1], ["tear", 1], ["press", -1]]
[[contacts]]
name = "seam"
surfaces = ["left.right", "right.left"]
kind = "tied"
until = "pull"
released = "tear"
[[contacts]]
name = "joint"
surfaces = ["left.right", "right.left"]
friction = 0.2
since = "pull"
[[steps]]
name = "pull"
[[steps]]
name = "tear"
increments = 2
[[steps]]
name = "press"
"""


def _job(folder: Path, text: str = JOB) -> Path:
    path = folder / "job.toml"
    path.write_text(text, encoding="utf-8")
    return path


def test_a_job_says_what_records_say(tmp_path: Path) -> None:
    job = load_job(_job(tmp_path))
    seam, joint = job.model.contacts
    thirds = pytest.approx(1 / 3), pytest.approx(2 / 3)
    assert (seam.since, seam.until, seam.released) == (0.0, *thirds)
    assert (joint.since, joint.until, joint.released) == (thirds[0], None, None)
    said = [note for note in job.notes if note.startswith("step '")]
    assert ["'seam' (let go)" in line for line in said] == [False, True, False]
    assert ["'seam' (open)" in line for line in said] == [False, False, True]
    assert ["'joint' (open)" in line for line in said] == [True, False, False]
    copy, _ = write_job(tmp_path / "copy.toml", job)
    again = load_job(copy).model
    assert again.contacts == job.model.contacts
    below = [float(step.reactions["left.left"][0]) for step in abut.solve(again).steps]  # bars in a row, E A / 2 L
    assert below == pytest.approx([-50.0, -25.0, 0.0, 50.0], abs=1e-9)


def test_what_cannot_be(tmp_path: Path) -> None:
    for old, new, told in (
        ('until = "pull"', 'until = "pul"', "no step named 'pul'"),
        ('released = "tear"', 'released = "start"', "contact 'seam': expected times"),
        ('since = "pull"', "", "would be determined twice"),
    ):
        with pytest.raises(InputError, match=told):
            load_job(_job(tmp_path, JOB.replace(old, new)))

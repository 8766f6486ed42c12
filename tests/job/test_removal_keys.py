"""Bodies that go and come back in job files: read with the names of steps, told, written and read again."""

from __future__ import annotations

import pytest

import abut
from abut.errors import InputError
from abut.job.convert import write_job
from abut.job.load import load_job

JOB = """schema = 1
model.plane = "stress"
solids = [{ body = "left", material = "soft" }, { body = "right", material = "soft" }]
materials.soft = { kind = "linear-elastic", young = 1000, poisson = 0, density = 1 }
mesh.bodies.left = { kind = "rectangle", x = [0, 1], y = [0, 2], cells = [2, 2] }
mesh.bodies.right = { kind = "rectangle", x = [1.1, 2.1], y = [0, 2], cells = [2, 2] }
supports = [{ on = "left.bottom", x = 0, y = 0 }, { on = "right.bottom", x = 0, y = 0 }]
contacts = [{ name = "seam", surfaces = ["left.right", "right.left"] }]
[[steps]]
name = "stand"
[[steps]]
name = "gap"
[[steps]]
name = "filled"
[[removals]]
body = "right"
until = "stand"
since = "gap"
[[loads]]
kind = "gravity"
value = [0, -3]
amplitude = [["start", 1]]
"""


def test_a_job_says_what_records_say(tmp_path):
    path = tmp_path / "job.toml"
    path.write_text(JOB, encoding="utf-8")
    job = load_job(path)
    (removal,) = job.model.removals
    assert (removal.body, removal.until, removal.since) == ("right", pytest.approx(1 / 3), pytest.approx(2 / 3))
    assert [load.amplitude(0.5) for load in job.model.loads] == [1.0, 0.0]  # of each body, while it is there
    said = [note for note in job.notes if note.startswith("step '")]
    assert ["taken out" in said[0], "'right' (taken out)" in said[1], "'right' (comes back)" in said[2]] == [
        False,
        True,
        True,
    ]
    assert ["'seam' (open)" in line for line in said] == [False, True, False]
    copy, _ = write_job(tmp_path / "copy.toml", job)
    again = load_job(copy).model
    assert again.removals == job.model.removals
    assert [load.amplitude(0.5) for load in again.loads] == [1.0, 0.0]
    solution = abut.solve(again)
    top = solution.model.mesh.nodes_of("right.top")
    weight = 3.0 * 2.0**2 / 2.0 / 1000.0  # w h^2 / (2 E), twice: its place, and what it settles when it is back
    settled = [-float(step.displacement[top, 1].mean()) for step in solution.steps]
    assert settled == pytest.approx([weight, weight, 2.0 * weight], rel=1e-6)
    assert all(check.passed for check in solution.certificate)


def test_a_body_that_there_is_none_of_is_told(tmp_path):
    path = tmp_path / "job.toml"
    path.write_text(JOB.replace('body = "right"\nuntil', 'body = "rigth"\nuntil'), encoding="utf-8")
    with pytest.raises(InputError, match=r"removals\[0\].body: no body named 'rigth'.*'right'"):
        load_job(path)

"""Preloads, springs, holds and local axes in job files: read, refused with their place, written and read again."""

from __future__ import annotations

import pytest

import abut
from abut.errors import InputError
from abut.job.convert import write_job
from abut.job.load import load_job

JOB = """schema = 1
supports = [
  { on = "rod.bottom", x = 0, y = 0, z = 0 },
  { on = "rod.round", y = 0, axes = { kind = "cylindrical" } },
]
solids = [{ body = "rod", material = "steel" }]
materials.steel = { kind = "linear-elastic", young = 210e3, poisson = 0.3 }
mesh.bodies.rod = { kind = "cylinder", radius = 2, z = [0, 20], cells = [4, 6], cell = "hex8" }
[[preloads]]
name = "M4"
body = "rod"
force = 100
lock = 0.5
amplitude = [[0, 0], [0.5, 1]]
[[springs]]
name = "bed"
on = "rod.top"
normal = [[0, 0], [1, 1e6]]
x = 5
[[holds]]
on = "rod.top"
x = "stay"
y = 0.25
since = 0.5
until = 0.75
"""


def written(tmp_path, text):
    path = tmp_path / "job.toml"
    path.write_text(text, encoding="utf-8")
    return path


def test_a_job_says_what_records_say(tmp_path):
    job = load_job(written(tmp_path, JOB))
    model = job.model
    assert model.supports[1].axes == abut.Axes("cylindrical")
    assert model.springs == (abut.Spring("bed", "rod.top", normal=((0.0, 0.0), (1.0, 1e6)), x=5.0),)
    assert model.holds == (abut.Hold("rod.top", x="stay", y=0.25, since=0.5, until=0.75),)
    (preload,) = model.preloads
    assert (preload.force, preload.lock, preload.body) == (100.0, 0.5, "rod")
    copy, _ = write_job(tmp_path / "copy.toml", job)
    again = load_job(copy).model
    assert (again.supports, again.springs, again.preloads) == (model.supports, model.springs, model.preloads)
    assert again.holds == model.holds
    assert len(again.mesh.points) == len(model.mesh.points)
    last = abut.solve(again).steps[-1]
    assert last.preloads["M4"].tension == pytest.approx(100.0, rel=1e-4)
    abut.write(abut.solve(model), tmp_path / "results")
    forces = (tmp_path / "results" / "forces.csv").read_text(encoding="utf-8")
    assert "preload,M4" in forces
    assert "spring,bed" in forces
    assert "What preloads carry" in (tmp_path / "results" / "report.html").read_text(encoding="utf-8")


@pytest.mark.parametrize(
    ("old", "new", "words"),
    [
        ("lock = 0.5", "lock = 2", "lock: expected a time"),
        ('kind = "cylindrical"', 'kind = "cylindrical", x = [1, 0, 0]', r"supports\[1\].axes: x does not go with"),
        ("x = 5", "x = -5", "spring 'bed': x"),
        ('body = "rod"\nforce', 'body = "rods"\nforce', r"preloads\[0\].body: no body named 'rods'"),
        ("force = 100", "tension = 100", "tension: unknown key"),
    ],
)
def test_refused(old, new, words, tmp_path):
    with pytest.raises(InputError, match=words):
        load_job(written(tmp_path, JOB.replace(old, new)))

"""Loads in local axes in job files: read, written and read again, refused where they do not fit."""

from __future__ import annotations

import numpy as np
import pytest

import abut
from abut.errors import InputError
from abut.job.convert import write_job
from abut.job.load import load_job

JOB = """schema = 1
model.plane = "stress"
solids = [{ body = "ring", material = "soft" }]
materials.soft = { kind = "linear-elastic", young = 1000, poisson = 0.3 }
mesh.bodies.ring = { kind = "ring", radii = [1, 2], cells = [3, 24], cell = "quad8" }
supports = [
  { on = "ring.inner", x = 0, y = 0 },
  { on = "ring.start", x = 0, axes = { kind = "cylindrical" } },
  { on = "ring.end", x = 0, axes = { kind = "cylindrical" } },
]
[[loads]]
kind = "traction"
on = "ring.outer"
value = [0, 3]
axes = { kind = "cylindrical" }
"""


def test_a_traction_around_turns_a_ring(tmp_path):
    """A quarter of it, whose ends go round and carry shear. T / (2 pi r^2) on the way out, T = 2 pi R^2 t:
    v(R) = R t R^2 / (2 G) (1 / a^2 - 1 / R^2), no radial motion."""
    path = tmp_path / "job.toml"
    path.write_text(JOB, encoding="utf-8")
    job = load_job(path)
    copy, _ = write_job(tmp_path / "copy.toml", job)
    again = load_job(copy).model
    assert again.loads == job.model.loads == (abut.Traction("ring.outer", (0.0, 3.0), axes=abut.Axes("cylindrical")),)
    step = abut.solve(again).steps[-1]
    nodes = again.mesh.nodes_of("ring.outer")
    x, u = again.mesh.points[nodes] / 2.0, step.displacement[nodes]
    shear = 1000.0 / 2.6
    assert x[:, 0] * u[:, 1] - x[:, 1] * u[:, 0] == pytest.approx(2.0 * 3.0 * 4.0 / (2.0 * shear) * 0.75, rel=2e-3)
    assert np.abs((x * u).sum(axis=1)).max() < 1e-6


def test_nodal_forces_are_along_their_axes(tmp_path):
    """The resultant of equal forces along the radius of a quarter's nodes, in turn."""
    text = JOB.replace('kind = "traction"', 'kind = "nodal-force"').replace("[0, 3]", "[3, 0]")
    path = tmp_path / "job.toml"
    path.write_text(text, encoding="utf-8")
    model = load_job(path).model
    nodes = model.mesh.nodes_of("ring.outer")
    assert abut.solve(model).steps[-1].load == pytest.approx(3.0 * model.mesh.points[nodes].sum(axis=0) / 2.0, rel=1e-9)


def test_axes_that_do_not_fit_are_told(tmp_path):
    path = tmp_path / "job.toml"
    path.write_text(f"{JOB.removesuffix(' }' + chr(10))}, axis = [0, 0, 1] }}", encoding="utf-8")
    with pytest.raises(InputError, match=r"loads\[0\].*axes: axis: the model is 2D"):
        load_job(path)

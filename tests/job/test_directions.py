"""Materials with directions in job files, there and back."""

from __future__ import annotations

from pathlib import Path

import pytest

import abut
from abut.errors import InputError
from abut.job import load_job
from abut.job.convert import write_job

JOB = """
schema = 1
[mesh.bodies.ring]
kind = "ring"
[model]
plane = "stress"
[materials.wood]
kind = "orthotropic"
young = [1100, 600, 12000]
poisson = [0.3, 0.03, 0.03]
shear = [50, 900, 800]
expansion = [3e-5, 4e-5, 4e-6]
axes = { kind = "cylindrical", origin = [1, 0] }
[[solids]]
body = "ring"
material = "wood"
[[supports]]
on = "ring.start"
x = 0
y = 0
"""


def written(tmp_path: Path, text: str = JOB) -> Path:
    path = tmp_path / "job.toml"
    path.write_text(text, encoding="utf-8")
    return path


def test_there_and_back(tmp_path: Path) -> None:
    """A job gives the material that Python does; written and read again it is the same."""
    job = load_job(written(tmp_path))
    axes = abut.Axes("cylindrical", origin=(1, 0))
    law = abut.Orthotropic(
        (1100, 600, 12000), (0.3, 0.03, 0.03), (50, 900, 800), axes=axes, expansion=(3e-5, 4e-5, 4e-6)
    )
    assert job.model.solids[0].material == law
    again, _ = write_job(tmp_path / "again.toml", job)
    assert load_job(again).model.solids[0].material == law


def test_anisotropic(tmp_path: Path) -> None:
    head, _, rest = JOB.partition("[materials.wood]")
    constants = [3, 1, 3, 1, 1, 3, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 0, 1]
    table = f'[materials.wood]\nkind = "anisotropic"\nconstants = {constants}\n[[solids]]'
    job = load_job(written(tmp_path, head + table + rest.partition("[[solids]]")[2]))
    steel = abut.LinearElastic(2.5, 0.25)  # lambda = mu = 1
    assert job.model.solids[0].material.stiffness == pytest.approx(  # type: ignore[attr-defined]
        steel.evaluate([[0.0] * 6], steel.initial(1))[1][0]  # type: ignore[arg-type]
    )


@pytest.mark.parametrize(
    ("old", "new", "said"),
    [
        ("young = [1100, 600, 12000]", "young = [1100, 600]", "materials.wood.young"),
        ("young = [1100, 600, 12000]", "young = [1100, -600, 12000]", "materials.wood.young: E2 must be > 0"),
        ('kind = "cylindrical", ', 'kind = "conical", ', "materials.wood.axes.kind"),
        ("origin = [1, 0]", "origin = [1, 0, 0]", "materials.wood.axes|solids.0..material: axes: origin"),
        ('kind = "orthotropic"', 'kind = "ortho"', "orthotropic is what it is called"),
    ],
)
def test_refused(tmp_path: Path, old: str, new: str, said: str) -> None:
    with pytest.raises(InputError, match=said):
        load_job(written(tmp_path, JOB.replace(old, new)))

"""Probes in local axes: components of the same vectors and tensors, turned as theory turns them."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

import abut
from abut.axes import Axes
from abut.benchmarks import BENCHMARKS, run
from abut.errors import InputError
from abut.job import load_job
from abut.mesh.make import box, join, rectangle
from models.probes import TEXT

TENSOR = [(0, 0), (1, 1), (2, 2), (0, 1), (1, 2), (2, 0)]
AXES = (
    Axes(x=(1.0, 2.0, -1.0), xy=(0.5, 1.0, 3.0)),
    Axes("cylindrical", origin=(1.0, -2.0, 0.0), axis=(1.0, 1.0, 3.0)),
    Axes("spherical", origin=(-1.0, 0.5, 4.0)),
)


def whole(values: np.ndarray, shear: float = 1.0) -> np.ndarray:
    """Symmetric matrices of components in the order of results."""
    result = np.empty((len(values), 3, 3))
    for k, (i, j) in enumerate(TENSOR):
        result[:, i, j] = result[:, j, i] = values[:, k] * (1.0 if i == j else shear)
    return result


def drawn(axes: Axes | None) -> abut.Solution:
    """A bar beyond yield, drawn askew, read at its nodes."""
    mesh = join({"bar": box((0, 2), (0, 1), (0, 1), (2, 1, 1), "hex8")})
    of = ("displacement", "stress", "von-mises", "principal-stress", "max-shear", "reaction", "plastic-strain")
    return abut.solve(
        abut.Model(
            mesh,
            [abut.Solid("bar", abut.Plastic(200.0, 0.3, yield_stress=0.2, hardening=20.0))],
            [abut.Support("bar.left", x=0, y=0, z=0), abut.Support("bar.right", x=0.02, y=0.01, z=-0.005)],
            probes=[abut.Probe("all", on="bar", of=of, axes=axes)],
            solve=abut.SolveOptions(steps=2),
        )
    )


@pytest.mark.parametrize("axes", AXES, ids=lambda one: one.kind)
def test_components_are_turned(axes: Axes) -> None:
    """v' = R v and s' = R s R^T with the directions in the rows of R, strains with half of their doubled shear; scalars and
    what is derived from stresses stay."""
    given, local = (drawn(one).probes[0] for one in (None, axes))
    turn = axes.frames(given.points)
    for name in ("displacement", "reaction"):
        assert local.values[name] == pytest.approx(np.einsum("nij,nj->ni", turn, given.values[name]), abs=1e-12)
    for name, shear in (("stress", 1.0), ("plastic_strain", 0.5)):
        wanted = turn @ whole(given.values[name], shear) @ turn.transpose(0, 2, 1)
        size = np.abs(wanted).max()
        assert size > 1e-3
        assert whole(local.values[name], shear) == pytest.approx(wanted, abs=1e-12 * size)
    for name in ("von_mises", "principal_stress", "max_shear"):
        assert local.values[name] == pytest.approx(given.values[name], rel=1e-12)


def test_plane_models_keep_what_is_out_of_the_plane() -> None:
    """Plane strain: a traction along y; axes whose first direction is y have it first, and the third stress stays."""
    mesh = join({"block": rectangle((0.0, 2.0), (0.0, 1.0), (2, 2), "quad4")})
    one = abut.Probe("p", at=(0.7, 0.4), axes=Axes(x=(0.0, 1.0)))
    model = abut.Model(
        mesh,
        [abut.Solid("block", abut.LinearElastic(100.0, 0.25))],
        [abut.Support("block.bottom", y=0), abut.Support("block.left", x=0)],
        [abut.Traction("block.top", (0.0, 4.0))],
        probes=[one],
        plane="strain",
    )
    stress = abut.solve(model).probes[0].values["stress"][0]
    assert stress == pytest.approx([4.0, 0.0, 1.0, 0.0, 0.0, 0.0], abs=1e-10)
    radial = Axes("cylindrical")
    with pytest.raises(InputError, match=r"probes\[0\].axes: the model is axisymmetric: x is radial already"):
        replace(model, plane="axisymmetric", probes=[abut.Probe("p", at=(0.7, 0.4), axes=radial)])
    with pytest.raises(InputError, match=r"probes\[0\]: axes: axis: the model is 2D"):
        replace(model, probes=[replace(one, axes=Axes("cylindrical", axis=(0.0, 0.0, 1.0)))])
    with pytest.raises(InputError, match="probe 'p': axes: expected local axes"):
        abut.Probe("p", at=(0.7, 0.4), axes="cylindrical")  # type: ignore[arg-type]


def test_hollow_ball() -> None:
    for outcome in run(BENCHMARKS["ball-probe"]):
        assert outcome.passed, outcome


def test_job_file(tmp_path: Path) -> None:
    """The same keys as those of supports; the place says so."""
    text = TEXT + '\n[[probes]]\nname = "local"\nat = [5, 5, 5]\naxes = { kind = "cylindrical", axis = [0, 1, 0] }\n'
    (tmp_path / "job.toml").write_text(text)
    model = load_job(tmp_path / "job.toml").model
    assert model.probes[-1].axes == Axes("cylindrical", axis=(0.0, 1.0, 0.0))
    assert model.probes[-1].place.endswith(", in cylindrical axes")

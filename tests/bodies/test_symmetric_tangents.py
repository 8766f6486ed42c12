"""Laws that say that their tangents are symmetric, and so get solvers for symmetric matrices: these are."""

from __future__ import annotations

import numpy as np
import pytest

import abut
from abut.bodies.assemble import is_symmetric, respond
from abut.bodies.solids import Solids, TemperatureChange
from abut.materials.material import Material
from abut.mesh.make import box

COLD, HOT = abut.Plastic(200.0, 0.3, 0.4, 5.0), abut.Plastic(100.0, 0.3, 0.2, 3.0)
AROUND = abut.Axes("cylindrical", origin=(0, 0, 0), axis=(0, 0, 1))
LAWS: dict[str, Material] = {
    "flow": abut.Plastic(200.0, 0.3, 0.4, 5.0, backstresses=[(3.0, 0.0)]),
    "heated-flow": abut.OverTemperature([0.0, 100.0], [COLD, HOT]),
    "heated": abut.OverTemperature([0.0, 10.0], [abut.LinearElastic(1.0, 0.3), abut.LinearElastic(2.0, 0.3)]),
    "ply": abut.Orthotropic([14, 2, 1], [0.3, 0.3, 0.45], [5, 5, 3.4], axes=AROUND, expansion=[1e-2, 2e-2, 0]),
    "hencky": abut.Hencky(1.0, 0.3),
    "mooney-rivlin": abut.MooneyRivlin(c10=1.0, c01=0.5, bulk=10.0),
    "ogden": abut.Ogden(terms=[(1.0, 2.0), (0.3, -2.0)], bulk=10.0),
}
FADING = abut.Plastic(200.0, 0.3, 0.4, 5.0, backstresses=[(30.0, 20.0)])


def tangents(law: Material, integration: str) -> tuple[bool, float]:
    """Whether it is said to be symmetric under finite strains, and how far it is from that after two motions."""
    mesh, rng = box(cells=(2, 1, 1), cell="hex20"), np.random.default_rng(0)
    solids = Solids(mesh, {"body": law}, None, {"body": integration}, "finite")
    change = TemperatureChange({"body": 30.0})
    first = respond(solids, rng.uniform(-0.03, 0.03, mesh.points.shape), change)
    tangent = respond(solids, rng.uniform(-0.03, 0.03, mesh.points.shape), change, first.history).tangent
    return is_symmetric(solids), float(abs(tangent - tangent.T).max() / abs(tangent).max())


@pytest.mark.parametrize("integration", ["full", "mixed"])
@pytest.mark.parametrize("name", LAWS)
def test_symmetric(name: str, integration: str) -> None:
    said, apart = tangents(LAWS[name], integration)
    assert said
    assert apart < 1e-14


def test_back_stress_that_fades() -> None:
    said, apart = tangents(FADING, "full")
    assert not said
    assert apart > 1e-6

"""Mixed cells: a pressure of their own, eliminated, theory (E6), (E7) and (D19) to (D21)."""

from __future__ import annotations

import numpy as np
import pytest

from abut import (
    Hencky,
    LinearElastic,
    MooneyRivlin,
    NeoHooke,
    Plastic,
)
from abut.bodies.assemble import is_symmetric, respond, stiffness
from abut.bodies.solids import Solids, TemperatureChange
from abut.bodies.stress import point_stress
from abut.mesh import make
from abut.mesh.mesh import Mesh
from abut.mesh.quadrature import PRESSURES
from abut.verify.cell_pressures import cell_inf_sup

PLANE = [kind for kind in PRESSURES if not kind.startswith("hex")]


def distorted(kind: str, n: int = 2, axisymmetric: bool = False) -> Mesh:
    """A block whose inner nodes have moved."""
    if kind.startswith("hex"):
        mesh = make.box([0, 1], [0, 1], [0, 1], cells=[n] * 3, cell=kind)
    else:
        mesh = make.rectangle([1, 2], [0, 1], cells=[n, n], cell=kind)
    points = mesh.points.copy()
    x = points - points.min(axis=0)
    points += 0.06 * np.sin(np.pi * x).prod(axis=1)[:, None] * np.arange(1, points.shape[1] + 1)
    return Mesh(points, mesh.blocks, mesh.bodies, mesh.surfaces, axisymmetric=axisymmetric)


def solids(mesh: Mesh, material: object, kinematics: str) -> Solids:
    """All of it mixed."""
    plane = {True: "axisymmetric", False: "strain"}[mesh.axisymmetric] if mesh.dim == 2 else None
    return Solids(mesh, dict.fromkeys(mesh.bodies, material), plane, dict.fromkeys(mesh.bodies, "mixed"), kinematics)


@pytest.mark.parametrize("kinematics", ["small", "finite"])
@pytest.mark.parametrize("kind", PRESSURES)
def test_uniform_strain(kind: str, kinematics: str) -> None:
    """Linear displacements give the law's stress at every point (patch test), to rounding of the bulk modulus's stress."""
    mesh = distorted(kind)
    law = MooneyRivlin(c10=0.3, c01=0.2, bulk=50.0) if kinematics == "finite" else LinearElastic(3.0, 0.49)
    gradient = 0.1 * np.random.default_rng(1).normal(size=(mesh.dim, mesh.dim))
    u = np.ascontiguousarray(mesh.points @ gradient.T)
    full = Solids(mesh, dict.fromkeys(mesh.bodies, law), "strain" if mesh.dim == 2 else None, {}, kinematics)
    mixed = solids(mesh, law, kinematics)
    for one, other in zip(point_stress(mixed, u), point_stress(full, u)):
        np.testing.assert_allclose(one, other, atol=1e-11)
    np.testing.assert_allclose(respond(mixed, u).force, respond(full, u).force, atol=1e-11)


@pytest.mark.parametrize("axisymmetric", [False, True])
@pytest.mark.parametrize("kind", ["tri6", "quad9", "hex20", "hex27"])
@pytest.mark.parametrize(
    "law", [NeoHooke(shear=1.0, bulk=40.0), Hencky(2.0, 0.48), Plastic(2.0, 0.48, yield_stress=0.05)]
)
def test_tangent(kind: str, axisymmetric: bool, law: object) -> None:
    """It is the derivative of the forces, and symmetric."""
    if axisymmetric and kind.startswith("hex"):
        pytest.skip("in the plane only")
    mesh = distorted(kind, 1, axisymmetric)
    body = solids(mesh, law, "finite")
    rng = np.random.default_rng(2)
    u = 0.05 * rng.normal(size=mesh.points.shape)
    v = rng.normal(size=mesh.points.shape)
    slope = respond(body, u).tangent
    step = 1e-6
    change = (respond(body, u + step * v).force - respond(body, u - step * v).force) / (2 * step)
    np.testing.assert_allclose(slope @ v.ravel(), change, rtol=0, atol=1e-6 * abs(change).max())
    assert abs(slope - slope.T).max() < 1e-11 * abs(slope).max()
    assert is_symmetric(body)


@pytest.mark.parametrize("kind", PRESSURES)
def test_finite_begins_as_small(kind: str) -> None:
    """At rest the finite tangent is the small one."""
    mesh = distorted(kind)
    law = LinearElastic(3.0, 0.499)
    rest = respond(solids(mesh, law, "finite"), np.zeros(mesh.points.shape)).tangent
    small = stiffness(solids(mesh, law, "small"))
    assert abs(rest - small).max() < 1e-12 * abs(small).max()


@pytest.mark.parametrize("kinematics", ["small", "finite"])
@pytest.mark.parametrize("kind", ["tri6", "quad9", "hex20"])
def test_heat_without_stress(kind: str, kinematics: str) -> None:
    """Free expansion has none: u = alpha (T x - x^2 grad T / 2) under a linear temperature of small strains, and under a
    uniform one in cells that are not straight of finite strains; in plane strain that across the plane alone."""
    small = kinematics == "small"
    mesh = _clamped(kind, 2)[0] if small else distorted(kind)
    law = LinearElastic(3.0, 0.49, expansion=1e-3)
    slope = np.arange(1.0, mesh.dim + 1) * (small and mesh.dim == 3)
    heat = TemperatureChange({}, 5.0 + mesh.points @ slope)
    x = mesh.points
    u = 1e-3 * ((5.0 + x @ slope)[:, None] * x - 0.5 * (x**2).sum(axis=1)[:, None] * slope)
    u *= 1.49 if small and mesh.dim == 2 else 1.0
    body = solids(mesh, law, kinematics)
    force = respond(body, u, heat)
    if mesh.dim == 3:
        np.testing.assert_allclose(force.force, 0.0, atol=1e-13)
    for values in point_stress(body, u, heat):
        assert np.ptp(values.reshape(-1, 6), axis=0).max() < 1e-11


STABLE = {"tri6": (2, 4, 8), "quad8": (2, 4, 8), "quad9": (2, 4, 8), "hex20": (1, 2), "hex27": (1, 2)}


@pytest.mark.parametrize("kind", STABLE)
def test_inf_sup(kind: str) -> None:
    """The constant stays: tri6/P0 .723 on 8 x 8 (another program, clamped base), .5 and more for the others; that of quad8
    with three pressures halves with h."""
    sizes = STABLE[kind]
    found = [cell_inf_sup(*_clamped(kind, n), PRESSURES[kind]) for n in sizes]
    assert found[-1] > 0.5
    if kind == "tri6":
        assert found[-1] == pytest.approx(0.723, abs=2e-3)
    if len(sizes) == 3:
        assert found[-1] > 0.9 * found[-2]
    if kind == "quad8":
        unstable = [cell_inf_sup(*_clamped(kind, n), 3) for n in sizes]
        assert unstable[-1] < 0.6 * unstable[-2]


def _clamped(kind: str, n: int) -> tuple[Mesh, np.ndarray]:
    if kind.startswith("hex"):
        mesh = make.box([0, 1], [0, 1], [0, 1], cells=[n] * 3, cell=kind)
    else:
        mesh = make.rectangle([0, 1], [0, 1], cells=[n, n], cell=kind)
    return mesh, mesh.points[:, -1] > 1e-12

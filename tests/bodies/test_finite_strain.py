"""Finite strains: forces against the energy, tangents against forces, rigid turns, formulas, and cells turned inside out."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from abut.bodies.assemble import is_symmetric, respond, stiffness
from abut.bodies.inverted import Inverted
from abut.bodies.recovery import nodal_stress
from abut.bodies.solids import Solids, TemperatureChange
from abut.cells import CELLS
from abut.materials.elastic import LinearElastic
from abut.materials.hyperelastic import VOLUMETRIC, NeoHooke
from abut.materials.material import Array, Material
from abut.mesh.make import box, rectangle
from abut.mesh.quadrature import BBAR, REDUCED

LAWS: dict[str, Material] = {
    "linear": LinearElastic(2.0, 0.3, expansion=1e-2),
    **{name: NeoHooke(2.0, 0.3, volumetric=name, expansion=1e-2) for name in VOLUMETRIC},
}
CASES = [
    (kind, plane, rule)
    for kind, cell in CELLS.items()
    if cell.dim > 1
    for plane in (("strain", "stress", "axisymmetric") if cell.dim == 2 else (None,))
    for rule in ("full", "reduced", "b-bar")
    if rule == "full" or (kind in (REDUCED if rule == "reduced" else BBAR) and (rule, plane) != ("b-bar", "stress"))
]
HOT = TemperatureChange({"body": 15.0})
STEP = 1e-5  # of a central difference: its error is about its square times third derivatives, beside rounding over it


def body(kind: str, plane: str | None, rule: str, material: Material) -> Solids:
    """Two distorted cells along each axis of a small body away from the axis."""
    if CELLS[kind].dim == 2:
        mesh = rectangle((1.0, 2.0), (0.0, 1.0), (2, 1), kind)
    else:
        mesh = box((0.0, 1.0), (0.0, 1.0), (0.0, 1.0), (1, 1, 1), kind)
    noise = 0.02 * np.random.default_rng(1).standard_normal(mesh.points.shape)
    mesh = replace(mesh, points=mesh.points + noise, axisymmetric=plane == "axisymmetric")
    return Solids(mesh, {"body": material}, plane, {"body": rule}, "finite")


def deformed(solids: Solids, seed: int = 2) -> Array:
    """A large smooth displacement and some noise, without a cell turned inside out."""
    x = solids.points
    rng = np.random.default_rng(seed)
    slope = np.eye(x.shape[1]) * 0.2 + 0.2 * rng.standard_normal((x.shape[1],) * 2)
    return x @ slope.T + 0.02 * rng.standard_normal(x.shape)


def difference(function, at: Array, along: Array):
    return (function(at + STEP * along) - function(at - STEP * along)) / (2.0 * STEP)


@pytest.mark.parametrize("name", LAWS)
@pytest.mark.parametrize(("kind", "plane", "rule"), CASES)
def test_force_and_tangent(kind: str, plane: str | None, rule: str, name: str) -> None:
    solids = body(kind, plane, rule, LAWS[name])
    u = deformed(solids)
    along = np.random.default_rng(3).standard_normal(u.shape)
    told = respond(solids, u, HOT)
    by = difference(lambda at: respond(solids, at, HOT, tangent=False).force, u, along)
    assert np.abs(told.tangent @ along.ravel() - by).max() < 1e-7 * np.abs(by).max()
    symmetric = abs(told.tangent - told.tangent.T).max() < 1e-12 * abs(told.tangent).max()
    assert symmetric or not is_symmetric(solids)
    in_plane = plane == "strain" and name in ("square-log", "log-squared")  # the area of a quad4 is that of its centre
    assert symmetric == (rule != "b-bar" or in_plane)
    if rule != "b-bar":  # whose forces have no energy
        by = difference(lambda at: respond(solids, at, HOT, tangent=False).energy.sum(), u, along)
        assert by == pytest.approx(told.force @ along.ravel(), abs=1e-7 * np.abs(told.force * along.ravel()).sum())


@pytest.mark.parametrize("name", LAWS)
@pytest.mark.parametrize(("kind", "plane", "rule"), [case for case in CASES if case[2] != "b-bar"])
def test_at_rest(kind: str, plane: str | None, rule: str, name: str) -> None:
    """Without displacement it is the material of small strains."""
    solids = body(kind, plane, rule, LAWS[name])
    small = replace(solids, kinematics="small", materials={"body": LAWS["linear"]})
    rest = respond(solids, np.zeros(solids.points.shape))
    assert abs(rest.tangent - stiffness(small)).max() < 1e-13 * abs(rest.tangent).max()
    assert not rest.force.any()
    assert not rest.energy.any()


@pytest.mark.parametrize("name", LAWS)
@pytest.mark.parametrize(("kind", "plane", "rule"), [case for case in CASES if case[1] != "axisymmetric"])
def test_rigid_turn(kind: str, plane: str | None, rule: str, name: str) -> None:
    """A body that turns by 70 degrees stays without stress; one that is stretched and then turned has turned stresses."""
    solids = body(kind, plane, rule, LAWS[name])
    dim, angle = solids.points.shape[1], np.deg2rad(70.0)
    turn = np.eye(dim)
    turn[:2, :2] = [[np.cos(angle), -np.sin(angle)], [np.sin(angle), np.cos(angle)]]
    told = respond(solids, solids.points @ (turn - np.eye(dim)).T, tangent=False)
    assert np.abs(told.force).max() < 1e-12
    assert np.abs(told.energy).max() < 1e-12
    assert np.abs(nodal_stress(solids, solids.points @ (turn - np.eye(dim)).T)).max() < 1e-12
    u = deformed(solids)
    turned = (solids.points + u) @ turn.T - solids.points
    before, after = respond(solids, u, tangent=False), respond(solids, turned, tangent=False)
    assert np.abs(before.force.reshape(-1, dim) @ turn.T - after.force.reshape(-1, dim)).max() < 1e-12
    assert after.energy == pytest.approx(before.energy, rel=1e-11)
    full = np.eye(3)
    full[:dim, :dim] = turn
    s, t = tensors(nodal_stress(solids, u)), tensors(nodal_stress(solids, turned))
    assert np.abs(full @ s @ full.T - t).max() < 1e-12 * max(np.abs(s).max(), 1.0)


def tensors(stress: Array) -> Array:
    xx, yy, zz, xy, yz, zx = stress.T
    return np.array([[xx, xy, zx], [xy, yy, yz], [zx, yz, zz]]).transpose(2, 0, 1)


def exact(name: str, f: Array) -> Array:
    """Cauchy stress by the textbooks' formulas, in the form with b = F F^T."""
    young, poisson = 2.0, 0.3
    mu, lambda_ = young / 2 / (1 + poisson), young * poisson / (1 + poisson) / (1 - 2 * poisson)
    bulk, b, j, one = lambda_ + 2 * mu / 3, f @ f.T, np.linalg.det(f), np.eye(3)
    if name == "linear":
        e = (f.T @ f - one) / 2
        return f @ (lambda_ * np.trace(e) * one + 2 * mu * e) @ f.T / j
    if name == "isochoric":
        return mu * j ** (-5 / 3) * (b - np.trace(b) / 3 * one) + bulk * (j - 1) * one
    push = lambda_ * np.log(j) if name == "log-squared" else lambda_ / 2 * (j**2 - 1)
    return (mu * (b - one) + push * one) / j


@pytest.mark.parametrize("name", LAWS)
@pytest.mark.parametrize(
    "f", [np.diag([1.6, 0.8, 0.9]), np.array([[1.0, 0.9, 0.0], [0, 1, 0], [0, 0, 1]])], ids=["stretch", "shear"]
)
@pytest.mark.parametrize("kind", [kind for kind, cell in CELLS.items() if cell.dim == 3])
def test_stress_in_space(kind: str, f: Array, name: str) -> None:
    solids = body(kind, None, "b-bar" if kind in BBAR else "full", LAWS[name])
    stress = tensors(nodal_stress(solids, solids.points @ (f - np.eye(3)).T))
    assert np.abs(stress - exact(name, f)).max() < 1e-12


@pytest.mark.parametrize("name", LAWS)
@pytest.mark.parametrize("plane", ["strain", "stress", "axisymmetric"])
@pytest.mark.parametrize("kind", [kind for kind, cell in CELLS.items() if cell.dim == 2])
def test_stress_in_the_plane(kind: str, plane: str, name: str) -> None:
    f = np.array([[1.5, 0.4, 0.0], [0.1, 0.8, 0], [0, 0, 1]])
    if plane == "axisymmetric":
        f = np.diag([1.5, 0.8, 1.5])
    solids = body(kind, plane, "full", LAWS[name])
    stress = tensors(nodal_stress(solids, solids.points @ (f - np.eye(3))[:2, :2].T))
    if plane == "stress":
        f[2, 2] = thickness(name, f)
    assert np.abs(stress - exact(name, f)).max() < 1e-12


def thickness(name: str, f: Array) -> float:
    """The stretch out of the plane without stress there, by bisection."""
    low, high = 0.1, 3.0
    for _ in range(100):
        f[2, 2] = 0.5 * (low + high)
        low, high = (low, f[2, 2]) if exact(name, f)[2, 2] > 0 else (f[2, 2], high)
    return 0.5 * (low + high)


@pytest.mark.parametrize("name", LAWS)
@pytest.mark.parametrize(("kind", "plane", "rule"), CASES)
def test_free_expansion(kind: str, plane: str | None, rule: str, name: str) -> None:
    """Heat alone leaves no stress where bodies may expand."""
    if plane == "strain":
        return
    solids = body(kind, plane, rule, LAWS[name])
    told = respond(solids, 0.15 * solids.points, HOT, tangent=False)
    assert np.abs(told.force).max() < 1e-13


@pytest.mark.parametrize(("kind", "plane", "rule"), [case for case in CASES if case[2] == "full"])
def test_inside_out(kind: str, plane: str | None, rule: str) -> None:
    solids = body(kind, plane, rule, LAWS["square-log"])
    u = np.zeros(solids.points.shape)
    u[:, 1] = -2.0 * solids.points[:, 1]
    with pytest.raises(Inverted, match=r"cell 0 of body 'body' turns inside out \(det F = -1") as found:
        respond(solids, u)
    assert found.value.determinant == pytest.approx(-1.0)
    assert found.value.cell == 0
    with pytest.raises(Inverted):
        respond(solids, np.full(u.shape, np.nan))


@pytest.mark.parametrize("poisson", [0.0, 0.3, 0.49999])
@pytest.mark.parametrize("name", VOLUMETRIC)
def test_thickness_is_found_at_any_stretch(name: str, poisson: float) -> None:
    """Neo-Hookean materials have exactly one stretch without stress out of the plane."""
    solids = body("quad4", "stress", "full", NeoHooke(1.0, poisson, volumetric=name))
    rng = np.random.default_rng(9)
    for _ in range(200):
        f = np.diag(np.exp(rng.uniform(-1.5, 1.5, 2))) @ (np.eye(2) + 0.5 * rng.standard_normal((2, 2)))
        f[:, 0] *= np.sign(np.linalg.det(f))
        assert not nodal_stress(solids, solids.points @ (f - np.eye(2)).T)[:, 2].any()


def test_no_thickness() -> None:
    """Saint Venant and Kirchhoff's material would have to become thinner than nothing."""
    solids = body("quad4", "stress", "full", LinearElastic(1.0, 0.3))
    with pytest.raises(Inverted, match="has no stretch out of the plane without stress there \\(det F = 4\\)"):
        respond(solids, solids.points)

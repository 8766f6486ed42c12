"""Integration of solids: reduced rules and the mean dilatation (B-bar), against theory."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

import abut
from abut.bodies.assemble import stiffness, thermal_load
from abut.bodies.recovery import nodal_stress
from abut.bodies.solids import Solids, TemperatureChange
from abut.cells import CELLS
from abut.errors import InputError
from abut.materials.elastic import LinearElastic
from abut.mesh.make import box, rectangle
from abut.mesh.mesh import Mesh
from abut.mesh.quadrature import BBAR, REDUCED
from models.patch import errors, model, two_blocks

MATERIAL = LinearElastic(young=2.0, poisson=0.3, expansion=1e-3)
EVERY = [(kind, "reduced") for kind in REDUCED] + [(kind, "b-bar") for kind in BBAR]


def distorted(kind: str) -> Mesh:
    return two_blocks(kind, kind, ((3, 2), (2, 3)) if CELLS[kind].dim == 2 else ((2, 2, 2), (2, 3, 2)))


def regular(kind: str) -> Mesh:
    return rectangle(cells=(2, 2), cell=kind) if CELLS[kind].dim == 2 else box(cells=(2, 2, 2), cell=kind)


def plane(mesh: Mesh) -> str | None:
    return "strain" if mesh.dim == 2 else None


def solids(mesh: Mesh, how: str) -> Solids:
    return Solids(mesh, dict.fromkeys(mesh.bodies, MATERIAL), plane(mesh), dict.fromkeys(mesh.bodies, how))


def system(mesh: Mesh, how: str) -> np.ndarray:
    return stiffness(solids(mesh, how)).toarray()


@pytest.mark.parametrize(("kind", "how"), EVERY)
def test_linear_displacement_gives_constant_stress_and_balanced_forces(kind: str, how: str) -> None:
    mesh = distorted(kind)
    slope = np.random.default_rng(1).uniform(-1, 1, (mesh.dim, mesh.dim))
    u = mesh.points @ slope.T
    force = (system(mesh, how) @ u.ravel()).reshape(u.shape)
    inside = np.ones(len(u), dtype=bool)
    for name in mesh.surfaces:
        inside[mesh.nodes_of(name)] = False
    assert np.abs(force[inside]).max(initial=0.0) < 1e-13
    strain = np.zeros((3, 3))
    strain[: mesh.dim, : mesh.dim] = 0.5 * (slope + slope.T)
    lam, mu = 2.0 * 0.3 / (1.3 * 0.4), 2.0 / 2.6
    stress = lam * np.trace(strain) * np.eye(3) + 2 * mu * strain
    got = nodal_stress(solids(mesh, how), u)
    assert np.abs(got - stress[[0, 1, 2, 0, 1, 2], [0, 1, 2, 1, 2, 0]]).max() < 1e-12


@pytest.mark.parametrize(("kind", "how"), EVERY)
def test_free_expansion_has_no_stress(kind: str, how: str) -> None:
    mesh = distorted(kind)
    u = 5.0 * 1e-3 * (1.3 if mesh.dim == 2 else 1.0) * mesh.points
    own, change = solids(mesh, how), TemperatureChange(dict.fromkeys(mesh.bodies, 5.0))
    load = thermal_load(own, change)
    assert np.abs(system(mesh, how) @ u.ravel() - load).max() < 1e-15
    stress = nodal_stress(own, u, change)
    assert np.abs(stress[:, [0, 1, 3, 4, 5]]).max() < 1e-13


@pytest.mark.parametrize(("kind", "how"), EVERY)
def test_only_rigid_motions_cost_nothing(kind: str, how: str) -> None:
    """Motions that the smaller rule does not see cannot spread over a mesh of several cells."""
    mesh = regular(kind)
    values = np.linalg.eigvalsh(system(mesh, how))
    rigid = 3 if mesh.dim == 2 else 6
    assert np.abs(values[:rigid]).max() < 1e-13
    assert values[rigid] > 1e-4


@pytest.mark.parametrize("kind", REDUCED)
def test_reduced_is_exact_for_quadratic_displacements_of_regular_cells(kind: str) -> None:
    """The energy density is quadratic there; and, but for wedge15 whose gradients are quadratic across the triangle, so is
    (or cubic in each coordinate) what gives the nodal forces: they are those of full integration, to rounding."""
    mesh = regular(kind)
    x = mesh.points
    rng = np.random.default_rng(2)
    u = np.einsum("ajk,nj,nk->na", rng.uniform(-1, 1, (mesh.dim,) * 3), x, x).ravel()
    full, reduced = (system(mesh, how) @ u for how in ("full", "reduced"))
    assert u @ reduced == pytest.approx(u @ full, rel=1e-13)
    if kind != "wedge15":
        assert np.abs(full - reduced).max() < 1e-13


@pytest.mark.parametrize("kind", ["quad8", "hex20", "wedge15"])
def test_reduced_is_softer(kind: str) -> None:
    """It drops energy that is never negative: no eigenvalue grows, some fall."""
    mesh = distorted(kind)
    full, reduced = (np.linalg.eigvalsh(system(mesh, how)) for how in ("full", "reduced"))
    assert (reduced <= full + 1e-12).all()
    assert (reduced[20:] < full[20:] * (1 - 1e-3)).any()


def tube(how: str, poisson: float, kind: str, cells: int = 6) -> float:
    """Error of the radial displacement at the bore of a thick tube (radii 1 and 2, no axial strain) under unit pressure,
    over Lame's (Timoshenko and Goodier, Theory of elasticity, art. 28)."""
    if kind == "axisymmetric":
        mesh, bore, supports = rectangle((1, 2), (0, 1), (cells, cells), "quad4"), "left", ("bottom", "top")
    elif kind == "plane":
        mesh, bore, supports = rectangle((1, 2), (0, np.pi / 2), (cells, cells), "quad4"), "left", ("bottom", "top")
    else:
        mesh = box((1, 2), (0, np.pi / 2), (0, 1), (cells, cells, 2), "hex8")
        bore, supports = "left", ("front", "back", "bottom", "top")
    if kind != "axisymmetric":
        r, turn = mesh.points[:, 0], mesh.points[:, 1]
        mesh = replace(mesh, points=np.column_stack([r * np.cos(turn), r * np.sin(turn), mesh.points[:, 2:]]))
    built = abut.Model(
        mesh,
        [abut.Solid("body", LinearElastic(1.0, poisson), integration=how)],
        supports=[abut.Support(on, normal=0.0) for on in supports],
        loads=[abut.Pressure(bore, 1.0)],
        plane={"axisymmetric": "axisymmetric", "plane": "strain"}.get(kind),
    )
    exact = (1 + poisson) * ((1 - 2 * poisson) + 4.0) / 3.0
    u = abut.solve(built).displacement[mesh.nodes_of(bore)]
    size = u[:, 0] if kind == "axisymmetric" else np.linalg.norm(u[:, :2], axis=1)
    return float(np.abs(size / exact - 1.0).max())


@pytest.mark.parametrize("kind", ["plane", "axisymmetric", "solid"])
def test_mean_dilatation_does_not_lock(kind: str) -> None:
    """Nearly incompressible, full integration is far too stiff; the mean dilatation is as good as at nu = 0.3."""
    usual = tube("full", 0.3, kind)
    assert usual < 0.03
    assert tube("full", 0.4999, kind) > 0.3
    assert tube("b-bar", 0.4999, kind) < 1.5 * usual


@pytest.mark.parametrize(("kind", "how"), EVERY)
def test_contact_patch_test(kind: str, how: str) -> None:
    """Pressure and displacement stay exact when both bodies, or the contactor alone, are integrated differently."""
    cells = ((5, 3), (7, 3)) if CELLS[kind].dim == 2 else ((2, 3, 2), (3, 2, 2))
    built = model(two_blocks(kind, kind, cells))
    for rules in ((how, how), (how, "full")):
        bodies = [replace(solid, integration=rule) for solid, rule in zip(built.solids, rules)]
        assert max(errors(replace(built, solids=bodies))) < 1e-10


@pytest.mark.parametrize(
    ("kind", "how", "of", "message"),
    [
        (
            "hex8",
            "reduced",
            None,
            "solids[0].integration: 'reduced' leaves hex8 cells zero-energy modes (hourglass",
        ),
        ("quad9", "reduced", "strain", "hourglass"),
        ("wedge6", "reduced", None, "hourglass"),
        ("tet4", "reduced", None, "tet4 cells have a single point already"),
        (
            "quad8",
            "b-bar",
            "strain",
            "'b-bar' is for quad4 and hex8 cells, the body has quad8; use 'full', or 'reduced' near",
        ),
        ("tri3", "b-bar", "strain", "the body has tri3; use 'full', with tri6 or quad8 cells near"),
        ("quad4", "b-bar", "stress", "plane stress, which does not lock"),
        ("hex8", "bbar", None, "integration"),
    ],
)
def test_refusals(kind: str, how: str, of: str | None, message: str) -> None:
    with pytest.raises(InputError) as caught:
        abut.Model(regular(kind), [abut.Solid("body", MATERIAL, integration=how)], plane=of)
    assert message in str(caught.value)


@pytest.mark.parametrize("kind", BBAR)
def test_mean_dilatation_gives_each_cell_one_pressure(kind: str) -> None:
    """Of a unit cell: bulk modulus times what its faces displace outward on average, which is all it depends on."""
    mesh = (rectangle if kind == "quad4" else box)(cells=(1,) * CELLS[kind].dim, cell=kind)
    u = np.random.default_rng(4).uniform(-1, 1, mesh.points.shape)
    dilatation = sum(
        u[mesh.points[:, a] == 1.0, a].mean() - u[mesh.points[:, a] == 0.0, a].mean() for a in range(mesh.dim)
    )
    stress = nodal_stress(solids(mesh, "b-bar"), u)
    mean = stress[:, :3].sum(axis=1) / 3.0
    assert mean == pytest.approx(2.0 / (3 * (1 - 2 * 0.3)) * dilatation, abs=1e-13)


@pytest.mark.parametrize("kind", BBAR)
def test_mean_dilatation_sees_the_mean_temperature(kind: str) -> None:
    """A temperature that varies over a unit cell pushes its volume apart as its mean does: E alpha T / (1 - 2 nu)."""
    mesh = (rectangle if kind == "quad4" else box)(cells=(1,) * CELLS[kind].dim, cell=kind)
    rng = np.random.default_rng(6)
    u, temperature = rng.uniform(-1, 1, mesh.points.shape), rng.uniform(-1, 1, len(mesh.points))
    dilatation = sum(
        u[mesh.points[:, a] == 1.0, a].mean() - u[mesh.points[:, a] == 0.0, a].mean() for a in range(mesh.dim)
    )
    load = thermal_load(solids(mesh, "b-bar"), TemperatureChange(nodes=temperature))
    assert load @ u.ravel() == pytest.approx(2.0 * 1e-3 / 0.4 * temperature.mean() * dilatation, abs=1e-15)

"""Stiffness, loads and stresses against theory, on distorted meshes of every cell type."""

from __future__ import annotations

import numpy as np
import pytest

from abut.bodies.assemble import stiffness, thermal_load
from abut.bodies.loads import body_load, force_load, pressure_load, surface_area
from abut.bodies.recovery import nodal_stress
from abut.bodies.solids import Solids, TemperatureChange
from abut.materials.elastic import LinearElastic
from abut.mesh.make import box, rectangle
from abut.mesh.mesh import Mesh
from models.patch import two_blocks

PLANE = ("tri3", "tri6", "quad4", "quad8", "quad9")
SOLID = ("tet4", "tet10", "hex8", "hex20", "hex27", "wedge6", "wedge15")
STEEL = LinearElastic(young=2.0, poisson=0.3, density=3.0, expansion=1e-3)


def distorted(kind: str) -> Mesh:
    cells = ((3, 2), (2, 3)) if kind in PLANE else ((2, 2, 2), (2, 3, 2))
    return two_blocks(kind, kind, cells)


def solids(mesh: Mesh, plane: str | None) -> Solids:
    return Solids(mesh, dict.fromkeys(mesh.bodies, STEEL), plane)


@pytest.mark.parametrize("kind", PLANE + SOLID)
def test_linear_displacement_gives_constant_stress_and_balanced_forces(kind: str) -> None:
    """The patch test of the solids: no force at interior nodes, Hooke's stress everywhere (exact up to rounding)."""
    mesh = distorted(kind)
    plane = "strain" if mesh.dim == 2 else None
    slope = np.random.default_rng(1).uniform(-1, 1, (mesh.dim, mesh.dim))
    u = mesh.points @ slope.T
    force = (stiffness(solids(mesh, plane)) @ u.ravel()).reshape(u.shape)
    inside = np.ones(len(u), dtype=bool)
    for name in mesh.surfaces:
        inside[mesh.nodes_of(name)] = False
    assert inside.any() or kind in ("quad4", "hex8", "tri3", "tet4", "wedge6")
    assert np.abs(force[inside]).max(initial=0.0) < 1e-13
    strain = np.zeros((3, 3))
    strain[: mesh.dim, : mesh.dim] = 0.5 * (slope + slope.T)
    lam, mu = 2.0 * 0.3 / (1.3 * 0.4), 2.0 / 2.6
    stress = lam * np.trace(strain) * np.eye(3) + 2 * mu * strain
    expected = stress[[0, 1, 2, 0, 1, 2], [0, 1, 2, 1, 2, 0]]
    got = nodal_stress(solids(mesh, plane), u)
    assert np.abs(got - expected).max() < 1e-12


@pytest.mark.parametrize("kind", PLANE + SOLID)
def test_rigid_motions_cost_nothing(kind: str) -> None:
    mesh = distorted(kind)
    matrix = stiffness(solids(mesh, "strain" if mesh.dim == 2 else None))
    turn = np.zeros((mesh.dim, mesh.dim))
    turn[0, 1], turn[1, 0] = 1.0, -1.0
    for u in (np.ones_like(mesh.points), mesh.points @ turn):
        assert np.abs(matrix @ u.ravel()).max() < 1e-13
    assert abs(matrix - matrix.T).max() < 1e-15


@pytest.mark.parametrize("kind", PLANE + SOLID)
def test_loads_have_the_right_resultant(kind: str) -> None:
    mesh = distorted(kind)
    top = mesh.surface("upper.top")
    assert surface_area(top) == pytest.approx(1.0, abs=1e-13)
    down = np.zeros(mesh.dim)
    down[-1] = -2.5
    for load in (pressure_load(top, 2.5), force_load(top, down)):
        assert load.reshape(-1, mesh.dim).sum(axis=0) == pytest.approx(down, abs=1e-13)
    weight = body_load(mesh, {"lower": 3.0 * down}).reshape(-1, mesh.dim).sum(axis=0)
    assert weight == pytest.approx(3.0 * down, abs=1e-12)  # the lower block has unit volume


@pytest.mark.parametrize("plane", ["strain", "stress"])
def test_free_thermal_expansion_in_the_plane(plane: str) -> None:
    """u = alpha' dT x balances the thermal load; the stress is zero but for the blocked direction of plane strain."""
    mesh = rectangle(cells=(3, 2))
    alpha = 1e-3 * (1.3 if plane == "strain" else 1.0)
    u = 5.0 * alpha * mesh.points
    own, change = solids(mesh, plane), TemperatureChange({"body": 5.0})
    miss = stiffness(own) @ u.ravel() - thermal_load(own, change)
    assert np.abs(miss).max() < 1e-15
    stress = nodal_stress(own, u, change)
    assert np.abs(stress[:, [0, 1, 3, 4, 5]]).max() < 1e-14
    blocked = -2.0 * 5.0 * 1e-3 if plane == "strain" else 0.0  # -E alpha dT
    assert stress[:, 2] == pytest.approx(blocked, abs=1e-14)


def test_free_thermal_expansion_in_space() -> None:
    mesh = box(cells=(2, 2, 2), cell="hex20")
    u = 5.0 * 1e-3 * mesh.points
    own, change = solids(mesh, None), TemperatureChange({"body": 5.0})
    assert np.abs(stiffness(own) @ u.ravel() - thermal_load(own, change)).max() < 1e-15
    assert np.abs(nodal_stress(own, u, change)).max() < 1e-14

"""Forces that straight cells leave of quadratic displacements, beside those of the displacements themselves."""

from __future__ import annotations

import numpy as np
import pytest

import abut
from abut.bodies.assemble import internal_force
from abut.bodies.interpolation import interpolation_forces
from abut.bodies.solids import Solids, TemperatureChange
from abut.materials.invariants import von_mises
from abut.mesh.make import box, rectangle
from abut.mesh.mesh import Mesh
from abut.types import Array
from models.interpolation import forces_by_arrays

YOUNG, NU = 3.0, 0.3


def uneven(cell: str) -> Mesh:
    """Cells of different sizes and shapes."""
    mesh = rectangle((0, 2), (0, 1), (3, 2), cell) if cell == "tri3" else box((0, 2), (0, 1), (0, 1), (3, 2, 2), cell)
    points = mesh.points + 0.05 * np.sin(3.0 * mesh.points[:, ::-1] + np.arange(mesh.dim))
    return Mesh(points, mesh.blocks, mesh.bodies, mesh.surfaces, mesh.node_sets)


def stress_of(slope: Array, plane: str | None) -> Array:
    """Of linear elastic bodies under slopes (n, dim, dim) of displacements, (n, 6)."""
    lame, shear = YOUNG * NU / ((1 + NU) * (1 - 2 * NU)), YOUNG / (2 * (1 + NU))
    if plane == "stress":
        lame *= (1 - 2 * NU) / (1 - NU)
    strain = np.zeros((len(slope), 3, 3))
    dim = slope.shape[1]
    strain[:, :dim, :dim] = 0.5 * (slope + np.swapaxes(slope, 1, 2))
    sigma = 2 * shear * strain + lame * strain.trace(axis1=1, axis2=2)[:, None, None] * np.eye(3)
    if plane == "stress":
        sigma[:, 2, 2] = 0.0
    return np.stack([sigma[:, a, b] for a, b in ((0, 0), (1, 1), (2, 2), (0, 1), (1, 2), (2, 0))], axis=1)


@pytest.mark.parametrize(("cell", "plane"), [("tri3", "strain"), ("tri3", "stress"), ("tet4", None)])
def test_quadratic_displacements(cell: str, plane: str | None) -> None:
    """Their stress is linear, so that in each cell int B^T sigma is volume times the mean of the stresses at the corners
    times the functions' slopes; what straight cells have of it is ``internal_force`` of the values at the nodes."""
    mesh = uneven(cell)
    dim, x = mesh.dim, mesh.points
    solids = Solids(mesh, {body: abut.LinearElastic(YOUNG, NU) for body in mesh.bodies}, plane)
    bend = np.random.default_rng(3).normal(size=(dim, dim, dim))
    bend = bend + np.swapaxes(bend, 1, 2)
    moved = 0.5 * np.einsum("abc,nb,nc->na", bend, x, x)
    stress = stress_of(np.einsum("abc,nc->nab", bend, x), plane)
    assert von_mises(stress).max() > 1.0
    (block,) = mesh.blocks
    corners = x[block.nodes]
    edges = corners[:, 1:] - corners[:, :1]
    volume = np.linalg.det(edges) / (2.0 if dim == 2 else 6.0)
    slopes = np.swapaxes(np.linalg.inv(edges), 1, 2)
    slopes = np.concatenate([-slopes.sum(axis=1, keepdims=True), slopes], axis=1)
    mean = stress[block.nodes].mean(axis=1)[:, [[0, 3, 5], [3, 1, 4], [5, 4, 2]]][:, :dim, :dim]
    whole = np.zeros_like(x)
    np.add.at(whole, block.nodes, volume[:, None, None] * np.einsum("nab,nkb->nka", mean, slopes))
    left = whole - internal_force(solids, moved).reshape(x.shape)
    found = interpolation_forces(solids, [stress[block.nodes]], TemperatureChange())
    assert np.abs(left).max() > 0.01 * np.abs(whole).max()
    assert np.abs(found - left).max() < 1e-12 * np.abs(whole).max()


def test_round_an_axis() -> None:
    """u_r = r^2, u_z = 0: sigma_r = (2 lame + 4 shear + lame) r ..., closed form of the whole force per node against cells'
    own. Its strain r is that of a polynomial, but 1 / r is not: 1e-3 is the rule's."""
    mesh = rectangle((1, 2), (0, 1), (6, 6), "tri3")
    mesh = Mesh(mesh.points, mesh.blocks, mesh.bodies, mesh.surfaces, mesh.node_sets, axisymmetric=True)
    solids = Solids(mesh, {body: abut.LinearElastic(YOUNG, NU) for body in mesh.bodies}, "axisymmetric")
    lame, shear = YOUNG * NU / ((1 + NU) * (1 - 2 * NU)), YOUNG / (2 * (1 + NU))
    r = mesh.points[:, 0]
    normal = np.stack([(3 * lame + 4 * shear) * r, 3 * lame * r, (3 * lame + 2 * shear) * r], axis=1)
    stress = np.column_stack([normal, np.zeros((len(r), 3))])
    (block,) = mesh.blocks
    found = interpolation_forces(solids, [stress[block.nodes]], TemperatureChange())
    own = internal_force(solids, np.column_stack([r**2, np.zeros_like(r)])).reshape(-1, 2)
    # Inside, forces of the displacement itself are those of its unbalanced body force f_r = -(d s_r / dr + (s_r - s_t) / r)
    # = -(3 lame + 6 shear), times int N_i 2 pi r dA, on an even mesh h^2 2 pi r.
    inside = (np.abs(r - 1.5) < 0.4) & (np.abs(mesh.points[:, 1] - 0.5) < 0.4)
    whole = -(3 * lame + 6 * shear) / 36.0 * 2.0 * np.pi * r[inside]
    assert np.abs(own[inside, 0] + found[inside, 0] - whole).max() < 1e-3 * np.abs(whole).max()


@pytest.mark.parametrize(("cell", "plane"), [("tri3", "strain"), ("tri3", "axisymmetric"), ("tet4", None)])
def test_compiled_as_by_arrays(cell: str, plane: str | None, monkeypatch: pytest.MonkeyPatch) -> None:
    """Two materials, heated, of stresses that nothing holds together, on one thread and on three; cells in their thousands,
    so that threads are used."""
    sizes = (60, 60) if cell == "tri3" else (11, 11, 11)
    one = rectangle((1, 2), (0, 1), sizes, cell) if cell == "tri3" else box((0, 1), (0, 1), (0, 1), sizes, cell)
    half = np.arange(one.n_cells) < one.n_cells // 2
    points = one.points + 0.002 * np.sin(9.0 * one.points[:, ::-1] + np.arange(one.dim))
    bodies = {"soft": np.flatnonzero(half), "stiff": np.flatnonzero(~half)}
    mesh = Mesh(points, one.blocks, bodies, {}, {}, axisymmetric=plane == "axisymmetric")
    materials = {
        "soft": abut.LinearElastic(YOUNG, NU, expansion=0.1), "stiff": abut.LinearElastic(5.0 * YOUNG, 0.2, expansion=0.3),
    }  # fmt: skip
    solids = Solids(mesh, materials, plane)
    (block,) = mesh.blocks
    generator = np.random.default_rng(5)
    stress, heat = generator.normal(size=(*block.nodes.shape, 6)), generator.normal(size=len(points))
    thermal = np.where(half, 0.1, 0.3)[:, None] * heat[block.nodes]
    if one.dim == 2:
        stress[..., 4:] = 0.0
    known = forces_by_arrays(solids, cell, block.nodes, stress, thermal)
    monkeypatch.setenv("OMP_NUM_THREADS", "1")
    found = interpolation_forces(solids, [stress], TemperatureChange(nodes=heat))
    assert np.abs(found - known).max() < 1e-12 * np.abs(known).max()
    monkeypatch.setenv("OMP_NUM_THREADS", "3")
    assert np.array_equal(interpolation_forces(solids, [stress], TemperatureChange(nodes=heat)), found)

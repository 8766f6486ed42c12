"""Stresses at surfaces from the slopes of the surface's own nodes and the traction: theory (Z9), (Z10)."""

from __future__ import annotations

import numpy as np
import pytest
import scipy.sparse as sp

import abut
from abut.analysis.surface_slopes import SurfacePoints, surface_stress
from abut.bodies.solids import Solids, TemperatureChange
from abut.contact.geometry import area_vectors
from abut.materials.material import Material
from abut.mesh.make import box, join, rectangle, ring
from abut.mesh.mesh import Mesh
from abut.types import Array

ELASTIC = abut.LinearElastic(10.0, 0.3, expansion=0.02)
PLACE = ((0, 3, 5), (3, 1, 4), (5, 4, 2))  # components of a tensor's rows among xx yy zz xy yz zx


def normals(mesh: Mesh, on: str, nodes: Array) -> Array:
    """Mean normals of the facets, (n, dim)."""
    surface = mesh.surface(on)
    area = np.zeros_like(mesh.points)
    used = surface.nodes >= 0
    np.add.at(area, surface.nodes[used], area_vectors(surface)[used])
    return np.asarray(area[nodes] / np.linalg.norm(area[nodes], axis=1, keepdims=True))


def points(mesh: Mesh, on: str, nodes: Array, normal: Array, traction: Array) -> SurfacePoints:
    """Nodes of a surface, none of them on a plane of symmetry."""
    surface = mesh.surface(on)
    facet, local = np.nonzero(surface.nodes >= 0)
    shape = (len(mesh.points), len(surface))
    has = sp.csr_matrix((np.ones(len(facet)), (surface.nodes[facet, local], facet)), shape=shape)
    return SurfacePoints(nodes, has[nodes].tocsr(), normal, np.zeros(normal.shape, dtype=bool), traction)


def inside(mesh: Mesh, on: str) -> Array:
    """Nodes of a surface that lie on none of the others."""
    others = [name for name in mesh.surfaces if name != on]
    return np.setdiff1d(mesh.nodes_of(on), np.concatenate([mesh.nodes_of(name) for name in others]))


@pytest.mark.parametrize("plane", ["strain", "stress", "axisymmetric", None])
@pytest.mark.parametrize("kind", ["quad4", "tri3", "quad8", "tri6"])
def test_quadratic_displacements_give_their_stress(plane: str | None, kind: str) -> None:
    """To rounding, on uneven cells of linear elastic material that is heated: polynomials hold them, while the cells' own
    slopes are off by the size of the cells."""
    if plane is None:
        kind = {"quad4": "hex8", "tri3": "tet4", "quad8": "hex20", "tri6": "tet10"}[kind]
        mesh = box(cells=(3, 4, 2), cell=kind)
    else:
        mesh = rectangle((1.0, 2.0), cells=(5, 2), cell=kind)
    uneven = mesh.points + 0.1 * mesh.points**2
    mesh = Mesh(uneven, mesh.blocks, mesh.bodies, mesh.surfaces, mesh.node_sets, axisymmetric=plane == "axisymmetric")
    dim, random = mesh.dim, np.random.default_rng(5)
    slope, bend = random.normal(size=(dim, dim)), random.normal(size=(dim, dim, dim))
    bend += np.swapaxes(bend, 1, 2)
    x = mesh.points
    moved = x @ slope.T + 0.5 * np.einsum("iab,na,nb->ni", bend, x, x)
    nodes, n = inside(mesh, "top"), len(inside(mesh, "top"))
    strain = np.zeros((n, 3, 3))
    strain[:, :dim, :dim] = slope + np.einsum("iab,nb->nia", bend, x[nodes])
    strain = 0.5 * (strain + np.swapaxes(strain, 1, 2))
    if plane == "axisymmetric":
        strain[:, 2, 2] = moved[nodes, 0] / x[nodes, 0]
    warm = x[:, 0]
    strain -= 0.02 * (warm[nodes] + 3.0)[:, None, None] * np.eye(3)
    lame, mu = 10.0 * 0.3 / (1.3 * 0.4), 10.0 / 2.6
    if plane == "stress":
        strain[:, 2, 2] = -lame * (strain[:, 0, 0] + strain[:, 1, 1]) / (lame + 2.0 * mu)
    exact = 2.0 * mu * strain + lame * np.trace(strain, axis1=1, axis2=2)[:, None, None] * np.eye(3)
    solids = Solids(mesh, dict.fromkeys(mesh.bodies, ELASTIC), plane)
    change = TemperatureChange(dict.fromkeys(mesh.bodies, 3.0), warm)
    normal = normals(mesh, "top", nodes)
    at = points(mesh, "top", nodes, normal, (exact[:, :dim, :dim] @ normal[..., None])[..., 0])
    stress, found = surface_stress(solids, mesh.surface("top"), moved, change, at)
    assert n
    assert found.all()
    assert np.abs(stress[:, np.array(PLACE)[:dim, :dim]] - exact[:, :dim, :dim]).max() < 1e-10
    assert np.abs(stress[:, 2] - exact[:, 2, 2]).max() < 1e-10


@pytest.mark.parametrize("material", [ELASTIC, abut.Hencky(10.0, 0.3), abut.MooneyRivlin(c10=2.0, c01=0.5, bulk=40.0)])
def test_a_uniform_finite_strain_on_a_curved_surface(material: Material) -> None:
    """Turned and stretched by a third, any law of the strain alone: Cauchy's stress F S F^T / J to rounding, whatever the
    surface's normal, since what is fitted is the rest beside the cells' own slope."""
    mesh = ring((1.0, 2.0), cells=(2, 8), cell="quad4")
    turn = np.array([[np.cos(0.8), -np.sin(0.8)], [np.sin(0.8), np.cos(0.8)]])
    moving = turn @ np.array([[1.3, 0.2], [0.0, 0.9]])
    whole = np.eye(3)
    whole[:2, :2] = moving
    green = 0.5 * (whole.T @ whole - np.eye(3))
    strain = np.array([[green[0, 0], green[1, 1], 0.0, 2.0 * green[0, 1], 0.0, 0.0]])
    law = material.evaluate if material is ELASTIC else material.evaluate_finite  # type: ignore[attr-defined]
    second = law(strain, np.zeros((1, 0)))[0][0][np.array(PLACE)]
    exact = whole @ second @ whole.T / np.linalg.det(whole)
    nodes = inside(mesh, "outer")
    still = normals(mesh, "outer", nodes)
    now = still @ np.linalg.inv(moving)
    now /= np.linalg.norm(now, axis=1, keepdims=True)
    at = points(mesh, "outer", nodes, still, now @ exact[:2, :2])
    solids = Solids(mesh, dict.fromkeys(mesh.bodies, material), "strain", kinematics="finite")
    moved = mesh.points @ (moving - np.eye(2)).T
    stress, found = surface_stress(solids, mesh.surface("outer"), moved, TemperatureChange(), at)
    assert found.all()
    assert stress == pytest.approx(
        np.tile([exact[0, 0], exact[1, 1], exact[2, 2], exact[0, 1]], (len(nodes), 1)), rel=1e-8
    )


def test_only_where_the_strain_tells_the_stress() -> None:
    """A metal's stress hangs on its past, too."""
    mesh = rectangle(cells=(3, 2))
    metal = abut.Plastic(10.0, 0.3, 1.0)
    solids = Solids(mesh, dict.fromkeys(mesh.bodies, metal), "strain")
    nodes = inside(mesh, "top")
    at = points(mesh, "top", nodes, normals(mesh, "top", nodes), np.zeros((len(nodes), 2)))
    _, found = surface_stress(solids, mesh.surface("top"), 0.01 * mesh.points, TemperatureChange(), at)
    assert not found.any()


@pytest.mark.parametrize("kind", ["quad4", "quad8"])
def test_half_a_body_shows_what_the_whole_does(kind: str) -> None:
    """Mirrored at its plane of symmetry, at the free surface, under a pressure that changes along it."""
    found = []
    for left in (0.0, -1.0):
        mesh = join({"b": rectangle((left, 1.0), (0.0, 1.0), (round(4 * (1.0 - left)), 3), kind)})
        held = [abut.Support("b.bottom", x=0, y=0)] + ([abut.Support("b.left", x=0)] if left == 0.0 else [])
        load = abut.Pressure("b.top", lambda x: 1.0 - x[:, 0] ** 2)
        solution = abut.solve(abut.Model(mesh, [abut.Solid("b", ELASTIC)], held, [load], plane="strain"))
        top = mesh.nodes_of("b.top")
        top = top[(mesh.points[top, 0] > -1e-9) & (mesh.points[top, 0] < 1.0 - 1e-9)]
        found.append(solution.steps[-1].stress[top[np.argsort(mesh.points[top, 0])]])
    assert found[0] == pytest.approx(found[1], abs=1e-10)

"""The compiled stresses and determinants against the same in NumPy, plainly written."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace

import numpy as np
import pytest

from abut._core import shape_functions, smallest_determinants
from abut.bodies.recovery import nodal_stress
from abut.bodies.solids import Solids, TemperatureChange
from abut.bodies.stress import point_stress
from abut.cells import CELLS
from abut.materials.elastic import LinearElastic, lame
from abut.mesh.integrals import gradients
from abut.mesh.make import box
from abut.mesh.mesh import Mesh
from abut.mesh.quadrature import BBAR, stiffness_rule
from models.patch import two_blocks

MATERIALS = {
    "lower": LinearElastic(young=2.0, poisson=0.3, expansion=1e-2),
    "upper": LinearElastic(young=5.0, poisson=0.1, expansion=3e-2),
}
PLANES = ("strain", "stress", "axisymmetric")
SOLID = [kind for kind, cell in CELLS.items() if cell.dim == 3]
CASES = [
    *((kind, plane, "full") for kind, cell in CELLS.items() if cell.dim == 2 for plane in PLANES),
    *((kind, None, "full") for kind in SOLID),
    *(
        (kind, plane, "b-bar")
        for kind in BBAR
        for plane in (("strain", "axisymmetric") if CELLS[kind].dim == 2 else (None,))
    ),
]


def stress_by_numpy(
    solids: Solids, temperatures: Mapping[str, float], displacement: np.ndarray, nodal: np.ndarray
) -> list[np.ndarray]:
    """D (B u - thermal strain) at the integration points, of each group of cells (cells, points, 6)."""
    mesh, plane, dim = solids.mesh, solids.plane, solids.mesh.dim
    result = []
    body = np.empty(mesh.n_cells, dtype=object)
    for name, own in mesh.bodies.items():
        body[own] = name
    for group in solids.groups():
        kind, nodes, cells, rule = group.kind, group.nodes, group.cells, group.integration
        xi, weights = group.rule
        shapes, derivatives = shape_functions(CELLS[kind].code, np.ascontiguousarray(xi))
        slopes, det = gradients(mesh.points, nodes, derivatives)
        slope = np.einsum("cna,cqnb->cqab", displacement[nodes], slopes)
        strain = np.zeros((*slope.shape[:2], 3, 3))
        strain[..., :dim, :dim] = 0.5 * (slope + np.swapaxes(slope, 2, 3))
        own = [MATERIALS[name] for name in body[cells]]
        lambda_, mu = np.array([lame(m, None) for m in own]).T[..., None]
        poisson = np.array([m.poisson for m in own])[:, None]
        uniform = np.array([temperatures[name] for name in body[cells]])[:, None]
        heat = nodal[nodes] if CELLS[kind].degree > 1 else nodal[nodes].mean(axis=1, keepdims=True) + 0.0 * nodal[nodes]
        thermal = np.array([m.expansion for m in own])[:, None] * (uniform + heat @ shapes.T)
        if plane == "axisymmetric":
            radius = mesh.points[nodes][..., 0] @ shapes.T
            det = det * radius
            strain[..., 2, 2] = displacement[nodes][..., 0] @ shapes.T / radius
        if plane == "stress":
            inplane = strain[..., 0, 0] + strain[..., 1, 1] - 2.0 * thermal
            strain[..., 2, 2] = thermal - poisson / (1.0 - poisson) * inplane
        if rule == "b-bar":
            dilatation = np.trace(strain, axis1=2, axis2=3)
            mean = (dilatation * det * weights).sum(axis=1) / (det * weights).sum(axis=1)
            strain = strain + ((mean[:, None] - dilatation) / 3.0)[..., None, None] * np.eye(3)
        strain = strain - thermal[..., None, None] * np.eye(3)
        trace = np.trace(strain, axis1=2, axis2=3)
        stress = 2.0 * mu[..., None, None] * strain + (lambda_ * trace)[..., None, None] * np.eye(3)
        voigt = stress[..., [0, 1, 2, 0, 1, 2], [0, 1, 2, 1, 2, 0]]
        result.append(voigt)
    return result


def blocks(kind: str, plane: str | None) -> Mesh:
    mesh = two_blocks(kind, kind, ((3, 2), (2, 3)) if CELLS[kind].dim == 2 else ((2, 2, 2), (2, 3, 2)))
    points = mesh.points + (1.0 if plane == "axisymmetric" else 0.0)  # away from the axis
    return replace(mesh, points=points, axisymmetric=plane == "axisymmetric")


@pytest.mark.parametrize(("kind", "plane", "rule"), CASES)
def test_stresses_are_those_of_the_plain_code(kind: str, plane: str | None, rule: str) -> None:
    mesh = blocks(kind, plane)
    random = np.random.default_rng(3)
    u, nodal = random.uniform(-1, 1, mesh.points.shape), random.uniform(-1, 1, len(mesh.points))
    temperatures = {"lower": 2.0, "upper": -1.0}
    solids = Solids(mesh, MATERIALS, plane, {"lower": rule, "upper": "full"})
    got = point_stress(solids, u, TemperatureChange(temperatures, nodal))
    for own, want in zip(got, stress_by_numpy(solids, temperatures, u, nodal), strict=True):
        assert np.abs(own - want).max() < 1e-13 * np.abs(want).max()


def test_stresses_of_a_body_are_its_own() -> None:
    """Recovered from its own cells, with another body beside it or without; a body without material has none."""
    mesh = blocks("hex8", None)
    u = np.random.default_rng(4).uniform(-1, 1, mesh.points.shape)
    whole = nodal_stress(Solids(mesh, MATERIALS), u)
    for name, material in MATERIALS.items():
        alone = nodal_stress(Solids(mesh, {name: material}), u)
        inside = np.isin(np.arange(len(mesh.points)), mesh.nodes_of(name))
        assert np.abs(alone - whole)[inside].max() < 1e-12 * np.abs(whole).max()
        assert not alone[~inside].any()


@pytest.mark.parametrize("kind", [kind for kind, cell in CELLS.items() if cell.dim > 1])
def test_smallest_determinants_are_those_of_the_cells_scaled_to_size_one(kind: str) -> None:
    mesh = blocks(kind, None)
    nodes = mesh.blocks[0].nodes
    _, derivatives = shape_functions(CELLS[kind].code, np.ascontiguousarray(stiffness_rule(kind)[0]))
    x = mesh.points[nodes]
    x = x / np.ptp(x, axis=1).max(axis=1)[:, None, None]
    want = np.linalg.det(np.einsum("cna,qnb->cqab", x, derivatives)).min(axis=1)
    assert np.abs(smallest_determinants(mesh.points, nodes, derivatives) - want).max() < 1e-14
    infinite = np.where(np.arange(len(mesh.points)) == nodes[0, -1], np.inf, mesh.points.T).T.copy()
    assert np.isnan(smallest_determinants(infinite, nodes[:1], derivatives)).all()


def test_threads_do_not_change_the_stresses(monkeypatch: pytest.MonkeyPatch) -> None:
    mesh = box(cells=(19, 18, 17), cell="hex8")  # enough cells for threads to be used
    u = np.random.default_rng(5).uniform(-1, 1, mesh.points.shape)
    results = []
    for threads in ("1", "2", "5"):
        monkeypatch.setenv("OMP_NUM_THREADS", threads)
        results.append(nodal_stress(Solids(mesh, {"body": MATERIALS["lower"]}), u))
    assert all(np.array_equal(results[0], other) for other in results[1:])

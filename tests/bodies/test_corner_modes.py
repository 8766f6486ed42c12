"""Stiffness of quad4 and hex8 by modes of their corners, theory (D26), beside the sum over pairs of nodes at each point:
that of a rule with one point more, at the centre and without weight, with which cells have no such modes."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

import abut
from abut.bodies.assemble import respond
from abut.bodies.integrate import integrate
from abut.bodies.solids import UNHEATED, Solids
from abut.materials.kernel import Since, Wanted
from abut.materials.material import Array, Material
from abut.mesh.make import box, rectangle
from abut.mesh.quadrature import Rule, stiffness_rule

LAWS: dict[str, Material] = {
    "neo-hooke": abut.NeoHooke(10.0, 0.3),
    "mooney-rivlin": abut.MooneyRivlin(c10=1.0, c01=0.5, bulk=20.0),
    "hencky": abut.Hencky(10.0, 0.3),
    "metal": abut.Plastic(200.0, 0.3, 0.4, 5.0),
    "metal-fading": abut.Plastic(200.0, 0.3, 0.4, 5.0, backstresses=[(30.0, 20.0)]),
}
MESHES = {"quad4": rectangle(cells=(2, 2), cell="quad4"), "hex8": box(cells=(2, 1, 2), cell="hex8")}
CASES = [
    (cell, law, integration, since)
    for cell in MESHES
    for law in LAWS
    for integration, since in (("full", False), ("b-bar", False), ("b-bar", True))
]


def bodies(cell: str, law: str, integration: str) -> Solids:
    """Distorted cells."""
    mesh = MESHES[cell]
    mesh = replace(mesh, points=mesh.points + np.random.default_rng(5).uniform(-0.08, 0.08, mesh.points.shape))
    plane = "strain" if cell == "quad4" else None
    return Solids(mesh, {"body": LAWS[law]}, plane, {"body": integration}, "finite")


def moved(solids: Solids, seed: int) -> Array:
    """Displacements that strain by some percent: metal flows at most points."""
    return np.random.default_rng(seed).uniform(-0.03, 0.03, solids.points.shape)


def with_centre(rule: Rule) -> Rule:
    points, weights = rule
    return np.vstack([points, np.zeros((1, points.shape[1]))]), np.append(weights, 0.0)


def integrated(solids: Solids, rule: Rule, u: Array, since: Since | None) -> tuple[Array, Array]:
    """Force, and values of the tangent."""
    indptr, indices = solids.pattern
    force, values = np.zeros(u.shape), np.zeros(len(indices) * u.shape[1] ** 2)
    for group in solids.groups():
        wanted = Wanted(force=force, tangent=(indptr, indices, values), energy=np.zeros(len(group.cells)))
        integrate(solids, group, rule, u, UNHEATED, None, wanted, since)
    return force, values


@pytest.mark.parametrize(("cell", "law", "integration", "foreseen"), CASES)
def test_sum_over_nodes(cell: str, law: str, integration: str, foreseen: bool) -> None:
    """Both are the same sum; what they differ by is rounding."""
    solids, rule = bodies(cell, law, integration), stiffness_rule(cell)
    u = moved(solids, 1)
    since = Since(0.5 * u + moved(solids, 2), False) if foreseen else None
    (force, values), (expected_force, expected) = (
        integrated(solids, each, u, since) for each in (rule, with_centre(rule))
    )
    assert abs(force - expected_force).max() < 1e-13 * abs(expected_force).max()
    assert abs(values - expected).max() < 1e-13 * abs(expected).max()


@pytest.mark.parametrize(("cell", "law", "integration"), [case[:3] for case in CASES if not case[3]])
def test_tangent_is_the_derivative(cell: str, law: str, integration: str) -> None:
    """Central differences of the force; 1e-7: their own error with steps of 1e-5."""
    solids = bodies(cell, law, integration)
    u, way, step = moved(solids, 1), np.random.default_rng(3).standard_normal(solids.points.shape), 1e-5
    ahead, behind = (respond(solids, u + sign * step * way, tangent=False).force for sign in (1.0, -1.0))
    slope = (ahead - behind) / (2.0 * step)
    assert abs(respond(solids, u).tangent @ way.ravel() - slope).max() < 1e-7 * abs(slope).max()

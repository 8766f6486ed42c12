"""The tangent of Newton's method with pressures foreseen where an iteration began, theory (D24)."""

from __future__ import annotations

import numpy as np
import pytest

import abut
from abut.bodies.assemble import respond
from abut.bodies.solids import Solids
from abut.materials.hyperelastic import NeoHooke
from abut.materials.kernel import Since
from abut.materials.material import Array
from abut.mesh.make import rectangle

BULK = 50.0
LAW = NeoHooke(shear=0.7, bulk=BULK, volumetric="isochoric")
GAUSS = 1.0 / np.sqrt(3.0)


def cell(rule: str) -> Solids:
    """One distorted quad4 in plane strain."""
    mesh = rectangle((0.0, 1.0), (0.0, 1.0), (1, 1), "quad4")
    mesh.points[:] += 0.1 * np.random.default_rng(1).standard_normal(mesh.points.shape)
    return Solids(mesh, {"body": LAW}, "strain", {"body": rule}, "finite")


def volume(solids: Solids, u: Array) -> tuple[float, float]:
    """Undeformed size of the cell, and the mean of det F over it by Gauss's rule, which is quadratic in ``u``."""
    nodes = solids.mesh.blocks[0].nodes[0]
    corner = np.array([[-1, -1], [1, -1], [1, 1], [-1, 1]], dtype=float)
    sizes, ratios = [], []
    for xi in GAUSS * corner:
        slope = 0.25 * np.column_stack(
            [corner[:, 0] * (1 + corner[:, 1] * xi[1]), corner[:, 1] * (1 + corner[:, 0] * xi[0])]
        )
        one, other = (np.linalg.det(x[nodes].T @ slope) for x in (solids.points, solids.points + u))
        sizes.append(one)
        ratios.append(other / one)
    return sum(sizes), float(np.dot(sizes, ratios) / sum(sizes))


@pytest.mark.parametrize("guessed", [False, True])
def test_pressure_beside_displacements(guessed: bool) -> None:
    """The tangent differs by the second derivative of the volume times what the foreseen pressure differs by; as det F is
    quadratic in the displacements of a plane cell, differences give both exactly."""
    solids, rng = cell("mixed"), np.random.default_rng(2)
    before, after, a, b = (0.1 * rng.standard_normal(solids.points.shape) for _ in range(4))

    def at(u: Array) -> float:
        return volume(solids, u)[1]

    usual = respond(solids, after).tangent
    foreseen = respond(solids, after, since=Since(before, guessed)).tangent
    way = after - before
    linear = 0.0 if guessed else 0.5 * (at(before + way) - at(before - way))
    more = -BULK * (at(after) - at(before) - linear)
    curved = at(after + a + b) - at(after + a) - at(after + b) + at(after)
    expected = volume(solids, after)[0] * more * curved
    assert a.ravel() @ (foreseen - usual) @ b.ravel() == pytest.approx(expected, rel=1e-9)


@pytest.mark.parametrize("rule", ["full", "b-bar", "mixed"])
def test_nothing_to_foresee(rule: str) -> None:
    """From where it is the tangent is the usual one; forces never change."""
    solids = cell(rule)
    u, other = (0.1 * np.random.default_rng(seed).standard_normal(solids.points.shape) for seed in (2, 3))
    told = respond(solids, u)
    for guessed in (False, True):
        same = respond(solids, u, since=Since(u, guessed))
        assert abs(same.tangent - told.tangent).max() <= 1e-13 * abs(told.tangent).max()
        elsewhere = respond(solids, u, since=Since(other, guessed))
        assert (elsewhere.force == told.force).all()
        assert (abs(elsewhere.tangent - told.tangent).max() == 0.0) == (rule == "full")  # with no volume of its own


@pytest.mark.parametrize(("kind", "rule"), [("quad4", "mixed"), ("quad4", "b-bar"), ("tri6", "mixed")])
def test_iterations_do_not_grow_with_the_bulk_modulus(kind: str, rule: str) -> None:
    """A rough block squeezed by a fifth at once. With the pressure as an unknown Newton's method has a limit as the bulk
    modulus grows without end; with displacements alone its steps shrink with it."""

    def iterations(bulk: float) -> int:
        law = NeoHooke(shear=1.0, bulk=bulk, volumetric="isochoric")
        model = abut.Model(
            rectangle((0.0, 2.0), (0.0, 1.0), (8, 4), kind),
            [abut.Solid("body", law, integration=rule)],
            [abut.Support("bottom", x=0.0, y=0.0), abut.Support("top", x=0.0, y=-0.2)],
            plane="strain",
            kinematics="finite",
            solve=abut.SolveOptions(steps=1),
        )
        solution = abut.solve(model)
        assert solution.converged
        assert len(solution.steps) == 1  # no cut
        return len(solution.steps[-1].iterations)

    assert iterations(1e5) <= iterations(1e3) + 1

"""What cells of first order miss of displacements that bend, and stresses without it, theory (Z13)."""

from __future__ import annotations

from dataclasses import replace
from itertools import permutations

import numpy as np
import pytest

import abut
from abut._core import shape_functions
from abut.bodies.interpolated_samples import (
    PAIRS,
    TENSOR,
    missed_strains,
    slopes_in_middle,
    straight,
    without_interpolation,
)
from abut.bodies.patch_fits import Sampling, fitted, no_equations
from abut.bodies.recovery import recovered
from abut.bodies.solids import Solids, TemperatureChange
from abut.bodies.stress import point_stress
from abut.cells import CELLS
from abut.mesh.make import box, rectangle
from abut.mesh.mesh import Mesh
from abut.mesh.reference import reference_nodes
from abut.types import Array

FIRST = [kind for kind, cell in CELLS.items() if cell.dim > 1 and cell.degree == 1]


def symmetric(values: Array) -> Array:
    """In all but the first index."""
    orders = list(permutations(range(1, values.ndim)))
    return np.asarray(sum(np.transpose(values, (0, *order)) for order in orders) / len(orders))


class Cubic:
    """u_a = B_abc x_b x_c / 2 + C_abcd x_b x_c x_d / 6, with random numbers."""

    def __init__(self, dim: int) -> None:
        random = np.random.default_rng(dim)
        self.second = symmetric(random.normal(size=(dim,) * 3))
        self.third = symmetric(random.normal(size=(dim,) * 4))

    def displacement(self, x: Array) -> Array:
        quadratic = np.einsum("abc,...b,...c->...a", self.second, x, x)
        return np.asarray(quadratic / 2.0 + np.einsum("abcd,...b,...c,...d->...a", self.third, x, x, x) / 6.0)

    def slope(self, x: Array) -> Array:
        """du_a / dx_b, (..., dim, dim)."""
        quadratic = np.einsum("abcd,...c,...d->...ab", self.third, x, x)
        return np.asarray(np.einsum("abc,...c->...ab", self.second, x) + quadratic / 2.0)

    def bend(self, x: Array) -> Array:
        """Its slopes, (..., dim, dim, dim)."""
        return np.asarray(self.second + np.einsum("abcd,...d->...abc", self.third, x))


def strain(slope: Array) -> Array:
    """Components (..., 6) of a tensor, of slopes (..., dim, dim)."""
    dim = slope.shape[-1]
    result = np.zeros((*slope.shape[:-2], 6))
    for a, b in PAIRS[dim]:
        result[..., TENSOR[a][b]] = 0.5 * (slope[..., a, b] + slope[..., b, a])
    return result


@pytest.mark.parametrize("round_axis", [False, True])
@pytest.mark.parametrize("kind", FIRST)
def test_of_cubic_displacements(kind: str, round_axis: bool) -> None:
    """In bent cells, beside the slopes that their own shape functions give of the nodes' displacements."""
    dim = CELLS[kind].dim
    if round_axis and dim == 3:
        pytest.skip("is plane")
    exact, random = Cubic(dim), np.random.default_rng(7)
    corners = reference_nodes(kind)
    x = 2.0 + corners + random.uniform(-0.15, 0.15, size=(4, *corners.shape))
    middle = x.mean(axis=1)
    steep = strain(np.moveaxis(exact.bend(middle), -1, 1))
    curve = np.stack([strain(exact.third[..., a, b]) for a, b in PAIRS[dim]])
    shapes, derivatives = shape_functions(CELLS[kind].code, corners.mean(axis=0, keepdims=True))
    nodal = exact.displacement(x)
    slope = np.swapaxes(nodal, 1, 2) @ derivatives[0] @ np.linalg.inv(np.swapaxes(x, 1, 2) @ derivatives[0])
    off = strain(slope - exact.slope(middle))
    off[:, 3:] *= 2.0
    if round_axis:
        off[:, 2] = (shapes[0] @ nodal[..., 0].T - exact.displacement(middle)[:, 0]) / middle[:, 0]
    off = off[:, : 4 if dim == 2 else 6]
    radius = middle[:, 0] if round_axis else None
    found = missed_strains(
        slopes_in_middle(kind, x), x - middle[:, None], steep, np.broadcast_to(curve, (4, *curve.shape)), radius
    )
    assert np.abs(off).max() > 0.01 * np.abs(strain(exact.slope(middle))).max()
    assert np.abs(found - off).max() < 1e-12 * np.abs(exact.slope(middle)).max()


ISOTROPIC = abut.LinearElastic(3.0, 0.3)
PLY = abut.Orthotropic((3.0, 2.0, 4.0), (0.2, 0.1, 0.3), (1.0, 0.7, 1.2))


@pytest.mark.parametrize(
    ("kind", "plane", "material"),
    [
        ("quad4", "strain", ISOTROPIC), ("quad4", "stress", ISOTROPIC), ("quad4", "strain", PLY), ("hex8", None, ISOTROPIC),
        ("hex8", None, PLY),
    ],
)  # fmt: skip
def test_quadratic_stresses_inside(kind: str, plane: str | None, material: abut.Material) -> None:
    """Cells that are alike are off by the same everywhere under a cubic displacement, so that second derivatives are right
    from the start: what is left is of what keeps these small (1e-4 in (Z2))."""
    dim = CELLS[kind].dim
    mesh = rectangle((0, 2), (0, 1), (7, 6), kind) if dim == 2 else box((0, 2), (0, 1), (0, 1.5), (6, 6, 6), kind)
    solids, exact = Solids(mesh, dict.fromkeys(mesh.bodies, material), plane), Cubic(dim)
    stress = point_stress(solids, np.ascontiguousarray(exact.displacement(mesh.points)))
    strains = strain(exact.slope(mesh.points))
    strains[:, 3:] *= 2.0
    if plane == "stress":
        strains[:, 2] = -0.3 / 0.7 * strains[:, :2].sum(axis=1)
    known = material.evaluate(strains, np.zeros((len(strains), 0)))[0]
    inside = np.ones(len(mesh.points), dtype=bool)
    for surface in mesh.surfaces:
        inside[mesh.nodes_of(surface)] = False
    before, after = (
        np.abs(recovered(solids, mesh.points, stress, interpolated=change) - known)[inside].max()
        for change in (None, TemperatureChange())
    )
    assert before > 3e-4 * np.abs(known).max()
    assert after < 0.03 * before


def test_free_expansion() -> None:
    """Under a temperature x a free body moves by alpha (x^2 - y^2) / 2 and alpha x y, in plane stress, without stress:
    triangles have some of the interpolate, and temperatures tell how much."""
    mesh = rectangle((0, 2), (0, 1), (8, 6), "tri3")
    points = mesh.points + 0.03 * np.sin(9.0 * mesh.points[:, ::-1] + np.arange(2))
    mesh = Mesh(points, mesh.blocks, mesh.bodies, mesh.surfaces, {})
    solids = Solids(mesh, dict.fromkeys(mesh.bodies, abut.LinearElastic(3.0, 0.3, expansion=0.1)), "stress")
    x, y = points.T
    change = TemperatureChange(nodes=x)
    stress = point_stress(solids, 0.1 * np.column_stack([0.5 * (x**2 - y**2), x * y]), change)
    none = np.zeros((len(solids.patches.corner), 6, 4))
    own = fitted(Sampling.of(solids, points, no_equations(solids.patches, 2)), stress, no_equations(solids.patches, 2))
    flat = replace(own, coefficients=none)  # the stress that there is: nothing
    (before,), (after,) = stress, without_interpolation(flat, change)
    assert np.abs(after).max() < 1e-12 * np.abs(before).max()


@pytest.mark.parametrize("kind", ["tri3", "tet4"])
def test_of_some_cells(kind: str) -> None:
    """The same there as of all, the others as they are."""
    mesh = rectangle((0, 2), (0, 1), (6, 4), kind) if kind == "tri3" else box((0, 2), (0, 1), (0, 1), (3, 3, 3), kind)
    solids, exact, nothing = (
        Solids(mesh, dict.fromkeys(mesh.bodies, ISOTROPIC), "strain"),
        Cubic(mesh.dim),
        TemperatureChange(),
    )
    stress = point_stress(solids, np.ascontiguousarray(exact.displacement(mesh.points)))
    known = no_equations(solids.patches, mesh.dim)
    fits = fitted(Sampling.of(solids, mesh.points, known), stress, known)
    some = np.random.default_rng(3).random(mesh.n_cells) < 0.2
    (own,), (whole,), (part,) = stress, without_interpolation(fits, nothing), without_interpolation(fits, nothing, some)
    assert np.abs(part - whole)[some].max() < 1e-12 * np.abs(own).max()
    assert (part == own)[~some].all()
    assert (np.abs(whole - own).max(axis=(1, 2)) > 0.0).all()
    (none,) = without_interpolation(fits, nothing, np.zeros(mesh.n_cells, dtype=bool))
    assert (none == own).all()


def test_other_laws_and_cells_stay() -> None:
    """Of cells of second order, of mean dilatation, and of a law that is not linear, samples are left as they are."""
    rubber = abut.NeoHooke(young=3.0, poisson=0.3)
    for kind, material, how, kinematics in (
        ("quad8", ISOTROPIC, "full", "small"), ("quad4", ISOTROPIC, "b-bar", "small"),
        ("quad4", ISOTROPIC, "full", "finite"), ("quad4", rubber, "full", "finite"),
    ):  # fmt: skip
        mesh = rectangle(cells=(3, 3), cell=kind)
        bodies = dict.fromkeys(mesh.bodies, material)
        solids = Solids(mesh, bodies, "strain", dict.fromkeys(mesh.bodies, how), kinematics)
        assert not straight(solids).any()

"""Axisymmetric models: patch test, Lame's thick ring under pressure and heat, the axis, and bad input."""

from __future__ import annotations

import numpy as np
import pytest

import abut
from abut.mesh.make import join, rectangle

CELLS = ("tri3", "tri6", "quad4", "quad8", "quad9")
MATERIAL = abut.LinearElastic(1.0, 0.3, density=2.0, expansion=1e-3)


@pytest.mark.parametrize("law", [{}, {"law": "constraint-function", "epsilon": 1e-24}], ids=["pdas", "constraint"])
@pytest.mark.parametrize("cell", CELLS)
def test_patch(cell: str, law: dict[str, object]) -> None:
    """Two cylinders pressed together: uniform pressure and linear displacement lie in the spaces, so they are exact."""
    parts = {
        "lower": rectangle(y=(0, 1), cells=(3, 3), cell=cell),
        "upper": rectangle(y=(1, 2), cells=(4, 3), cell=cell),
    }
    model = abut.Model(
        join(parts),
        [abut.Solid(body, MATERIAL) for body in parts],
        [abut.Support("lower.bottom", y=0)],
        [abut.Pressure("upper.top", 1e-3)],
        [abut.Contact(contactor="lower.top", target="upper.bottom", **law)],
        plane="axisymmetric",
    )
    solution = abut.solve(model)
    r, z = model.mesh.points.T
    assert solution.displacement == pytest.approx(np.column_stack([0.3e-3 * r, -1e-3 * z]), abs=1e-13)
    assert np.nanmax(np.abs(solution.contacts[0].pressure / 1e-3 - 1)) < 1e-12
    assert solution.contacts[0].force[1] == pytest.approx(-np.pi * 1e-3, rel=1e-12)  # all round
    assert solution.steps[-1].balance_error < 1e-12


def ring(cells: int, **options: object) -> abut.Solution:
    mesh = join({"ring": rectangle(x=(1, 2), y=(0, 0.5), cells=(cells, 2), cell="quad8")})
    model = abut.Model(
        mesh,
        [abut.Solid("ring", MATERIAL, temperature=float(options.get("temperature", 0.0)))],
        [abut.Support("ring.bottom", y=0), *options.get("supports", [])],
        options.get("loads", []),
        plane="axisymmetric",
    )
    return abut.solve(model)


def test_thick_ring_under_inner_pressure() -> None:
    """Lame: radial -p (b^2/r^2 - 1)/(b^2 - 1), hoop p (b^2/r^2 + 1)/(b^2 - 1) for radii 1 and b = 2. Quadratic cells
    are off by h^2/12 times the second derivative (8 at most) where stress is extrapolated to nodes: 2.6e-3 at h = 1/16."""
    solution = ring(16, loads=[abut.Pressure("ring.left", 1.0)], supports=[])
    r = solution.model.mesh.points[:, 0]
    stress = solution.steps[-1].stress
    assert stress[:, 0] == pytest.approx(-(4 / r**2 - 1) / 3, abs=3e-3)
    assert stress[:, 2] == pytest.approx((4 / r**2 + 1) / 3, abs=3e-3)
    radial = (1 / 3) * ((1 - 0.3) * r + (1 + 0.3) * 4 / r)  # plane stress
    assert solution.displacement[:, 0] == pytest.approx(radial, rel=1e-5)


def test_heated_ring_grows_freely() -> None:
    """A uniform temperature change strains all directions alike and stresses nothing."""
    solution = ring(3, temperature=10.0)
    assert solution.displacement == pytest.approx(1e-2 * solution.model.mesh.points, abs=1e-13)
    assert np.abs(solution.steps[-1].stress).max() < 1e-12


def test_weight_of_a_ring() -> None:
    """The support carries density x g x volume, the volume that of the whole ring."""
    solution = ring(3, loads=[abut.Gravity((0.0, -10.0))])
    assert solution.steps[-1].reaction[1] == pytest.approx(2.0 * 10.0 * np.pi * (4 - 1) * 0.5, rel=1e-12)


def test_bad_axisymmetric_input() -> None:
    mesh = join({"plate": rectangle(x=(-1, 1), cells=(2, 2))})
    with pytest.raises(abut.InputError, match="points lie at x < 0"):
        abut.Model(mesh, [abut.Solid("plate", MATERIAL)], plane="axisymmetric")
    mesh = join({"ring": rectangle(x=(1, 2), cells=(2, 2))})
    free = abut.Model(mesh, [abut.Solid("ring", MATERIAL)], loads=[abut.Pressure("ring.top", 1)], plane="axisymmetric")
    with pytest.raises(abut.SingularModelError, match="is free to translate along the axis -y"):
        abut.solve(free)

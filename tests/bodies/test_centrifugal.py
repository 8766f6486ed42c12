"""Centrifugal forces: rotating discs and cylinders against Lame's solution with body forces, and sums of reactions."""

from __future__ import annotations

import numpy as np
import pytest

import abut
from abut.mesh import make
from abut.problem.loads import applied_load

E, NU, RHO, SPEED, A, B = 210e3, 0.3, 7.8e-9, 1000.0, 20.0, 100.0
STEEL = abut.LinearElastic(young=E, poisson=NU, density=RHO)


def radial(r: np.ndarray, young: float, poisson: float) -> np.ndarray:
    """Displacement of a rotating annular disc, free at both radii, in plane stress (Timoshenko and Goodier, Theory of
    Elasticity, section 32)."""
    return (
        RHO * SPEED**2 * (3.0 + poisson) * (1.0 - poisson) / (8.0 * young)
        * ((A * A + B * B) * r + (1.0 + poisson) / (1.0 - poisson) * (A * B) ** 2 / r
           - (1.0 + poisson) / (3.0 + poisson) * r**3)
    )  # fmt: skip


@pytest.mark.parametrize("given", [{}, {"through": (0.0, 0.0)}, {"on": "body"}])
def test_a_rotating_disc(given: dict) -> None:
    """A quarter of it, quadratic cells: their error is of the fourth order in displacements, measured 3e-5 here."""
    mesh = make.ring([A, B], [0, 90], cells=[12, 12], cell="quad9")
    mesh = make.join({"body": mesh})
    supports = [abut.Support("body.start", y=0), abut.Support("body.end", x=0)]
    load = abut.Centrifugal(SPEED, **given)
    solution = abut.solve(abut.Model(mesh, [abut.Solid("body", STEEL)], supports, [load], plane="stress"))
    exact = radial(np.linalg.norm(mesh.points, axis=1), E, NU)
    assert np.linalg.norm(solution.displacement, axis=1) == pytest.approx(exact, rel=1e-4)


def test_a_rotating_cylinder() -> None:
    """Axisymmetric, held along its axis: plane strain."""
    mesh = make.join({"body": make.rectangle([A, B], [0, 10], cells=[16, 2], cell="quad9")})
    supports = [abut.Support(f"body.{side}", y=0) for side in ("bottom", "top")]
    model = abut.Model(mesh, [abut.Solid("body", STEEL)], supports, [abut.Centrifugal(SPEED)], plane="axisymmetric")
    exact = radial(mesh.points[:, 0], E / (1.0 - NU**2), NU / (1.0 - NU))
    assert abut.solve(model).displacement[:, 0] == pytest.approx(exact, rel=1e-4)


def test_the_whole_force() -> None:
    """Mass times speed squared times the distance of its centre from an oblique axis, whatever the cells."""
    mesh = make.join({"body": make.box([2, 3], [1, 2], [0, 3], cells=[2, 2, 2], cell="tet10")})
    solid = abut.Solid("body", abut.LinearElastic(young=1e9, poisson=0.3, density=2.0))
    axis, through = np.array([1.0, 2.0, 2.0]) / 3.0, np.array([1.0, 0.0, 1.0])
    load = abut.Centrifugal(3.0, tuple(2.0 * axis), tuple(through))
    model = abut.Model(mesh, [solid], [abut.Support("body.bottom", x=0, y=0, z=0)], [load])
    apart = np.array([2.5, 1.5, 1.5]) - through
    exact = 2.0 * 3.0 * 9.0 * (apart - apart @ axis * axis)
    assert applied_load(model).sum(axis=1).reshape(-1, 3).sum(axis=0) == pytest.approx(exact, rel=1e-12)


@pytest.mark.parametrize(
    ("load", "says"),
    [
        ({"speed": 1.0}, r"loads\[0\]: axis is missing"),
        ({"speed": 1.0, "axis": (0, 0, 0)}, "expected a direction, got zero"),
        ({"speed": 1.0, "axis": (0, 1)}, r"loads\[0\].axis: expected 3 components, got 2"),
        ({"speed": 1.0, "axis": (0, 0, 1), "through": (0, 1)}, r"through: expected 3 components, got 2"),
        ({"speed": float("nan"), "axis": (0, 0, 1)}, "speed"),
        ({"speed": 1.0, "axis": (0, 0, 1), "on": "nobody"}, r"loads\[0\].on"),
    ],
)
def test_what_is_refused(load: dict, says: str) -> None:
    mesh = make.join({"body": make.box([0, 1], [0, 1], [0, 1], cells=[1, 1, 1])})
    with pytest.raises(abut.InputError, match=says):
        abut.Model(
            mesh, [abut.Solid("body", STEEL)], [abut.Support("body.bottom", x=0, y=0, z=0)], [abut.Centrifugal(**load)]
        )

"""Bilateral contact, theory (L16): the gap stays zero whatever the sign of the pressure, and the sides slide freely."""

from __future__ import annotations

import numpy as np
import pytest

import abut
from abut.errors import InputError
from abut.mesh.make import block, join
from models.patch import two_blocks

YOUNG = 1000.0
CELLS = {
    "quad4": (((3, 2), (4, 2)), "quad4"),
    "tri6": (((3, 2), (2, 2)), "quad8"),
    "hex8": (((2, 3, 1), (3, 2, 1)), "hex20"),
}


def pulled(lower: str, kinematics: str = "small", gap: float = 0.0, pull: float = 1.0, **contact: object) -> abut.Model:
    """Unit blocks with meshes of their own, without Poisson's ratio: pulled by ``pull`` on top, a length ``gap`` apart."""
    cells, upper = CELLS[lower]
    mesh = two_blocks(lower, upper, cells)
    mesh = mesh.__class__(**{**vars(mesh), "points": mesh.points + gap * lifted(mesh)})
    both, names = ("lower", "upper"), ("left", "front")[: mesh.dim - 1]
    sides = [abut.Support(f"{body}.{side}", normal=0.0) for body in both for side in names]
    steel = abut.LinearElastic(YOUNG, 0.0)
    return abut.Model(
        mesh,
        solids=[abut.Solid("lower", steel), abut.Solid("upper", steel)],
        supports=[abut.Support("lower.bottom", normal=0.0), *sides],
        loads=[abut.Pressure("upper.top", -pull)],
        contacts=[abut.Contact("lower.top", "upper.bottom", **{"kind": "bilateral", **contact})],
        plane="strain" if mesh.dim == 2 else None,
        kinematics=kinematics,
    )  # fmt: skip


def lifted(mesh: abut.Mesh) -> np.ndarray:
    """A unit of height for the upper block's points."""
    up = np.zeros_like(mesh.points)
    up[mesh.nodes_of("upper"), -1] = 1.0
    return up


@pytest.mark.parametrize("cell", CELLS)
@pytest.mark.parametrize("sign", [1.0, -1.0])
def test_tension_goes_over_as_pressure_does(cell: str, sign: float) -> None:
    """The patch test, either way: a uniform stress on unlike meshes, to rounding."""
    solution = abut.solve(pulled(cell, pull=sign))
    step = solution.steps[-1]
    assert solution.converged
    assert np.nanmax(np.abs(step.contacts[0].pressure + sign)) < 1e-9
    mesh = solution.model.mesh
    high = mesh.nodes_of("upper.top")
    assert step.displacement[high, -1] == pytest.approx(sign * 1.8 / YOUNG, rel=1e-9)
    assert all(check.passed for check in solution.certificate)
    assert "tension" not in {check.name for check in solution.certificate}


def test_it_slides_freely() -> None:
    """The upper block moved along the interface by 0.02, while it is pulled: no force along it."""
    base = pulled("quad4")
    supports = [support for support in base.supports if support.on != "upper.left"]
    moved = abut.Model(
        **{**{f: getattr(base, f) for f in ("mesh", "solids", "loads", "contacts", "plane")},
           "supports": [*supports, abut.Support("upper.left", x=0.02)]}
    )  # fmt: skip
    step = abut.solve(moved).steps[-1]
    assert np.abs(step.contacts[0].force[0]) < 1e-9 * np.abs(step.contacts[0].force[1])
    assert abs(step.contacts[0].force[1]) == pytest.approx(1.0, rel=1e-9)


@pytest.mark.parametrize(("options", "closes"), [({}, 0.01), ({"adjust": 0.02}, 0.0), ({"offset": -0.004}, 0.006)])
def test_the_gap_is_closed(options: dict[str, float], closes: float) -> None:
    """The gap of the mesh and the offset are, what ``adjust`` takes away is not."""
    solution = abut.solve(pulled("quad4", gap=0.01, **options))
    low = solution.steps[-1].displacement[solution.model.mesh.nodes_of("upper.bottom"), -1]
    assert low == pytest.approx(1.0 / YOUNG - closes, rel=1e-9, abs=1e-12)


def test_large_displacements() -> None:
    """Saint Venant and Kirchhoff under a pull of 50 that follows: both blocks stretch alike."""
    base = pulled("quad4", "finite", pull=50.0)
    solution = abut.solve(base)
    step = solution.steps[-1]
    assert solution.converged
    high, low = (step.displacement[solution.model.mesh.nodes_of(name), -1] for name in ("upper.top", "lower.top"))
    assert np.ptp(high) < 1e-9
    assert high.mean() == pytest.approx(1.8 * low.mean(), rel=1e-8)
    assert np.nanmax(np.abs(step.contacts[0].pressure + 50.0)) < 1e-6


def test_large_sliding_under_tension() -> None:
    """A short block slides along a long one by several facets while it is pulled away: nothing opens, nothing drags."""
    lines = [np.linspace(0.0, 3.0, 10), np.linspace(0.0, 1.0, 3)]
    short = [np.linspace(0.4, 1.4, 5), np.linspace(1.0, 2.0, 3)]
    mesh = join({"base": block.grid(lines, "quad4"), "slider": block.grid(short, "quad4")})
    steel = abut.LinearElastic(YOUNG, 0.0)
    solution = abut.solve(
        abut.Model(
            mesh,
            solids=[abut.Solid("base", steel), abut.Solid("slider", steel)],
            supports=[abut.Support("base.bottom", x=0.0, y=0.0), abut.Support("slider.top", x=1.0)],
            loads=[abut.Pressure("slider.top", -1.0)],
            contacts=[abut.Contact(contactor="slider.bottom", target="base.top", kind="bilateral")],
            plane="strain",
            kinematics="finite",
        )
    )
    step = solution.steps[-1]
    assert solution.converged
    assert abs(step.contacts[0].force[1]) == pytest.approx(1.0, rel=1e-3)
    assert abs(step.contacts[0].force[0]) < 5e-3
    assert np.nanmax(step.contacts[0].pressure) < 0.0


@pytest.mark.parametrize(
    ("options", "message"),
    [
        ({"friction": 0.1}, "bilateral contact slides freely"),
        ({"law": "constraint-function"}, "bilateral contact is an equation"),
        ({"method": "node-to-segment"}, "knows only kind contact"),
    ],
)
def test_what_does_not_go_with_it(options: dict[str, object], message: str) -> None:
    with pytest.raises(InputError, match=message):
        abut.Contact("a", "b", kind="bilateral", **options)

"""The contact patch test at finite strain: squeezed to 0.8 in a frame turned by 70 degrees, for every pair of facets and
pressure.

One affine motion is the solution, with Cauchy's pressure everywhere on the interface and none on the free sides."""

from __future__ import annotations

import itertools
from dataclasses import replace
from typing import Any

import numpy as np
import pytest
from numpy.typing import NDArray

import abut
from abut.nonlinear.settings import DEFAULT
from abut.problem.turns import rotation
from models.patch import CELL_OF, two_blocks
from models.sliding import turned

RUBBER = abut.NeoHooke(100.0, 0.3)
SHEAR, LAME, SQUEEZE = 100.0 / 2.6, 100.0 * 0.3 / (1.3 * 0.4), 0.8
ANGLE = np.deg2rad(70.0)
EXACT = 1e-9
ENDS = (
    1e-12  # of Newton's method, which else stops at 1e-9 of the largest force: what the discretisation leaves is seen
)
TO_THE_END = replace(DEFAULT, newton=replace(DEFAULT.newton, balanced=ENDS))
LINEAR = ("P0", "P1", "dual", "dual-P1")  # those whose pressures are determined
QUADRATIC = (*LINEAR, "P1-discontinuous", "P2")
PLANE = {"line2": "quad4", "line3": "quad8"}
SECOND_ORDER = ("tri6", "quad8", "quad9", "line3")


def sideways(dim: int) -> float:
    """The stretch across that leaves no stress there: mu (b - 1) + lambda (J^2 - 1) / 2 = 0."""
    power = 1 if dim == 2 else 2  # J^2 = b^power s^2
    lame = 0.5 * LAME * SQUEEZE**2
    coefficients = [lame, SHEAR, -SHEAR - 0.5 * LAME] if power == 2 else [lame + SHEAR, -SHEAR - 0.5 * LAME]
    return float(np.sqrt(np.max(np.roots(coefficients))))


def frame(dim: int) -> NDArray[np.float64]:
    axis = np.array([0.3, -0.8, 0.5])
    return turned(ANGLE) if dim == 2 else rotation(ANGLE * axis / np.linalg.norm(axis))


def cauchy(dim: int) -> float:
    """Pressure between the blocks."""
    volume = sideways(dim) ** (dim - 1) * SQUEEZE
    return -(SHEAR * (SQUEEZE**2 - 1.0) + 0.5 * LAME * (volume**2 - 1.0)) / volume


def errors(contactor: str, target: str, pressure: str, friction: float = 0.0) -> tuple[float, float]:
    """Largest relative errors of pressure and displacement, between blocks whose ends follow the motion."""
    dim = 2 if contactor in PLANE else 3
    cells = ((3, 2), (4, 2)) if dim == 2 else ((1, 2, 1), (2, 1, 1))
    cell_of = {**CELL_OF, **PLANE}
    mesh = two_blocks(cell_of[contactor], cell_of[target], cells)
    turn = frame(dim)
    mesh = replace(mesh, points=mesh.points @ turn.T)
    moves = turn @ np.diag([sideways(dim)] * (dim - 1) + [SQUEEZE]) @ turn.T

    def u(a: int) -> Any:
        return lambda x: x @ moves[a] - x[:, a]

    axes = {axis: u(a) for a, axis in enumerate("xyz"[:dim])}
    built = abut.Model(
        mesh, [abut.Solid("lower", RUBBER), abut.Solid("upper", RUBBER)],
        supports=[abut.Support(name, **axes) for name in ("lower.bottom", "upper.top")],
        plane="strain" if dim == 2 else None,
        contacts=[abut.Contact(contactor="lower.top", target="upper.bottom", pressure=pressure, friction=friction)],
        kinematics="finite", solve=abut.SolveOptions(steps=1),
    )  # fmt: skip
    solution = abut.solve(built, settings=TO_THE_END)
    assert solution.converged
    exact = mesh.points @ moves.T - mesh.points
    wrong = np.nanmax(np.abs(solution.contacts[0].multiplier / cauchy(dim) - 1.0))
    return float(wrong), float(np.abs(solution.steps[-1].displacement - exact).max())


PAIRS = [*itertools.product(PLANE, PLANE), *itertools.product(CELL_OF, CELL_OF)]


SOME = {("tri3", "quad4"), ("quad4", "tri3"), ("quad8", "quad4"), ("quad9", "quad9"), ("tri6", "quad8")}


@pytest.mark.long
@pytest.mark.parametrize(
    ("contactor", "target"),
    [p if p[0] in PLANE or p in SOME else pytest.param(*p, marks=pytest.mark.exhaustive) for p in PAIRS],
)
def test_every_pair(contactor: str, target: str) -> None:
    assert max(errors(contactor, target, "dual", 0.3)) < EXACT


def spaces(contactor: str) -> tuple[str, ...]:
    return QUADRATIC if contactor in SECOND_ORDER else LINEAR


@pytest.mark.parametrize("friction", [0.0, 0.3])
@pytest.mark.parametrize(
    ("contactor", "target", "pressure"),
    [(c, t, p) for c, t in (("line2", "line3"), ("line3", "line2"), ("tri6", "quad4")) for p in spaces(c)],
)
def test_every_space(contactor: str, target: str, pressure: str, friction: float) -> None:
    assert max(errors(contactor, target, pressure, friction)) < EXACT


@pytest.mark.exhaustive
@pytest.mark.parametrize(
    ("contactor", "target", "pressure"), [(c, t, p) for c, t in PAIRS for p in spaces(c) if p != "dual"]
)
def test_every_pair_in_every_space(contactor: str, target: str, pressure: str) -> None:
    assert max(errors(contactor, target, pressure)) < EXACT

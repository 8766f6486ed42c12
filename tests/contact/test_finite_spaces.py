"""Every pressure space at current positions: derivatives, sliding, the edge of the target."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from numpy.typing import NDArray

import abut
from models.sliding import arched, finite, pressed_in_space

LINEAR = ("P0", "P1", "P1-discontinuous", "dual")
QUADRATIC = (*LINEAR, "P2", "P2-discontinuous")
ALONG_THE_EDGE = 0.45  # moved so far, a part of the contactor hangs over


def over(model: abut.Model, pressure: str) -> abut.Model:
    """With a pressure, and with the upper body moved so that it hangs over the end of the lower one."""
    points = model.mesh.points.copy()
    body = np.unique(np.concatenate([cells.ravel() for _, cells, _ in model.mesh.cells_of("upper")]))
    points[body, 0] += 3.0 - 1.5 + ALONG_THE_EDGE if points.shape[1] == 2 else 2.0 - 1.1 + ALONG_THE_EDGE - 0.1
    contact = replace(model.contacts[0], pressure=pressure)
    return replace(model, mesh=replace(model.mesh, points=points), contacts=[contact])


def error(model: abut.Model, step: float = 1e-6, size: float = 3e-3) -> float:
    """Of the derivatives of forces, gaps and slips in all displacements at once, against central differences; relative."""
    problem, rng = finite(model), np.random.default_rng(3)
    before, n = problem.start(), problem.operator.shape[0]
    at = replace(
        before, time=0.7, unknowns=size * rng.standard_normal(problem.n_free), multipliers=rng.uniform(0.0, 5.0, n)
    )
    system, way = problem.linearise(before, at), rng.standard_normal(problem.n_free)

    def there(by: float) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
        state = replace(at, unknowns=at.unknowns + by * way)
        near = problem.linearise(before, state)
        return near.unbalanced(state), near.gap(state)

    ahead, back = there(step), there(-step)
    forces, gaps = ((a - b) / (2.0 * step) for a, b in zip(ahead, back))
    wrong = np.abs(forces - system.stiffness @ way).max() / np.abs(forces).max()
    return float(max(wrong, np.abs(gaps - system.operator @ way).max() / np.abs(gaps).max()))


CASES_2D = [("quad4", name) for name in LINEAR] + [("quad8", name) for name in QUADRATIC]


@pytest.mark.parametrize("friction", [0.0, 0.3])
@pytest.mark.parametrize(("cell", "pressure"), CASES_2D)
def test_tangent_in_the_plane(cell: str, pressure: str, friction: float) -> None:
    """Beyond the end of the target too, where functions go over from dual to ordinary ones. Differences of quantities of
    order one leave 1e-9; without the derivative of that transition 1e-3 is wrong."""
    assert error(over(arched(friction, cell), pressure)) < 1e-7


@pytest.mark.parametrize("friction", [0.0, 0.3])
@pytest.mark.parametrize("cell", ["quad4", "quad8"])
def test_tangent_round_an_axis(cell: str, friction: float) -> None:
    model = over(arched(friction, cell), "dual")
    assert error(replace(model, plane="axisymmetric")) < 1e-7


@pytest.mark.parametrize(
    ("cell", "pressure", "friction"),
    [("hex8", name, 0.3) for name in LINEAR]
    + [("hex8", "dual", 0.0), ("tet10", "dual", 0.3), ("hex20", "dual", 0.3), ("hex27", "P2-discontinuous", 0.3)],
)
def test_tangent_in_space(cell: str, pressure: str, friction: float) -> None:
    assert error(over(pressed_in_space(friction, cell), pressure), size=1e-3) < 1e-7

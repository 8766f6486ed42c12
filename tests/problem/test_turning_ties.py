"""Ties across gaps at large displacements: no strain under a turn, exact derivatives, balance."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from numpy.typing import NDArray
from scipy.spatial.transform import Rotation

import abut
from abut.mesh import make
from abut.problem.frame import PairFrame
from abut.problem.kinematics import ContactNow, Kinematics
from abut.problem.problem import ContactProblem
from abut.problem.turning_ties import TurningTie
from models.sliding import SOFT, finite

ANGLE = np.deg2rad(70.0)


def about(dim: int) -> NDArray[np.float64]:
    """(dim, dim): a turn by 70 degrees, in 3D about an oblique axis."""
    axis = np.array([0.6, 0.64, 0.48]) if dim == 3 else np.array([0.0, 0.0, 1.0])
    return Rotation.from_rotvec(ANGLE * axis).as_matrix()[:dim, :dim]


def layers(dim: int, gap: float, curved: bool) -> abut.Model:
    """Two layers of different meshes with a gap between them, flat or bent round an arc, tied; the lower one's underside
    turned."""
    if dim == 2:
        lower = make.rectangle([0, 2], [0, 1], cells=[5, 2], cell="quad4")
        upper = make.rectangle([0, 2], [1 + gap, 2], cells=[4, 2], cell="quad4")
    else:
        lower = make.box([0, 2], [0, 1], [0, 1], cells=[4, 2, 2])
        upper = make.box([0, 2], [0, 1], [1 + gap, 2], cells=[3, 3, 2])

    def bend(x: NDArray[np.float64]) -> NDArray[np.float64]:
        radius, angle = 1.0 + x[:, -1], x[:, 0]
        return np.column_stack([radius * np.sin(angle), x[:, 1:-1], radius * np.cos(angle)])

    if curved:
        lower, upper = (replace(mesh, points=bend(mesh.points)) for mesh in (lower, upper))
    motion = about(dim) - np.eye(dim)
    turn = {axis: (lambda x, a=a: x @ motion[a]) for a, axis in enumerate("xyz"[:dim])}
    return abut.Model(
        make.join({"lower": lower, "upper": upper}), kinematics="finite", plane="strain" if dim == 2 else None,
        solids=[abut.Solid("lower", SOFT), abut.Solid("upper", SOFT)], supports=[abut.Support("lower.bottom", **turn)],
        contacts=[abut.Contact(contactor="upper.bottom", target="lower.top", kind="tied")],
    )  # fmt: skip


def tie_of(problem: ContactProblem) -> Kinematics:
    """Its only one."""
    (kind,) = problem.kinematics
    return kind


@pytest.mark.parametrize("curved", [False, True])
@pytest.mark.parametrize("gap", [0.0, 0.1])
@pytest.mark.parametrize("dim", [2, 3])
def test_a_turn_strains_nothing(dim: int, gap: float, curved: bool) -> None:
    """Where the tie held undeformed points together, a gap of 0.1 would be sheared by 70 degrees."""
    model = layers(dim, gap, curved)
    turns = isinstance(tie_of(finite(model)), TurningTie)
    assert turns == (gap > 0.0 or curved)  # chords of an arc lie apart
    solution = abut.solve(model)
    assert solution.converged
    turned = model.mesh.points @ about(dim).T
    assert np.abs(model.mesh.points + solution.displacement - turned).max() < 1e-8
    assert np.abs(solution.steps[-1].stress).max() < 1e-6 * SOFT.young


@pytest.mark.parametrize("dim", [2, 3])
def test_jumps_and_forces(dim: int) -> None:
    """The rows are the derivative of the jumps, to central differences, and so forces and moments of any tractions balance
    wherever the jumps are none."""
    model = layers(dim, 0.1, True)
    problem = finite(model)
    tie, (rest,) = tie_of(problem), problem.placed(problem.start())

    def at(displacement: NDArray[np.float64]) -> ContactNow:
        return tie.at(PairFrame(), replace(rest, displacement=displacement), rest.displacement)

    points, rng = model.mesh.points, np.random.default_rng(1)
    here = (points @ about(dim).T + [1.0, 2.0, 3.0][:dim] - points).ravel()
    jump, rows = at(here).gap, at(here).by_position
    assert np.abs(jump).max() < 1e-13
    way = rng.standard_normal(len(here))
    ahead, back = at(here + 1e-6 * way), at(here - 1e-6 * way)
    assert np.abs((ahead.gap - back.gap) / 2e-6 - rows @ way).max() < 1e-8 * np.abs(rows @ way).max()
    force = (rows.T @ rng.standard_normal(rows.shape[0])).reshape(-1, dim)
    where = points + here.reshape(-1, dim)
    assert np.abs(force.sum(axis=0)).max() < 1e-13 * np.abs(force).sum()
    assert np.abs(where.T @ force - force.T @ where).max() < 1e-12 * np.abs(force).sum()


def test_a_load_on_a_tie_across_a_gap() -> None:
    """Bent by a pressure that follows: few iterations, and the work of the load is in the strain energy."""
    held = [abut.Support("lower.bottom", x=0, y=0)]
    model = replace(layers(2, 0.1, True), supports=held, loads=[abut.Pressure("upper.left", 6.0)])
    solution = abut.solve(replace(model, solve=abut.SolveOptions(steps=8)))
    assert solution.converged
    assert np.abs(solution.displacement).max() > 0.1
    assert max(len(step.iterations) for step in solution.steps) <= 6
    for step in solution.steps:
        assert step.energy.error < step.energy.limit

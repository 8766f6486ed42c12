"""Finite turns: the matrix and its derivatives, and the tangent of whole problems with rigid bodies and rotations."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

import abut
from abut.analysis.run import Run
from abut.errors import InputError
from abut.mesh.make import box, join, rectangle
from abut.problem.problem import ContactProblem
from abut.problem.turns import rotation, slopes

VECTORS = [np.zeros(3), np.array([1e-3, 2e-3, -1e-3]), np.array([0.06, 0.05, 0.06]), np.array([1.0, -2.0, 0.5])]
RUBBER = abut.NeoHooke(2.0, 0.3)


@pytest.mark.parametrize("vector", VECTORS)
def test_matrix(vector: np.ndarray) -> None:
    turn, h = rotation(vector), 1e-6
    assert np.abs(turn @ turn.T - np.eye(3)).max() < 1e-15
    assert turn @ vector == pytest.approx(vector, abs=1e-15)
    assert np.trace(turn) == pytest.approx(1 + 2 * np.cos(np.linalg.norm(vector)), abs=1e-15)
    for k, step in enumerate(h * np.eye(3)):
        difference = (rotation(vector + step) - rotation(vector - step)) / (2 * h)
        assert np.abs(slopes(vector)[k] - difference).max() < 1e-9


def gripped(dim: int, **given: object) -> abut.Model:
    """A rubber block, its left face held, glued to a rigid one at its right, which is loaded out of the middle."""
    n = (3, 1, 1)[:dim]
    if dim == 2:
        mesh = join({"body": rectangle((0.0, 3.0), (0.0, 1.0), n, "quad4")})
    else:
        mesh = join({"body": box((0.0, 3.0), (0.0, 1.0), (0.0, 1.0), n, "hex8")})
    mesh = replace(mesh, bodies={"body": np.array([0, 1]), "grip": np.array([2])})
    corner = np.flatnonzero((mesh.points == (3.0, 1.0, 0.0)[:dim]).all(axis=1))
    mesh = replace(mesh, node_sets={"corner": corner})
    return abut.Model(
        mesh,
        [abut.Solid("body", RUBBER, integration="b-bar")],
        [abut.Support("body.left", **dict.fromkeys("xyz"[:dim], 0.0))],
        [abut.NodalForce("corner", (0.02, 0.15, 0.08)[:dim]), abut.Pressure("body.top", 0.1)],
        rigid=[abut.Rigid("grip", **given)],
        plane="strain" if dim == 2 else None,
        kinematics="finite",
    )


def problem_of(model: abut.Model) -> ContactProblem:
    return Run.of(model, lambda _: None, lambda *_: None, None, ()).assembled.problem


@pytest.mark.parametrize("given", [{}, {"rz": 0.7}, {"x": 0.2, "y": 0.1}, {"rz": 1.0, "x": 0.1, "reference": True}])
@pytest.mark.parametrize("dim", [2, 3])
def test_tangent_of_the_whole_problem(dim: int, given: dict) -> None:
    """Bodies with F-bar, following pressure and rigid bodies together, against central differences."""
    if "reference" in given:
        given = given | {"reference": (2.5, 0.2, -0.4)[:dim]}
    problem, h = problem_of(gripped(dim, **given)), 1e-6
    before = problem.start()
    frame = problem.frame(before)
    rng = np.random.default_rng(6)
    at = 0.15 * rng.standard_normal(problem.n_free)
    along = rng.standard_normal(problem.n_free)

    def force(unknowns: np.ndarray) -> np.ndarray:
        state = replace(before, time=0.8, unknowns=unknowns)
        return problem.linearise(before, frame, state).unbalanced(state)

    difference = (force(at + h * along) - force(at - h * along)) / (2 * h)
    told = problem.linearise(before, frame, replace(before, time=0.8, unknowns=at)).stiffness @ along
    assert np.abs(told - difference).max() < 1e-7 * np.abs(difference).max()


@pytest.mark.parametrize("dim", [2, 3])
def test_free_grip(dim: int) -> None:
    """What is left free carries no force and no moment, and the body stays rigid."""
    solution = abut.solve(gripped(dim))
    assert solution.converged
    grip, step = solution.steps[-1].rigid["grip"], solution.steps[-1]
    size = step.reference_force
    assert np.abs(grip.rotation).max() > 0.3
    corner = solution.model.mesh.points[solution.model.mesh.nodes_of("corner")[0]]
    moved = corner + solution.displacement[solution.model.mesh.nodes_of("corner")[0]]
    assert np.abs(step.load + step.reaction).max() < 1e-9 * size
    assert np.abs(grip.moment).max() < 1e-8 * size
    assert np.abs(grip.force).max() < 1e-8 * size
    nodes = np.flatnonzero(solution.model.mesh.points[:, 0] >= 2.0)
    points = solution.model.mesh.points[nodes]
    there = points + solution.displacement[nodes]
    apart = np.linalg.norm(points - corner, axis=1) - np.linalg.norm(there - moved, axis=1)
    assert np.abs(apart).max() < 1e-12


def test_prescribed_turn_goes_along_an_arc() -> None:
    """Half a turn in 12 steps: the reference stays, all points keep their distance, at the end of every step."""
    model = gripped(2, x=0.0, y=0.0, rz=np.pi / 2, reference=(2.5, 0.5))
    steps = abut.solve(replace(model, solve=abut.SolveOptions(steps=4))).steps
    for step in steps:
        grip = step.rigid["grip"]
        assert grip.rotation[0] == pytest.approx(step.factor * np.pi / 2, abs=1e-12)
        assert np.abs(grip.displacement).max() < 1e-12


BLOCK = join({"body": rectangle((0.0, 3.0), (0.0, 1.0), (3, 1), "quad4")})


@pytest.mark.parametrize(
    ("given", "words"),
    [
        ({"kinematics": "small"}, 'rotations are finite; use kinematics = "finite"'),
        ({"rotations": [abut.Rotation("body.rite", 1.0, (0, 0))]}, "did you mean 'body.right'"),
        ({"rotations": [abut.Rotation("body.right", 1.0, (0, 0, 0))]}, "centre: expected 2 numbers"),
        ({"rotations": [abut.Rotation("body.right", 1.0, (0, 0), (0, 0, 1))]}, "axis: leave it out in 2D"),
        ({"rotations": [abut.Rotation("body.top", 1.0, (0, 0))]}, "is moved by a support on 'body.left' too"),
        ({"plane": "axisymmetric"}, "an axisymmetric model cannot turn"),
    ],
)
def test_refused(given: dict, words: str) -> None:
    own = {"rotations": [abut.Rotation("body.right", 1.0, (0, 0))], "kinematics": "finite", "plane": "strain"} | given
    material = abut.LinearElastic(1.0, 0.3)
    with pytest.raises(InputError, match=words):
        abut.Model(BLOCK, [abut.Solid("body", material)], [abut.Support("body.left", x=0, y=0)], **own)

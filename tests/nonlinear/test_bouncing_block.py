"""A block that is pressed on a base again and again while it drifts along: iterations against those that MOOSE publishes for
its test of frictionless mortar contact with the min function."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
import pytest
import scipy.sparse as sp

import abut
from abut.linear.choice import Direct
from abut.linear.solver import LinearSolver, NotConverged
from abut.mesh.make import join, rectangle
from abut.nonlinear.large_steps import LargeSteps
from abut.nonlinear.march import Control, march
from abut.nonlinear.pace import pace_of
from abut.problem.backend import Serial
from abut.problem.onset import Onset
from abut.problem.terms import Motion, Share
from abut.solution import Iteration
from abut.types import Sparse
from models.sliding import finite

STEPS, EACH = 40, 8  # load steps, and how many of them a bounce takes
TOLERANCE = 1e-7
PUBLISHED = 106  # idaholab/moose, pull request 13508: mortar, min function


def bouncing() -> abut.Model:
    """Geometry, meshes and motion as in MOOSE: cells of 0.1, up and down by 0.2, 0.19 into the base, 2 along."""
    count = np.arange(STEPS + 1)
    up = abut.Amplitude(tuple((k / STEPS, 0.2 * (np.cos(2.0 * np.pi * k / EACH) - 1.0)) for k in count))
    mesh = join({
        "base": rectangle((-2.5, 2.5), (-1.0, 0.0), (49, 10), "quad4"),
        "block": rectangle((-2.0, -1.0), (0.21, 1.21), (10, 10), "quad4"),
    })  # fmt: skip
    return abut.Model(
        mesh, [abut.Solid(body, abut.LinearElastic(2.0, 0.0)) for body in ("base", "block")],
        [abut.Support("base.bottom", x=0, y=0), abut.Support("block.top", y=1, amplitude=up),
         abut.Support("block.left", x=2)],
        contacts=[abut.Contact(contactor="block.bottom", target="base.top")], plane="strain", kinematics="finite",
        solve=abut.SolveOptions(times=tuple((count[1:] / STEPS).tolist())),
    )  # fmt: skip


@dataclass(frozen=True)
class Laplace:
    """MOOSE's bodies there, as ``Term``: each displacement meets Laplace's equation. matrix: (2 n_points, 2 n_points)."""

    model: abut.Model
    matrix: Sparse
    name: str = "bodies"
    constant: bool = True

    def evaluate(self, before: Motion, now: Motion) -> Share:
        return Share(self.matrix @ now.displacement, Serial(self.model, self.matrix))


def laplace(model: abut.Model) -> Laplace:
    """Of bilinear rectangles a x b, integrated exactly."""
    nodes = np.concatenate([block.nodes for block in model.mesh.blocks])
    a, b = np.ptp(model.mesh.points[nodes], axis=1).T
    along = np.array([[2, -2, -1, 1], [-2, 2, 1, -1], [-1, 1, 2, -2], [1, -1, -2, 2]]) / 6.0
    across = along[[0, 3, 2, 1]][:, [0, 3, 2, 1]]
    cells = (b / a)[:, None, None] * along + (a / b)[:, None, None] * across
    row, column = np.broadcast_to(nodes[:, :, None], cells.shape), np.broadcast_to(nodes[:, None], cells.shape)
    scalar = sp.coo_matrix((cells.ravel(), (row.ravel(), column.ravel())), shape=(len(model.mesh.points),) * 2)
    return Laplace(model, sp.kron(scalar, sp.identity(2)).tocsr())


@pytest.mark.long
def test_iterations_are_fewer_than_published() -> None:
    """MOOSE stops at 1e-8 of a step's first residual, in which the displacements prescribed count with their size, 0.2 and
    more: some 1e-7 of the forces, which are 0.02. abut goes on to 1e-9."""
    model, rows = bouncing(), list[Iteration]()
    problem = finite(model)
    problem = replace(problem, terms=(laplace(model), *problem.terms[1:]))
    control = Control(50, rows.append, _silent, _silent, _silent, _same, _silent, lambda *_: Onset(), _silent)
    pace = pace_of(model.solve.steps, model.solve.times, model.histories)
    attempts = list(march(LargeSteps(problem, Direct(), control), [problem.start()], pace, control))
    assert all(attempt.converged for attempt in attempts)
    assert len(attempts) == STEPS
    assert sum(attempt.state.closed.any() for attempt in attempts) == 3 * STEPS // EACH
    assert len(rows) <= 112
    needed = [1 + sum(_error(row) > TOLERANCE for row in attempt.iterations) for attempt in attempts]
    assert sum(needed) < PUBLISHED


def _error(row: Iteration) -> float:
    return max(row.residual, row.contact_residual)


def _silent(*_: object) -> None:
    return None


def _same(number: int, reason: NotConverged) -> LinearSolver:
    raise reason

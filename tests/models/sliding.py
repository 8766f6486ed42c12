"""Two bodies that slide over each other at large displacements."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np
from numpy.typing import NDArray

import abut
from abut.analysis.run import Run
from abut.mesh import make
from abut.mesh.mesh import Mesh
from abut.problem.finite import FiniteProblem

SOFT = abut.LinearElastic(young=100.0, poisson=0.3)
FIRST = abut.Amplitude(((0.0, 0.0), (0.4, 1.0), (1.0, 1.0)))
THEN = abut.Amplitude(((0.0, 0.0), (0.4, 0.0), (1.0, 1.0)))


def arched(friction: float, cell: str = "quad4", slide: float = 0.5, **options: Any) -> abut.Model:
    """A block with a curved underside, pressed 0.06 into a wider one and then slid along it."""
    lower = make.rectangle([0, 3], [0, 1], cells=[7, 2], cell=cell)
    upper = make.rectangle([0.5, 1.5], [1, 2], cells=[5, 2], cell=cell)
    upper = bent(upper, lambda x: np.column_stack([x[:, 0], x[:, 1] + 0.2 * (2 - x[:, 1]) * (x[:, 0] - 1.0) ** 2]))
    return abut.Model(
        make.join({"lower": lower, "upper": upper}), plane="strain", kinematics="finite",
        solids=[abut.Solid("lower", SOFT), abut.Solid("upper", SOFT)],
        supports=[
            abut.Support("lower.bottom", x=0, y=0), abut.Support("upper.top", y=-0.06, amplitude=FIRST),
            abut.Support("upper.top", x=slide, amplitude=THEN),
        ],
        contacts=[abut.Contact("upper.bottom", "lower.top", friction=friction)], **options,
    )  # fmt: skip


def bent(mesh: Mesh, move: Callable[[NDArray[np.float64]], NDArray[np.float64]]) -> Mesh:
    from dataclasses import replace

    return replace(mesh, points=move(mesh.points))


def finite(model: abut.Model) -> FiniteProblem:
    """The problem of a model as a run sets it up."""
    problem = Run.of(model, lambda *_: None, lambda *_: None, None, ()).assembled.problem
    assert isinstance(problem, FiniteProblem)
    return problem


def turned(angle: float) -> NDArray[np.float64]:
    """(2, 2) rotation, against the clock."""
    c, s = np.cos(angle), np.sin(angle)
    return np.array([[c, -s], [s, c]])


def pressed_in_space(friction: float, cell: str = "hex8", **options: Any) -> abut.Model:
    """The same in 3D: a cushion pressed into a plate and slid along and across it."""
    lower = make.box([0, 2], [0, 1], [0, 0.8], cells=[5, 3, 2], cell=cell)
    upper = make.box([0.3, 1.1], [0.2, 0.8], [0.8, 1.4], cells=[3, 2, 2], cell=cell)

    def cushion(x: NDArray[np.float64]) -> NDArray[np.float64]:
        rise = 0.2 * (1.4 - x[:, 2]) * ((x[:, 0] - 0.7) ** 2 + (x[:, 1] - 0.5) ** 2)
        return np.column_stack([x[:, :2], x[:, 2] + rise])

    return abut.Model(
        make.join({"lower": lower, "upper": bent(upper, cushion)}), kinematics="finite",
        solids=[abut.Solid("lower", SOFT), abut.Solid("upper", SOFT)],
        supports=[
            abut.Support("lower.bottom", x=0, y=0, z=0), abut.Support("upper.top", z=-0.06, amplitude=FIRST),
            abut.Support("upper.top", x=0.4, y=0.1, amplitude=THEN),
        ],
        contacts=[abut.Contact("upper.bottom", "lower.top", friction=friction)], **options,
    )  # fmt: skip

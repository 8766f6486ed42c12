"""Two bodies that slide over each other at large displacements."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

import abut
from abut.analysis.run import Run
from abut.mesh import make
from abut.mesh.mesh import Mesh
from abut.problem.current import Current
from abut.problem.frame import Frame
from abut.problem.problem import ContactProblem
from abut.solution.state import State

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
        contacts=[abut.Contact(contactor="upper.bottom", target="lower.top", friction=friction)], **options,
    )  # fmt: skip


def sharp(friction: float, cells: int, **options: Any) -> abut.Model:
    """The same block with a flat underside and sharp edges, and the plate with so many cells as the contactor: its nodes
    come under the block one after the other."""
    plate = make.rectangle([0, 3], [0, 1], cells=[cells, 2], cell="quad4")
    block = make.rectangle([0.5, 1.5], [1, 2], cells=[5, 2], cell="quad4")
    contacts = [abut.Contact(contactor="lower.top", target="upper.bottom", friction=friction)]
    return replace(
        arched(friction, slide=0.6, **options), mesh=make.join({"lower": plate, "upper": block}), contacts=contacts
    )


def bent(mesh: Mesh, move: Callable[[NDArray[np.float64]], NDArray[np.float64]]) -> Mesh:
    return replace(mesh, points=move(mesh.points))


def finite(model: abut.Model) -> ContactProblem:
    """The problem of a model as a run sets it up."""
    return Run.of(model, lambda *_: None, lambda *_: None, None, ()).assembled.problem


def current(problem: ContactProblem) -> Current:
    """How its only pair is looked at."""
    (kind,) = problem.kinematics
    assert isinstance(kind, Current)
    return kind


def forgetful(problem: ContactProblem, size: float) -> State:
    """The start, as if nothing had been opposite the contactors: all slips count at points of another state, random
    displacements of that size from it."""
    start, contacts = problem.start(), {}
    there = replace(start, unknowns=size * np.random.default_rng(5).standard_normal(problem.n_free))
    for kind in problem.kinematics:
        name, ways = kind.pair.contact.name, (problem.displacement(start), problem.displacement(there))
        known, every = start.history.contacts[name], np.ones(len(kind.pair), dtype=bool)
        assert isinstance(kind, Current)
        assert known.past is not None
        none = replace(known.past, points=known.past.points.on(np.zeros(0, np.int64)))
        contacts[name] = replace(known, past=kind.with_late(none, *ways, every))
    return replace(start, history=replace(start.history, contacts=contacts))


def tangent_errors(
    problem: ContactProblem, size: float, start: State | None = None, frame: Frame | None = None
) -> tuple[float, float]:
    """Of the derivatives of balance and of gaps (slips) near random displacements of that size. start: what the step begins
    from, the problem's own where left out; frame: of the step, that in which ``start`` ended."""
    rng = np.random.default_rng(3)
    before, n = start or problem.start(), problem.operator.shape[0]
    at = replace(
        before, time=0.7, unknowns=size * rng.standard_normal(problem.n_free), multipliers=rng.uniform(0.0, 5.0, n)
    )
    return tangent_errors_at(problem, before, at, rng.standard_normal(problem.n_free), 1e-6, frame)


def tangent_errors_at(
    problem: ContactProblem,
    before: State,
    at: State,
    way: NDArray[np.float64],
    step: float,
    frame: Frame | None = None,
) -> tuple[float, float]:
    """The same near a state, against central differences of a step along a way (n_free,), relative."""
    frame = problem.ended(before) if frame is None else frame
    system = problem.linearise(before, frame, at)

    def there(step: float) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
        state = replace(at, unknowns=at.unknowns + step * way)
        near = problem.linearise(before, frame, state)
        return near.unbalanced(state), near.gap(state)

    (force, gap), (force_back, gap_back) = there(step), there(-step)
    forces, gaps = (force - force_back) / (2.0 * step), (gap - gap_back) / (2.0 * step)
    left = np.abs(forces - system.stiffness @ way).max() / np.abs(forces).max()
    return float(left), float(np.abs(gaps - system.operator @ way).max() / np.abs(gaps).max())


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
        contacts=[abut.Contact(contactor="upper.bottom", target="lower.top", friction=friction)], **options,
    )  # fmt: skip

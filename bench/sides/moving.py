"""Sides of contacts that slide far: a block drawn over the sharp edge of another one, whole bodies as sides or the two faces
that touch, and a snap joint. No closed forms: how far the way is gone, and how the curves of either side differ."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import replace
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

import abut
from abut.job import load_job
from abut.mesh.make import join, rectangle

ROOT = Path(__file__).parents[2]
Table = tuple[list[str], list[list[str]]]
SOFT = abut.LinearElastic(young=100.0, poisson=0.3)
PRESS = abut.Amplitude(((0.0, 0.0), (0.2, 1.0), (1.0, 1.0)))
GO = abut.Amplitude(((0.0, 0.0), (0.2, 0.0), (1.0, 1.0)))


def over_edge(cell: str, sides: tuple[str, str], named: bool) -> abut.Model:
    """A block pressed .06 into another one and drawn beyond its edge; sides: two names, without roles unless ``named``."""
    parts = {
        "ground": rectangle((0, 1.6), (0, 0.6), (12, 4), cell),
        "block": rectangle((0.6, 1.0), (0.6, 0.9), (4, 3), cell),
    }
    first, second = sides
    contact = abut.Contact(contactor=first, target=second) if named else abut.Contact(first, second)
    return abut.Model(
        join(parts), [abut.Solid(body, SOFT) for body in parts],
        [
            abut.Support("ground.bottom", x=0, y=0), abut.Support("block.top", y=-0.06, amplitude=PRESS),
            abut.Support("block.top", x=0.8, amplitude=GO),
        ],
        contacts=[contact], plane="strain", kinematics="finite",
    )  # fmt: skip


def edge(cell: str = "quad4") -> Table:
    """Who gets to the end of the way, and in how many iterations: whole bodies, and the faces that touch."""
    rows = []
    for sides in (("block", "ground"), ("block.bottom", "ground.top")):
        for named in (None, sides, sides[::-1]):
            model = over_edge(cell, named or sides, named is not None)
            contactor = str(model.contacts[0].contactor) + ("" if named else " (abut's choice)")
            rows.append([", ".join(sides), contactor, *reached(model)])
    return ["sides", "contactor", "reached", "iterations"], rows


def reached(model: abut.Model) -> tuple[str, str]:
    """The time that a model gets to, and the iterations."""
    solution = abut.solve(model)
    total = sum(len(step.iterations) for step in solution.steps)
    good = [step.factor for step in solution.steps if step.converged]
    return f"{max(good, default=0.0):.3f}", str(total)


def snap() -> Table:
    """The snap joint of the examples with either side: largest force that pushes the hook, and how rough its curve is."""
    job = load_job(ROOT / "examples" / "snap-joint" / "job.toml")
    rows = []
    for name, model in _either(job.model):
        force = np.array([float(step.reactions["root"][0]) for step in abut.solve(model).steps])
        rows.append([name, f"{np.abs(force).max():.3f}", str(len(force)), f"{roughness(force):.3f}"])
    return ["contactor", "largest force", "steps", "roughness"], rows


def _either(model: abut.Model) -> Iterator[tuple[str, abut.Model]]:
    (contact,) = model.contacts
    yield f"abut's choice ({contact.contactor})", model
    yield str(contact.target), replace(model, contacts=[contact.forced(contact.target, contact.contactor)])


def roughness(values: NDArray[np.float64]) -> float:
    """Largest second difference that changes sign from one point to the next, over the largest value."""
    bend = np.diff(values, 2)
    turns = np.minimum(np.abs(bend[1:]), np.abs(bend[:-1]))[bend[1:] * bend[:-1] < 0.0]
    return float(turns.max(initial=0.0) / max(np.abs(values).max(), 1e-300))


MOVING: dict[str, Callable[[], Table]] = {"edge": edge, "snap": snap}

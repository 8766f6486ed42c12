"""Linear buckling of an assembly: factors of a state's stresses at which it gives way."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from abut.errors import InputError
from abut.model import Buckling, Model
from abut.modes.frequencies import relative_energy
from abut.modes.held import Held
from abut.modes.spectrum import MORE, Pencil, gap_after
from abut.problem.constraints import Constraints
from abut.problem.terms import Tangent
from abut.solution.modes import BUCKLING, ModesResult
from abut.types import Operator

NOTHING = 1e-12  # of the largest 1 / factor: none at all
Vector = NDArray[np.float64]


def buckling(model: Model, constraints: Constraints, held: Held, stressed: Tangent, wanted: Buckling) -> ModesResult:
    """The smallest positive factors, theory (J6). stressed: stiffness that stresses add, over all points.

    Raises InputError where no stress makes anything buckle, or bodies are not held, ConvergenceError, and
    SingularModelError."""
    if held.loose:
        raise InputError(
            "buckling: some body moves as a whole without resistance, and any load makes it give way; support it"
        )
    geometric, stiffness = stressed.reduce(constraints), held.stiffness
    factors, size = held.by.factors(stiffness, held), stiffness.shape[0]
    pencil = Pencil(factors, -1.0 * geometric, stiffness, size, size - len(held.give))
    if not (geometric @ np.random.default_rng(0).standard_normal(size)).any():
        raise InputError("buckling: there is no stress at the end of the last step; give a load")
    found = held.by.largest(pencil, wanted.count + MORE)
    positive = found.values > NOTHING * np.abs(found.values).max(initial=0.0)
    if not positive.any():
        raise InputError(
            "buckling: no stress at the end of the last step makes anything buckle; check the loads' signs"
        )
    inverse, vectors = found.values[positive], found.vectors[:, positive]
    order = np.argsort(-inverse)
    inverse, vectors = inverse[order], vectors[:, order]
    values = 1.0 / inverse
    missing = _missing(held, geometric, values, wanted.count)
    values, inverse, vectors = values[: wanted.count], inverse[: wanted.count], vectors[:, : wanted.count]
    again = np.column_stack([factors.solve(-(geometric @ x)) for x in vectors.T]) / inverse - vectors
    products = vectors.T @ (pencil.metric @ vectors) - np.eye(len(values))
    residual = relative_energy(stiffness, again, vectors)
    shapes = np.asarray(constraints.free @ vectors)
    shapes = shapes / np.abs(shapes).max(axis=0)
    none = np.zeros((len(values), 0))
    return ModesResult(
        BUCKLING, values, values, shapes.T.reshape(len(values), -1, model.dim), none, none, np.zeros(0),
        float(residual.max()), float(np.abs(products).max()), missing,
    )  # fmt: skip


def _missing(held: Held, geometric: Operator, values: Vector, count: int) -> int | None:
    """How many factors are missing below the last one, by a count; None where that is not known."""
    place = gap_after(values, min(count, len(values) - 1)) if len(values) > 1 else None
    if place is None:
        return None
    below, top = place
    known = held.by.factors(held.stiffness + top * geometric, held).negative
    return None if known is None else max(known - below, 0)

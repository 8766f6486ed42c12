"""Natural frequencies of an assembly about a converged state."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from abut.bodies.rigid_modes import motions
from abut.errors import InputError
from abut.model import Frequencies, Model
from abut.modes.held import Held
from abut.modes.spectrum import MORE, Pairs, Pencil, gap_after
from abut.problem.constraints import Constraints
from abut.problem.terms import Tangent
from abut.solution.modes import FREQUENCIES, ModesResult
from abut.types import Operator

SHIFT = 1e-8  # of stiffness over mass of a cell, below zero, where bodies move freely as a whole
ROUNDING = 64.0 * np.finfo(float).eps  # of the same: squares of frequencies that are zero
Vector = NDArray[np.float64]


def frequencies(model: Model, constraints: Constraints, held: Held, whole: Tangent, wanted: Frequencies) -> ModesResult:
    """The lowest frequencies, theory (J1) to (J3). constraints: the linear change of variables near the state; held: its
    stiffness and contact; whole: mass of all points.

    Raises ConvergenceError and SingularModelError."""
    found = lowest(held, whole.reduce(constraints), wanted.count)
    shapes = np.asarray(constraints.free @ found.vectors)
    factors, total = _participation(model, whole, shapes)
    return ModesResult(
        FREQUENCIES, found.values, found.squares, shapes.T.reshape(len(found.squares), -1, model.dim), factors,
        factors**2, total, found.residual, found.orthogonality, found.missing,
    )  # fmt: skip


@dataclass(frozen=True)
class Lowest:
    """squares: (n,) of angular frequencies, ascending; vectors: (n_free, n) of modal mass 1; residual, orthogonality,
    missing: as in ``ModesResult``."""

    squares: Vector
    vectors: Vector
    residual: float
    orthogonality: float
    missing: int | None

    @property
    def values(self) -> Vector:
        """(n,) in cycles per time, negative where the square is."""
        return np.asarray(np.sign(self.squares) * np.sqrt(np.abs(self.squares)) / (2.0 * np.pi))


def lowest(held: Held, reduced: Operator, count: int) -> Lowest:
    """The lowest ``count`` modes; reduced: (n_free, n_free) mass. Raises ConvergenceError and SingularModelError."""
    highest = fastest(held.stiffness, reduced)
    shift = -SHIFT * highest if held.loose else 0.0
    stiffness = held.stiffness - shift * reduced if shift else held.stiffness
    shifted = held.by.factors(stiffness, held)
    moving = int((reduced.diagonal() > 0.0).sum())
    pencil = Pencil(shifted, reduced, reduced, reduced.shape[0], min(moving, reduced.shape[0] - len(held.give)))
    rounding = ROUNDING * highest
    found, missing = _complete(pencil, held, shift, count, rounding)
    squares, vectors = shift + 1.0 / found.values, found.vectors
    squares = np.where(np.abs(squares) <= rounding, 0.0, squares)
    mass_of = reduced @ vectors
    again = np.column_stack([shifted.solve(force) for force in mass_of.T]) / found.values - vectors
    residual = relative_energy(stiffness, again, vectors)
    products = vectors.T @ mass_of - np.eye(len(squares))
    return Lowest(squares, vectors, float(residual.max()), float(np.abs(products).max()), missing)


def relative_energy(stiffness: Operator, change: Vector, vectors: Vector) -> Vector:
    """(n,) roots of the energy of changes (n_free, n) over that of vectors (n_free, n)."""
    left, whole = (np.einsum("im,im->m", x, stiffness @ x) for x in (change, vectors))
    return np.asarray(np.sqrt(np.abs(left) / np.maximum(np.abs(whole), 1e-300)))


def densities(model: Model) -> dict[str, float]:
    """Of all bodies that have one. Raises InputError where none has."""
    found = {solid.body: float(solid.material.density) for solid in model.solids}
    found |= {rigid.body: rigid.density for rigid in model.rigid}
    if not any(found.values()):
        raise InputError(
            "frequencies: no body has a mass; give the materials a density, in units that go with force, length and time "
            "(N, mm and s: tonnes per mm^3, 7.85e-9 of steel)"
        )
    return found


def fastest(stiffness: Operator, mass: Operator) -> float:
    """Square of the highest angular frequency, about: of points by themselves."""
    stiff, heavy = stiffness.diagonal(), mass.diagonal()
    return float(np.median(stiff[heavy > 0.0] / heavy[heavy > 0.0]))


def _complete(pencil: Pencil, held: Held, shift: float, count: int, rounding: float) -> tuple[Pairs, int | None]:
    """The lowest ``count``, ascending, and how many are missing; where some are, once more with another start."""
    wanted, missing = count + MORE, None
    for seed in range(2):
        found = held.by.largest(pencil, wanted, seed)
        order = np.argsort(1.0 / found.values)
        found = Pairs(found.values[order], found.vectors[:, order])
        place = gap_after(shift + 1.0 / found.values, count, rounding)
        if place is None:
            break
        below, top = place
        known = held.by.factors(held.stiffness - top * pencil.metric, held).negative
        missing = None if known is None else max(known - below, 0)
        if not missing:
            break
        wanted += missing
    return _first(found, count), missing


def _first(found: Pairs, count: int) -> Pairs:
    return Pairs(found.values[:count], found.vectors[:, :count])


def _participation(model: Model, mass: Tangent, shapes: Vector) -> tuple[Vector, Vector]:
    """Factors (n, k) of modes (dim n_points, n) with unit motions of the whole, and its mass for these (k,)."""
    unit = motions(model.mesh.points, model.mesh.axisymmetric).reshape(shapes.shape[0], -1)
    moved = mass.internal(unit)
    return np.asarray(shapes.T @ moved), np.asarray(np.einsum("ik,ik->k", unit, moved))

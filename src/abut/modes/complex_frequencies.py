"""Complex frequencies of a sliding assembly about a converged state: which vibrations friction makes grow."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from abut.bodies.mass import mass
from abut.model import Frequencies, Model
from abut.modes.arnoldi import nearest
from abut.modes.frequencies import ROUNDING, SHIFT, densities, fastest
from abut.modes.held import Held
from abut.modes.sliding import Sliding, UnsymmetricFactors
from abut.modes.spectrum import MORE
from abut.problem.constraints import Constraints
from abut.solution.modes import COMPLEX, ModesResult
from abut.types import Sparse

PAIRED = 1e-12  # relative distance of an eigenvalue from its partner's conjugate: ARPACK gives them exactly
Vector = NDArray[np.float64]
Complex = NDArray[np.complex128]


def complex_frequencies(
    model: Model, constraints: Constraints, held: Held, slides: Sliding, wanted: Frequencies
) -> ModesResult:
    """The lowest by size, theory (J4); one more than asked for where two that belong together would be parted.

    Raises InputError where no body has a density, ConvergenceError, and SingularModelError."""
    reduced = constraints.reduce(mass(model.mesh, densities(model)))
    highest = fastest(held.stiffness, reduced)
    shift = -SHIFT * highest if held.loose else 0.0
    symmetric = (held.stiffness - shift * reduced).tocsr()
    factors = UnsymmetricFactors((symmetric + slides.skew).tocsr(), held, slides.pushing)
    inverse, vectors = nearest(factors.solve, reduced, reduced.shape[0] - len(held.give), wanted.count + MORE)
    squares = shift + 1.0 / inverse
    order = np.lexsort((squares.imag, np.abs(squares)))  # of a pair the one that grows first
    order = order[: whole_pairs(squares[order], wanted.count)]
    squares, inverse, vectors = squares[order], inverse[order], vectors[:, order]
    squares = np.where(np.abs(squares) <= ROUNDING * highest, 0.0, squares)
    again = _applied(factors, reduced, vectors) / inverse
    residual = np.sqrt(energy(symmetric, again - vectors) / np.maximum(energy(symmetric, again), 1e-300))
    shapes = turned(np.asarray(constraints.free @ (again / np.sqrt(energy(reduced, again)))))
    shapes = shapes.T.reshape(len(squares), -1, model.dim)
    values, growth = motion_of(squares)
    none = np.zeros((len(squares), 0))
    return ModesResult(
        COMPLEX, values, squares.real.copy(), shapes.real.copy(), none, none, np.zeros(0), float(residual.max()),
        float("nan"), None, growth, shapes.imag.copy(), slides.slips,
    )  # fmt: skip


def motion_of(squares: Complex) -> tuple[Vector, Vector]:
    """Frequencies in cycles per time, and rates of growth: of both motions with the same square that which oscillates
    forward, or without oscillation that which grows."""
    omega = np.sqrt(squares)  # exp(i omega t), with a real part >= 0
    growth = np.where(omega.real > 0.0, -omega.imag, np.abs(omega.imag))
    return omega.real / (2.0 * np.pi), growth + 0.0  # no -0


def whole_pairs(squares: Complex, count: int) -> int:
    """How many of squares in order of size are ``count``, or one more where the last one's conjugate comes next."""
    if count >= len(squares):
        return len(squares)
    last, after = squares[count - 1], squares[count]
    parted = last.imag != 0.0 and abs(after - last.conjugate()) <= PAIRED * abs(last)
    return count + int(parted and (squares[:count] == last.conjugate()).sum() == 0)


def _applied(factors: UnsymmetricFactors, reduced: Sparse, vectors: Complex) -> Complex:
    forces = reduced @ vectors
    return np.column_stack([factors.solve(f.real) + 1j * factors.solve(f.imag) for f in forces.T])


def energy(matrix: Sparse, vectors: Complex) -> Vector:
    """(n,) x^H A x, of vectors (size, n) and a symmetric matrix."""
    return np.asarray(np.abs(sum(np.einsum("im,im->m", x, matrix @ x) for x in (vectors.real, vectors.imag))))


def turned(shapes: Complex) -> Complex:
    """With phases by which the largest component of each is real and positive."""
    largest = shapes[np.abs(shapes).argmax(axis=0), np.arange(shapes.shape[1])]
    return np.asarray(shapes * np.conj(largest) / np.abs(largest))

"""Complex frequencies of what turns about a converged state: Coriolis forces part whirling with and against the rotation."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from abut.bodies.mass import mass
from abut.model import Frequencies, Model
from abut.modes.arnoldi import nearest_of_quadratic
from abut.modes.complex_frequencies import energy, motion_of, turned, whole_pairs
from abut.modes.frequencies import ROUNDING, SHIFT, densities, fastest
from abut.modes.held import Held
from abut.modes.sliding import Sliding, UnsymmetricFactors
from abut.modes.spectrum import MORE
from abut.modes.spinning import coriolis
from abut.problem.constraints import Constraints
from abut.solution.modes import COMPLEX, GROWS, ModesResult
from abut.types import Sparse

Complex = NDArray[np.complex128]


def whirling_frequencies(
    model: Model, constraints: Constraints, held: Held, slides: Sliding | None, time: float, wanted: Frequencies
) -> ModesResult:
    """The lowest by size, theory (J12); slides: friction that follows the pressure, None for none; time: of the state.

    Raises InputError where no body has a density or nothing turns, ConvergenceError, and SingularModelError."""
    reduced = constraints.reduce(mass(model.mesh, densities(model)))
    whole, speed = coriolis(model, time)
    turning = constraints.reduce(whole)
    highest = fastest(held.stiffness, reduced)
    shift = max(speed, float(np.sqrt(SHIFT * highest)) if held.loose else 0.0)
    stiff = (held.stiffness + shift**2 * reduced).tocsr()  # as at rest, or stiffer, at critical speeds too
    skew, pushing = (0.0 * turning, held.rows) if slides is None else (slides.skew, slides.pushing)
    factors = UnsymmetricFactors((stiff + shift * turning + skew).tocsr(), held, pushing)
    slower = (turning + 2.0 * shift * reduced).tocsr()  # the quadratic about the shift
    free = reduced.shape[0] - len(held.give)
    inverse, vectors = nearest_of_quadratic(factors.solve, slower, reduced, free, 2 * (wanted.count + MORE))
    zero = max(ROUNDING * highest, (GROWS * shift) ** 2)
    order = _one_of_each(shift + 1.0 / inverse, zero)
    order = order[: whole_pairs(-((shift + 1.0 / inverse[order]) ** 2), wanted.count)]
    near, vectors = 1.0 / inverse[order], vectors[:, order]
    rates = np.where(np.abs(shift + near) ** 2 <= zero, 0.0, shift + near)
    again = _applied(factors, slower, reduced, near, vectors)
    residual = np.sqrt(energy(stiff, again - vectors) / np.maximum(energy(stiff, again), 1e-300))
    again = again / np.sqrt(energy(reduced, again))
    shapes = turned(np.asarray(constraints.free @ again)).T.reshape(len(rates), -1, model.dim)
    squares, none = -(rates**2), np.zeros((len(rates), 0))
    values, growth = motion_of(squares)
    around = np.einsum("im,im->m", again.conj(), turning @ again).imag / (2.0 * speed)
    return ModesResult(
        COMPLEX, values, squares.real.copy(), shapes.real.copy(), none, none, np.zeros(0), float(residual.max()),
        float("nan"), None, growth, shapes.imag.copy(), slides is not None and slides.slips, whirl=around,
    )  # fmt: skip


def _one_of_each(rates: Complex, rounding: float) -> NDArray[np.int64]:
    """Which of rates, by size, are one of a conjugate pair, forward in time; of real ones those that grow; of those whose
    squares are below ``rounding``, which come twice, every other one."""
    order = np.lexsort((-rates.real, np.abs(rates)))
    zero = np.abs(rates[order]) ** 2 <= rounding
    kept = np.where(rates[order].imag != 0.0, rates[order].imag > 0.0, rates[order].real > 0.0)
    kept[zero] = np.arange(int(zero.sum())) % 2 == 0
    return np.asarray(order[kept])


def _applied(factors: UnsymmetricFactors, slower: Sparse, reduced: Sparse, near: Complex, vectors: Complex) -> Complex:
    """What vectors (size, n) are after one more iteration."""
    forces = -(slower @ vectors * near + reduced @ vectors * near**2)
    return np.column_stack([factors.solve(f.real.copy()) + 1j * factors.solve(f.imag.copy()) for f in forces.T])

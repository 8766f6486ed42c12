"""Contact with friction by smooth constraint functions: no status, derivatives everywhere."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from abut.contact.friction_bound import FrictionBound
from abut.contact.laws import LawResult, LawState, constraint_function

FAINT = 1e-12  # of the largest pressure, under which there is no friction to speak of
SOLUTIONS = 60  # of Newton's method for one function; about 20 are used for the smallest epsilon
LARGEST = 1e100  # s of the function, whose square and quotient by epsilon are still numbers
Array = NDArray[np.float64]


def friction_function(size: Array, epsilon: float) -> tuple[Array, Array]:
    """f(s) for s >= 0, which solves f = 2/pi atan((s - f) / epsilon), and its derivative: theory (R13).

    With s = tau + u this is tau + w of the constraint function w(u, tau) of El-Abbasi and Bathe, which is implicit:
    tau + w - 2/pi atan((u - w) / epsilon) = 0. epsilon -> 0 gives min(s, 1).

    Solved for y = (s - f) / epsilon, in which s is a rising concave function: Newton's method goes up to the solution from
    below, and never past it."""
    share, size = 2.0 / np.pi, np.minimum(size, LARGEST)
    y = np.maximum(size / (share + epsilon), (size - 1.0) / epsilon)
    for _ in range(SOLUTIONS):
        slope = share / (1.0 + y * y) + epsilon
        step = np.maximum(size - share * np.arctan(y) - epsilon * y, 0.0) / slope
        y = np.minimum(y + step, size / epsilon)
        if (step <= 1e-15 * y).all():
            break
    rise = share / (1.0 + y * y)
    return share * np.arctan(y), rise / (rise + epsilon)


def slip_of(traction: Array, bound: Array, epsilon: float) -> Array:
    """Slip times the stiffness under tractions of that size, (n,): the function solved for u, theory (R14)."""
    share = np.minimum(traction / np.maximum(bound, 1e-300), 1.0)
    return np.asarray(epsilon * bound * np.tan(0.5 * np.pi * share))


@dataclass(frozen=True)
class SmoothCoulomb:
    """The constraint function of contact in the first component, ``constraint_function``, and that of friction along the
    direction of slip in the others, ``friction_function``: theory (R15). No status is held.

    jump, traction, stiffness: as of ``Coulomb``; bound: of the tangential traction; epsilon: of friction, its square that of
    contact; reference: the largest pressure."""

    stiffness: float
    bound: FrictionBound
    epsilon: float
    reference: float

    def evaluate(self, jump: Array, traction: Array, state: LawState) -> LawResult:
        """Residual, derivatives and status at n points, as in ``Law``, c = 2 or 3."""
        soft, scaled, pressure = 1.0 / self.stiffness, self.stiffness * jump[:, 0], traction[:, 0]
        value, by_gap, by_pressure = constraint_function(scaled, pressure, (self.epsilon * self.reference) ** 2)
        drag, by_slip, by_drag, by_push = self._friction(jump[:, 1:], traction[:, 1:], pressure)
        n, c = jump.shape
        by_jump, by_traction = np.zeros((n, c, c)), np.zeros((n, c, c))
        by_jump[:, 0, 0], by_traction[:, 0, 0] = -by_gap, -soft * by_pressure
        by_jump[:, 1:, 1:], by_traction[:, 1:, 1:], by_traction[:, 1:, 0] = by_slip, by_drag, by_push
        closed = (pressure > scaled) & (pressure > 0.0)
        return LawResult(np.column_stack([-soft * value, drag]), by_jump, by_traction, closed)

    def _friction(self, slip: Array, drag: Array, pressure: Array) -> tuple[Array, Array, Array, Array]:
        """The residual (n, k), its derivatives by slip and by the traction (n, k, k), and that by the pressure (n, k)."""
        soft, unit = 1.0 / self.stiffness, np.eye(slip.shape[1])
        pressed = pressure > FAINT * self.reference
        bound, slope = self.bound.at(np.maximum(pressure, 0.0))
        trial = drag - self.stiffness * slip
        if self.bound.rough:
            on = pressed[:, None, None]
            by_slip = np.broadcast_to(np.where(on, -unit, 0.0), (len(slip), *unit.shape))
            by_drag = np.broadcast_to(np.where(on, 0.0, -soft * unit), by_slip.shape)
            return np.where(pressed[:, None], -slip, -soft * drag), by_slip, by_drag, np.zeros_like(slip)
        length = np.linalg.norm(trial, axis=1)
        rubs = pressed & (bound > length / LARGEST)
        limit = np.where(rubs, bound, np.maximum(length, 1.0))
        size = length / limit
        share, rise = friction_function(size, self.epsilon)
        along = trial / np.maximum(length, 1e-300)[:, None]
        outer = along[:, :, None] * along[:, None]
        across = np.where(size > 0.0, share / np.maximum(size, 1e-300), rise)[:, None, None]
        turn = np.where(rubs[:, None, None], rise[:, None, None] * outer + across * (unit - outer), 0.0)
        residual = soft * (np.where(rubs, limit * share, 0.0)[:, None] * along - drag)
        by_push = soft * np.where(rubs, (share - size * rise) * slope, 0.0)[:, None] * along
        return residual, -turn, soft * (turn - unit), by_push

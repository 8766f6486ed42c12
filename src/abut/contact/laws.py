"""Contact laws: residual and derivatives from jump and traction at points; Newton does the rest.

Each law states its residual r(jump, traction) = 0 for n points and c components; the solver finds K u - B^T p = f,
theory (F6), together with r = 0. Normal component: gap >= 0 open, pressure >= 0 compressive, theory (F2).
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Protocol, runtime_checkable

import numpy as np
from numpy.typing import NDArray

from abut.contact.friction_bound import FrictionBound

TENSION = 30.0  # how much more a point in tension counts than one in compression
TENSION_START = 1e-3  # of the largest pressure: tension below it counts less, lest Newton chases the last ripples
Array = NDArray[np.float64]


@dataclass(frozen=True)
class LawState:
    """Data of a law besides jump and traction. closed: (n,) bool, the contact status that the search holds; slipping: (n,)
    bool, of those closed, None without friction."""

    closed: NDArray[np.bool_]
    slipping: NDArray[np.bool_] | None = None


@dataclass(frozen=True)
class LawResult:
    """A law near jumps and tractions. residual: (n, c), zero where the law is met, in any unit; by_jump, by_traction:
    (n, c, c) its derivatives; closed: (n,) bool, points in contact."""

    residual: Array
    by_jump: Array
    by_traction: Array
    closed: NDArray[np.bool_]


@runtime_checkable
class Law(Protocol):
    """A contact law, of abut or a user: an object with this method."""

    def evaluate(self, jump: Array, traction: Array, state: LawState) -> LawResult:
        """jump: (n, c) length, the gap alone for a normal law (c = 1); traction: (n, c) force per area, the pressure alone
        for a normal law."""
        ...


@dataclass(frozen=True)
class Complementarity:
    """gap >= 0, pressure >= 0, one of them zero, with the contact status as it is: gap = 0 where closed, pressure = 0
    elsewhere; theory (L3).

    stiffness: pressure per length, theory (L2), which gives both rows the same unit. The semi-smooth Newton derivative of
    min(gap, pressure / stiffness), theory (L1), is just this (Hintermueller, Ito and Kunisch 2002).
    """

    stiffness: float

    def evaluate(self, jump: Array, traction: Array, state: LawState) -> LawResult:
        """Residual, derivatives and status at n points, as in ``Law``, c = 1."""
        on = state.closed[:, None]
        return LawResult(
            residual=np.where(on, -jump, -traction / self.stiffness),
            by_jump=np.where(on, -1.0, 0.0)[:, :, None],
            by_traction=np.where(on, 0.0, -1.0 / self.stiffness)[:, :, None],
            closed=state.closed,
        )


@dataclass(frozen=True)
class Tied:
    """jump = 0 in all components, theory (L9)."""

    def evaluate(self, jump: Array, traction: Array, state: LawState) -> LawResult:
        """Residual, derivatives and status at n points, as in ``Law``, any c."""
        n, c = jump.shape
        return LawResult(
            residual=-jump,
            by_jump=np.broadcast_to(-np.eye(c), (n, c, c)),
            by_traction=np.zeros((n, c, c)),
            closed=np.ones(n, dtype=bool),
        )


@dataclass(frozen=True)
class Gone:
    """traction = 0 in all components, of what does not act; stiffness: as of ``Complementarity``."""

    stiffness: float

    def evaluate(self, jump: Array, traction: Array, state: LawState) -> LawResult:
        """As in ``Law``, any c."""
        n, c = jump.shape
        return LawResult(
            residual=-traction / self.stiffness,
            by_jump=np.zeros((n, c, c)),
            by_traction=np.broadcast_to(-np.eye(c) / self.stiffness, (n, c, c)),
            closed=np.zeros(n, dtype=bool),
        )


@dataclass(frozen=True)
class Coulomb:
    """Complementarity in the first component, Coulomb's law in the others, with a given status: theory (R5), (R6), (R7).

    jump: gap, and slip since the last converged step; traction: pressure, and tangential traction on the contactor.
    stiffness: as of ``Complementarity``; friction: the coefficient, infinite where nothing slips, or the bound of each
    point. The bound is that of the augmented pressure p - c g and the direction that of t - c v, c the stiffness: Alart and
    Curnier 1991."""

    stiffness: float
    friction: float | FrictionBound

    def evaluate(self, jump: Array, traction: Array, state: LawState) -> LawResult:
        """Residual, derivatives and status at n points, as in ``Law``, c = 2 or 3."""
        n, c = jump.shape
        soft = 1.0 / self.stiffness
        closed, slips = state.closed, np.zeros(n, dtype=bool) if state.slipping is None else state.slipping
        residual = np.where(closed[:, None], -jump, -soft * traction)
        by_jump = np.where(closed[:, None, None], -np.eye(c), 0.0)
        by_traction = np.where(closed[:, None, None], 0.0, -soft * np.eye(c))
        sliding = np.flatnonzero(closed & slips)
        if len(sliding):
            slip, drag = jump[sliding, 1:], traction[sliding, 1:]
            limit = self.friction if isinstance(self.friction, FrictionBound) else FrictionBound(self.friction)
            pushed = traction[:, 0] - self.stiffness * jump[:, 0]
            bound, slope = limit.at(np.maximum(pushed, 0.0))
            # A closed point whose gap is still open: the bound goes on straight, so that its linear problem ends at mu p.
            bound = (bound + slope * np.minimum(pushed, 0.0))[sliding]
            slope = slope[sliding, None, None]
            trial = drag - self.stiffness * slip
            size = np.maximum(np.linalg.norm(trial, axis=1), 1e-300)
            along = trial / size[:, None]
            across = np.eye(c - 1) - along[:, :, None] * along[:, None]
            turn = np.clip(bound / size, 0.0, 1.0)[:, None, None] * across
            residual[sliding, 1:] = -soft * (drag - bound[:, None] * along)
            by_jump[sliding, 1:] = np.concatenate([-slope * along[:, :, None], -turn], axis=2)
            by_traction[sliding, 1:] = np.concatenate(
                [soft * slope * along[:, :, None], soft * (turn - np.eye(c - 1))], axis=2
            )
        return LawResult(residual, by_jump, by_traction, closed)


def constraint_function(gap: Array, pressure: Array, epsilon: float) -> tuple[Array, Array, Array]:
    """w(g, l) = (g + l)/2 - sqrt(((g - l)/2)^2 + eps) and its derivatives by g and by l (paper, section 3).

    w = 0 means g l = eps with g, l > 0; eps -> 0 gives min(g, l). Both arguments in the same unit.
    Function and derivatives: theory (L4), (L5).
    """
    half = 0.5 * (gap - pressure)
    root = np.sqrt(half * half + epsilon)
    slope = half / root
    # min + a term that stays accurate where |half| >> sqrt(eps) and the difference would cancel
    value = np.minimum(gap, pressure) - epsilon / (root + np.abs(half))
    return value, 0.5 * (1.0 - slope), 0.5 * (1.0 + slope)


@dataclass(frozen=True)
class ConstraintFunction:
    """w(c g, l) + TENSION t(l) = 0 at points: theory (L6) (paper, eq. 21).

    stiffness c: (n,) pressure per length, puts the gap on the scale of the pressure; reference: the largest pressure, to
    which epsilon is relative; tension: share of it below which tension counts less. The second term, t(l) = min(l, 0) but
    for a smooth start, theory (L7), is not in the paper: behind the edge of contact w = l, and zero means against every H_k
    leave room for a pressure that swings about zero.
    """

    stiffness: Array
    epsilon: float
    reference: float
    tension: float = TENSION_START

    def evaluate(self, jump: Array, traction: Array, state: LawState) -> LawResult:
        """Residual, derivatives and status at n points, as in ``Law``, c = 1."""
        scaled, pressure = self.stiffness * jump[:, 0], traction[:, 0]
        value, by_gap, by_pressure = constraint_function(scaled, pressure, self.epsilon * self.reference**2)
        width = self.tension * self.reference
        pull = np.minimum(pressure, 0.0)
        value = value + TENSION * np.where(pull > -width, -0.5 * pull**2 / width, pull + 0.5 * width)
        by_pressure = by_pressure + TENSION * np.minimum(-pull / width, 1.0)
        closed = (pressure > scaled) & (pressure > 0.0)
        return LawResult(value[:, None], (self.stiffness * by_gap)[:, None, None], by_pressure[:, None, None], closed)

"""The contact problem as a convex quadratic programme: Mehrotra's predictor and corrector on displacements, pressures, gaps.

Each row gets a compliance, the ratio of its gap and pressure; no row is ever released, so that intermediate active sets do
not matter. The few rows that remain undecided in the end are resolved exactly by ``abut.nonlinear.search``.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
import scipy.linalg
from numpy.typing import NDArray

from abut.linear.solver import Prepared, Solve
from abut.nonlinear.settings import NOTHING, Settings
from abut.problem.laws import softened
from abut.problem.linearised import Rows
from abut.solution.state import State

Vector = NDArray[np.float64]


@dataclass(frozen=True)
class Interior:
    """state: displacements and pressures, the latter positive but for tied rows; slack: (n,) gaps, positive, that
    pressures are to be complementary to (zero on tied rows); opening, closing: (n,) d g / g and d p / p of the last
    predictor."""

    state: State
    slack: Vector
    opening: Vector
    closing: Vector

    @property
    def active(self) -> NDArray[np.bool_]:
        """Rows on which the gap goes faster than the pressure, theory (V20)."""
        return self.closing > self.opening


@dataclass(frozen=True)
class Programme:
    """What stays the same over the iterations of a load step. prepared: the linear solver; scale: (n,) gap per pressure;
    tied: (n,) rows that are closed whatever happens; softness: of the bodies over that of their facets; settings:
    thresholds."""

    prepared: Prepared
    scale: Vector
    tied: NDArray[np.bool_]
    softness: float
    settings: Settings

    def undecided(self, here: Interior) -> NDArray[np.bool_]:
        """Rows that are neither closing nor opening."""
        return np.abs(here.closing + 0.5) < self.settings.interior.undecided

    def mean(self, pressure: Vector, slack: Vector) -> float:
        """Mean product of gaps (as pressures) and pressures, theory (V17)."""
        free = ~self.tied
        return float((slack[free] * pressure[free] / self.scale[free]).mean())

    def central(self, pressure: Vector, slack: Vector) -> bool:
        """Whether no product is far smaller than the mean of all, which makes the steps after it short."""
        free = ~self.tied
        product = slack[free] * pressure[free] / self.scale[free]
        return bool(product.min() >= self.settings.interior.central * product.mean())

    def rows(self, state: State, softness: Vector, shift: Vector) -> Rows:
        """The rows of theory (V18)."""
        system = self.prepared.system
        parts = zip(*map(system.split, (system.gap(state), shift, softness, state.closed)))
        return system.rows([softened(*part) for part in parts])

    def solver(self, state: State, softness: Vector) -> Solve:
        """Solutions with rows of that softness, as often as wanted: (residual of equilibrium, shift) -> (du, dp)."""
        rows = self.rows(state, softness, np.zeros_like(softness))
        factors = self.prepared.factorise(rows)
        if factors is None:
            return self._iterations(rows, state)
        return lambda residual, shift: factors(residual, rows.residual + shift)

    def _iterations(self, rows: Rows, state: State) -> Solve:
        """The same by an iterative solver, each solution from the one before on."""
        system = self.prepared.system
        du, dp = np.zeros_like(state.unknowns), np.zeros_like(state.multipliers)

        def solve(residual: Vector, shift: Vector) -> tuple[Vector, Vector]:
            nonlocal du, dp
            left, of_law = residual, rows.residual + shift
            if du.any() or dp.any():
                left = residual + system.stiffness @ du - system.operator.T @ dp
                of_law = of_law + rows.by_displacement @ du + rows.by_pressure @ dp
            more = self.prepared.solve(
                replace(rows, residual=of_law), left, state.multipliers, self.settings.accuracy.rough
            )
            du, dp = du + more[0], dp + more[1]
            return du, dp

        return solve

    def missed(self, here: Interior) -> float:
        """Largest difference between gaps and slacks, as a pressure."""
        return float(np.abs((self.prepared.system.gap(here.state) - here.slack) / self.scale).max())

    def unbalanced(self, state: State) -> Vector:
        return self.prepared.system.unbalanced(state)


def softness(solver: Prepared) -> float:
    """How far the bodies give way under a uniform pressure, over how far their facets alone would, theory (V16). Rigid
    motions are held by springs at a few displacements, and their share is taken out."""
    system = solver.system
    root = np.sqrt(system.scale)
    one = np.ones(len(root))
    moved = system.operator @ solver.respond(np.asarray(system.operator.T @ one), _springs(solver))
    if system.compliance is not None:
        moved = moved + system.compliance @ one
    if system.motions.shape[1]:
        rigid = np.asarray(system.operator @ system.motions) / root[:, None]
        moved = moved - root * (rigid @ np.linalg.lstsq(rigid, moved / root, rcond=None)[0])
    return max(1.0, float(np.linalg.norm(moved / root) / np.linalg.norm(root)))


def _springs(solver: Prepared) -> Vector:
    """Springs (n_free,) on as many displacements as hold the rigid motions, as stiff as the bodies there."""
    motions = solver.system.motions
    springs = np.zeros(len(motions))
    if motions.shape[1]:
        pivots = scipy.linalg.qr(motions.T, mode="r", pivoting=True)[1][: motions.shape[1]]
        springs[pivots] = solver.system.unit
    return springs


def begin(programme: Programme, state: State) -> Interior:
    """The starting point, theory (V17): one solution with softness everywhere."""
    free, soft = ~programme.tied, np.where(programme.tied, 0.0, programme.softness * programme.scale)
    solve = programme.solver(state, soft)
    du, dp = solve(programme.unbalanced(state), -soft * state.multipliers)
    pressure = state.multipliers + dp
    size = max(float(np.abs(pressure[free]).mean()), NOTHING)
    pressure = np.where(free, np.maximum(pressure, 0.0) + size, pressure)
    start = replace(state, unknowns=state.unknowns + du, multipliers=pressure)
    return Interior(start, soft * size, np.zeros(len(soft)), np.zeros(len(soft)))


def iterate(programme: Programme, here: Interior) -> Interior:
    """One iteration, theory (V18), (V19), with Gondzio's correctors."""
    settings = programme.settings.interior
    free, scale, p, g = ~programme.tied, programme.scale, here.state.multipliers, here.slack
    inverse = np.where(free, 1.0 / np.where(free, p, 1.0), 0.0)
    solve = programme.solver(here.state, g * inverse)
    residual, mean = programme.unbalanced(here.state), programme.mean(p, g)

    def direction(product: Vector) -> tuple[Vector, Vector, Vector]:
        """The step to gaps times pressures that are ``product`` but for the product of their steps."""
        du, dp = solve(residual, product * inverse)
        return du, dp, np.where(free, (product - g * p - g * dp) * inverse, 0.0)

    def length_of(dp: Vector, dg: Vector) -> float:
        return min(1.0, _longest(p, dp, free), _longest(g, dg, free))

    _, closing, opening = direction(np.zeros_like(p))
    length = length_of(closing, opening)
    foreseen = programme.mean(p + length * closing, g + length * opening)
    centring = (max(foreseen, 0.0) / max(mean, NOTHING)) ** 3
    product = centring * mean * scale - closing * opening
    du, dp, dg = direction(product)
    for _ in range(2 if programme.prepared.exact else 0):
        length = length_of(dp, dg)
        aim = min(1.0, length + settings.farther)
        reached, wanted = (p + aim * dp) * (g + aim * dg), centring * mean * scale
        change = np.maximum(
            np.clip(reached, settings.worth * wanted, wanted / settings.worth) - reached, -wanted / settings.worth
        )
        following = product + np.where(free, change, 0.0)
        corrected = direction(following)
        if length_of(*corrected[1:]) < length + settings.worth * settings.farther:
            break
        product, (du, dp, dg) = following, corrected
    length = min(1.0, settings.boundary * _longest(p, dp, free), settings.boundary * _longest(g, dg, free))
    shorter = length * settings.shorter ** np.arange(4 * programme.settings.newton.patience)
    length = next((t for t in shorter if programme.central(p + t * dp, g + t * dg)), length)
    state = replace(
        here.state, unknowns=here.state.unknowns + length * du, multipliers=here.state.multipliers + length * dp
    )
    share = np.where(free, g, 1.0)
    return Interior(
        state, g + length * dg, np.where(free, opening / share, -1.0), np.where(free, closing * inverse, 0.0)
    )


def _longest(values: Vector, steps: Vector, free: NDArray[np.bool_]) -> float:
    """How many steps it takes until the first of the positive values is zero."""
    falling = free & (steps < 0.0)
    return float((values[falling] / -steps[falling]).min(initial=np.inf))

"""Flexible GMRES on displacements and active pressures, preconditioned by blocks: multigrid for the stiffness, the
interface's own operator for the pressures. Nothing but the interface's part changes with the active set."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from abut.linear.interface_conditions import Conditions, conditions
from abut.linear.krylov import fgmres
from abut.linear.multigrid import Hierarchy
from abut.linear.schur_preconditioner import Apply, PressureBlock, foresight, pressure_block
from abut.problem.system import Rows, System

RESTART, CYCLES = 100, 3
RESPONSE = 0.03
LOOSE = 1e-9  # resistance of contact to a motion, over the largest, below which it is none: the motion rests
FAILED = "multigrid does not converge on this model"


class NotConverged(Exception):
    """The linear iteration gave up; a direct solver may not."""


@dataclass
class Count:
    """Linear iterations so far."""

    iterations: int = 0


@dataclass(frozen=True)
class Iterative:
    """motions: (n_free, m) rigid motions that supports leave free, which multigrid does not see."""

    operator: Any
    hierarchy: Hierarchy
    pressures: PressureBlock
    motions: NDArray[np.float64]
    count: Count

    def step(
        self, rows: Rows, residual: NDArray[np.float64], pressure: NDArray[np.float64], accuracy: float
    ) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
        """Solve theory (V1), preconditioned by theory (V11), to a residual ``accuracy`` times the present one.

        Raises NotConverged."""
        fixed, active = rows.fixed, ~rows.decoupled
        own = conditions(rows, self.operator, self.pressures)
        operator, n = self.operator[active], len(residual)
        coarse = self._rigid(operator, own)

        def multiply(x: NDArray[np.float64]) -> NDArray[np.float64]:
            u, p = x[:n], own.columns * x[n:]
            return np.concatenate(
                [self.hierarchy.product(u) - operator.T @ p, own.rows * (own.lower @ u + own.corner @ p)]
            )

        def precondition(x: NDArray[np.float64]) -> NDArray[np.float64]:
            p = -own.inverse(x[n:] / own.rows)
            r = x[:n] + operator.T @ p
            return np.concatenate([self.hierarchy.cycle(r) + coarse(r), p / own.columns])

        rhs = np.concatenate([-residual + self.operator.T @ fixed, -own.rows * rows.residual[active]])
        solution, iterations, done = fgmres(multiply, precondition, rhs, accuracy, RESTART, CYCLES)
        self.count.iterations += iterations
        if not done or not np.isfinite(solution).all():
            raise NotConverged(FAILED)
        dp = fixed
        dp[active] = own.columns * solution[n:]
        return solution[:n], dp

    def respond(self, force: NDArray[np.float64], springs: NDArray[np.float64]) -> NDArray[np.float64]:
        """Displacements by forces where ``springs`` (n_free,) hold what supports do not, to ``RESPONSE`` or as near as
        it gets."""
        motions = self.motions
        small = np.linalg.pinv(motions.T @ (springs[:, None] * motions))
        answer, iterations, _ = fgmres(
            lambda u: self.hierarchy.product(u) + springs * u,
            lambda r: self.hierarchy.cycle(r) + motions @ (small @ (motions.T @ r)),
            force, RESPONSE, RESTART, 1,
        )  # fmt: skip
        self.count.iterations += iterations
        return answer

    def _rigid(self, operator: Any, own: Conditions) -> Apply:
        """What multigrid misses: rigid motions of bodies that only contact holds."""
        if not self.motions.shape[1]:
            return lambda r: np.zeros_like(r)
        small = compliance(operator @ self.motions, own.inverse, -np.asarray(own.lower @ self.motions))
        return lambda r: np.asarray(self.motions @ (small @ (self.motions.T @ r)))


def compliance(
    moved: NDArray[np.float64], inverse: Apply, seen: NDArray[np.float64] | None = None
) -> NDArray[np.float64]:
    """How far rigid motions yield (m, m) that only contact resists. moved: (n, m) weighted gaps by unit motions; inverse: of
    the pressures' preconditioner; seen: (n, m) what the rows give for unit motions, the gaps where left out."""
    answers = np.column_stack([inverse(column) for column in (moved if seen is None else seen).T])
    return np.asarray(np.linalg.pinv(moved.T @ answers, rcond=LOOSE))


def iterate(system: System, hierarchy: Hierarchy, motions: NDArray[np.float64], count: Count) -> System:
    """The system with its linear systems solved iteratively; ``count`` goes on counting."""
    pressures = pressure_block(system.pairs, system.operator, system.stiffness.diagonal())
    solver = Iterative(system.operator, hierarchy, pressures, motions, count)
    predict = foresight(lambda: pressures.half_spaces, np.asarray(system.operator @ motions))
    return replace(system, step=solver.step, factorise=None, respond=solver.respond, exact=False, predict=predict)

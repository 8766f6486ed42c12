"""Flexible GMRES on displacements and active pressures, with a block triangular preconditioner: multigrid for the stiffness,
an approximate Schur complement for the pressures, which alone changes with the active set."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from abut.errors import SingularModelError
from abut.linear.interface_conditions import Conditions, conditions
from abut.linear.krylov import fgmres
from abut.linear.multigrid import Hierarchy, hierarchy
from abut.linear.schur_preconditioner import Apply, Predict, PressureBlock, foresight, pressure_block
from abut.linear.solver import ACCURATE, Count, NotConverged, Prepared, Vector
from abut.linear.static_condensation import UNBALANCED, UNBALANCED_LOADS
from abut.problem.linearised import Linearised, Rows
from abut.problem.problem import Problem
from abut.types import Sparse

RESTART, CYCLES = 100, 3
RESPONSE = 0.03
LOOSE = 1e-9  # resistance of contact to a motion, over the largest, below which it is none: the motion rests
FAILED = "multigrid does not converge on this model"


@dataclass(frozen=True)
class Iterative:
    """As ``abut.linear.solver.Prepared``. count: of iterations, goes on counting."""

    system: Linearised
    hierarchy: Hierarchy
    pressures: PressureBlock
    predict: Predict
    count: Count
    exact: bool = False
    accurate: float = ACCURATE

    def solve(self, rows: Rows, residual: Vector, pressure: Vector, accuracy: float) -> tuple[Vector, Vector]:
        """As in ``Prepared``, preconditioned by theory (V11)."""
        interface = conditions(rows, self.system.operator, self.pressures, self.system.pairs)
        operator, n = interface.forces, len(residual)
        coarse = self._rigid(interface, residual - self.system.operator.T @ interface.fixed)

        def multiply(x: NDArray[np.float64]) -> NDArray[np.float64]:
            u, p = x[:n], interface.columns * x[n:]
            return np.concatenate(
                [
                    self.hierarchy.product(u) - operator.T @ p,
                    interface.rows * (interface.lower @ u + interface.corner @ p),
                ]
            )

        def precondition(x: NDArray[np.float64]) -> NDArray[np.float64]:
            p = -interface.inverse(x[n:] / interface.rows)
            r = x[:n] + operator.T @ p
            return np.concatenate([self.hierarchy.cycle(r) + coarse(r), p / interface.columns])

        rhs = np.concatenate(
            [-residual + self.system.operator.T @ interface.fixed, -interface.rows * interface.residual]
        )
        solution, iterations, done = fgmres(multiply, precondition, rhs, accuracy, RESTART, CYCLES)
        self.count.iterations += iterations
        if not done or not np.isfinite(solution).all():
            raise NotConverged(FAILED)
        return solution[:n], interface.multipliers(interface.columns * solution[n:])

    def factorise(self, rows: Rows) -> None:
        """No factors are kept."""

    def foresee(
        self, gap: Vector, pressure: Vector, active: NDArray[np.bool_], tied: NDArray[np.bool_]
    ) -> NDArray[np.bool_]:
        """As in ``Prepared``."""
        return self.predict(gap, pressure, active, tied)

    def respond(self, force: Vector, springs: Vector) -> Vector:
        """As in ``Prepared``, to ``RESPONSE`` or as near as it gets."""
        motions = self.system.motions
        small = np.linalg.pinv(motions.T @ (springs[:, None] * motions))
        answer, iterations, _ = fgmres(
            lambda u: self.hierarchy.product(u) + springs * u,
            lambda r: self.hierarchy.cycle(r) + motions @ (small @ (motions.T @ r)),
            force, RESPONSE, RESTART, 1,
        )  # fmt: skip
        self.count.iterations += iterations
        return answer

    def _rigid(self, interface: Conditions, force: Vector) -> Apply:
        """What multigrid misses: rigid motions of bodies that only contact holds. Raises SingularModelError where nothing
        does, and ``force`` (n_free,) moves them."""
        motions = self.system.motions
        if not motions.shape[1]:
            return lambda r: np.zeros_like(r)
        small = compliance(interface.forces @ motions, interface.inverse, -np.asarray(interface.lower @ motions))
        require_held(motions, small, force, float(np.abs(self.system.forces).sum()))
        return lambda r: np.asarray(motions @ (small @ (motions.T @ r)))


def require_held(motions: NDArray[np.float64], small: NDArray[np.float64], force: Vector, loads: float) -> None:
    """Raises SingularModelError where a force (n,) does work on motions (n, m) that nothing resists, whose compliance
    ``small`` (m, m) is zero, as ``compliance`` leaves it. loads: sum of all, beside which what is left is rounding."""
    basis, sizes, _ = np.linalg.svd(small)
    unconstrained = basis[:, sizes <= LOOSE * sizes.max(initial=0.0)]
    if np.abs(unconstrained.T @ (motions.T @ force)).max(initial=0.0) > UNBALANCED * (np.abs(force).sum() + loads):
        raise SingularModelError(UNBALANCED_LOADS)


def compliance(
    moved: NDArray[np.float64], inverse: Apply, seen: NDArray[np.float64] | None = None
) -> NDArray[np.float64]:
    """How far rigid motions yield (m, m) that only contact resists. moved: (n, m) weighted gaps by unit motions; inverse: of
    the pressures' preconditioner; seen: (n, m) what the rows give for unit motions, the gaps where left out."""
    answers = np.column_stack([inverse(column) for column in (moved if seen is None else seen).T])
    return np.asarray(np.linalg.pinv(moved.T @ answers, rcond=LOOSE))


@dataclass(frozen=True)
class Multigrid:
    """As ``abut.linear.solver.LinearSolver``. free: (dim n_points, n_free) change of variables; near_null: (dim n_points, m)
    motions that strain bodies least; points: (n_points, dim)."""

    free: Sparse
    near_null: NDArray[np.float64]
    points: NDArray[np.float64]
    count: Count
    name: str = "multigrid (PyAMG)"

    def condensed(self, problem: Problem) -> Problem:
        """The problem as it is."""
        return problem

    def prepare(self, system: Linearised, previous: Prepared | None) -> Iterative:
        """As in ``LinearSolver``: the hierarchy stays while the stiffness does, the rest while the operator does too."""
        if isinstance(previous, Iterative) and previous.system.stiffness is system.stiffness:
            if previous.system.operator is system.operator:
                return replace(previous, system=system)
            levels = previous.hierarchy
        else:
            levels = hierarchy(system.stiffness, self.free, self.near_null, self.points)
        pressures = pressure_block(system.pairs, system.operator, system.stiffness.diagonal())
        predict = foresight(lambda: pressures.half_spaces, np.asarray(system.operator @ system.motions))
        return Iterative(system, levels, pressures, predict, self.count)

    def note(self, prepared: Prepared) -> str:
        """As in ``LinearSolver``."""
        return prepared.hierarchy.summary if isinstance(prepared, Iterative) else self.name

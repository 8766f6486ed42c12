"""Flexible GMRES on displacements and active pressures, with a block triangular preconditioner: multigrid for the stiffness,
an approximate Schur complement for the pressures, which alone changes with the active set."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from abut.bordered import eliminated
from abut.contact.geometry import facet_products, full_moments
from abut.errors import SingularModelError
from abut.linear.bodies_now import bodies_now
from abut.linear.dense import UNBALANCED, UNBALANCED_LOADS
from abut.linear.foresight import LOOSE, Predict, foresight
from abut.linear.interface_conditions import Conditions, conditions
from abut.linear.krylov import fgmres
from abut.linear.loose_motions import Loose, loose
from abut.linear.multigrid import Hierarchy, hierarchy
from abut.linear.schur_preconditioner import Apply, PressureBlock, pressure_block
from abut.linear.solver import ACCURATE, Count, NotConverged, Prepared, Vector
from abut.linear.transposed import Coupled, by_iterations
from abut.problem.linearised import Linearised, Rows
from abut.problem.pair import Pair
from abut.problem.problem import ContactProblem, Problem

RESTART, CYCLES = 100, 3
RESPONSE = 0.03
FAILED = "multigrid does not converge on this model"
COVERED = 0.01  # least share of a function that counts as covered


@dataclass(frozen=True)
class Iterative:
    """As ``abut.linear.solver.Prepared``. count: of iterations, goes on counting."""

    system: Linearised
    hierarchy: Hierarchy
    loose: Loose
    pressures: PressureBlock
    predict: Predict
    count: Count
    exact: bool = False
    accurate: float = ACCURATE

    def solve(self, rows: Rows, residual: Vector, pressure: Vector, accuracy: float) -> tuple[Vector, Vector]:
        """One Newton system solved, as in ``Prepared``, preconditioned by theory (V11)."""
        system = self.system
        interface = conditions(rows, system.operator, self.pressures, system.pairs, system.columns)
        operator, n = interface.forces, len(residual)
        force = residual - system.columns.T @ interface.fixed
        coarse = self._rigid(interface, force)

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

        rhs = np.concatenate([-force, -interface.rows * interface.residual])
        solution, iterations, done = fgmres(multiply, precondition, rhs, accuracy, RESTART, CYCLES)
        self.count.iterations += iterations
        if not done or not np.isfinite(solution).all():
            raise NotConverged(FAILED)
        return solution[:n], interface.multipliers(interface.columns * solution[n:])

    def transposed(self, rows: Rows, force: Vector, gap: Vector, accuracy: float) -> tuple[Vector, Vector]:
        """The transposed system solved, as in ``Transposable``."""
        motions = self.loose.motions

        def correction(part: Coupled, inverse: Apply) -> Apply:
            if not motions.shape[1]:
                return lambda r: np.zeros_like(r)
            small = compliance(part.lower @ motions, inverse, part.forces @ motions, self.loose.stiffness)
            return lambda r: np.asarray(motions @ (small @ (motions.T @ r)))

        v, q, iterations = by_iterations(
            self.system,
            rows,
            self.pressures,
            self.hierarchy.cycle,
            correction,
            (force, gap),
            accuracy,
            (RESTART, CYCLES),
        )
        self.count.iterations += iterations
        return v, q

    def factorise(self, rows: Rows) -> None:
        """No factors are kept."""

    def foresee(
        self, gap: Vector, pressure: Vector, active: NDArray[np.bool_], tied: NDArray[np.bool_]
    ) -> NDArray[np.bool_]:
        """The next active set, predicted, as in ``Prepared``."""
        return self.predict(gap, pressure, active, tied)

    def respond(self, force: Vector, springs: Vector) -> Vector:
        """Displacements by forces, without contact, as in ``Prepared``, to ``RESPONSE`` or as near as it gets."""
        motions = self.loose.motions
        small = np.linalg.pinv(self.loose.stiffness + motions.T @ (springs[:, None] * motions))
        answer, iterations, _ = fgmres(
            lambda u: self.hierarchy.product(u) + springs * u,
            lambda r: self.hierarchy.cycle(r) + motions @ (small @ (motions.T @ r)),
            force, RESPONSE, RESTART, 1,
        )  # fmt: skip
        self.count.iterations += iterations
        return answer

    def _rigid(self, interface: Conditions, force: Vector) -> Apply:
        """What multigrid misses: rigid motions of bodies that only contact holds, and displacements of many points. Raises
        SingularModelError where nothing holds a body that ``force`` (n_free,) moves; at large displacements iterations fail
        there."""
        motions = self.loose.motions
        if not motions.shape[1]:
            return lambda r: np.zeros_like(r)
        seen = -np.asarray(interface.lower @ motions)
        small = compliance(interface.forces @ motions, interface.inverse, seen, self.loose.stiffness)
        if self.system.about is None:
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
    moved: NDArray[np.float64],
    inverse: Apply,
    seen: NDArray[np.float64] | None = None,
    stiffness: NDArray[np.float64] | float = 0.0,
) -> NDArray[np.float64]:
    """How far motions yield (m, m) that contact resists. moved: (n, m) weighted gaps by unit motions; inverse: of the
    pressures' preconditioner; seen: (n, m) what the rows give for unit motions, the gaps where left out; stiffness: (m, m)
    what bodies resist, none to rigid motions."""
    answers = np.column_stack([inverse(column) for column in (moved if seen is None else seen).T])
    return np.asarray(np.linalg.pinv(moved.T @ answers + stiffness, rcond=LOOSE))


@dataclass(frozen=True)
class Multigrid:
    """As ``abut.linear.solver.LinearSolver``, for a problem."""

    problem: ContactProblem
    count: Count
    name: str = "multigrid (PyAMG)"

    def condensed(self, problem: Problem) -> Problem:
        """The problem as it is."""
        return problem

    def prepare(self, system: Linearised, previous: Prepared | None) -> Iterative:
        """Set up for a linearised problem, as in ``LinearSolver``: the hierarchy stays while the stiffness does, the
        rest while the operator does too; both stay for a load step at large displacements, and where bodies flow."""
        if system.about is not None:
            return self._at_state(system, previous)
        known = previous if isinstance(previous, Iterative) and previous.system.stiffness is system.stiffness else None
        if known is not None and known.system.operator is system.operator:
            return replace(known, system=system)
        if isinstance(previous, Iterative) and self._same_step(previous.system, system):
            levels = replace(previous.hierarchy, product=lambda values: np.asarray(system.stiffness @ values))
            return replace(previous, system=system, hierarchy=levels)
        if known is None:
            bodies = bodies_now(self.problem, system)
            levels = hierarchy(eliminated(system.stiffness), bodies.free, bodies.near_null, bodies.points)
            beside = loose(system, bodies, levels, self.count)
        else:
            levels, beside = known.hierarchy, known.loose
        return self._with_pressures(system, levels, beside)

    @staticmethod
    def _same_step(previous: Linearised, system: Linearised) -> bool:
        """Whether only the stiffness of the bodies is another one than it was in the same load step."""
        return previous.time == system.time and previous.operator is system.operator

    def _at_state(self, system: Linearised, previous: Prepared | None) -> Iterative:
        """At large displacements. Multigrid is for the bodies' own stiffness, its symmetric part: contact terms tie bodies
        together that are to be aggregated apart."""

        def product(values: Vector) -> Vector:
            return np.asarray(system.stiffness @ values)

        covered = covered_shares(system.pairs)
        if isinstance(previous, Iterative) and previous.system.time == system.time:
            levels, pressures = (
                replace(previous.hierarchy, product=product),
                replace(previous.pressures, covered=covered),
            )
            return replace(previous, system=system, hierarchy=levels, pressures=pressures)
        bodies = bodies_now(self.problem, system)
        own = eliminated(system.stiffness)
        elastic = own if system.bending is None else own + system.bending
        levels = hierarchy((0.5 * (elastic + elastic.T)).tocsr(), bodies.free, bodies.near_null, bodies.points)
        beside = loose(system, bodies, levels, self.count)
        whole = replace(system, pairs=[wholly_covered(pair) for pair in system.pairs])
        made = self._with_pressures(whole, replace(levels, product=product), beside)
        return replace(made, system=system, pressures=replace(made.pressures, covered=covered))

    def _with_pressures(self, system: Linearised, levels: Hierarchy, beside: Loose) -> Iterative:
        pressures = pressure_block(system.pairs, system.operator, system.stiffness.diagonal())
        predict = foresight(lambda: pressures.half_spaces, np.asarray(system.operator @ system.motions))
        return Iterative(system, levels, beside, pressures, predict, self.count)

    def note(self, prepared: Prepared) -> str:
        """What is told of it, as in ``LinearSolver``."""
        return prepared.hierarchy.summary if isinstance(prepared, Iterative) else self.name

    @property
    def effort(self) -> str:
        """What is told of its work, as in ``LinearSolver``."""
        return self.count.effort


def wholly_covered(pair: Pair) -> Pair:
    """With products of functions over the whole contactor, whatever is opposite."""
    if pair.tied:
        return pair
    mass = facet_products(pair.contactor, pair.coupling.degree)
    return replace(pair, coupling=replace(pair.coupling, mass=mass))


def covered_shares(pairs: Sequence[Pair]) -> Vector:
    """(n,) share of every multiplier's function that is opposite the target, of all pairs."""
    return np.concatenate([np.zeros(0), *map(_covered, pairs)])


def _covered(pair: Pair) -> Vector:
    """(n,) share of every multiplier's function that is opposite the target."""
    if pair.tied:
        return np.ones(len(pair))
    whole = pair.space.transfer.T @ full_moments(pair.contactor, pair.coupling.degree).ravel()
    share = np.divide(
        pair.space.weight, whole, out=np.zeros(len(whole)), where=whole > 0.0
    )  # none of what follows others
    return pair.of_functions(np.maximum(share, COVERED))

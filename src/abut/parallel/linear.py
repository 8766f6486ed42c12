"""Linear solvers on several processes, by PETSc: direct, and iterative with multigrid."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
import scipy.sparse as sp
from numpy.typing import NDArray

from abut.errors import InputError, SingularModelError
from abut.linear.bodies_now import BodiesNow, bodies_now
from abut.linear.choice import chosen
from abut.linear.cost_model import LARGE_ON_MANY
from abut.linear.direct import SINGULAR
from abut.linear.foresight import Predict, foresight
from abut.linear.interface_conditions import conditions
from abut.linear.iterative import RESPONSE, compliance, covered_shares, require_held, wholly_covered
from abut.linear.loose_motions import Loose
from abut.linear.saddle_point import saddle
from abut.linear.schur_preconditioner import PressureBlock, half_spaces, interfaces, pressure_block
from abut.linear.solver import Count, NotConverged, Prepared, Solve
from abut.parallel.factors import by_factors, direct_solver, drop_factors, factorise, keep_factors
from abut.parallel.krylov import Task, iterate, multigrid
from abut.parallel.matrix import Distributed
from abut.parallel.options import krylov_method, preconditioner, require_known, wants_factors, wants_iterations
from abut.parallel.partition import Layout
from abut.parallel.systems import Answer, Conditions
from abut.parallel.team import Team
from abut.problem.linearised import Linearised, Rows
from abut.problem.pair import Pair
from abut.problem.problem import ContactProblem, Problem
from abut.types import Sparse

SYMMETRIC = ("minres", "cg", "symmlq")  # Krylov methods for such matrices
ACCURATE = 1e-11  # of equilibrium and of closed gaps: results differ by less than 1e-8 from those of a direct solver
Vector = NDArray[np.float64]


@dataclass(frozen=True)
class Iterative:
    """As ``abut.linear.iterative.Iterative``, with everything as large as the volume on all processes. matrix: the
    stiffness, all of it in PETSc's."""

    system: Linearised
    matrix: Distributed
    loose: Loose
    pressures: PressureBlock
    predict: Predict
    count: Count
    exact: bool = False
    accurate: float = ACCURATE

    def factorise(self, rows: Rows) -> None:
        """No factors are kept."""

    def foresee(
        self, gap: Vector, pressure: Vector, active: NDArray[np.bool_], tied: NDArray[np.bool_]
    ) -> NDArray[np.bool_]:
        """The next active set, predicted, as in ``Prepared``."""
        return self.predict(gap, pressure, active, tied)

    def solve(self, rows: Rows, residual: Vector, pressure: Vector, accuracy: float) -> tuple[Vector, Vector]:
        """Solve theory (V1), preconditioned by theory (V11), to a residual ``accuracy`` times the present one.

        Raises NotConverged."""
        system, layout, loose = self.system, self.matrix.layout, self.loose
        interface = conditions(rows, system.operator, self.pressures, system.pairs, system.columns)
        inverse, force = interface.inverse, residual - system.columns.T @ interface.fixed
        small = np.zeros((0, 0))
        if loose.motions.shape[1]:
            seen = -np.asarray(interface.lower @ loose.motions)
            small = compliance(interface.forces @ loose.motions, inverse, seen, loose.stiffness)
            if system.about is None:
                require_held(loose.motions, small, force, float(np.abs(system.forces).sum()))
        by_column, by_row = sp.diags(interface.columns), sp.diags(interface.rows)
        beside = Conditions(
            spread(by_column @ interface.forces, layout), spread(by_row @ interface.lower, layout),
            (by_row @ interface.corner @ by_column).tocsr(), -interface.rows * interface.residual,
            lambda gap: inverse(gap / interface.rows) / interface.columns if len(gap) else gap,
        )  # fmt: skip
        answers = self._solve(accuracy, -force, small, beside)
        solution = displacement(answers, layout)
        if answers[0].reason < 0 or not np.isfinite(solution).all():
            raise NotConverged(f"PETSc's iterations do not converge on this model (reason {answers[0].reason})")
        return solution, interface.multipliers(interface.columns * answers[0].pressure)

    def respond(self, force: Vector, springs: Vector) -> Vector:
        """As ``abut.linear.iterative.Iterative.respond``."""
        motions = self.loose.motions
        small = np.asarray(np.linalg.pinv(self.loose.stiffness + motions.T @ (springs[:, None] * motions)))
        with self.matrix.with_springs(springs):
            return displacement(self._solve(RESPONSE, force, small, None), self.matrix.layout)

    def _solve(self, accuracy: float, rhs: Vector, small: Vector, beside: Conditions | None) -> list[Answer]:
        n = 0 if beside is None else len(beside.rhs)
        shares = self.matrix.layout.shares(np.column_stack([rhs, self.loose.motions]))
        task = Task(self.matrix.kept.number, n, accuracy, small, self.system.about is None)
        arguments = [(v[:, 0], v[:, 1:], None if rank else beside) for rank, (v,) in enumerate(shares)]
        answers: list[Answer] = self.matrix.team.each(iterate, task, per_rank=arguments)
        self.count.iterations += answers[0].iterations
        return answers


@dataclass(frozen=True)
class Direct:
    """As ``abut.linear.saddle_point.SaddlePoint``."""

    system: Linearised
    predict: Predict
    exact: bool = True
    accurate: float = ACCURATE

    @property
    def matrix(self) -> Distributed:
        return self.system.stiffness

    def foresee(
        self, gap: Vector, pressure: Vector, active: NDArray[np.bool_], tied: NDArray[np.bool_]
    ) -> NDArray[np.bool_]:
        """The next active set, predicted, as in ``Prepared``."""
        return self.predict(gap, pressure, active, tied)

    def solve(self, rows: Rows, residual: Vector, pressure: Vector, accuracy: float) -> tuple[Vector, Vector]:
        """Solve theory (V1). Raises SingularModelError."""
        layout, n = self.matrix.layout, len(pressure)
        if n == 0:
            return self._solve(0, self.system.symmetric, -residual, None)[0], pressure
        s = saddle(self.system.unit, self.system.columns, rows, residual)
        beside = Conditions(
            spread(s.coupled, layout), spread(s.lower, layout), sp.csr_matrix(s.corner), s.rhs_p,
            possible=None if self.system.about is None else possible(self.system, layout),
        )  # fmt: skip
        solution, q = self._solve(n, s.symmetric, s.rhs_u, beside)
        return solution, s.pressure(q)

    def factorise(self, rows: Rows) -> Solve:
        """As ``abut.linear.saddle_point.factorise``."""
        layout, n = self.matrix.layout, len(rows.residual)
        s = saddle(self.system.unit, self.system.operator, rows, np.zeros(self.matrix.shape[0]))
        beside = Conditions(spread(s.coupled, layout), spread(s.lower, layout), sp.csr_matrix(s.corner), s.rhs_p)
        team, more = self.matrix.team, self.matrix.beside_by_process()
        team.each(
            keep_factors, self.matrix.kept.number, n, s.symmetric,
            per_rank=[(own, None if rank else beside) for rank, own in enumerate(more)],
        )  # fmt: skip

        def solve(residual: Vector, of_law: Vector) -> tuple[Vector, Vector]:
            s = saddle(self.system.unit, self.system.operator, replace(rows, residual=of_law), residual)
            shares = layout.shares(s.rhs_u)
            arguments = [(share, np.zeros(0) if rank else s.rhs_p) for rank, (share,) in enumerate(shares)]
            solution, q = checked(team.each(by_factors, per_rank=arguments), layout)
            return solution, s.pressure(q)

        return solve

    def respond(self, force: Vector, springs: Vector) -> Vector:
        """Displacements by forces where ``springs`` (n_free,) hold what supports do not."""
        with self.matrix.with_springs(springs):
            return self._solve(0, True, force, None)[0]

    def _solve(self, n: int, symmetric: bool, rhs: Vector, beside: Conditions | None) -> tuple[Vector, Vector]:
        matrix, team = self.matrix, self.matrix.team
        both = zip(matrix.layout.shares(rhs), matrix.beside_by_process())
        arguments = [(share, more, None if rank else beside) for rank, ((share,), more) in enumerate(both)]
        answers = team.each(factorise, matrix.kept.number, n, symmetric, per_rank=arguments)
        if not (answers[0].error < SINGULAR or answers[0].memory):  # perhaps for an analysis made for other values;
            # and unlike LU, symmetric factors of several processes do not pivot beyond what has a diagonal of its own
            team.each(drop_factors)
            answers = team.each(factorise, matrix.kept.number, n, False, per_rank=arguments)
        return checked(answers, matrix.layout)


@dataclass(frozen=True)
class PetscIterations:
    """As ``abut.linear.solver.LinearSolver``, for a problem."""

    problem: ContactProblem
    count: Count

    @property
    def name(self) -> str:
        return f"PETSc Krylov with {preconditioner()}"

    def condensed(self, problem: Problem) -> Problem:
        """The problem as it is."""
        return problem

    def prepare(self, system: Linearised, previous: Prepared | None) -> Iterative:
        """Set up for a linearised problem, as in ``LinearSolver``; at large displacements multigrid stays for a load
        step. Raises InputError for laws or Krylov methods that do not go with it."""
        known = previous if isinstance(previous, Iterative) else None
        if known is not None and known.system.same_matrices(system):
            return replace(known, system=system)
        _require_general(system)
        if system.about is not None:
            return self._at_state(system, known)
        if known is not None and known.system.stiffness is system.stiffness:
            return self._with_pressures(system, known.matrix, known.loose)
        whole = system.stiffness.whole()
        self._set_up(whole, bodies_now(self.problem, system))
        return self._with_pressures(system, whole, Loose(system.motions, np.zeros((system.motions.shape[1],) * 2)))

    def _at_state(self, system: Linearised, known: Iterative | None) -> Iterative:
        """At large displacements. Multigrid is for the bodies' own stiffness: contact terms tie bodies together that are to
        be aggregated apart."""
        matrix: Distributed = system.stiffness
        whole, shares = matrix.whole(), covered_shares(system.pairs)
        if known is not None and known.system.time == system.time:
            return replace(known, system=system, matrix=whole, pressures=replace(known.pressures, covered=shares))
        bodies = bodies_now(self.problem, system)
        self._set_up(matrix.of_bodies(), bodies)
        motions = np.linalg.qr(bodies.motions)[0]
        made = self._with_pressures(
            replace(system, pairs=[wholly_covered(pair) for pair in system.pairs]), whole,
            Loose(motions, motions.T @ (whole @ motions)),
        )  # fmt: skip
        return replace(made, system=system, pressures=replace(made.pressures, covered=shares))

    def _set_up(self, matrix: Distributed, bodies: BodiesNow) -> None:
        """Multigrid for a stiffness."""
        motions = matrix.layout.shares(np.linalg.qr(bodies.near_null)[0])
        matrix.team.each(multigrid, matrix.kept.number, per_rank=motions)

    def _with_pressures(self, system: Linearised, matrix: Distributed, loose: Loose) -> Iterative:
        pressures = pressure_block(system.pairs, system.operator, matrix.diagonal())
        predict = foresight(lambda: pressures.half_spaces, np.asarray(system.operator @ system.motions))
        return Iterative(system, matrix, loose, pressures, predict, self.count)

    def note(self, prepared: Prepared) -> str:
        """What is told of it, as in ``LinearSolver``."""
        if not isinstance(prepared, Iterative):
            return self.name
        return f"{self.name}, {_processes(prepared.matrix.team)}"

    @property
    def effort(self) -> str:
        """What is told of its work, as in ``LinearSolver``."""
        return self.count.effort


def _require_general(system: Linearised) -> None:
    """Raises InputError for Krylov methods of symmetric matrices where the laws do not leave such."""
    if krylov_method() not in SYMMETRIC:
        return
    bends = [
        f"{what} does not leave (contact '{pair.contact.name}')"
        for pair in system.pairs
        for what, is_so in (("friction", pair.frictional), ("the constraint function", pair.smooth))
        if is_so
    ]
    if bends or system.about is not None:
        why = bends[0] if bends else "finite kinematics does not leave"
        raise InputError(f"-ksp_type {krylov_method()} is for symmetric matrices, which {why}: leave the option out")


@dataclass(frozen=True)
class PetscDirect:
    """As ``abut.linear.solver.LinearSolver``, by whichever direct solver PETSc has."""

    count: None = None

    @property
    def name(self) -> str:
        return f"PETSc direct ({direct_solver()})"

    def condensed(self, problem: Problem) -> Problem:
        """The problem as it is."""
        return problem

    def prepare(self, system: Linearised, previous: Prepared | None) -> Direct:
        """Set up for a linearised problem, as in ``LinearSolver``. Raises InputError where PETSc has no solver for
        several processes."""
        if isinstance(previous, Direct) and previous.system.same_matrices(system):
            return replace(previous, system=system)
        matrix: Distributed = system.stiffness
        if direct_solver() == "petsc" and matrix.team.size > 1:
            raise InputError(
                "this PETSc has neither MUMPS nor SuperLU_DIST, so that it factorises on one process only; install one of "
                "them"
            )
        pairs = system.pairs
        moved = np.asarray(system.operator @ system.motions)
        return Direct(system, foresight(lambda: half_spaces(interfaces(pairs)), moved))

    def note(self, prepared: Prepared) -> str:
        """What is told of it, as in ``LinearSolver``."""
        return f"PETSc's direct solver {direct_solver()}, {_processes(prepared.system.stiffness.team)}"

    @property
    def effort(self) -> str:
        """Nothing to tell."""
        return ""


def choose(problem: ContactProblem) -> str:
    """As ``abut.linear.choice.choose``; PETSc options come first. Raises InputError."""
    require_known()
    coupled = problem.constraints.coupled
    if wants_factors():
        return "direct"
    if wants_iterations() and coupled:
        raise InputError(
            "PETSc's options ask for iterations, but equations or components left free of a rigid body couple points, "
            "which multigrid cannot: leave -ksp_type and -pc_type out"
        )
    smooth = [pair.contact.name for pair in problem.pairs if pair.smooth and pair.frictional]
    if wants_iterations() and smooth:
        raise InputError(
            f"PETSc's iterations know friction by Coulomb's law alone, and contact '{smooth[0]}' has the constraint "
            'function for it; choose law = "complementarity", or leave -ksp_type and -pc_type out'
        )
    linear = "amg" if wants_iterations() else "auto"
    unfit = coupled or problem.model.deformable.pressures is not None
    return chosen(linear, problem.n_free, problem.pairs, problem.model.mesh, unfit, LARGE_ON_MANY)


def spread(rows: Sparse, layout: Layout) -> Sparse:
    """Rows (n, n_free) with the columns at their places, (n, n_places)."""
    entries = rows.tocoo()
    shape = rows.shape[0], int(layout.starts[-1])
    return sp.csr_matrix((entries.data, (entries.row, layout.slot[entries.col])), shape=shape)


def possible(system: Linearised, layout: Layout) -> tuple[Sparse, Sparse]:
    """Ones where rows of the laws may have entries, whatever the contact status: by displacements (n, n_places) and by
    multipliers (n, n). A row sees all multipliers of its function, and what they see."""
    whole = sp.block_diag([_of_functions(pair) for pair in system.pairs], format="csr")
    return spread(whole @ abs(system.operator), layout), whole


def _of_functions(pair: Pair) -> Sparse:
    """(n, n) ones between multipliers of the same function."""
    if not pair.frictional:
        return sp.identity(len(pair), format="csr")
    function, component = np.nonzero(pair.index >= 0)
    shape = len(pair), len(pair.index)
    by = sp.csr_matrix((np.ones(len(function)), (pair.index[function, component], function)), shape=shape)
    return (by @ by.T).tocsr()


def checked(answers: list[Answer], layout: Layout) -> tuple[Vector, Vector]:
    """Displacements (n_free,) and pressures by factors. Raises InputError where memory does not do, SingularModelError."""
    if answers[0].memory:
        raise InputError(
            "not enough memory for PETSc's direct solver; take more processes or machines, or a coarser mesh, or, in "
            '3D, law "complementarity" and no equations, which multigrid can solve'
        )
    if not answers[0].error < SINGULAR:
        raise SingularModelError("the equations have no unique solution; check supports, contacts and units")
    return displacement(answers, layout), answers[0].pressure


def displacement(answers: list[Answer], layout: Layout) -> Vector:
    """All free displacements."""
    return layout.values([answer.displacement for answer in answers])


def _processes(team: Team) -> str:
    return "1 process" if team.size == 1 else f"{team.size} processes"

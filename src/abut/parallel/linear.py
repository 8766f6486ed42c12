"""Linear solvers on many processes: the same two ways as on one, by PETSc."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Any

import numpy as np
import scipy.sparse as sp
from numpy.typing import NDArray

from abut.errors import InputError, SingularModelError
from abut.linear.choice import Prepared
from abut.linear.direct import SINGULAR
from abut.linear.interface_conditions import conditions
from abut.linear.iterative import RESPONSE, Count, NotConverged, compliance
from abut.linear.saddle_point import saddle
from abut.linear.schur_preconditioner import PressureBlock, foresight, half_spaces, interfaces, pressure_block
from abut.parallel.krylov import (
    FACTORS,
    Answer,
    Conditions,
    by_factors,
    direct_solver,
    factorise,
    iterate,
    keep_factors,
    multigrid,
)
from abut.parallel.matrix import Distributed
from abut.parallel.partition import Layout
from abut.parallel.team import Team
from abut.problem.system import Rows, Solve, System

ACCURATE = 1e-11  # of equilibrium and of closed gaps: results differ by less than 1e-8 from those of a direct solver
Vector = NDArray[np.float64]


@dataclass(frozen=True)
class Iterative:
    """As ``abut.linear.iterative.Iterative``, with everything as large as the volume on all processes."""

    matrix: Distributed
    operator: Any
    pressures: PressureBlock
    motions: Vector
    count: Count

    def step(self, rows: Rows, residual: Vector, pressure: Vector, accuracy: float) -> tuple[Vector, Vector]:
        """Solve theory (V1), preconditioned by theory (V11), to a residual ``accuracy`` times the present one.

        Raises NotConverged."""
        fixed, active = rows.fixed, ~rows.decoupled
        operator, own = self.operator[active], conditions(rows, self.operator, self.pressures)
        s, inverse, layout = own.columns, own.inverse, self.matrix.layout
        small = compliance(operator @ self.motions, inverse) if self.motions.shape[1] else np.zeros((0, 0))
        lower, corner = spread(sp.diags(s) @ own.lower, layout), sp.diags(s) @ own.corner @ sp.diags(s)
        beside = Conditions(
            lower, lower, corner.tocsr(), -s * rows.residual[active],
            lambda gap: inverse(gap / s) / s if len(gap) else gap,
        )  # fmt: skip
        answers = self._solve(accuracy, -residual + self.operator.T @ fixed, small, beside)
        solution = displacement(answers, layout)
        if answers[0].reason < 0 or not np.isfinite(solution).all():
            raise NotConverged(f"PETSc's iterations do not converge on this model (reason {answers[0].reason})")
        fixed[active] = s * answers[0].pressure
        return solution, fixed

    def respond(self, force: Vector, springs: Vector) -> Vector:
        """As ``abut.linear.iterative.Iterative.respond``."""
        motions = self.motions
        small = np.asarray(np.linalg.pinv(motions.T @ (springs[:, None] * motions)))
        with self.matrix.held(springs):
            return displacement(self._solve(RESPONSE, force, small, None), self.matrix.layout)

    def _solve(self, accuracy: float, rhs: Vector, small: Vector, beside: Conditions | None) -> list[Answer]:
        n = 0 if beside is None else len(beside.rhs)
        shares = self.matrix.layout.shares(np.column_stack([rhs, self.motions]))
        answers: list[Answer] = self.matrix.team.each(
            iterate, accuracy, n, small,
            own=[(v[:, 0], v[:, 1:], None if rank else beside) for rank, (v,) in enumerate(shares)],
        )  # fmt: skip
        self.count.iterations += answers[0].iterations
        return answers


@dataclass(frozen=True)
class Direct:
    """As ``abut.linear.saddle_point.newton_step``."""

    matrix: Distributed
    operator: Any
    unit: float

    def step(self, rows: Rows, residual: Vector, pressure: Vector, _: float) -> tuple[Vector, Vector]:
        """Solve theory (V1). Raises SingularModelError."""
        layout, n = self.matrix.layout, len(pressure)
        if n == 0:
            return self._solve(0, True, -residual, None)[0], pressure
        s = saddle(self.unit, self.operator, rows, residual)
        beside = Conditions(spread(s.coupled, layout), spread(s.lower, layout), sp.csr_matrix(s.corner), s.rhs_p)
        solution, q = self._solve(n, s.symmetric, s.rhs_u, beside)
        return solution, s.pressure(q)

    def factorise(self, rows: Rows) -> Solve:
        """As ``abut.linear.saddle_point.factorise``."""
        layout, n = self.matrix.layout, len(rows.residual)
        s = saddle(self.unit, self.operator, rows, np.zeros(self.matrix.shape[0]))
        beside = Conditions(spread(s.coupled, layout), spread(s.lower, layout), sp.csr_matrix(s.corner), s.rhs_p)
        team = self.matrix.team
        team.each(keep_factors, n, s.symmetric, own=[(None if rank else beside,) for rank in range(team.size)])

        def solve(residual: Vector, of_law: Vector) -> tuple[Vector, Vector]:
            s = saddle(self.unit, self.operator, replace(rows, residual=of_law), residual)
            shares = layout.shares(s.rhs_u)
            own = [(share, np.zeros(0) if rank else s.rhs_p) for rank, (share,) in enumerate(shares)]
            solution, q = self._checked(team.each(by_factors, own=own))
            return solution, s.pressure(q)

        return solve

    def respond(self, force: Vector, springs: Vector) -> Vector:
        """Displacements by forces where ``springs`` (n_free,) hold what supports do not."""
        with self.matrix.held(springs):
            return self._solve(0, True, force, None)[0]

    def _solve(self, n: int, symmetric: bool, rhs: Vector, beside: Conditions | None) -> tuple[Vector, Vector]:
        shares = self.matrix.layout.shares(rhs)
        own = [(share, None if rank else beside) for rank, (share,) in enumerate(shares)]
        return self._checked(self.matrix.team.each(factorise, n, symmetric, own=own))

    def _checked(self, answers: list[Answer]) -> tuple[Vector, Vector]:
        if answers[0].memory:
            raise InputError(
                "not enough memory for PETSc's direct solver; take more processes or machines, or a coarser mesh, or, in "
                '3D, law "complementarity" and no equations, which multigrid can solve'
            )
        if not answers[0].error < SINGULAR:
            raise SingularModelError("the equations have no unique solution; check supports, contacts and units")
        return displacement(answers, self.matrix.layout), answers[0].pressure


def prepare_iterative(matrix: Distributed, system: System, motions: Vector, loose: Vector) -> Prepared:
    """motions: (n_free, m) rigid motions of the bodies, which multigrid must reproduce; loose: those that supports leave
    free. Raises InputError for the constraint function, whose rows the preconditioner does not know."""
    smooth = [pair.contact.name for pair in system.pairs if pair.smooth]
    if smooth:
        raise InputError(
            f"multigrid does not know the constraint function of contact '{smooth[0]}'; choose law = "
            '"complementarity", or leave the option -pc_type out'
        )
    kind = matrix.team.each(multigrid, own=matrix.layout.shares(np.linalg.qr(motions)[0]))[0]
    return _iterative(matrix, system, loose, kind, Count())


def _iterative(matrix: Distributed, system: System, loose: Vector, kind: str, count: Count) -> Prepared:
    pressures = pressure_block(system.pairs, system.operator, matrix.diagonal())
    solver = Iterative(matrix, system.operator, pressures, loose, count)
    predict = foresight(lambda: pressures.half_spaces, np.asarray(system.operator @ loose))
    iterative = replace(
        system,
        step=solver.step,
        factorise=None,
        respond=solver.respond,
        exact=False,
        accurate=ACCURATE,
        predict=predict,
    )
    name = f"PETSc Krylov with {kind}"
    return Prepared(
        iterative, lambda outcome, _: outcome, lambda other: _iterative(matrix, other, loose, kind, count), name,
        f"{name}, {_processes(matrix.team)}", count,
    )  # fmt: skip


def prepare_direct(matrix: Distributed, system: System, loose: Vector) -> Prepared:
    """loose: (n_free, m) rigid motions that supports leave free. Raises InputError where PETSc has no solver for several
    processes."""
    name = direct_solver()
    if name == "petsc" and matrix.team.size > 1:
        raise InputError(
            "this PETSc has neither MUMPS nor SuperLU_DIST, so that it factorises on one process only; install one of them"
        )
    solver = Direct(matrix, system.operator, float(np.median(matrix.diagonal())) if matrix.shape[0] else 1.0)
    predict = foresight(lambda: half_spaces(interfaces(system.pairs)), np.asarray(system.operator @ loose))
    direct = replace(system, step=solver.step, factorise=solver.factorise, respond=solver.respond, predict=predict)
    return Prepared(
        direct, lambda outcome, _: outcome, lambda other: prepare_direct(matrix, other, loose),
        f"PETSc direct ({name})", f"PETSc's direct solver {name}, {_processes(matrix.team)}",
    )  # fmt: skip


def wants_factors() -> bool:
    """Whether the user's PETSc options ask for a direct solver."""
    from petsc4py import PETSc

    return str(PETSc.Options().getString("pc_type", "")) in FACTORS


def wants_iterations() -> bool:
    """Whether they ask for another preconditioner, or another Krylov method."""
    from petsc4py import PETSc

    options = PETSc.Options()
    return not wants_factors() and any(options.hasName(name) for name in ("pc_type", "ksp_type", "stiffness_pc_type"))


def spread(rows: Any, layout: Layout) -> Any:
    """Rows (n, n_free) with the columns at their places, (n, n_places)."""
    entries = rows.tocoo()
    shape = rows.shape[0], int(layout.starts[-1])
    return sp.csr_matrix((entries.data, (entries.row, layout.slot[entries.col])), shape=shape)


def displacement(answers: list[Answer], layout: Layout) -> Vector:
    """All free displacements."""
    return layout.values([answer.displacement for answer in answers])


def _processes(team: Team) -> str:
    return "1 process" if team.size == 1 else f"{team.size} processes"

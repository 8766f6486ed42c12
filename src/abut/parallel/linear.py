"""Linear solvers on many processes: the same two ways as on one, by PETSc."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Any

import numpy as np
import scipy.sparse as sp
from numpy.typing import NDArray

from abut.errors import InputError, SingularModelError
from abut.parallel.krylov import FACTORS, Answer, Conditions, direct_solver, factorise, iterate, multigrid
from abut.parallel.matrix import Distributed
from abut.parallel.partition import Layout
from abut.parallel.team import Team
from abut.solvers.active_set import Rows, System
from abut.solvers.blocks import saddle
from abut.solvers.direct import SINGULAR
from abut.solvers.iterative import Count, NotConverged, compliance, pressure_scale
from abut.solvers.linear import Prepared
from abut.solvers.schur import Interface, interfaces, predictor, schur, schur_inverse

ACCURATE = 1e-11  # of equilibrium and of closed gaps: results differ by less than 1e-8 from those of a direct solver
Vector = NDArray[np.float64]


@dataclass(frozen=True)
class Iterative:
    """As ``abut.solvers.iterative.Iterative``, with everything as large as the volume on all processes."""

    matrix: Distributed
    operator: Any
    parts: list[Interface]
    motions: Vector
    scale: float
    count: Count

    def step(self, rows: Rows, residual: Vector, pressure: Vector, accuracy: float) -> tuple[Vector, Vector]:
        """Solve theory (V1), preconditioned by theory (V11), to a residual ``accuracy`` times the present one.

        Raises NotConverged."""
        s, fixed, active = self.scale, rows.fixed, ~rows.decoupled
        operator = self.operator[active]
        inverse = schur_inverse(self.parts, active)
        layout = self.matrix.layout
        small = compliance(operator @ self.motions, inverse) if self.motions.shape[1] else np.zeros((0, 0))
        lower = spread(-s * operator, layout)
        conditions = Conditions(
            lower, lower, None, -s * rows.residual[active], lambda gap: inverse(gap / s) / s if len(gap) else gap
        )
        shares = layout.shares(np.column_stack([-residual + self.operator.T @ fixed, self.motions]))
        answers = self.matrix.team.each(
            iterate, accuracy, operator.shape[0], small,
            own=[(v[:, 0], v[:, 1:], None if rank else conditions) for rank, (v,) in enumerate(shares)],
        )  # fmt: skip
        self.count.iterations += answers[0].iterations
        solution = displacement(answers, layout)
        if answers[0].reason < 0 or not np.isfinite(solution).all():
            raise NotConverged(f"PETSc's iterations do not converge on this model (reason {answers[0].reason})")
        fixed[active] = s * answers[0].pressure
        return solution, fixed


@dataclass(frozen=True)
class Direct:
    """As ``abut.solvers.blocks.newton_step``."""

    matrix: Distributed
    operator: Any
    unit: float

    def step(self, rows: Rows, residual: Vector, pressure: Vector, _: float) -> tuple[Vector, Vector]:
        """Solve theory (V1). Raises SingularModelError."""
        layout, n = self.matrix.layout, len(pressure)
        if n == 0:
            return self._solve(0, True, -residual, None)[0], pressure
        s = saddle(self.unit, self.operator, rows, residual)
        conditions = Conditions(spread(s.coupled, layout), spread(s.lower, layout), sp.csr_matrix(s.corner), s.rhs_p)
        solution, q = self._solve(n, s.symmetric, s.rhs_u, conditions)
        return solution, s.pressure(q)

    def _solve(self, n: int, symmetric: bool, rhs: Vector, conditions: Conditions | None) -> tuple[Vector, Vector]:
        shares = self.matrix.layout.shares(rhs)
        own = [(share, None if rank else conditions) for rank, (share,) in enumerate(shares)]
        answers = self.matrix.team.each(factorise, n, symmetric, own=own)
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
    parts = interfaces(system.pairs)
    solver = Iterative(matrix, system.operator, parts, loose, pressure_scale(system), count)
    predict = predictor(schur(parts), np.asarray(system.operator @ loose))
    iterative = replace(
        system, step=solver.step, factorise=None, softens=False, exact=False, accurate=ACCURATE, predict=predict
    )
    name = f"PETSc Krylov with {kind}"
    return Prepared(
        iterative, lambda outcome, _: outcome, lambda other: _iterative(matrix, other, loose, kind, count), name,
        f"{name}, {_processes(matrix.team)}", count,
    )  # fmt: skip


def prepare_direct(matrix: Distributed, system: System) -> Prepared:
    """Raises InputError where PETSc has no solver for several processes."""
    name = direct_solver()
    if name == "petsc" and matrix.team.size > 1:
        raise InputError(
            "this PETSc has neither MUMPS nor SuperLU_DIST, so that it factorises on one process only; install one of them"
        )
    solver = Direct(matrix, system.operator, float(np.median(matrix.diagonal())) if matrix.shape[0] else 1.0)
    return Prepared(
        replace(system, step=solver.step, factorise=None), lambda outcome, _: outcome,
        lambda other: prepare_direct(matrix, other),
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

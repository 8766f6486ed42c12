"""Factors and the lowest eigenpairs on several processes: MUMPS, and Krylov-Schur iterations of SLEPc."""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np
import scipy.sparse as sp

from abut.errors import ConvergenceError
from abut.modes.factors import Vector, beside
from abut.modes.held import Held
from abut.modes.spectrum import RESTARTS, TOLERANCE, Pairs, Pencil
from abut.parallel.eigen import Task, iterate, keep_apart, negative, solve_apart
from abut.parallel.linear import checked, spread
from abut.parallel.matrix import Distributed
from abut.parallel.systems import Conditions
from abut.parallel.team import Kept, Team


@dataclass(frozen=True)
class FactorsOfTeam:
    """As ``abut.modes.spectrum.Factored``. matrix: (n_free, n_free) symmetric, all of it in PETSc's."""

    matrix: Distributed
    held: Held
    kept: Kept = field(init=False)
    _rows: int = field(init=False)

    def __post_init__(self) -> None:
        matrix, team = self.matrix, self.matrix.team
        scale, below, corner = beside(self.held)
        lower, n = spread(below, matrix.layout), len(scale)
        conditions = Conditions(-1.0 * lower, lower, sp.csr_matrix(corner), np.zeros(n)) if n else None
        kept = team.keep()
        first = [(None if rank else conditions,) for rank in range(team.size)]
        team.each(keep_apart, matrix.kept.number, kept.number, n, per_rank=first)
        object.__setattr__(self, "kept", kept)
        object.__setattr__(self, "_rows", n)

    def solve(self, force: Vector) -> Vector:
        """Solutions of one system, as in ``Factored``. Raises InputError where memory does not suffice, and
        SingularModelError."""
        if not force.any():
            return np.zeros(len(force))
        layout, team = self.matrix.layout, self.matrix.team
        answers = team.each(solve_apart, self.kept.number, self._rows, per_rank=layout.shares(force))
        return checked(answers, layout)[0]

    @property
    def negative(self) -> int | None:
        """How many eigenvalues are negative, as in ``Factored``."""
        count: int | None = self.matrix.team.each(negative, self.kept.number)[0]
        return None if count is None else count - self._rows


@dataclass(frozen=True)
class Together:
    """As ``abut.modes.held.Eigensolver``, on several processes."""

    team: Team

    def factors(self, matrix: Distributed, held: Held) -> FactorsOfTeam:
        """Factors of a symmetric matrix, as in ``Eigensolver``."""
        return FactorsOfTeam(matrix.whole(), held)

    def largest(self, pencil: Pencil, count: int, seed: int = 0) -> Pairs:
        """The largest eigenvalues and their vectors, as in ``Eigensolver``."""
        factors, left, metric = pencil.factors, pencil.left.whole(), pencil.metric.whole()
        assert isinstance(factors, FactorsOfTeam)
        count, basis = pencil.wanted(count)
        task = Task(
            factors.matrix.kept.number, factors.kept.number, left.kept.number, metric.kept.number, pencil.inverts,
            count, basis, TOLERANCE, None if pencil.inverts else RESTARTS,
        )  # fmt: skip
        layout = factors.matrix.layout
        answers = self.team.each(iterate, task, per_rank=layout.shares(pencil.start(seed)))
        values = answers[0].values
        if not len(values) or (pencil.inverts and len(values) < count):
            raise ConvergenceError(
                f"modes: SLEPc's iterations did not converge (reason {answers[0].reason}, {len(values)} of {count} found); "
                "ask for fewer modes"
            )
        vectors = layout.values([answer.vectors for answer in answers])
        return Pairs(1.0 / values if pencil.inverts else values, vectors)

"""Interface of the linear solvers: set up once for matrices that do not change, then used for any number of solutions."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Protocol

import numpy as np
from numpy.typing import NDArray

from abut.problem.linearised import Linearised, Rows
from abut.problem.problem import Problem

ACCURATE = 2e-9  # of equilibrium and of closed gaps, where linear systems are solved iteratively
Vector = NDArray[np.float64]
Solve = Callable[[Vector, Vector], tuple[Vector, Vector]]


class NotConverged(Exception):
    """The linear iteration did not converge; a direct solver may succeed."""


@dataclass
class Count:
    """Linear iterations so far."""

    iterations: int = 0

    @property
    def effort(self) -> str:
        """What is told of its work, as in ``LinearSolver``."""
        return f"{self.iterations} linear iterations in all"


class Prepared(Protocol):
    """A linear solver set up for a linearised problem.

    exact: solutions are exact but for rounding; accurate: of equilibrium and of closed gaps, where they are not.
    """

    @property
    def system(self) -> Linearised: ...

    @property
    def exact(self) -> bool: ...

    @property
    def accurate(self) -> float: ...

    def solve(self, rows: Rows, residual: Vector, pressure: Vector, accuracy: float) -> tuple[Vector, Vector]:
        """(du, dp) of [K, -B^T; r_u, r_p] (du, dp) = -(residual, rows.residual), theory (V1), at the present multipliers
        ``pressure``; the residual reduced by ``accuracy`` or, where ``exact``, to rounding.

        Raises SingularModelError where there is no unique solution, NotConverged where iterations give up."""
        ...

    def factorise(self, rows: Rows) -> Solve | None:
        """The same in two, rows first, then (residual of equilibrium, of the rows) -> (du, dp) as often as wanted; None
        where the solver keeps no factors of them."""
        ...

    def respond(self, force: Vector, springs: Vector) -> Vector:
        """Displacements (n_free,) by forces, where ``springs`` (n_free,) hold what supports do not; roughly, by iterative
        solvers."""
        ...

    def foresee(
        self, gap: Vector, pressure: Vector, active: NDArray[np.bool_], tied: NDArray[np.bool_]
    ) -> NDArray[np.bool_]:
        """A guess at the final active set, from half spaces; ``active``: what the law asks for now."""
        ...


class Transposable(Prepared, Protocol):
    """A solver that solves the transposed system, too: those of one process."""

    def transposed(self, rows: Rows, force: Vector, gap: Vector, accuracy: float) -> tuple[Vector, Vector]:
        """(v, q) of [K, -F^T; r_u, r_p]^T (v, q) = (force, gap), (n_free,) and (n,): the system of ``solve`` transposed, F
        being the forces by multiplier; ``accuracy`` as there.

        With a quantity's derivatives by displacements and multipliers on the right-hand side, v and -q are its derivatives
        by loads and by residuals of the laws (the adjoint). Raises what ``solve`` raises."""
        ...


class LinearSolver(Protocol):
    """name: for the summary; count: iterations of an iterative one, else None."""

    @property
    def name(self) -> str: ...

    @property
    def count(self) -> Count | None: ...

    def condensed(self, problem: Problem) -> Problem:
        """The problem with displacements condensed, where this solver takes that; else the same object."""
        ...

    def prepare(self, system: Linearised, previous: Prepared | None) -> Prepared:
        """Set up; what depends on matrices that are those of ``previous`` is kept. Raises InputError where the solver is not
        installed or cannot serve the system."""
        ...

    def note(self, prepared: Prepared) -> str:
        """For the log, before the first step."""
        ...

    @property
    def effort(self) -> str:
        """For the log, at the end of a run: what all solutions took; empty where there is nothing to tell."""
        ...

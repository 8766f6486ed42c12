"""Linear constraints between unknowns, eliminated exactly: y = Z z + sum of w_h y_h; theory (F11)."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
import scipy.sparse as sp
import scipy.sparse.linalg as spla
from numpy.typing import NDArray

from abut.errors import SingularModelError
from abut.types import Sparse

DEPENDENT = 1e-8  # coefficients over the constraint's own from which on it says something new
CANCELLED = 1e-13  # coefficients over the largest that are what subtractions left
PIVOT = 0.1  # coefficients over the largest among which the pivot may be chosen so that few others change
NAMED = 6  # constraints named in an error
AGREE = 1e-9  # of the values that make it up: what may be missing where constraints repeat each other


@dataclass(frozen=True)
class Expression:
    """One unknown by others: the sum of terms and value (n_histories,); from constraint ``source`` and the unknowns
    ``through`` that were put into it."""

    terms: dict[int, float]
    value: NDArray[np.float64]
    source: int
    through: tuple[int, ...] = ()


@dataclass(frozen=True)
class Eliminated:
    """free (n, n_free) sparse and prescribed (n, n_histories): y = free @ z + prescribed for any z. independent: numbers of
    the constraints that say something new; pivots: the unknown that each of them is solved for."""

    free: Sparse
    prescribed: NDArray[np.float64]
    independent: NDArray[np.int64]
    pivots: NDArray[np.int64]


@dataclass(frozen=True)
class Links:
    """What the forces of equations follow from. outer: (dim n_points, n) the unknowns before equations; matrix: (m, m) the
    coefficients of the m constraints that were eliminated, at the unknowns ``pivots`` they were solved for; equations:
    (m, dim n_points) coefficients on all displacements of those that are equations and support nothing."""

    outer: Sparse
    matrix: Sparse
    pivots: NDArray[np.int64]
    equations: Sparse

    def forces(self, residual: NDArray[np.float64]) -> NDArray[np.float64]:
        """The share of these equations in the forces (dim n_points,) that hold the points."""
        if not len(self.pivots):
            return np.zeros_like(residual)
        multipliers = spla.splu(self.matrix.T.tocsc()).solve((self.outer.T @ residual)[self.pivots])
        return np.asarray(self.equations.T @ multipliers)


def eliminate(rows: Sparse, values: NDArray[np.float64], names: Sequence[str]) -> Eliminated:
    """Solve rows @ y = values by Gaussian elimination, one unknown for each constraint that says something new.

    rows: (m, n) sparse; values: (m, n_histories); names: of each constraint, for errors.
    Raises SingularModelError for constraints that contradict each other; repeated ones do no harm.
    """
    rows = rows.tocsr()
    uses = np.bincount(rows.indices, minlength=rows.shape[1])
    slack = max(1e-12 * np.abs(values).max(initial=0.0), 1e-39)
    solved: dict[int, Expression] = {}
    for i in range(rows.shape[0]):
        entries = slice(rows.indptr[i], rows.indptr[i + 1])
        given = dict(zip(rows.indices[entries].tolist(), rows.data[entries].tolist()))
        row, value, through, size = _substitute(given, values[i], solved)
        scale = max(map(abs, given.values()), default=0.0)
        largest = max(map(abs, row.values()), default=0.0)
        if largest <= DEPENDENT * scale:
            if np.abs(value).max() > max(slack, AGREE * size):
                raise SingularModelError(_contradiction(i, through, solved, names))
            continue
        row = {k: c for k, c in row.items() if abs(c) > CANCELLED * largest}
        pivot = min((k for k, c in row.items() if abs(c) >= PIVOT * largest), key=lambda k: (uses[k], -abs(row[k]), k))
        by = row.pop(pivot)
        solved[pivot] = Expression({k: -c / by for k, c in row.items()}, value / by, i, through)
    free, prescribed = _assemble(solved, rows.shape[1], values.shape[1])
    independent = np.array([expression.source for expression in solved.values()], dtype=np.int64)
    return Eliminated(free, prescribed, independent, np.array(list(solved), dtype=np.int64))


def _substitute(
    given: dict[int, float], value: NDArray[np.float64], solved: dict[int, Expression]
) -> tuple[dict[int, float], NDArray[np.float64], tuple[int, ...], float]:
    """A constraint without the unknowns that are solved for: coefficients, value, what was put in, size of what was added
    up to the value. Expressions hold unknowns solved for later at most, so this ends."""
    row, value, size = dict(given), value.copy(), float(np.abs(value).max(initial=0.0))
    through = []
    pending = [k for k in row if k in solved]
    while pending:
        k = pending.pop()
        factor = row.pop(k, 0.0)
        if factor == 0.0:
            continue
        through.append(k)
        known = solved[k]
        value -= factor * known.value
        size = max(size, abs(factor) * float(np.abs(known.value).max(initial=0.0)))
        for other, coefficient in known.terms.items():
            row[other] = row.get(other, 0.0) + factor * coefficient
            if other in solved:
                pending.append(other)
    return row, value, tuple(through), size


def _assemble(solved: dict[int, Expression], n: int, n_histories: int) -> tuple[Sparse, NDArray[np.float64]]:
    """Back substitution: the last one solved for holds free unknowns only."""
    final: dict[int, tuple[dict[int, float], NDArray[np.float64]]] = {}
    none = np.zeros(n_histories)
    for pivot, expression in reversed(solved.items()):
        terms: dict[int, float] = {}
        value = expression.value.copy()
        for k, coefficient in expression.terms.items():
            inner, constant = final.get(k, ({k: 1.0}, none))
            value += coefficient * constant
            for other, by in inner.items():
                terms[other] = terms.get(other, 0.0) + coefficient * by
        final[pivot] = terms, value
    remain = np.setdiff1d(np.arange(n), np.fromiter(final, dtype=np.int64, count=len(final)))
    column = np.full(n, -1)
    column[remain] = np.arange(len(remain))
    entries = [(pivot, column[k], c) for pivot, (terms, _) in final.items() for k, c in terms.items() if c != 0.0]
    i, j, c = np.array(entries, dtype=float).reshape(-1, 3).T
    free = sp.csr_matrix(
        (
            np.concatenate([np.ones(len(remain)), c]),
            (np.concatenate([remain, i.astype(np.int64)]), np.concatenate([column[remain], j.astype(np.int64)])),
        ),
        shape=(n, len(remain)),
    )
    prescribed = np.zeros((n, n_histories))
    for pivot, (_, value) in final.items():
        prescribed[pivot] = value
    return free, prescribed


def _contradiction(i: int, through: Sequence[int], solved: dict[int, Expression], names: Sequence[str]) -> str:
    """Which constraints take part, found by going back through what was put in."""
    involved, seen, pending = {i}, set(), list(through)
    while pending:
        k = pending.pop()
        if k not in seen:
            seen.add(k)
            involved.add(solved[k].source)
            pending += solved[k].through
    others = list(dict.fromkeys(names[k] for k in sorted(involved)))
    if len(others) == 1:
        return f"{others[0]} contradicts what is prescribed at its points: no displacement meets both; take one of them out"
    return f"{_listed(others)} contradict each other: no displacement meets all; take one of them out"


def contradiction_at_node(names: Sequence[str], where: str) -> SingularModelError:
    """Of supports that give a node different displacements in one direction. names: of each, alike where they are on one
    group."""
    what, known = "different displacements in one direction", sorted(set(names))
    if len(names) == 1:
        return SingularModelError(f"{names[0]} contradicts itself {where}: it prescribes {what}; leave out a component")
    who = _listed(known) if len(known) > 1 else known[0].replace("support", "supports", 1)
    return SingularModelError(f"{who} contradict each other {where}: they prescribe {what}; take one of them out")


def _listed(names: Sequence[str]) -> str:
    """Two or more names in a sentence."""
    if len(names) > NAMED:
        names = [*names[:NAMED], f"{len(names) - NAMED} more"]
    return f"{', '.join(names[:-1])} and {names[-1]}"


def row_products(free: Sparse, rows: NDArray[np.int64]) -> NDArray[np.float64]:
    """Products of the rows (n, dim) of each point with each other, (n, dim, dim)."""
    count = free.indptr[rows + 1] - free.indptr[rows]
    if free.nnz and count.max(initial=0) <= 1:  # supports along the axes
        at = np.minimum(free.indptr[rows], free.nnz - 1)
        column, value = np.where(count, free.indices[at], -1), np.where(count, free.data[at], 0.0)
        return np.where(column[:, :, None] == column[:, None], value[:, :, None] * value[:, None], 0.0)
    parts = [free[rows[:, a]] for a in range(rows.shape[1])]
    return np.array([[np.asarray(p.multiply(q).sum(axis=1)).ravel() for q in parts] for p in parts]).transpose(2, 0, 1)

"""Contact laws as rows of the linear system: at the multipliers, or in the mean over integration points."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
import scipy.sparse as sp
from numpy.typing import NDArray

from abut.contact.laws import Law, LawResult, LawState
from abut.errors import InputError
from abut.problem.pair import Pair, PairPoints
from abut.types import Sparse

Vector = NDArray[np.float64]
SOFT = 1e-6  # over weight h / E: how far jumps, and repeated gaps, give way to their tractions within one iteration
FAINT = 1e-12  # of a jump over what its traction gives way: a row that hardly sees it holds the traction alone


@dataclass(frozen=True)
class LawRows:
    """A law near the present state, for one pair, in its n multipliers.

    residual: (n,); closed: (n,) bool, multipliers in contact; by_gap: (n, n_gaps) sparse, derivative by the gaps that the
    law looks at; by_pressure: (n, n) sparse, derivative by the multipliers. at_points: the gaps are those at the
    integration points, else the n weighted ones; decoupled: (n,) bool, rows that hold nothing but their own multiplier;
    symmetric: all others look at minus their own weighted gap, and give way under their own multiplier.
    """

    residual: Vector
    closed: NDArray[np.bool_]
    by_gap: Sparse
    by_pressure: Sparse
    at_points: bool
    decoupled: NDArray[np.bool_]
    symmetric: bool = True


def at_multipliers(
    pair: Pair,
    law: Law,
    gap: Vector,
    multipliers: Vector,
    closed: NDArray[np.bool_],
    slipping: NDArray[np.bool_] | None = None,
) -> LawRows:
    """Rows of a law at each multiplier. gap: (n,) weighted; its mean under the multiplier's function is the jump; closed,
    slipping: (n,) status, the latter with friction.

    Normal laws are divided by minus their derivative by the gap, so that every linear solver meets rows of one kind. Raises
    InputError for a user's law that returns arrays of other shapes than it should."""
    where, weight = pair.index, pair.weight
    there = where >= 0
    mean = np.zeros(len(pair)) if not len(pair) else gap / weight
    state = LawState(_status(closed, where), slipping=None if slipping is None else _status(slipping, where))
    result = _checked(law.evaluate(_spread(mean, where), _spread(multipliers, where), state), where.shape, pair)
    n = len(pair)
    residual = np.zeros(n)
    residual[where[there]] = result.residual[there]
    if where.shape[1] == 1:
        by_gap, by_pressure, residual = _normalised(result, where[:, 0], residual, weight, pair.stiffness)
    else:
        by_gap, of_traction = (_matrix(blocks, where, n) for blocks in (result.by_jump, result.by_traction))
        by_pressure = (sp.diags(weight) @ of_traction).tocsr()
    decoupled = np.diff(by_gap.indptr) == 0
    plain = (by_gap.diagonal() == -1.0) & (by_pressure.diagonal() <= 0.0)
    shut = np.zeros(n, dtype=bool)
    shut[where[there]] = np.broadcast_to(result.closed[:, None], where.shape)[there]
    return LawRows(
        weight * residual, shut, by_gap, by_pressure, False, decoupled,
        bool(plain[~decoupled].all()),
    )  # fmt: skip


def in_the_mean(points: PairPoints, law: Law, gap: Vector, multipliers: Vector) -> LawRows:
    """Rows of a law that holds at integration points in the mean under every multiplier's function: int H_k r = 0.

    gap: (n_points,)."""
    n = len(multipliers)
    pressure = points.test @ multipliers
    none = LawState(np.zeros(len(gap), dtype=bool))
    result: LawResult = law.evaluate(gap[:, None], pressure[:, None], none)
    weighted = (points.test.T @ sp.diags(points.weight)).tocsr()
    return LawRows(
        residual=weighted @ result.residual[:, 0],
        closed=np.asarray(weighted @ (result.closed - 0.5)) > 0.0,
        by_gap=(weighted @ sp.diags(result.by_jump[:, 0, 0])).tocsr(),
        by_pressure=(weighted @ sp.diags(result.by_traction[:, 0, 0]) @ points.test).tocsr(),
        at_points=True,
        decoupled=np.zeros(n, dtype=bool),
        symmetric=False,
    )


def giving(pair: Pair, law: LawRows) -> LawRows:
    """A law for one iteration, in which jumps that the target alone sees give way to a change of their tractions: what more
    functions hold than it has nodes is unique then, theory (R20). Residuals stay as they are, and with them the solution."""
    if pair.carried is None or not pair.carried.any():
        return law
    soft = sp.diags(np.where(pair.carried, SOFT * pair.scale, 0.0))
    return replace(law, by_pressure=(law.by_pressure + law.by_gap @ soft).tocsr())


def _checked(result: LawResult, shape: tuple[int, ...], pair: Pair) -> LawResult:
    n, c = shape
    for name, expected in (("residual", (n, c)), ("by_jump", (n, c, c)), ("by_traction", (n, c, c)), ("closed", (n,))):
        found = np.shape(getattr(result, name))
        if found != expected:
            raise InputError(
                f"contact '{pair.contact.name}': law: evaluate returned {name} of shape {found}, expected {expected}"
            )
    return result


def _spread(values: Vector, where: NDArray[np.int64]) -> Vector:
    """Values of multipliers by function and component, zero where there is no multiplier."""
    return np.where(where >= 0, values[np.maximum(where, 0)], 0.0) if len(values) else np.zeros(where.shape)


def _status(closed: NDArray[np.bool_], where: NDArray[np.int64]) -> NDArray[np.bool_]:
    first = where.max(axis=1, initial=-1)
    return np.where(first >= 0, closed[np.maximum(first, 0)], False) if len(closed) else np.zeros(len(where), bool)


def _matrix(blocks: Vector, where: NDArray[np.int64], n: int) -> sp.csr_matrix:
    row = np.broadcast_to(where[:, :, None], blocks.shape)
    column = np.broadcast_to(where[:, None, :], blocks.shape)
    keep = (row >= 0) & (column >= 0) & (blocks != 0.0)
    return sp.csr_matrix((blocks[keep], (row[keep], column[keep])), shape=(n, n))


def _diagonal(values: Vector) -> sp.csr_matrix:
    """Without what is zero."""
    (kept,) = np.nonzero(values)
    start = np.searchsorted(kept, np.arange(len(values) + 1))
    return sp.csr_matrix((values[kept], kept, start), shape=(len(values),) * 2)


def _normalised(
    result: LawResult, where: NDArray[np.int64], residual: Vector, weight: Vector, stiffness: float
) -> tuple[Sparse, Sparse, Vector]:
    """Rows of a normal law divided by minus their derivative by the gap; those that hardly look at it do not at all."""
    slope, give = np.zeros(len(residual)), np.zeros(len(residual))
    there = where >= 0
    slope[where[there]], give[where[there]] = result.by_jump[there, 0, 0], result.by_traction[there, 0, 0]
    sees = np.abs(slope) > FAINT * np.abs(give) * stiffness
    by = np.where(sees, -1.0 / np.where(sees, slope, 1.0), 1.0)
    return _diagonal(np.where(sees, -1.0, 0.0)), _diagonal(weight * (by * give)), by * residual

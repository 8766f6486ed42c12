"""Rows of Coulomb's law with slip eliminated: what slips knows its traction from the pressure, and its row from the gap's.

In the row of a function that slips, theory (V23), the gap is that of its normal row: subtracted, what is left along the slip
holds multipliers alone, and across it a spring. Pressures, tractions of what sticks and those across the slip remain.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
import scipy.sparse as sp
from numpy.typing import NDArray

from abut.problem.linearised import Rows
from abut.problem.pair import Pair
from abut.types import Sparse

STRAIGHT = 1e-9  # how much of a turn of the slip its row may see and count as none
Vector = NDArray[np.float64]


@dataclass(frozen=True)
class Reduced:
    """The rows as residual - pull dg + corner q = 0 in m unknowns q, dp = fixed + push^T q, dg the change of the n weighted
    gaps. push, pull: (m, n), corner: (m, m), sparse; single: (n,) bool, multipliers that are unknowns by themselves, the
    first ones; ``symmetric``: push is pull, and corner diagonal and negative."""

    residual: Vector
    push: Sparse
    pull: Sparse
    corner: Sparse
    fixed: Vector
    single: NDArray[np.bool_]
    symmetric: bool


def reduced(rows: Rows, pairs: Sequence[Pair]) -> Reduced | None:
    """Rows at the multipliers, of complementarity, ties and Coulomb's law; None of any other."""
    by_gap, by_multiplier = rows.by_gap, rows.by_multiplier
    if by_gap is None or by_multiplier is None:
        return None
    found, first = [], 0
    for pair in pairs:
        if pair.frictional:
            found.append(_slips(rows, by_gap, by_multiplier, np.where(pair.index >= 0, pair.index + first, -1)))
        first += len(pair)
    n, coupled = len(rows.residual), ~rows.decoupled
    slips = _joined(found) if found else None
    if slips is not None:
        coupled[slips.number[slips.number >= 0]] = False
    plain, corner = np.flatnonzero(coupled), by_multiplier[coupled][:, coupled]
    if (by_gap.diagonal()[coupled] != -1.0).any():
        return None
    if slips is None:
        select = sp.identity(n, format="csr")[coupled]
        there = np.ones(len(plain), dtype=bool)
        residual = rows.residual[coupled]
        return Reduced(residual, select, select, corner, rows.fixed, there, _negative_diagonal(corner))
    m, across = len(plain), slips.across
    place = np.cumsum(coupled) - 1
    fixed = rows.fixed
    fixed[slips.number[slips.there]] = slips.known[slips.there]
    dragged = _entries(place[slips.normal], slips.number, slips.drag, (m, n))
    select = sp.csr_matrix((np.ones(m), (np.arange(m), plain)), shape=(m, n))
    turned = _entries(np.arange(len(across.row)), slips.number[across.row], across.direction, (len(across.row), n))
    pull = sp.vstack([select, turned]).tocsr()
    return Reduced(
        residual=np.concatenate([rows.residual[plain], across.residual]),
        push=sp.vstack([select + dragged, turned]).tocsr(),
        pull=pull,
        corner=sp.block_diag([corner, sp.diags(-across.soft)], format="csr"),
        fixed=fixed,
        single=coupled,
        symmetric=dragged.nnz == 0 and _negative_diagonal(corner),
    )


@dataclass(frozen=True)
class _Across:
    """Springs across the slip. row: (k,) of which slip; direction: (k, c - 1) along its tangents; residual, soft: (k,)."""

    row: NDArray[np.int64]
    direction: Vector
    residual: Vector
    soft: Vector


@dataclass(frozen=True)
class _Slips:
    """Functions that slip. normal: (k,) numbers of the pressures; number: (k, c - 1) of the tractions, -1 for none; drag:
    (k, c - 1) traction by pressure; known: (k, c - 1) traction that does not depend on it."""

    normal: NDArray[np.int64]
    number: NDArray[np.int64]
    drag: Vector
    known: Vector
    across: _Across

    @property
    def there(self) -> NDArray[np.bool_]:
        return self.number >= 0


def _slips(rows: Rows, by_gap: Sparse, by_multiplier: Sparse, index: NDArray[np.int64]) -> _Slips:
    """index: (n_functions, c) numbers of a pair's multipliers."""
    gaps, tractions = _blocks(by_gap, index), _blocks(by_multiplier, index)
    tangents = np.eye(index.shape[1])[1:]
    sticks = (gaps[:, 1:] == -tangents).all(axis=2) | (gaps[:, 1:] == 0.0).all(axis=2)
    slips = ~(sticks | (index[:, 1:] < 0)).all(axis=1)
    index, gaps, tractions = index[slips], gaps[slips], tractions[slips]
    number, there = index[:, 1:], index[:, 1:] >= 0
    residual = np.where(index >= 0, rows.residual[np.maximum(index, 0)], 0.0)
    left = residual[:, 1:] + gaps[:, 1:, 0] * residual[:, :1]  # the normal row's share of the gap taken off
    seen, main = np.linalg.eigh(gaps[:, 1:, 1:])
    main = np.where(there[:, :, None], main, 0.0)
    give = np.einsum("kai,kab,kbi->ki", main, tractions[:, 1:, 1:], main)
    along = (seen > -STRAIGHT) & (give < 0.0)
    by = np.where(along, give, -1.0)
    known = np.where(along, -np.einsum("kai,ka->ki", main, left) / by, 0.0)
    drag = np.where(along, -np.einsum("kai,ka->ki", main, tractions[:, 1:, 0]) / by, 0.0)
    row, i = np.nonzero((seen <= -STRAIGHT) & (np.abs(main).max(axis=1) > 0.0))
    yields = -seen[row, i]
    turned = np.einsum("ka,ka->k", main[row, :, i], left[row]) / yields
    across = _Across(row, main[row, :, i], turned, np.maximum(-give[row, i], 0.0) / yields)
    known, drag = (np.einsum("kai,ki->ka", main, values) for values in (known, drag))
    return _Slips(index[:, 0], number, drag, known, across)


def _blocks(matrix: Sparse, index: NDArray[np.int64]) -> Vector:
    """The entries (n_functions, c, c) of each function's multipliers with each other; zero where there is none."""
    row = np.broadcast_to(index[:, :, None], (*index.shape, index.shape[1]))
    column = np.broadcast_to(index[:, None, :], row.shape)
    there = (row >= 0) & (column >= 0)
    result = np.zeros(row.shape)
    result[there] = np.asarray(matrix[row[there], column[there]]).ravel()
    return result


def _negative_diagonal(matrix: Sparse) -> bool:
    diagonal = matrix.diagonal()
    return np.count_nonzero(matrix.data) == np.count_nonzero(diagonal) and bool((diagonal <= 0.0).all())


def _entries(
    row: NDArray[np.int64], columns: NDArray[np.int64], values: Vector, shape: tuple[int, int]
) -> sp.csr_matrix:
    """A matrix with values (k, c) at columns (k, c) of rows (k,); columns of -1 are left out."""
    there = (columns >= 0) & (values != 0.0)
    rows = np.broadcast_to(row[:, None], columns.shape)[there]
    return sp.csr_matrix((values[there], (rows, columns[there])), shape=shape)


def _joined(parts: Sequence[_Slips]) -> _Slips:
    """Of all pairs, which have as many components each."""

    def stack(values: Iterable[NDArray[Any]]) -> NDArray[Any]:
        return np.concatenate(list(values))

    starts = np.cumsum([0, *(len(part.normal) for part in parts)])[:-1]
    across = [part.across for part in parts]
    return _Slips(
        normal=stack(part.normal for part in parts),
        number=stack(part.number for part in parts),
        drag=stack(part.drag for part in parts),
        known=stack(part.known for part in parts),
        across=_Across(
            row=stack(each.row + start for each, start in zip(across, starts)),
            direction=stack(each.direction for each in across),
            residual=stack(each.residual for each in across),
            soft=stack(each.soft for each in across),
        ),
    )

"""What pressures do to gaps, approximately: a preconditioner for B K^-1 B^T, theory (V13).

A half space under a pressure cos(k x) yields 2 (1 - nu^2) / (E k) of it, so that the operator behaves as the inverse root of
the surface Laplacian: S = kappa M (M^-1 (L + M / l^2))^-1/2 with kappa = 2 sum (1 - nu^2) / E over both sides and l the size
of the contact, beyond which bodies are no half spaces. Its inverse needs nothing but sparse solutions on the interface.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import cache
from typing import Any

import numpy as np
import scipy.sparse as sp
import scipy.sparse.linalg as spla
from numpy.typing import NDArray

from abut.contact.geometry import facet_stiffness
from abut.linear.fractional import inverse_root
from abut.problem.contact_pairs import Pair

CONTINUOUS = ("P1", "P2", "dual", "dual-P1")
ACCURACY = 1e-2
SOFT_ACCURACY, SOFT_ITERATIONS = 0.1, 30
PREDICTIONS = 15  # active sets tried on the interface alone
Predict = Callable[[NDArray[np.float64], NDArray[np.float64], NDArray[np.bool_], NDArray[np.bool_]], NDArray[np.bool_]]
Apply = Callable[[NDArray[np.float64]], NDArray[np.float64]]


@dataclass(frozen=True)
class Interface:
    """One pair (or one component of a tied one): its rows in the system, L + M / l^2 and M of ordinary functions, what these
    integrate to against its own, C = int psi_k N_l (of a dual space diagonal, of ordinary functions M itself), kappa and
    1 / l^2."""

    rows: NDArray[np.int64]
    full: Any
    mass: Any
    coupled: Any
    compliance: float
    lowest: float


def interfaces(pairs: Sequence[Pair]) -> list[Interface]:
    """Everything about the interfaces that stays the same over all active sets."""
    result, first = [], 0
    for pair in pairs:
        component = pair.space.node if pair.tied else np.zeros(len(pair), dtype=np.int64)
        for a in np.unique(component):
            own = np.flatnonzero(component == a)
            result.append(_interface(pair, own, first + own))
        first += len(pair)
    return result


def _interface(pair: Pair, own: NDArray[np.int64], rows: NDArray[np.int64]) -> Interface:
    """own: (m,) the coefficients of the pair's space that it is about."""
    space = pair.space
    extent = float(np.ptp(pair.contactor.points[pair.contactor.node_ids], axis=0).max())
    lowest = (2.0 / extent) ** 2
    if space.name not in CONTINUOUS or not pair.coupling.mass.any():
        # No Laplacian across jumps: lumped, with the compliance of the shortest waves.
        mass = sp.diags(space.weight[own], format="csr")
        return Interface(rows, (np.pi / pair.size) ** 2 * mass, mass, mass, pair.compliance, (np.pi / pair.size) ** 2)
    transfer, plain = space.transfer.tocsc()[:, own], space.plain.tocsc()[:, own]
    products = sp.block_diag(list(pair.coupling.mass), format="csr")
    mass = (plain.T @ products @ plain).tocsr()
    coupled = mass if space.ordinary else (transfer.T @ products @ plain).tocsr()
    slopes = sp.block_diag(list(facet_stiffness(pair.contactor, pair.coupling.degree)), format="csr")
    laplacian = (plain.T @ slopes @ plain).tocsr()
    return Interface(rows, (laplacian + lowest * mass).tocsr(), mass, coupled, pair.compliance, lowest)


def schur_inverse(parts: Sequence[Interface], active: NDArray[np.bool_]) -> Apply:
    """The inverse of S on the active rows, (n_active,) -> (n_active,)."""
    position = np.cumsum(active) - 1
    blocks = []
    for part in parts:
        own = np.flatnonzero(active[part.rows])
        if len(own):
            blocks.append((position[part.rows[own]], _inverse(part, own)))

    def apply(gap: NDArray[np.float64]) -> NDArray[np.float64]:
        pressure = np.zeros_like(gap)
        for where, solve in blocks:
            pressure[where] = solve(gap[where])
        return pressure

    return apply


def schur(parts: Sequence[Interface]) -> Apply:
    """S on all rows, (n,) pressures -> (n,) gaps."""

    @cache  # not before it is needed: what is closed all over has no next active set
    def factorised() -> list[tuple[NDArray[np.int64], Apply]]:
        return [(part.rows, _forward(part)) for part in parts]

    def forward(pressure: NDArray[np.float64]) -> NDArray[np.float64]:
        gap = np.zeros_like(pressure)
        for rows, apply in factorised():
            gap[rows] = apply(pressure[rows])
        return gap

    return forward


def schur_diagonal(parts: Sequence[Interface], n: int) -> NDArray[np.float64]:
    """The size of S's diagonal, (n,): M and L row by row."""
    result = np.zeros(n)
    for part in parts:
        full, mass = part.full.diagonal(), part.mass.diagonal()
        own = part.coupled.diagonal() ** 2 / mass
        result[part.rows] = part.compliance * own * np.sqrt(mass / full)
    return result


def soft_inverse(forward: Apply, diagonal: NDArray[np.float64], softness: NDArray[np.float64]) -> Apply:
    """The inverse of S + softness, (n,) -> (n,), by conjugate gradients to ``SOFT_ACCURACY``."""
    n = len(softness)
    whole = spla.LinearOperator((n, n), matvec=lambda p: forward(p) + softness * p, dtype=float)
    jacobi = spla.LinearOperator((n, n), matvec=lambda g: g / (diagonal + softness), dtype=float)

    def apply(gap: NDArray[np.float64]) -> NDArray[np.float64]:
        if not gap.any():
            return np.zeros(n)
        return np.asarray(spla.cg(whole, gap, rtol=SOFT_ACCURACY, maxiter=SOFT_ITERATIONS, M=jacobi)[0])

    return apply


@dataclass(frozen=True)
class PressureBlock:
    """What preconditions pressures. forward, diagonal: of S on all rows; scale: of pressures, theory (V2); unit: size of the
    stiffness' entries."""

    parts: Sequence[Interface]
    forward: Apply
    diagonal: NDArray[np.float64]
    scale: float
    unit: float


def pressure_block(pairs: Sequence[Pair], operator: Any, diagonal: NDArray[np.float64]) -> PressureBlock:
    """operator: (n, n_free) of all pairs; diagonal: (n_free,) of the stiffness."""
    parts, unit = interfaces(pairs), float(np.median(diagonal))
    own = schur_diagonal(parts, operator.shape[0])
    return PressureBlock(parts, schur(parts), own, pressure_scale(operator, unit), unit)


def pressure_scale(operator: Any, unit: float) -> float:
    """What pressures are divided by, so that rows of the stiffness and of the operator are of one size; theory (V2)."""
    rows = np.flatnonzero(np.diff(operator.indptr))
    largest = np.maximum.reduceat(np.abs(operator.data), operator.indptr[rows]) if len(rows) else np.zeros(0)
    return float(unit / np.median(largest)) if len(largest) else 1.0


def predictor(forward: Apply, moved: NDArray[np.float64]) -> Predict:
    """A guess at the next active set: contact of half spaces, g = g0 + S (p - p0) + C a, solved on the interface alone.

    forward: S; moved: (n, m) change of the weighted gaps by rigid motions that supports leave free (C), which the
    pressures keep in balance. The function takes gap g0, pressure p0, a first active set, the rows that are never open."""

    def predict(
        gap: NDArray[np.float64], pressure: NDArray[np.float64], active: NDArray[np.bool_], tied: NDArray[np.bool_]
    ) -> NDArray[np.bool_]:
        rest = gap - forward(np.where(tied, 0.0, pressure))
        for _ in range(PREDICTIONS):
            own = np.flatnonzero(active & ~tied)
            if not len(own):
                return active
            p, shift = _balanced(forward, rest, moved, moved.T @ np.where(tied, 0.0, pressure), own)
            g = rest + forward(p) + moved @ shift
            following = np.where(active, p > 0.0, g < 0.0) | tied
            if (following == active).all() or not following[~tied].any():
                return active
            active = following
        return active

    return predict


def foresight(pairs: Sequence[Pair], moved: NDArray[np.float64]) -> Predict:
    """``predictor`` of the pairs' own half spaces, set up when it is first asked."""

    @cache
    def ready() -> Predict:
        return predictor(schur(interfaces(pairs)), moved)

    return lambda *state: ready()(*state)


def _balanced(
    forward: Apply, rest: NDArray[np.float64], moved: NDArray[np.float64], force: NDArray[np.float64],
    own: NDArray[np.int64],
) -> tuple[NDArray[np.float64], NDArray[np.float64]]:  # fmt: skip
    """Pressures on the rows ``own`` that close the gap there, with the resultants ``force`` on loose bodies."""

    def restricted(values: NDArray[np.float64]) -> NDArray[np.float64]:
        whole = np.zeros_like(rest)
        whole[own] = values
        return forward(whole)[own]

    operator = spla.LinearOperator((len(own), len(own)), matvec=restricted, dtype=float)

    def solve(rhs: NDArray[np.float64]) -> NDArray[np.float64]:
        return np.asarray(spla.cg(operator, rhs, rtol=ACCURACY, maxiter=200)[0])

    pressure = np.zeros_like(rest)
    closing = solve(-rest[own])
    if not moved.shape[1]:
        pressure[own] = closing
        return pressure, np.zeros(0)
    answers = np.column_stack([solve(column) for column in moved[own].T])
    shift = np.linalg.lstsq(moved[own].T @ answers, moved[own].T @ closing - force, rcond=1e-9)[0]
    pressure[own] = closing - answers @ shift
    return pressure, np.asarray(shift)


def _forward(part: Interface) -> Apply:
    shifts, weights = _resolvents(part.full, part.mass, part.lowest)
    solves = [spla.splu((part.full + s * part.mass).tocsc()).solve for s in shifts]

    def apply(pressure: NDArray[np.float64]) -> NDArray[np.float64]:
        spread = part.coupled @ pressure
        return np.asarray(
            part.compliance * (part.coupled @ sum(w * solve(spread) for w, solve in zip(weights, solves)))
        )

    return apply


def _resolvents(full: Any, mass: Any, lowest: float) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    rows = np.asarray(abs(mass).sum(axis=1)).ravel()
    largest = 10.0 * max(float((np.asarray(abs(full).sum(axis=1)).ravel() / rows).max()), lowest)
    return inverse_root(lowest, largest, ACCURACY)


def _inverse(part: Interface, own: NDArray[np.int64]) -> Apply:
    full, mass = part.full[own][:, own], part.mass[own][:, own]
    shifts, weights = _resolvents(full, mass, part.lowest)
    solves = [spla.splu((full + s * mass).tocsc()).solve for s in shifts]
    undo = spla.splu(part.coupled[own][:, own].tocsc()).solve
    ordinary = part.coupled is part.mass

    def apply(gap: NDArray[np.float64]) -> NDArray[np.float64]:
        weighted = gap if ordinary else mass @ undo(gap)
        rooted = sum(w * solve(weighted) for w, solve in zip(weights, solves))
        return np.asarray(undo(full @ rooted) / part.compliance)

    return apply

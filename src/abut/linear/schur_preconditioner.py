"""Approximate Schur complement B K^-1 B^T (half-space compliance), a preconditioner for the pressures; theory (V13).

The surface of a half space under a pressure cos(k x) is displaced by 2 (1 - nu^2) / (E k) of it, so that the operator
behaves as the inverse root of the surface Laplacian: S = kappa M (M^-1 (L + M / l^2))^-1/2 with kappa = 2 sum (1 - nu^2) / E
over both sides and l the size of the contact, beyond which bodies do not behave as half spaces. Its inverse needs sparse
solutions on the interface only.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np
import scipy.sparse as sp
import scipy.sparse.linalg as spla
from numpy.typing import NDArray

from abut.contact.geometry import facet_stiffness
from abut.contact.pressure_space import PressureSpace
from abut.linear.fractional import inverse_root
from abut.problem.pair import Pair
from abut.types import Sparse

CONTINUOUS = ("P1", "P2", "dual", "dual-P1")
ACCURACY = 1e-2
ALONG = 1.2  # compliance along a half space's surface over that across, theory (V25), in the mean of directions
SOFT_ACCURACY, SOFT_ITERATIONS = 0.1, 30
Apply = Callable[[NDArray[np.float64]], NDArray[np.float64]]


@dataclass(frozen=True)
class Interface:
    """One pair's pressures, or its tractions (of a tied one those along one axis): their rows in the system, L + M / l^2 and
    M of ordinary functions, what these integrate to against its own, C = int psi_k N_l (of a dual space diagonal, of
    ordinary functions M itself), kappa, 1 / l^2."""

    rows: NDArray[np.int64]
    full: Sparse
    mass: Sparse
    coupled: Sparse
    compliance: float
    lowest: float


def interfaces(pairs: Sequence[Pair]) -> list[Interface]:
    """Everything about the interfaces that stays the same over all active sets."""
    result, first = [], 0
    for pair in pairs:
        spaces, start = (pair.space,) if pair.frictional else pair.components, first
        for space in spaces:
            if len(space):
                result.append(_interface(pair, space, start + np.arange(len(space))))
            start += len(space)
        first += len(pair)
        if first > start:
            result.append(_tangential(pair, result[-1], start + np.arange(first - start)))
    return result


def _interface(pair: Pair, space: PressureSpace, rows: NDArray[np.int64]) -> Interface:
    """Of one component of the pair's multipliers."""
    extent = float(np.ptp(pair.contactor.points[pair.contactor.node_ids], axis=0).max())
    lowest = (2.0 / extent) ** 2
    if space.name not in CONTINUOUS or not pair.coupling.mass.any():
        # No Laplacian across jumps: lumped, with the compliance of the shortest waves.
        mass = sp.diags(np.where(space.weight > 0.0, space.weight, _typical(space.weight)), format="csr")
        return Interface(rows, (np.pi / pair.size) ** 2 * mass, mass, mass, pair.compliance, (np.pi / pair.size) ** 2)
    transfer, plain = space.transfer, space.plain
    products = sp.block_diag(list(pair.coupling.mass), format="csr")
    mass, alone = _with_idle((plain.T @ products @ plain).tocsr())
    coupled = mass if space.ordinary else (transfer.T @ products @ plain + alone).tocsr()
    slopes = sp.block_diag(list(facet_stiffness(pair.contactor, pair.coupling.degree)), format="csr")
    laplacian = (plain.T @ slopes @ plain).tocsr()
    return Interface(rows, (laplacian + lowest * mass).tocsr(), mass, coupled, pair.compliance, lowest)


def _with_idle(mass: Sparse) -> tuple[Sparse, Sparse]:
    """M where functions without a place on the surface (those that follow others) stand by themselves, as large as others;
    and what that adds."""
    diagonal = mass.diagonal()
    alone = sp.diags(np.where(diagonal > 0.0, 0.0, _typical(diagonal)), format="csr")
    return (mass + alone).tocsr(), alone


def _typical(weights: NDArray[np.float64]) -> float:
    """The median of those that are not zero, else 1."""
    return float(np.median(weights[weights > 0.0])) if (weights > 0.0).any() else 1.0


def _tangential(pair: Pair, normal: Interface, rows: NDArray[np.int64]) -> Interface:
    """Of tractions, as vectors: tangents of neighbouring functions may point anywhere on the surface. normal: of the pair's
    pressures."""
    assert pair.slip is not None
    there = pair.index[:, 1:] >= 0
    column = pair.index[:, 1:][there] - len(pair.space)
    shape = len(pair.space), len(rows)
    axes = [
        sp.csr_matrix((along[there], (np.nonzero(there)[0], column)), shape=shape)
        for along in np.moveaxis(pair.slip.tangents, 2, 0)
    ]

    def vectors(matrix: Sparse) -> Sparse:
        return sum(axis.T @ matrix @ axis for axis in axes).tocsr()

    mass = vectors(normal.mass)
    coupled = mass if normal.coupled is normal.mass else vectors(normal.coupled)
    return replace(
        normal, rows=rows, full=vectors(normal.full), mass=mass, coupled=coupled, compliance=ALONG * normal.compliance
    )


def schur_inverse(parts: Sequence[Interface], rows: Sparse) -> Apply:
    """The inverse of R S R^T, (m,) -> (m,). rows R: (m, n) sparse, each row in multipliers of one part alone; those without
    entries are left at zero."""
    blocks = []
    for part in parts:
        mine = rows[:, part.rows]
        here = np.flatnonzero(np.diff(mine.indptr))
        if len(here):
            blocks.append((here, _inverse(part, mine[here])))

    def apply(gap: NDArray[np.float64]) -> NDArray[np.float64]:
        pressure = np.zeros_like(gap)
        for where, solve in blocks:
            pressure[where] = solve(gap[where])
        return pressure

    return apply


def selection(chosen: NDArray[np.bool_]) -> Sparse:
    """(n_chosen, n): picks what is chosen of n."""
    return sp.identity(len(chosen), format="csr")[chosen]


@dataclass(frozen=True)
class HalfSpaces:
    """S of all interfaces at once: work goes with their size, however many they are.

    rows: (n,) where the matrices full, mass and coupled of ``Interface`` lie in the system; compliance: (n,); resolvents:
    (full + s mass)^-1, each with its weight w, (n,), s and w each interface's own; size: (n,) root of S's diagonal, by which
    pressures are multiplied and gaps divided to compare rows."""

    rows: NDArray[np.int64]
    full: Sparse
    mass: Sparse
    coupled: Sparse
    compliance: NDArray[np.float64]
    resolvents: Sequence[tuple[NDArray[np.float64], Apply]]
    uncouple: Apply
    size: NDArray[np.float64]

    def forward(self, pressure: NDArray[np.float64]) -> NDArray[np.float64]:
        """S, (n,) -> (n,)."""
        gap = np.zeros_like(pressure)
        gap[self.rows] = self.compliance * (self.coupled @ self._root(self.coupled @ pressure[self.rows]))
        return gap

    def inverse(self, gap: NDArray[np.float64]) -> NDArray[np.float64]:
        """S^-1, (n,) -> (n,)."""
        pressure = np.zeros_like(gap)
        rooted = self._root(self.mass @ self.uncouple(gap[self.rows]))
        pressure[self.rows] = self.uncouple(self.full @ rooted) / self.compliance
        return pressure

    def _root(self, values: NDArray[np.float64]) -> NDArray[np.float64]:
        return np.asarray(sum(weight * solve(values) for weight, solve in self.resolvents))


def half_spaces(parts: Sequence[Interface]) -> HalfSpaces:
    """Everything factorised."""
    rows = np.concatenate([part.rows for part in parts])
    full, mass, coupled = (
        sp.block_diag([getattr(part, name) for part in parts], format="csc") for name in ("full", "mass", "coupled")
    )
    # Of each as wide, so that all have as many resolvents.
    spread = max(_largest(part.full, part.mass, part.lowest) / part.lowest for part in parts)
    terms = [inverse_root(part.lowest, spread * part.lowest, ACCURACY) for part in parts]
    sizes = [len(part.rows) for part in parts]
    shifts, weights = (np.repeat(np.stack(values), sizes, axis=0).T for values in zip(*terms))
    resolvents = [(w, spla.splu((full + sp.diags(s) @ mass).tocsc()).solve) for s, w in zip(shifts, weights)]
    compliance = np.repeat([part.compliance for part in parts], sizes)
    size = np.sqrt(schur_diagonal(parts, len(rows)))
    return HalfSpaces(rows, full, mass, coupled, compliance, resolvents, spla.splu(coupled).solve, size)


def schur_diagonal(parts: Sequence[Interface], n: int) -> NDArray[np.float64]:
    """The size of S's diagonal, (n,): M and L row by row."""
    result = np.zeros(n)
    for part in parts:
        full, mass = part.full.diagonal(), part.mass.diagonal()
        diagonal = part.coupled.diagonal() ** 2 / mass
        result[part.rows] = part.compliance * diagonal * np.sqrt(mass / full)
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
    """What preconditions pressures. diagonal: of S on all rows; scale: of pressures, theory (V2); unit: size of the
    stiffness' entries; covered: (n,) share of each function that is opposite the target now, None where the interfaces
    are covered parts themselves."""

    parts: Sequence[Interface]
    diagonal: NDArray[np.float64]
    scale: float
    unit: float
    covered: NDArray[np.float64] | None = None

    @cached_property  # not before it is needed: what is closed all over has no next active set
    def half_spaces(self) -> HalfSpaces:
        return half_spaces(self.parts)

    def forward(self, pressure: NDArray[np.float64]) -> NDArray[np.float64]:
        """S on all rows, (n,) pressures -> (n,) gaps."""
        return self.half_spaces.forward(pressure)


def pressure_block(pairs: Sequence[Pair], operator: Sparse, diagonal: NDArray[np.float64]) -> PressureBlock:
    """operator: (n, n_free) of all pairs; diagonal: (n_free,) of the stiffness."""
    parts, unit = interfaces(pairs), float(np.median(diagonal))
    estimate = schur_diagonal(parts, operator.shape[0])
    return PressureBlock(parts, estimate, pressure_scale(operator, unit), unit)


def pressure_scale(operator: Sparse, unit: float) -> float:
    """What pressures are divided by, so that rows of the stiffness and of the operator are of one size; theory (V2)."""
    rows = np.flatnonzero(np.diff(operator.indptr))
    largest = np.maximum.reduceat(np.abs(operator.data), operator.indptr[rows]) if len(rows) else np.zeros(0)
    return float(unit / np.median(largest)) if len(largest) else 1.0


def _largest(full: Sparse, mass: Sparse, lowest: float) -> float:
    """An upper bound of the pencil's eigenvalues."""
    rows = np.asarray(abs(mass).sum(axis=1)).ravel()
    return 10.0 * max(float((np.asarray(abs(full).sum(axis=1)).ravel() / rows).max()), lowest)


def _inverse(part: Interface, rows: Sparse) -> Apply:
    def seen(matrix: Sparse) -> Sparse:
        return (rows @ matrix @ rows.T).tocsr()

    full, mass = seen(part.full), seen(part.mass)
    shifts, weights = inverse_root(part.lowest, _largest(full, mass, part.lowest), ACCURACY)
    solves = [spla.splu((full + s * mass).tocsc()).solve for s in shifts]
    undo = spla.splu(seen(part.coupled).tocsc()).solve
    ordinary = part.coupled is part.mass

    def apply(gap: NDArray[np.float64]) -> NDArray[np.float64]:
        weighted = gap if ordinary else mass @ undo(gap)
        rooted = full @ sum(w * solve(weighted) for w, solve in zip(weights, solves))
        return np.asarray(undo(rooted) / part.compliance)

    return apply

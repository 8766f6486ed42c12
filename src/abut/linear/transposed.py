"""The transposed of a Newton system, theory (V1), as sensitivities ask for.

With A = [K, -F^T; R_u, R_p], F the forces by multiplier (``Linearised.columns``) and R the rows of the laws, A^T (v, q) =
(force, gap) is

    K^T v + R_u^T q = force,    -F v + R_p^T q = gap.

Rows that are decoupled, which hold their own multiplier alone, have a q that nothing else looks at: it follows at the end.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
import scipy.sparse as sp
import scipy.sparse.linalg as spla

from abut.bordered import widened, with_border
from abut.linear import direct
from abut.linear.krylov import Apply, Vector, fgmres
from abut.linear.schur_preconditioner import PressureBlock
from abut.linear.solver import NotConverged
from abut.problem.linearised import Linearised, Rows
from abut.types import Sparse

ACCURACY, ITERATIONS = 0.1, 30  # of the multipliers' preconditioner
FAINT = 1e-3  # share of the largest, below which how much a row looks at the gap counts as that
FAILED = "multigrid does not converge on the transposed system"


@dataclass(frozen=True)
class Coupled:
    """The part of the transposed system that hangs together: what is not decoupled.

    chosen: (n,) bool, of the multipliers; lower: (m, n_free) R_u; forces: (m, n_free) F; corner: (m, m) R_p."""

    chosen: np.ndarray
    lower: Sparse
    forces: Sparse
    corner: Sparse

    def complete(self, system: Linearised, rows: Rows, displacement: Vector, q: Vector, gap: Vector) -> Vector:
        """(n,) all of q from those of ``chosen``."""
        result, left = np.zeros(len(gap)), ~self.chosen
        result[self.chosen] = q
        rest = gap + system.columns @ displacement - rows.by_pressure.T @ result
        diagonal = rows.by_pressure.diagonal()
        result[left] = np.asarray(rest)[left] / diagonal[left]
        return result


def coupled(system: Linearised, rows: Rows) -> Coupled:
    """That part, of rows in any form."""
    chosen = ~rows.decoupled
    corner = sp.csr_matrix(rows.by_pressure)[chosen][:, chosen]
    lower, forces = (sp.csr_matrix(part)[chosen] for part in (rows.by_displacement, system.columns))
    return Coupled(chosen, lower, forces, corner)


def by_factors(system: Linearised, rows: Rows, force: Vector, gap: Vector) -> tuple[Vector, Vector]:
    """(v, q) by a sparse factorisation. Raises SingularModelError."""
    part, n = coupled(system, rows), len(force)
    stiffness, more = with_border(system.stiffness)
    unit = float(np.median(stiffness.diagonal()))
    by_row = unit / _largest(part.forces)
    by_column = unit / np.maximum(_largest(part.lower), _largest((part.corner @ sp.diags(by_row)).tocsr(), 0.0))
    matrix = sp.bmat(
        [
            [sp.csr_matrix(stiffness).T, (sp.diags(by_column) @ widened(part.lower, more)).T],
            [-sp.diags(by_row) @ widened(part.forces, more), (sp.diags(by_column) @ part.corner @ sp.diags(by_row)).T],
        ],
        format="csr",
    )
    right = np.concatenate([force, np.zeros(more), by_row * gap[part.chosen]])
    x = direct.solve(direct.store_diagonal(matrix), right, symmetric=False)
    return x[:n], part.complete(system, rows, x[:n], by_column * x[n + more :], gap)


def dense_matrix(system: Linearised, part: Coupled) -> np.ndarray:
    """The coupled part of a condensed system, (n + m, n + m)."""
    return np.block([[system.stiffness.T, part.lower.toarray().T], [-part.forces.toarray(), part.corner.toarray().T]])


def by_iterations(
    system: Linearised,
    rows: Rows,
    pressures: PressureBlock,
    cycle: Apply,
    correction: Callable[[Coupled, Apply], Apply],
    right: tuple[Vector, Vector],
    accuracy: float,
    cycles: tuple[int, int],
) -> tuple[Vector, Vector, int]:
    """(v, q) and the iterations by flexible GMRES. cycle: roughly the inverse of the stiffness; correction: of what that
    misses, by the multipliers' preconditioner; right: force and gap; cycles: length and number of those of GMRES.

    Raises NotConverged."""
    (force, gap), part = right, coupled(system, rows)
    n, scale, transposed = len(force), pressures.scale, system.stiffness.T
    inverse = _inverse(rows, part, pressures)
    coarse = correction(part, inverse)

    def multiply(x: Vector) -> Vector:
        v, q = x[:n], scale * x[n:]
        return np.concatenate([transposed @ v + part.lower.T @ q, scale * (part.corner.T @ q - part.forces @ v)])

    def precondition(x: Vector) -> Vector:
        q = inverse(x[n:] / scale)
        r = x[:n] - part.lower.T @ q
        return np.concatenate([cycle(r) + coarse(r), q / scale])

    rhs = np.concatenate([force, scale * gap[part.chosen]])
    x, iterations, done = fgmres(multiply, precondition, rhs, accuracy, *cycles)
    if not done or not np.isfinite(x).all():
        raise NotConverged(FAILED)
    return x[:n], part.complete(system, rows, x[:n], scale * x[n:], gap), iterations


def _inverse(rows: Rows, part: Coupled, pressures: PressureBlock) -> Apply:
    """Roughly that of R_p^T + S G^T, with S of theory (V13) for F K^-T B^T and R_u = G B: by Krylov iterations,
    preconditioned by the blocks that functions make with the diagonal of S in place of S."""
    places, m = np.flatnonzero(part.chosen), int(part.chosen.sum())
    seen = _by_gap(rows, part).T.tocsr()
    share = np.ones(m) if pressures.covered is None else pressures.covered[part.chosen]
    local = part.corner.T + sp.diags(share * pressures.diagonal[part.chosen]) @ seen
    factors = spla.splu(local.tocsc()) if m else None

    def multiply(q: Vector) -> Vector:
        whole = np.zeros(len(part.chosen))
        whole[places] = seen @ q
        return np.asarray(part.corner.T @ q + share * pressures.forward(whole)[places])

    def apply(r: Vector) -> Vector:
        if factors is None or not r.any():
            return np.zeros(m)
        return np.asarray(spla.gmres(whole, r, rtol=ACCURACY, restart=ITERATIONS, maxiter=1, M=first)[0])

    whole = spla.LinearOperator((m, m), matvec=multiply, dtype=float)
    first = None if factors is None else spla.LinearOperator((m, m), matvec=factors.solve, dtype=float)
    return apply


def _by_gap(rows: Rows, part: Coupled) -> Sparse:
    """(m, m) G; of rows that look at points a diagonal, about how much of the operator's row each is, theory (V22)."""
    if rows.by_gap is not None:
        return sp.csr_matrix(rows.by_gap)[part.chosen][:, part.chosen]
    size = np.asarray(part.forces.multiply(part.forces).sum(axis=1)).ravel()
    share = np.asarray(part.lower.multiply(part.forces).sum(axis=1)).ravel() / np.where(size > 0.0, size, 1.0)
    least = FAINT * np.abs(share).max(initial=1e-300)
    return sp.diags(np.where(np.abs(share) > least, share, -least)).tocsr()


def _largest(matrix: Sparse, empty: float = 1.0) -> Vector:
    """Largest size of an entry of each row; ``empty`` where there is none."""
    size = np.asarray(abs(matrix).max(axis=1).toarray()).ravel() if matrix.shape[0] else np.zeros(0)
    return np.where(size > 0.0, size, empty)

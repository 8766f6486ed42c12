"""A converged state as vibrations and buckling see it: the stiffness there, and what contact and ties hold."""

from __future__ import annotations

from collections.abc import Collection
from dataclasses import dataclass
from typing import Protocol

import numpy as np
import scipy.sparse as sp
from numpy.typing import NDArray

from abut.bordered import eliminated
from abut.contact.laws import Law
from abut.modes.spectrum import Factored, Pairs, Pencil
from abut.problem.laws import at_multipliers
from abut.problem.linearised import Linearised
from abut.problem.pair import Pair
from abut.problem.problem import ContactProblem
from abut.solution.state import State
from abut.types import Operator, Sparse

HARD = 1e-9  # by how much of what cells give way by (theory (L2)) gaps give way that are held: what is held twice is unique
LOOSE = 1e-6  # change of gaps by a rigid motion, over that by the one that changes them most, below which nothing resists it
Vector = NDArray[np.float64]


class Eigensolver(Protocol):
    """What factorises, and finds eigenpairs: on one process or on many."""

    def factors(self, matrix: Operator, held: Held) -> Factored:
        """Of a symmetric matrix (n_free, n_free), as the stiffness of ``held`` with something added, beside what is held.
        Raises SingularModelError where it is singular."""
        ...

    def largest(self, pencil: Pencil, count: int, seed: int = 0) -> Pairs:
        """The ``count`` largest t of a pencil, or as many as there may be; of positive t those found where iterations end.
        Raises ConvergenceError where they end else."""
        ...


@dataclass(frozen=True)
class Held:
    """stiffness: (n_free, n_free) symmetric, of bodies and real springs, CSR or on many processes; rows: (m, n_free) of the
    gaps and slips that are held, and of what connectors hold; give: (m,) what these give way by per multiplier, positive;
    loose: whether bodies move as a whole without resistance; kept: which of the problem's multipliers the first rows are;
    by: what finds modes."""

    stiffness: Operator
    rows: Sparse
    give: Vector
    loose: bool
    kept: NDArray[np.int64]
    by: Eigensolver


def held(
    problem: ContactProblem, system: Linearised, state: State, by: Eigensolver, apart: Collection[str] = ()
) -> Held:
    """Of a problem near a converged state, theory (J2). Closed contact is held along its normals, sticking in all
    directions, ties in all; what slips is free along its surface; contact with a law of its own gives way as that says.
    Connectors hold what they take, and motions that are prescribed or stopped at a limit.
    apart: contacts of which nothing is held."""
    own = problem.springs
    artificial = sp.csr_matrix((own.stiffness, (own.columns, own.columns)), shape=system.stiffness.shape)
    stiffness = eliminated(system.stiffness) - artificial
    stiffness = 0.5 * (stiffness + stiffness.T)
    kept, give = [np.zeros(0, bool)], [np.zeros(0)]
    parts = zip(system.pairs, *map(system.split, (system.gap(state), state.multipliers, state.closed, state.slipping)))
    for pair, gap, multipliers, closed, slipping in parts:
        law = pair.contact.law
        if pair.contact.name in apart:
            here, soft = np.zeros(len(pair), dtype=bool), np.zeros(len(pair))
        elif pair.smooth and not (pair.frictional or isinstance(law, str)):
            here, soft = _soft(pair, law, gap, multipliers, closed)
        else:
            here, soft = _status(pair, closed, slipping), np.zeros(len(pair))
        kept.append(here)
        give.append(np.maximum(soft, HARD * pair.scale)[here])
    places = np.flatnonzero(np.concatenate(kept))
    rows, motions = sp.csr_matrix(system.operator)[places], system.motions
    if problem.constraints.others is not None:
        count = stiffness.shape[0] - problem.constraints.others.free.nnz
        joined = _joined(stiffness, count)
        rows, stiffness = sp.vstack([rows[:, :count], joined], format="csr"), stiffness[:count, :count]
        give.append(HARD * np.asarray(abs(joined).max(axis=1).todense()).ravel())
        motions = motions[:count]
    return Held(stiffness, rows, np.concatenate(give), len(own) > 0 or _is_loose(rows, motions), places, by)


def _joined(tangent: Sparse, count: int) -> Sparse:
    """(m, count) rows of what connectors hold, from a tangent whose first ``count`` unknowns move; the others are their
    multipliers, of which those of open limits have a diagonal of their own."""
    tangent = tangent.tocsr()
    closed = tangent.diagonal()[count:] == 0.0
    return tangent[count:, :count][closed]


def _status(pair: Pair, closed: NDArray[np.bool_], slipping: NDArray[np.bool_]) -> NDArray[np.bool_]:
    """(n,) multipliers that hold something."""
    if pair.two_way and not pair.frictional:
        return np.ones(len(pair), dtype=bool)
    result = closed.copy()
    if pair.frictional:
        result[pair.tangential] &= ~slipping[pair.tangential]
    return result


def _soft(
    pair: Pair, law: Law, gap: Vector, pressure: Vector, closed: NDArray[np.bool_]
) -> tuple[NDArray[np.bool_], Vector]:
    """(n,) multipliers with a stiffness of their own, and what they give way by."""
    rows = at_multipliers(pair, law, gap, pressure, closed)
    seen = rows.by_gap.diagonal() != 0.0
    return seen & ~rows.decoupled, np.where(seen, np.maximum(-rows.by_pressure.diagonal(), 0.0), 0.0)


def _is_loose(rows: Sparse, motions: Vector) -> bool:
    """Whether some of rigid motions (n_free, k) changes no gap that is held."""
    count = motions.shape[1]
    if not count:
        return False
    if rows.shape[0] < count:
        return True
    size = np.maximum(np.asarray(abs(rows).sum(axis=1)).ravel(), 1e-300)
    changes = np.linalg.svd(sp.diags(1.0 / size) @ (rows @ motions), compute_uv=False)
    return bool(changes[-1] <= LOOSE * changes[0])

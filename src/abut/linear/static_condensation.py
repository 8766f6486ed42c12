"""Static condensation of a constant problem: the displacements are eliminated once; what is left is of the size of the
interface."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
import scipy.linalg
import scipy.sparse as sp
from numpy.typing import NDArray

from abut.errors import SingularModelError
from abut.linear import direct
from abut.linear.dense import cholesky, dense
from abut.problem.frame import Frame
from abut.problem.linearised import Linearised
from abut.problem.pair import Pair
from abut.problem.problem import ContactProblem, Laws, Problem
from abut.solution.state import State

LARGEST = 8000  # multipliers and kept displacements together up to which dense matrices are worth their memory
REFINEMENTS = 2


@dataclass(frozen=True)
class CondensedProblem:
    """A constant problem on the multipliers and the displacements that had to be kept: ``abut.problem.problem.Problem``.

    Everything but ``whole`` and ``refinements`` is private: kept: (n_kept,) displacements; factorization: of the rest;
    stiffness, operator, compliance: theory (V3); pairs: on the kept displacements. refinements: of a step's end."""

    whole: ContactProblem
    kept: NDArray[np.int64]
    factorization: direct.PartialFactorization
    stiffness: NDArray[np.float64]
    operator: NDArray[np.float64]
    compliance: NDArray[np.float64]
    pairs: Sequence[Pair]
    motions: NDArray[np.float64]
    constant: bool = True
    refinements: int = REFINEMENTS

    def start(self) -> State:
        """As in ``Problem``."""
        return self.restrict(self.whole.start())

    def frame(self, before: State, guess: State | None = None) -> Frame:
        """As in ``Problem``."""
        return self.whole.frame(before, guess)

    def linearise(self, before: State, frame: Frame, now: State) -> Linearised:
        """As in ``Problem``; before: in all free displacements; the unknowns of ``now`` do not matter."""
        full = self.whole.linearise(before, frame, now)
        n = len(full.load)
        load = self.factorization.forward(np.concatenate([full.load, np.zeros(len(full.offset))]))
        return Linearised(
            full.time, full.factors, self.stiffness, load[self.kept], self.pairs, self.operator, full.offset + load[n:],
            self.motions, full.restraint, full.load, full.unit, self.compliance,
        )  # fmt: skip

    def accepted(self, before: State, frame: Frame, now: State, system: Linearised) -> State:
        """As in ``Problem``."""
        return self.whole.accepted(before, frame, now, system)

    def again(self, before: State, state: State) -> Linearised:
        """As in ``Problem``."""
        return self.whole.again(before, state)

    def restrict(self, state: State) -> State:
        """As in ``Problem``."""
        return replace(state, unknowns=state.unknowns[self.kept])

    def with_ordinary(self, closed: NDArray[np.bool_]) -> Problem:
        """As in ``Problem``."""
        other = self.whole.with_ordinary(closed)
        if other is self.whole:
            return self
        return condense(other) or other

    def alone_at_edges(self, closed: NDArray[np.bool_], state: State | None = None) -> NDArray[np.bool_]:
        """As in ``Problem``."""
        return self.whole.alone_at_edges(closed, state)

    def expand(
        self, before: State, frame: Frame, state: State, laws: Laws, system: Linearised
    ) -> tuple[State, Linearised]:
        """As in ``Problem``. Eliminated stiff parts under soft ones lose digits by cancellation: the equations of the whole
        problem are met anew by refinement."""
        near, whole = system, self.whole.linearise(before, frame, state)
        n = len(whole.load)
        inner = self.factorization.forward(np.concatenate([whole.load, np.zeros(len(whole))]))
        inner[self.kept], inner[n:] = state.unknowns, state.multipliers
        state = replace(state, unknowns=self.factorization.backward(inner)[:n])
        if not self.refinements:
            return state, whole
        solver = dense(near)
        for _ in range(self.refinements):
            inner = self.factorization.forward(np.concatenate([-whole.unbalanced(state), np.zeros(len(whole))]))
            linear = laws(whole, state)
            opened = [law.residual for law in linear]
            for i, shift in enumerate(whole.split(inner[n:])):
                if not linear[i].at_points:  # what those see has been kept
                    opened[i] = opened[i] + linear[i].by_gap @ shift
            rows = replace(near.rows(linear), residual=near.join(opened))
            try:
                inner[self.kept], inner[n:] = solver.solve(rows, -inner[self.kept], state.multipliers, 0.0)
            except SingularModelError:  # laws that have not been met may be too far off to go on from
                return state, whole
            state = replace(
                state,
                unknowns=state.unknowns + self.factorization.backward(inner)[:n],
                multipliers=state.multipliers + inner[n:],
            )
        return state, whole


def condense(problem: ContactProblem) -> CondensedProblem | None:
    """The problem with all displacements eliminated but those that pairs with a law at the integration points look at, and
    as many as hold the bodies that supports leave free. None where the problem is not constant, where what is left is too
    large for dense matrices, or no solver for it is installed."""
    n, n_p = problem.n_free, problem.operator.shape[0]
    kept = _kept(problem.pairs, problem.motions)
    if not problem.constant or not 0 < n_p + len(kept) <= LARGEST or n_p == 0:
        return None
    upper, none = sp.triu(problem.stiffness), sp.csr_matrix((n_p, n_p))
    matrix = sp.bmat([[upper, -problem.operator.T], [None, none]], format="csr")
    factorization = direct.partial_factorization(
        direct.store_diagonal(matrix), np.concatenate([kept, n + np.arange(n_p)])
    )
    if factorization is None:
        return None
    n_u, schur = len(kept), factorization.schur
    stiffness, operator, compliance = schur[:n_u, :n_u], -schur[n_u:, :n_u], -schur[n_u:, n_u:]  # theory (V3)
    pairs, motions = [_restricted(pair, kept) for pair in problem.pairs], problem.motions[kept]
    try:
        cholesky(stiffness, motions, problem.unit)
    except np.linalg.LinAlgError:
        return None  # a zero-energy motion that is not rigid, as of bodies joined in a hinge
    return CondensedProblem(problem, kept, factorization, stiffness, operator, compliance, pairs, motions)


def _kept(pairs: Sequence[Pair], motions: NDArray[np.float64]) -> NDArray[np.int64]:
    """Numbers of the displacements that stay."""
    m = motions.shape[1]
    fixed = scipy.linalg.qr(motions.T, mode="r", pivoting=True)[1][:m] if m else np.zeros(0, dtype=int)
    points = [p.points.operator for p in pairs if p.points is not None]
    looked_at = np.flatnonzero(np.diff(sp.vstack(points).tocsc().indptr)) if points else np.zeros(0, dtype=int)
    return np.union1d(fixed, looked_at).astype(np.int64)


def _restricted(pair: Pair, kept: NDArray[np.int64]) -> Pair:
    if pair.points is None:
        return pair
    return replace(pair, points=replace(pair.points, operator=pair.points.operator[:, kept].tocsr()))

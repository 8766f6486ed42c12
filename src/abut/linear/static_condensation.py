"""Static condensation of a constant problem: the displacements are eliminated once; what is left is of the size of the
interface."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
import scipy.linalg
import scipy.sparse as sp
from numpy.typing import NDArray

from abut.bordered import widened, with_border
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
    stiffness, operator, compliance: theory (V3); pairs: on the kept displacements; first: number of the first multiplier
    among its unknowns, after displacements and what borders the stiffness. refinements: of a step's end."""

    whole: ContactProblem
    kept: NDArray[np.int64]
    factorization: direct.PartialFactorization
    stiffness: NDArray[np.float64]
    operator: NDArray[np.float64]
    compliance: NDArray[np.float64]
    pairs: Sequence[Pair]
    motions: NDArray[np.float64]
    first: int
    constant: bool = True
    refinements: int = REFINEMENTS

    def start(self) -> State:
        """The state before the first load step, as in ``Problem``."""
        return self.restrict(self.whole.start())

    def frame(self, before: State, guess: State | None = None) -> Frame:
        """What is fixed during a step, as in ``Problem``."""
        return self.whole.frame(before, guess)

    def linearise(self, before: State, frame: Frame, now: State) -> Linearised:
        """The problem near a trial state, as in ``Problem``; before: in all free displacements; the unknowns of ``now``
        do not matter."""
        full = self.whole.linearise(before, frame, now)
        load = self._forward(full.load)
        offset = full.offset + load[self.first :]
        return Linearised(
            full.time, full.factors, self.stiffness, load[self.kept], self.pairs, self.operator, offset,
            self.motions, full.restraint, full.load, full.unit, self.compliance,
        )  # fmt: skip

    def accepted(self, before: State, frame: Frame, now: State, system: Linearised) -> State:
        """The converged state with its history, as in ``Problem``."""
        return self.whole.accepted(before, frame, now, system)

    def again(self, before: State, state: State) -> Linearised:
        """The problem near a converged state, as in ``Problem``."""
        return self.whole.again(before, state)

    def restrict(self, state: State) -> State:
        """A state in the unknowns of this problem, as in ``Problem``."""
        return replace(state, unknowns=state.unknowns[self.kept])

    def with_ordinary(self, closed: NDArray[np.bool_]) -> Problem:
        """The problem with ordinary functions where contact is closed, as in ``Problem``."""
        other = self.whole.with_ordinary(closed)
        if other is self.whole:
            return self
        return condense(other) or other

    def alone_at_edges(self, closed: NDArray[np.bool_], state: State | None = None) -> NDArray[np.bool_]:
        """What is closed alone at edges where both sides end, as in ``Problem``."""
        return self.whole.alone_at_edges(closed, state)

    def expand(
        self, before: State, frame: Frame, state: State, laws: Laws, system: Linearised
    ) -> tuple[State, Linearised]:
        """A solution in all free displacements, as in ``Problem``. Eliminated stiff parts under soft ones lose digits by
        cancellation: the equations of the whole problem are met anew by refinement."""
        near, whole = system, self.whole.linearise(before, frame, state)
        n, first = len(whole.load), self.first
        inner = self._forward(whole.load)
        inner[self.kept], inner[first:] = state.unknowns, state.multipliers
        state = replace(state, unknowns=self.factorization.backward(inner)[:n])
        if not self.refinements:
            return state, whole
        solver = dense(near)
        for _ in range(self.refinements):
            inner = self._forward(-whole.unbalanced(state))
            linear = laws(whole, state)
            opened = [law.residual for law in linear]
            for i, shift in enumerate(whole.split(inner[first:])):
                if not linear[i].at_points:  # what those see has been kept
                    opened[i] = opened[i] + linear[i].by_gap @ shift
            rows = replace(near.rows(linear), residual=near.join(opened))
            try:
                inner[self.kept], inner[first:] = solver.solve(rows, -inner[self.kept], state.multipliers, 0.0)
            except SingularModelError:  # laws that have not been met may be too far off to go on from
                return state, whole
            state = replace(
                state,
                unknowns=state.unknowns + self.factorization.backward(inner)[:n],
                multipliers=state.multipliers + inner[first:],
            )
        return state, whole

    def _forward(self, load: NDArray[np.float64]) -> NDArray[np.float64]:
        """Forces (n_free,) on the displacements, eliminated."""
        rest = self.first - len(load) + self.whole.operator.shape[0]
        return self.factorization.forward(np.concatenate([load, np.zeros(rest)]))


def condense(problem: ContactProblem) -> CondensedProblem | None:
    """The problem with all displacements eliminated but those that pairs with a law at the integration points look at, and
    as many as hold the bodies that supports leave free. None where the problem is not constant, where what is left is too
    large for dense matrices, or no solver for it is installed."""
    n_p = problem.operator.shape[0]
    kept = _kept(problem.pairs, problem.motions)
    if not problem.constant or not 0 < n_p + len(kept) <= LARGEST or n_p == 0:
        return None
    stiff, more = with_border(problem.stiffness)
    first = problem.n_free + more
    upper, none = direct.upper(stiff.tocsr()), sp.csr_matrix((n_p, n_p))
    matrix = sp.bmat([[upper, -widened(problem.operator, more).T], [None, none]], format="csr")
    factorization = direct.partial_factorization(
        direct.store_diagonal(matrix), np.concatenate([kept, first + np.arange(n_p)])
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
    return CondensedProblem(problem, kept, factorization, stiffness, operator, compliance, pairs, motions, first)


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

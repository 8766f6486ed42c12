"""A contact problem: residual and tangent at a state."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from typing import Protocol

import numpy as np
import scipy.sparse as sp
from numpy.typing import NDArray

from abut.model import Model
from abut.model.conditions import weights
from abut.problem.approach import approach_slip
from abut.problem.constraints import Constraints
from abut.problem.contact_pairs import with_plain_functions
from abut.problem.free_modes import FreeModeSprings
from abut.problem.laws import LawRows
from abut.problem.linearised import Linearised
from abut.problem.pair import Pair
from abut.problem.restraint import Restraint
from abut.problem.terms import Motion, Share, Term
from abut.solution.state import State, at_rest
from abut.types import Operator, Sparse

TOUCHING = 1e-3  # initial gap over facet size below which a multiplier starts active
CONTACTS = "contacts"  # whose history is the slip
Laws = Callable[[Linearised, State], Sequence[LawRows]]


class Problem(Protocol):
    """What Newton's method solves. constant: stiffness, operator and compliance never change (the same objects come back
    from every state), so that one set-up of a linear solver serves them all."""

    @property
    def constant(self) -> bool: ...

    def start(self) -> State:
        """The state before the first load step."""
        ...

    def linearise(self, before: State, now: State) -> Linearised:
        """The problem near the trial state ``now``, at its time, which follows the converged ``before``."""
        ...

    def accepted(self, before: State, now: State, system: Linearised) -> State:
        """The converged state ``now`` with the history that it leaves; system: the whole problem near it, as from
        ``expand``."""
        ...

    def expand(self, before: State, state: State, laws: Laws, system: Linearised) -> tuple[State, Linearised]:
        """A solution in all free displacements, which follows the converged ``before``, and the problem near it, nothing
        condensed; laws: the ones it meets; system: this problem near the solution."""
        ...

    def again(self, before: State, state: State) -> Linearised:
        """The whole problem near a converged state with its history, as the step from ``before`` ended."""
        ...

    def restrict(self, state: State) -> State:
        """A state in all free displacements in the unknowns of this problem."""
        ...

    def with_ordinary(self, closed: NDArray[np.bool_]) -> Problem:
        """With the ordinary functions of "dual-P1" where the multipliers ``closed`` (n,) let them be; the same object where
        they are nowhere; theory (P9)."""
        ...


@dataclass(frozen=True)
class ContactProblem:
    """Bodies, loads and contact on the free displacements.

    terms: what adds to the balance of forces; held: supports, u = Z q + u_prescribed(t), theory (F8); pairs, operator
    (n, n_free) all of them stacked; restraint: of rigid-body modes; springs: on free rigid-body modes; stiffness:
    (n_free, n_free) where every term is constant, else None; motions: (n_free, m) rigid-body modes that supports leave free;
    unit: size of the stiffness' entries, where it is constant.
    """

    model: Model
    terms: Sequence[Term]
    constraints: Constraints
    pairs: Sequence[Pair]
    operator: Operator
    restraint: Restraint
    springs: FreeModeSprings
    stiffness: Operator
    motions: NDArray[np.float64]
    unit: float = 0.0

    @property
    def constant(self) -> bool:
        """As in ``Problem``."""
        return self.stiffness is not None

    @property
    def n_free(self) -> int:
        return int(self.constraints.free.shape[1])

    def start(self) -> State:
        """As in ``Problem``: zero displacement; multipliers that touch at the outset are closed, theory (V6)."""
        rest = at_rest(self.n_free, int(self.operator.shape[0]))
        offset = self._offset(np.zeros(len(self.model.histories)))
        first, closed = 0, np.zeros(len(offset), dtype=bool)
        for pair in self.pairs:
            here = slice(first, first := first + len(pair))
            touching = offset[here] <= TOUCHING * pair.size * pair.weight
            closed[here] = pair.of_functions(touching[pair.normal]) if pair.frictional else pair.two_way | touching
        return rest.with_closed(closed)

    def linearise(self, before: State, now: State) -> Linearised:
        """As in ``Problem``. A constant problem is affine everywhere: it is expanded about zero displacement, whose forces
        have no rounding."""
        if self.constant:
            rest = np.zeros(self.n_free)
            return self._near(before, replace(before, unknowns=rest), replace(now, unknowns=rest))
        return self._near(before, before, now)

    def _near(self, converged: State, before: State, now: State) -> Linearised:
        slipped = self._slipped(converged)
        at, there, here = now.unknowns, self.displacement(before), self.displacement(now)
        shares = [
            term.evaluate(*(Motion(s.time, u, before.history.of(term.name)) for s, u in ((before, there), (now, here))))
            for term in self.terms
        ]
        factors = weights(self.model.histories, now.time)
        force = self.constraints.free.T @ np.asarray(sum(share.force for share in shares))
        if self.constant:
            stiffness, load = self.stiffness, -force
        else:
            tangents = [share.tangent.reduce(self.constraints) for share in shares if share.tangent is not None]
            stiffness = self.springs.added_to(sum(tangents[1:], tangents[0]))
            load = stiffness @ at - force - self.springs.forces(at)
        return Linearised(
            now.time, factors, stiffness, load, self.pairs, self.operator, self._offset(factors, slipped), self.motions,
            self.restraint, load, self.unit or unit_of(stiffness), shares={} if self.constant else self._named(shares),
        )  # fmt: skip

    def _named(self, shares: Sequence[Share]) -> dict[str, Share]:
        """Of the terms by name, without their tangents."""
        return {term.name: replace(share, tangent=None) for term, share in zip(self.terms, shares)}

    def accepted(self, before: State, now: State, system: Linearised) -> State:
        """As in ``Problem``."""
        history = before.history
        if any(pair.frictional for pair in self.pairs):
            history = history.with_term(CONTACTS, self._slips(before, now, system))
        for name, share in system.shares.items():
            history = history.with_term(name, share.history)
        return now if history is before.history else replace(now, history=history)

    def expand(self, before: State, state: State, laws: Laws, system: Linearised) -> tuple[State, Linearised]:
        """As in ``Problem``: nothing has been condensed."""
        return state, system

    def again(self, before: State, state: State) -> Linearised:
        """As in ``Problem``."""
        return self.linearise(before, state)

    def restrict(self, state: State) -> State:
        """As in ``Problem``."""
        return state

    def with_ordinary(self, closed: NDArray[np.bool_]) -> ContactProblem:
        """As in ``Problem``."""
        parts = np.split(closed, np.cumsum([len(pair) for pair in self.pairs])[:-1]) if self.pairs else []
        pairs = [
            with_plain_functions(self.model, pair, self.constraints, part) for pair, part in zip(self.pairs, parts)
        ]
        if all(new is old for new, old in zip(pairs, self.pairs)):
            return self
        return replace(self, pairs=pairs, operator=stacked(pairs, self.n_free))

    def displacement(self, state: State) -> NDArray[np.float64]:
        """Of all points, (dim n_points,)."""
        return self.constraints.displacement(state.unknowns, weights(self.model.histories, state.time))

    def _offset(self, factors: NDArray[np.float64], slipped: Sequence[NDArray[np.float64]] = ()) -> NDArray[np.float64]:
        """Weighted gaps (n,) without free displacements, theory (F9), with the histories at ``factors``; slipped: what to
        leave out of the slip, as from ``_slipped``."""
        gaps = [pair.gap + pair.prescribed @ factors for pair in self.pairs]
        for pair, gap, before in zip(self.pairs, gaps, slipped):
            if pair.frictional:
                gap[pair.tangential] -= before
        return np.concatenate(gaps) if gaps else np.zeros(0)

    def _slipped(self, before: State) -> list[NDArray[np.float64]]:
        """Weighted tangential jumps of each pair from which the next step's slip counts, theory (R3): those in a converged
        state, and what is open moved on until it closes; empty without friction."""
        if not any(pair.frictional for pair in self.pairs):
            return []
        return [
            gap[pair.tangential] + came if pair.frictional else came
            for pair, gap, came in zip(self.pairs, self._gaps(before), self._approached(before))
        ]

    def _approached(self, before: State) -> list[NDArray[np.float64]]:
        """Of them, what is open moves on until it closes; empty of a pair without friction."""
        ends = np.cumsum([len(pair) for pair in self.pairs])[:-1]
        states = self._gaps(before), np.split(before.multipliers, ends), np.split(before.closed, ends)
        return [
            approach_slip(pair, gap, multipliers, closed) if pair.frictional else np.zeros(0)
            for pair, gap, multipliers, closed in zip(self.pairs, *states)
        ]

    def _gaps(self, before: State) -> list[NDArray[np.float64]]:
        """Weighted gaps and tangential jumps of each pair in a converged state."""
        factors = weights(self.model.histories, before.time)
        return [pair.gap + pair.operator @ before.unknowns + pair.prescribed @ factors for pair in self.pairs]

    def _slips(self, before: State, now: State, system: Linearised) -> dict[str, NDArray[np.float64]]:
        """Slip of each pair with friction by name, (n, 4): in the step that ends ``now``, in all steps in contact, what did
        not count in the step because it only came closer, and 1 where nothing did, for want of a past."""
        earlier = before.history.of(CONTACTS)
        result, gaps = {}, system.gap(now)
        forgotten = np.zeros(len(gaps), bool) if system.forgotten is None else system.forgotten
        gaps = np.where(forgotten, 0.0, gaps)  # what has no past has nothing to slip from
        states = system.split(gaps), system.split(now.closed), system.split(forgotten), self._approached(before)
        for pair, gap, closed, new, approached in zip(self.pairs, *states):
            if pair.frictional:
                step = gap / pair.weight
                step[pair.normal] = 0.0
                total = earlier.get(pair.contact.name, np.zeros((len(pair), 4)))[:, 1]
                came = np.zeros(len(pair))
                came[pair.tangential] = approached / pair.weight[pair.tangential]
                result[pair.contact.name] = np.column_stack([step, total + np.where(closed, step, 0.0), came, new])
        return result


def stacked(pairs: Sequence[Pair], n_free: int) -> Sparse:
    """The operators of all pairs, (n, n_free)."""
    return sp.vstack([p.operator for p in pairs]).tocsr() if pairs else sp.csr_matrix((0, n_free))


def unit_of(stiffness: Sparse) -> float:
    """Size of a stiffness' entries."""
    diagonal = stiffness.diagonal()
    return float(np.median(diagonal)) if len(diagonal) else 1.0

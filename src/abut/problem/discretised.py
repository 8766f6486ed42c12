"""What a contact problem is made of."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
import scipy.sparse as sp
from numpy.typing import NDArray

from abut.dofs import DISPLACEMENT
from abut.model import Model
from abut.model.conditions import weights
from abut.model.offset import offsets
from abut.model.rates import Rates, TimeIntegration
from abut.problem.constraints import Constraints
from abut.problem.frame import Frame
from abut.problem.free_modes import FreeModeSprings
from abut.problem.kinematics import Kinematics, Placed
from abut.problem.pair import Pair, by_pair
from abut.problem.restraint import Restraint
from abut.problem.terms import Motion, Share, Term, added_up
from abut.solution.state import State
from abut.types import Operator, Sparse


@dataclass(frozen=True)
class Discretised:
    """Bodies, loads and contact on the free displacements: what a problem is made of.

    terms: what adds to the balance of forces; held: supports, u = Z q + u_prescribed(t), theory (F8); operator:
    (n, n_free) of all pairs, stacked; restraint: of rigid-body modes; springs: on free rigid-body modes; stiffness:
    (n_free, n_free) where every term is constant, else None; motions: (n_free, m) rigid-body modes that supports leave free;
    unit: size of the stiffness' entries, where it is constant; kinematics: how each pair is looked at; own:
    names of the terms of other physics; integration: how rates follow from values.
    """

    model: Model
    terms: Sequence[Term]
    constraints: Constraints
    kinematics: Sequence[Kinematics]
    operator: Operator
    restraint: Restraint
    springs: FreeModeSprings
    stiffness: Operator
    motions: NDArray[np.float64]
    unit: float = 0.0
    own: frozenset[str] = frozenset()
    integration: TimeIntegration | None = None

    @property
    def pairs(self) -> list[Pair]:
        return [kind.pair for kind in self.kinematics]

    @property
    def constant(self) -> bool:
        """Whether the matrices never change, as in ``Problem``."""
        return self.stiffness is not None

    @property
    def n_free(self) -> int:
        return int(self.constraints.free.shape[1])

    def displacement(self, state: State) -> NDArray[np.float64]:
        """Of all points, (dim n_points,)."""
        return self.constraints.displacement(state.unknowns, weights(self.model.histories, state.time))

    def values(self, state: State) -> NDArray[np.float64]:
        """Of all fields, (n_values,), displacements first."""
        others, displacement = self.constraints.others, self.displacement(state)
        if others is None:
            return displacement
        return np.concatenate([displacement, others.values(state.unknowns, weights(self.model.histories, state.time))])

    def motion(self, time: float, values: NDArray[np.float64], rates: Rates | None = None) -> Motion:
        """What terms see of values of all fields, (n_values,), and of their rates."""
        if self.constraints.others is None:
            return Motion(time, values, rates=rates)
        fields = self.constraints.others.dofs.named(values)
        return Motion(time, fields.pop(DISPLACEMENT).ravel(), fields=fields, rates=rates)

    def rates(self, before: State, time: float, values: NDArray[np.float64]) -> Rates | None:
        """Of values (n_values,) at a time, which follow a converged state."""
        if self.integration is None or before.rates is None:
            return None
        return self.integration.after(before.rates, values - self.values(before), time - before.time)

    def sizes(
        self, shares: Sequence[Share], states: Sequence[State], stiffness: Operator
    ) -> NDArray[np.float64] | None:
        """(n_free,) what residuals are judged against, field by field, where there are others than displacements: the
        largest force of a term, what it gives for it, or what the largest values do; states: begin and end of the step."""
        others = self.constraints.others
        if others is None:
            return None
        n = others.dofs.size
        judged = [share.force if share.sizes is None else share.sizes for share in shares]
        largest = np.max([others.largest(added_up([each], n)) for each in judged], axis=0)
        moved = np.max([others.largest(self.values(state)) for state in states], axis=0)
        unit = others.largest(others.whole(self.constraints.free) @ np.abs(stiffness.diagonal()))
        return np.maximum(largest, unit * moved)

    def split(self, values: NDArray[Any]) -> list[NDArray[Any]]:
        """Values of all multipliers (n,), pair by pair."""
        return by_pair(self.pairs, values)

    def added(self, pair: Pair, time: float) -> float:
        """What is added to all gaps of a pair at a time."""
        constant, varying = offsets(self.model, pair.contact)
        return constant + float(varying @ weights(self.model.histories, time))

    def placed(self, state: State) -> list[Placed]:
        """Each pair in a state."""
        here, parts = self.displacement(state), (self.split(state.multipliers), self.split(state.closed))
        factors = weights(self.model.histories, state.time)
        return [
            Placed(here, values, closed, self.added(pair, state.time), pair.acting(factors).away)
            for pair, values, closed in zip(self.pairs, *parts)
        ]

    def shares(self, before: State, there: Motion, now: Motion, frame: Frame) -> list[Share]:
        """Of every term at ``now``, which follows ``there``, with the history of ``before``, in a frame."""
        return [
            term.evaluate(*(replace(at, history=before.history.of(term.name), wet=frame.wet) for at in (there, now)))
            for term in self.terms
        ]

    def named(self, shares: Sequence[Share]) -> Mapping[str, Share]:
        """Of the terms by name, without their tangents."""
        return {term.name: replace(share, tangent=None) for term, share in zip(self.terms, shares)}


def stacked(pairs: Sequence[Pair], n_free: int) -> Sparse:
    """The operators of all pairs, (n, n_free)."""
    return sp.vstack([p.operator for p in pairs]).tocsr() if pairs else sp.csr_matrix((0, n_free))


def unit_of(stiffness: Sparse) -> float:
    """Size of a stiffness' entries."""
    diagonal = stiffness.diagonal()
    return float(np.median(diagonal)) if len(diagonal) else 1.0

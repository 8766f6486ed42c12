"""The laws of contact at a state: complementarity, Coulomb's law and ties with the status as it is, and others."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
import scipy.sparse as sp
from numpy.typing import NDArray

from abut.contact.laws import Complementarity, ConstraintFunction, Coulomb, Gone, Law, Tied
from abut.contact.smooth_friction import SmoothCoulomb
from abut.problem.current import bare
from abut.problem.laws import LawRows, at_multipliers, giving
from abut.problem.linearised import Linearised
from abut.problem.pair import Pair
from abut.solution.state import State

Vector = NDArray[np.float64]


@dataclass(frozen=True)
class Asked:
    """Which laws hold for now. own: laws of one's own, else complementarity in their place; reference: the largest pressure,
    to which the constraint function is relative; without one complementarity (Coulomb's law) in its place; by_pressure: laws
    of one's own are linearised at the gaps that meet the pressures of the state."""

    own: bool = True
    reference: float | None = None
    by_pressure: bool = False

    def of(self, pair: Pair, system: Linearised) -> Law | None:
        """The law of a pair, if it is another one than complementarity or Coulomb's."""
        if not pair.smooth or pair.away:
            return None
        law = pair.contact.law
        if not isinstance(law, str):
            return law if self.own else None
        if self.reference is None:
            return None
        epsilon = pair.contact.epsilon
        if pair.frictional:
            return SmoothCoulomb(pair.stiffness, pair.friction(system.factors), float(np.sqrt(epsilon)), self.reference)
        return ConstraintFunction(np.full(len(pair), pair.stiffness), epsilon, self.reference)


def active_laws(system: Linearised, state: State) -> list[LawRows]:
    """The laws of all pairs with the status as it is."""
    parts = (system.gap(state), state.multipliers, state.closed, state.slipping)
    return [at_status(system, *part) for part in zip(system.pairs, *map(system.split, parts))]


def friction_laws(system: Linearised, state: State) -> list[LawRows]:
    """The same for one iteration, unique where friction repeats itself: ``giving``; multipliers of friction without a past
    carry nothing."""
    laws = [giving(*part) for part in zip(system.pairs, active_laws(system, state))]
    if system.forgotten is None:
        return laws
    parts = zip(system.pairs, laws, system.split(system.forgotten), system.split(state.multipliers))
    return [without(law, idle, pair.scale, multipliers) for pair, law, idle, multipliers in parts]


def without(law: LawRows, idle: NDArray[np.bool_], scale: Vector, multipliers: Vector) -> LawRows:
    """Rows that set some multipliers to zero."""
    if not idle.any():
        return law
    keep = sp.diags((~idle).astype(float))
    return replace(
        law,
        residual=np.where(idle, -scale * multipliers, law.residual),
        closed=law.closed & ~idle,
        by_gap=(keep @ law.by_gap).tocsr(),
        by_pressure=(keep @ law.by_pressure - sp.diags(np.where(idle, scale, 0.0))).tocsr(),
        decoupled=law.decoupled | idle,
    )


def barely_covered(system: Linearised) -> NDArray[np.bool_]:
    """(n,) multipliers with hardly any target opposite, which carry nothing."""
    return system.join([np.zeros(len(p), bool) if p.tied else p.of_functions(bare(p)) for p in system.pairs]).astype(
        bool
    )


def at_status(
    system: Linearised, pair: Pair, gap: Vector, multipliers: Vector, closed: NDArray[np.bool_], slipping: NDArray[np.bool_]
) -> LawRows:  # fmt: skip
    """The law of one pair with the status as it is; gap, multipliers, closed, slipping: (n,)."""
    law: Law = Tied() if pair.tied else Complementarity(pair.stiffness)
    if pair.away:
        law = Gone(pair.stiffness)
    elif pair.frictional:
        law = Coulomb(pair.stiffness, pair.friction(system.factors))
    return at_multipliers(pair, law, gap, multipliers, closed, slipping if pair.frictional else None)

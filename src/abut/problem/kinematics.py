"""Kinematics of a contact pair: gaps (and slips) of its multipliers at a displacement, with their derivatives."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Protocol

import numpy as np
from numpy.typing import NDArray

from abut.problem.contact_pairs import Pair
from abut.types import Sparse

Vector = NDArray[np.float64]


@dataclass(frozen=True)
class Jump:
    """value: (n,) weighted gaps; operator: (n, n_free) their derivative by the free displacements; bending: (n_free, n_free)
    their second derivatives, each times its multiplier, summed; None where they have none."""

    value: Vector
    operator: Sparse
    bending: Sparse | None = None


class Kinematics(Protocol):
    """constant: the jump is affine in the displacements, and the same operator comes back from every state."""

    @property
    def constant(self) -> bool: ...

    def at(self, unknowns: Vector, factors: Vector, multipliers: Vector) -> Jump:
        """At free displacements (n_free,), with the histories at ``factors`` (n_histories,) and multipliers (n,)."""
        ...

    def of(self, pair: Pair) -> Kinematics:
        """The same for the pair with another multiplier space."""
        ...


@dataclass(frozen=True)
class Frozen:
    """Contact between the undeformed surfaces, theory (F9): for small displacements."""

    pair: Pair
    constant: bool = True

    def at(self, unknowns: Vector, factors: Vector, multipliers: Vector) -> Jump:
        """As in ``Kinematics``."""
        fixed = self.pair.gap + self.pair.prescribed @ factors
        return Jump(fixed + self.pair.operator @ unknowns, self.pair.operator)

    def of(self, pair: Pair) -> Frozen:
        """As in ``Kinematics``."""
        return Frozen(pair)

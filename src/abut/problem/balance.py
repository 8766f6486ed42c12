"""The problem at the end of a load step: what its results, its certificate and its energies are made of."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from abut.problem.linearised import Linearised
from abut.problem.pair import Pair, by_pair
from abut.solution.state import State

Vector = NDArray[np.float64]


@dataclass(frozen=True)
class Balance:
    """What a problem near a state leaves behind, without its matrices, so that no state is linearised twice.

    factors: (n_histories,) of the histories; pairs: as they lie; gap: (n,) weighted gaps and slips; diagonal: (n_free,) of
    the stiffness; forces: by term, (dim n_points,) as in ``Share``, empty where the problem is constant; energy: elastic,
    of all terms, not a number where none knows it.
    """

    factors: Vector
    pairs: Sequence[Pair]
    gap: Vector
    diagonal: Vector
    forces: Mapping[str, Vector]
    energy: float

    @classmethod
    def of(cls, system: Linearised, state: State) -> Balance:
        """Of the problem near ``state``, nothing condensed."""
        forces = {name: share.force for name, share in system.shares.items()}
        known = [share.energy for share in system.shares.values() if share.energy is not None]
        energy = sum(known) if known else float("nan")
        return cls(system.factors, system.pairs, system.gap(state), system.stiffness.diagonal(), forces, energy)

    def split(self, values: NDArray[Any]) -> list[NDArray[Any]]:
        """Values of all multipliers (n,), pair by pair."""
        return by_pair(self.pairs, values)

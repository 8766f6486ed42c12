"""Vectors of functions on both sides of a sector in one frame: that of the function which they are compared at."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from abut.cells import MAX_FACET_NODES
from abut.contact.turned_functions import by_turn
from abut.contact.turned_images import used_sides
from abut.problem.pair import Pair
from abut.types import Array


@dataclass(frozen=True)
class TurnedPlaces:
    """turns: (n_functions, dim, dim) from each function's frame to that of its place; closed: (n_functions,) places whose
    functions go all round, where the mean of vectors over all sectors lies along the axis, on which ``along`` (dim, dim)
    projects."""

    turns: Array
    closed: NDArray[np.bool_]
    along: Array

    @classmethod
    def of(cls, pair: Pair, down: NDArray[np.int64], inside: NDArray[np.bool_]) -> TurnedPlaces | None:
        """down: (n_functions,) one beside each that is next on the way to its place, of connected ones ``inside``
        (n_functions,) the first of these. None where no sides of a sector are reached."""
        sides = used_sides(pair.contactor)
        if sides is None:
            return None
        powers, closed = _powers(_steps(pair), down, inside)
        turns = np.stack([sides.power(k)[0] for k in powers.tolist()])
        size, axes = np.linalg.eigh(0.5 * (sides.turn + sides.turn.T))
        along = axes[:, size > 1.0 - 1e-9]  # what a turn leaves as it is
        return cls(turns, closed, along @ along.T)

    def here(self, vectors: Array) -> NDArray[np.float64]:
        """Vectors (n_functions, ..., dim) in the frames of their places."""
        return np.asarray(np.einsum("nab,n...b->n...a", self.turns, vectors))

    def there(self, vectors: Array) -> NDArray[np.float64]:
        """Vectors (n_functions, dim) of the places in the functions' own frames."""
        return np.asarray(np.einsum("nba,nb->na", self.turns, vectors))


def _steps(pair: Pair) -> dict[int, dict[int, int]]:
    """Functions beside each one, and how many sectors each one's vectors are turned by on the way to it."""
    by_facet: dict[int, list[tuple[int, int]]] = {}
    for power, (_, part) in zip((0, 1, -1), by_turn(pair.contactor, pair.space.node, abs(pair.space.plain))):
        entries = part.tocoo()
        for facet, function in set(zip((entries.row // MAX_FACET_NODES).tolist(), entries.col.tolist())):
            by_facet.setdefault(facet, []).append((function, power))
    steps: dict[int, dict[int, int]] = {}
    for members in by_facet.values():
        for one, at_one in members:
            steps.setdefault(one, {}).update({other: at_other - at_one for other, at_other in members})
    return steps


def _powers(
    steps: dict[int, dict[int, int]], down: NDArray[np.int64], inside: NDArray[np.bool_]
) -> tuple[NDArray[np.int64], NDArray[np.bool_]]:
    """By how many sectors the vectors of each function are turned on their way to its place, and the places whose connected
    functions are reached by two ways that differ."""
    powers: dict[int, int] = {}
    closed = np.zeros(len(down), dtype=bool)
    for root in np.unique(down[inside]).tolist():
        powers[root], waiting = 0, [root]
        while waiting:
            one = waiting.pop()
            for other, step in steps.get(one, {}).items():
                if inside[other] and other not in powers:
                    powers[other] = powers[one] + step
                    waiting.append(other)
                elif inside[other] and powers[other] != powers[one] + step:
                    closed[root] = True
    for function in range(len(down)):
        way = [function]
        while way[-1] not in powers and down[way[-1]] != way[-1]:
            way.append(int(down[way[-1]]))
        powers.setdefault(way[-1], 0)
        for before, one in zip(way[-2::-1], way[:0:-1]):
            powers[before] = powers[one] + steps[one].get(before, 0)
    return np.array([powers[k] for k in range(len(down))]), closed

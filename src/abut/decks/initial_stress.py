"""Stresses that a body of a deck has before the first step."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray
from scipy.spatial import cKDTree

from abut._core import shape_functions
from abut.cells import CELLS
from abut.fields import Given
from abut.io.deck.faces import element_nodes
from abut.io.deck.groups import Piece
from abut.io.deck.reasons import DeckError
from abut.io.deck.record import Deck
from abut.mesh.quadrature import cell_rule
from abut.types import Array

COMPONENTS = {2: (0, 1, 2, 3), 3: (0, 1, 2, 3, 4, 5)}
CUBES = ("hex8", "hex20")  # whose eight integration points CalculiX numbers along xi first, then eta, then zeta


@dataclass(frozen=True)
class AtPoints:
    """A component of the stress, (n,), at places (n, dim) of integration points: elsewhere that of the nearest."""

    places: Array
    values: Array

    @cached_property
    def _tree(self) -> cKDTree:
        return cKDTree(self.places)

    def __call__(self, points: Array) -> NDArray[np.float64]:
        return np.asarray(self.values[self._tree.query(points)[1]])


def stress_before(deck: Deck, piece: Piece, plane: str | None) -> tuple[Given, ...] | None:
    """Components of ``Solid.initial_stress``: numbers where they are the same all over, else what is at integration points;
    None without. Elements that no line names have none. Raises DeckError for stresses that differ within an element whose
    integration points are not known to lie as the deck's."""
    given = {element: deck.stresses[element] for element in piece.elements.tolist() if element in deck.stresses}
    if not given:
        return None
    dim = 3 if plane is None else 2
    alike = {stress for stresses in given.values() for stress in stresses}
    if len(given) == len(piece.elements) and len(alike) == 1:
        stress = alike.pop()
        return tuple(stress[c] for c in COMPONENTS[dim])
    places, values = [], []
    for block in deck.blocks:
        ids = np.intersect1d(piece.elements, block.ids)
        if not len(ids):
            continue
        kind, rule = block.type.kind, cell_rule(block.type.kind, block.type.integration)
        shapes, _ = shape_functions(CELLS[kind].code, np.ascontiguousarray(rule[0]))
        at = deck.points[np.searchsorted(deck.nodes, element_nodes(block, ids))][..., :dim]
        places.append((shapes @ at).reshape(-1, dim))
        order = np.lexsort(np.round(rule[0], 9).T)
        values += [_at_rule(piece, e, given.get(e, ((0.0,) * 6,)), kind, order) for e in ids.tolist()]
    every, stress_at = np.concatenate(places), np.concatenate(values)
    return tuple(AtPoints(every, np.ascontiguousarray(stress_at[:, c])) for c in COMPONENTS[dim])


def _at_rule(
    piece: Piece, element: int, stresses: Sequence[tuple[float, ...]], kind: str, order: NDArray[np.int64]
) -> Array:
    """At the points of a rule, (n, 6), of which ``order`` is the one by zeta, eta, xi."""
    if len(set(stresses)) == 1:
        return np.broadcast_to(np.array(stresses[0]), (len(order), 6))
    if kind not in CUBES or len(stresses) != len(order) or len(order) != 8:
        raise DeckError(
            piece.section.place,
            f"*INITIAL CONDITIONS, TYPE=STRESS: element {element} has stresses that differ from point to point, and its "
            "integration points do not lie as CalculiX's; give one for all of them",
        )
    result = np.empty((len(order), 6))
    result[order] = stresses
    return result

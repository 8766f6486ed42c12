"""Terms of equations of a deck along the global axes: displacements of nodes, and turns of nodes of shells."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np
from numpy.typing import NDArray

from abut.io.deck.reasons import DeckError
from abut.io.deck.record import Deck
from abut.io.deck.thin_nodes import turn_terms
from abut.io.deck.thin_record import Thin

Vector = NDArray[np.float64]
Point = tuple[int, int]  # node, axis 0..2


def check(deck: Deck) -> None:
    """Raise InputError for an equation of a reference node, which is no displacement of any point, and of the turn of a node
    that has none."""
    for equation in deck.equations:
        for node, direction, _ in equation.terms:
            if node in deck.references:
                raise DeckError(
                    equation.place,
                    f"node {node} is the reference of a rigid body or coupling, and equations are for nodes of elements; "
                    "give its displacement with *BOUNDARY, or write the equation for one of its points",
                )
            if direction > 3 and (node not in deck.thin or deck.thin[node].along is None):
                raise DeckError(
                    equation.place,
                    f"*EQUATION: direction {direction}: node {node} has no turn of its own; directions 4 to 6 are for nodes "
                    "of shells that have one normal there",
                )


def along_axes(
    terms: tuple[tuple[int, int, float], ...],
    local: Mapping[int, Vector],
    own: Mapping[int, Vector],
    thin: Mapping[int, Thin],
) -> dict[Point, float]:
    """Terms (node, direction, coefficient) along the global axes. local: axes of nodes as rows; own: of those whose
    displacements have them here.

    The turn of a shell's node about its normal, which nothing resists, is an unknown by itself, of a node of no element: an
    equation that it stands in says what it is, and holds nothing else."""
    result: dict[Point, float] = {}
    for node, direction, coefficient in terms:
        if direction > 3:
            row = local.get(node, np.eye(3))[direction - 4]
            for point, share in turn_terms(node, thin[node], row).items():
                result[point] = result.get(point, 0.0) + coefficient * share
            continue
        row = own[node][direction - 1] if node in own else np.eye(3)[direction - 1]
        for k in np.flatnonzero(row).tolist():
            result[node, k] = result.get((node, k), 0.0) + coefficient * float(row[k])
    return result

"""Displacements of a global model's result file as those of the nodes of a deck."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path

import numpy as np

from abut.errors import InputError
from abut.io.deck.nodal_constraints import coordinates
from abut.io.deck.reasons import DeckError
from abut.io.deck.record import Deck, Prescribed
from abut.io.point_values import PointValues, read_values
from abut.probing.result_field import field_of

ARRAY, COMPONENTS = "DISP", ("D1", "D2", "D3")
Read = dict[tuple[str, int], PointValues]  # by file and step


def with_submodels(deck: Deck) -> Deck:
    """With numbers in place of what *BOUNDARY, SUBMODEL takes from other runs: between the global model's nodes by the shape
    functions of its cells.

    Raises InputError for nodes that no *SUBMODEL names, and for files without displacements of the step there."""
    known: Read = {}
    steps = [replace(step, values=tuple(_every(deck, step.values, known))) for step in deck.steps]
    return replace(deck, fixed=tuple(_every(deck, deck.fixed, known)), steps=tuple(steps))


def _every(deck: Deck, values: tuple[Prescribed, ...], known: Read) -> Iterator[Prescribed]:
    for value in values:
        if value.step:
            yield from _taken(deck, value, known)
        else:
            yield value


def _taken(deck: Deck, value: Prescribed, known: Read) -> Iterator[Prescribed]:
    """Of one line of a card: one value for the nodes that move alike."""
    named = [deck.submodels.get(node) for node in value.numbers.tolist()]
    if None in named:
        node = value.numbers[named.index(None)]
        raise DeckError(value.place, f"*BOUNDARY: SUBMODEL: node {node} is in no *SUBMODEL; name it in one")
    if max(value.directions) > len(COMPONENTS):
        raise DeckError(value.place, "*BOUNDARY: SUBMODEL: displacements have the directions 1 to 3; give these")
    for path in dict.fromkeys(filter(None, named)):
        nodes = value.numbers[[other == path for other in named]]
        try:
            if (path, value.step) not in known:
                known[path, value.step] = read_values(Path(path), ARRAY, value.step)
            for direction in value.directions:
                field = field_of(known[path, value.step], Path(path), ARRAY, COMPONENTS[direction - 1])
                found = field(coordinates(deck, nodes)[:, : field.mesh.dim])
                for size in np.unique(found).tolist():
                    yield replace(value, numbers=nodes[found == size], directions=(direction,), value=size, step=0)
        except InputError as error:
            raise DeckError(value.place, f"*BOUNDARY: SUBMODEL: {error}") from None

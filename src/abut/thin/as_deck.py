"""Shells and beams of a mesh as a deck has them."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from abut.cells import CELLS
from abut.io.deck.elements import ELEMENTS, ElementType
from abut.io.deck.reasons import Place
from abut.io.deck.record import (
    Amplitude,
    Block,
    Deck,
    Elastic,
    Expansion,
    Increments,
    Layer,
    Material,
    Prescribed,
    Section,
    Step,
)
from abut.mesh.thin.beams import EVEN
from abut.model.conditions import History
from abut.thin.quadratic import Sorted
from abut.thin.records import Shell, Thin

Numbers = NDArray[np.int64]
Value = tuple[str, Numbers, tuple[int, ...], float, History]  # kind, nodes, directions, value, history
FORMS = {
    (False, False): "rectangle",
    (True, False): "ellipse",
    (False, True): "box",
    (True, True): "pipe",
}  # round, hollow
PLACE = Place("", 0)  # of what no deck says
CODES = {"tri6": "S6", "quad8": "S8R", "line3": "B32"}
HINGED = {"tri6": "M3D6", "quad8": "M3D8"}
NOTHING = Material(
    "", Elastic("isotropic", ((0.0, (1.0, 0.0)),)), 0.0, Expansion(), PLACE
)  # sections of decks have one


def as_deck(parts: Sorted, sections: Mapping[str, Thin], where: str) -> Deck:
    """Nodes are the points, numbered from 1; the blocks of a shell or beam are called "NAME:KIND"."""
    blocks, made, first = list[Block](), list[Section](), 1
    for name, section in sections.items():
        start = first
        codes = HINGED if isinstance(section, Shell) and section.membrane else CODES
        for kind, cells in parts.bodies[name].items():
            nodes = (cells[:, [0, 2, 1]] if kind == "line3" else cells) + 1  # decks have the middle second
            ids = np.arange(first, first + len(cells))
            first += len(cells)
            blocks.append(Block(f"{name}:{kind}", ELEMENTS[codes[kind]], ids, nodes, Place(where, 0)))
        made.append(_section(name, section, np.arange(start, first)))
    for kind, cells in _solids(parts):
        blocks.append(
            Block(kind, ElementType(kind, None, "full"), np.arange(first, first + len(cells)), cells + 1, PLACE)
        )
        first += len(cells)
    sets = {name: np.unique(np.concatenate([c.ravel() for c in on.values()])) + 1 for name, on in parts.on.items()}
    return Deck(
        where, np.arange(1, len(parts.points) + 1), parts.points, tuple(blocks), sets, {}, {}, tuple(made), (), None, (), (),
        (), (), (), (), {}, {}, (), (), (), (),
    )  # fmt: skip


def _section(name: str, section: Thin, ids: Numbers) -> Section:
    if isinstance(section, Shell):
        each = section.thickness / (sum(section.layers) or 1.0)
        layers = tuple(Layer(each * part, NOTHING) for part in section.layers)
        return Section(name, ids, NOTHING, section.thickness, PLACE, offset=section.offset, layers=layers)
    (x, y, z), (first, second) = section.direction, section.offsets
    radius = (section.radius or 0.0) * (1.0 if section.wall else EVEN)
    a, b = section.widths or (2.0 * radius,) * 2
    form = FORMS[section.widths is None, section.wall is not None]
    return Section(
        name,
        ids,
        NOTHING,
        1.0,
        PLACE,
        widths=(a, b),
        axis=(x, y, z),
        offsets=(first, second),
        form=form,
        walls=(section.wall or 0.0,) * 4,
    )


def _solids(parts: Sorted) -> Iterator[tuple[str, Numbers]]:
    for each in parts.others.values():
        yield from ((kind, cells) for kind, cells in each.items() if kind != "point" and CELLS[kind].dim == 3)


def prescribed(deck: Deck, values: Sequence[Value]) -> Deck:
    """The deck with one step, and values in it."""
    histories = [history for history in dict.fromkeys(v[4] for v in values) if history is not None]
    names = {history: f"history {i}" for i, history in enumerate(histories)}
    given = tuple(
        Prescribed(kind, nodes, directions, value, names.get(history, "") if history else "", PLACE)
        for kind, nodes, directions, value, history in values
    )
    step = Step(1, 1.0, given, frozenset(), PLACE, Increments(1.0, 1.0, False))
    return replace(
        deck, steps=(step,), amplitudes={name: Amplitude(history.points, False) for history, name in names.items()}
    )

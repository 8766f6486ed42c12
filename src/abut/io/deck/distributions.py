"""*DISTRIBUTION: local axes of a section that differ from element to element."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import replace

import numpy as np

from abut.errors import nearest
from abut.io.deck.cards import Card, Line, as_float, of
from abut.io.deck.mesh_cards import MeshCards
from abut.io.deck.record import Numbers

NUMBERS = 6  # of two points, behind the elements


def axes_by_elements(
    card: Card, cards: Sequence[Card], mesh: MeshCards, known: Mapping[str, Card]
) -> Iterator[tuple[Numbers | None, Mapping[str, Card]]]:
    """Elements (None: all of the section) of one orientation, and the *ORIENTATION cards by name with that of the section as
    it counts there; later ones override earlier ones, as later sections do. card: of the section.

    Raises InputError for distributions that do not exist, and lines that are none."""
    name = (card.get("ORIENTATION") or "").upper()
    own = known.get(name)
    table = own.lines[0].text(0) if own is not None and own.lines else ""
    if own is None or not table or as_float(table) is not None:
        yield None, known
        return
    tables = {(other.get("NAME") or "").upper(): other for other in of(cards, "DISTRIBUTION")}
    if table.upper() not in tables:
        raise own.unknown(f"no *DISTRIBUTION named {table!r}{nearest(table.upper(), tables)}")
    every = mesh.element_sets.sets.get(card.need("ELSET").upper(), np.empty(0, np.int64))
    tables[table.upper()].first("elements and two points")
    parts: list[tuple[Numbers, Line]] = []
    for line in tables[table.upper()].lines:
        members = mesh.element_sets.resolve(line, 0, "element") if line.text(0) else every
        parts.append((np.intersect1d(every, members), line))
    if left := set(every.tolist()).difference(*(elements.tolist() for elements, _ in parts)):
        raise tables[table.upper()].error(
            f"element {min(left)} of '{card.get('ELSET')}' has no line; begin with a line for all others, without a name"
        )
    for elements, line in parts:
        if len(elements):
            at = Line(line.fields[1 : 1 + NUMBERS], line.place, line.card)
            yield elements, {**known, name: replace(own, lines=(at, *own.lines[1:]))}

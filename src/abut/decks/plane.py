"""Whether a deck is plane, and how thick."""

from __future__ import annotations

from abut.io.deck.reasons import DeckError
from abut.io.deck.record import Deck


def plane_of(deck: Deck) -> str | None:
    """One of "strain", "stress", "axisymmetric", or None in 3D. Raises InputError for elements of two of them."""
    planes = {block.type.plane: block for block in deck.blocks}
    if len(planes) > 1:
        codes = " and ".join(sorted(block.code for block in planes.values()))
        raise DeckError(
            list(planes.values())[1].place,
            f"*ELEMENT: elements {codes} in one deck: abut solves 3D, plane strain, "
            "plane stress or axisymmetry, not two of them together; use one of the types",
        )
    return next(iter(planes))


def thickness(deck: Deck, plane: str | None, notes: list[str]) -> float:
    """By which forces are divided: a plane model of abut is one unit thick."""
    if plane not in ("strain", "stress"):
        return 1.0
    values = {section.thickness: section for section in deck.sections}
    if len(values) > 1:
        place = next(reversed(values.values())).place
        raise DeckError(place, "*SOLID SECTION: sections of different thickness are not supported; give all the same")
    value = next(iter(values))
    if value != 1.0:
        notes.append(f"forces in the results are those of unit thickness: times {value:g} gives the deck's")
    return value

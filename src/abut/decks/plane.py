"""Whether a deck is plane, and how thick."""

from __future__ import annotations

from abut.io.deck.record import Deck


def solid_planes(deck: Deck) -> bool:
    """Whether plane and axisymmetric elements are to become solids: where they are of several kinds or thicknesses, have
    one at each node, or are beside others."""
    kinds = {block.type.plane for block in deck.blocks}
    if len(kinds) == 1:
        each = {section.thickness for section in deck.sections}
        return kinds <= {"strain", "stress"} and (len(each) > 1 or each == {0.0})
    return bool(kinds)


def plane_of(deck: Deck) -> str | None:
    """One of "strain", "stress", "axisymmetric", or None in 3D."""
    return None if solid_planes(deck) else next(block.type.plane for block in deck.blocks)


def thickness(deck: Deck, plane: str | None, notes: list[str]) -> float:
    """By which forces are divided: a plane model of abut is one unit thick."""
    if plane not in ("strain", "stress"):
        return 1.0
    value = deck.sections[0].thickness
    if value != 1.0:
        notes.append(f"forces in the results are those of unit thickness: times {value:g} gives the deck's")
    return value

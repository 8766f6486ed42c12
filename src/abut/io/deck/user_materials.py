"""User materials that CalculiX brings along by name (CrunchiX manual, 6.8) and that are elastic: as *ELASTIC."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

from abut.io.deck.cards import Card, as_float

LINEAR = ("LIN_ISO_EL", "UNDO_NLGEOM_LIN_ISO_EL", "UNDO_NLGEOM_LIN_EL")  # what names begin with
TYPES = {2: "ISO", 9: "ORTHO", 21: "ANISO"}  # by the number of constants


def with_elastic_laws(cards: Sequence[Card], notes: list[str]) -> tuple[Card, ...]:
    """The cards with *ELASTIC in place of *USER MATERIAL of such names; ``notes`` gets what is another law at large
    strains."""
    result, name = [], ""
    for card in cards:
        if card.key == "MATERIAL":
            name = (card.get("NAME") or "").upper()
        kind = TYPES.get(int(as_float(card.get("CONSTANTS") or "") or 0)) if card.key == "USERMATERIAL" else None
        if kind is not None and name.startswith(LINEAR):
            card = replace(card, key="ELASTIC", title="*ELASTIC", parameters={"TYPE": kind})
            if name.startswith("UNDO"):
                notes.append(
                    f"{card.place}: material '{name}': Green's strain, not stretches less one; alike where strains are small"
                )
        result.append(card)
    return tuple(result)

"""What a deck defines twice, and which definition counts, as runs of CalculiX 2.20 show; members that a set names twice."""

from __future__ import annotations

from collections.abc import Iterable, Sequence

from abut.io.deck.cards import Card
from abut.io.deck.mesh_cards import MeshCards

# Of these the first counts, with the cards that follow it and belong to it
FIRST = {
    "MATERIAL": ("ELASTIC", "HYPERELASTIC", "PLASTIC", "CYCLICHARDENING", "DENSITY", "EXPANSION"),
    "AMPLITUDE": (),
    "SURFACEINTERACTION": ("SURFACEBEHAVIOR", "FRICTION"),
}


def without_repeated(cards: Sequence[Card], notes: list[str]) -> tuple[Card, ...]:
    """Cards without second definitions of materials, amplitudes and interactions; ``notes`` gets them, and surfaces that are
    given twice, which are all of their faces or nodes together."""
    known: dict[tuple[str, ...], Card] = {}
    result: list[Card] = []
    dropped: tuple[str, ...] = ()
    for card in cards:
        if card.key in dropped:
            continue
        dropped = ()
        name = card.get("NAME")
        if name and (card.key in FIRST or card.key == "SURFACE"):
            kind = (card.get("TYPE") or "ELEMENT").upper() if card.key == "SURFACE" else ""
            first = known.setdefault((card.key, name.upper(), kind), card)
            if first is not card:
                counts = "both together make it up" if card.key == "SURFACE" else "the first counts"
                notes.append(
                    f"{card.place}: {card.title} '{name}' is defined a second time (first {first.place}): {counts}, as in "
                    "CalculiX"
                )
                if card.key in FIRST:
                    dropped = FIRST[card.key]
                    continue
        result.append(card)
    return tuple(result)


def repeated_members(cards: Iterable[Card], mesh: MeshCards) -> list[str]:
    """Notes on forces and pressures on sets that name a member more than once: CalculiX applies them as often."""
    result = {}
    for card in cards:
        if card.key not in ("CLOAD", "DLOAD"):
            continue
        sets, what = (mesh.node_sets, "node") if card.key == "CLOAD" else (mesh.element_sets, "element")
        for line in card.lines:
            name = line.text(0)
            twice = [] if name.upper() not in sets.repeated else sets.repeated[name.upper()].tolist()
            if twice and line.text(1).upper() not in ("GRAV", "CENTRIF"):
                result[name.upper()] = (
                    f"{line.place}: {card.title}: set '{name}' names {what} {twice[0]} more than once: the load acts on it "
                    "once, as in Abaqus; CalculiX applies it each time"
                )
    return list(result.values())

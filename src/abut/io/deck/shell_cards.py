"""Thickness at nodes of shells, beams and plane elements, and normals of shells there."""

from __future__ import annotations

from collections.abc import Sequence

from abut.io.deck.cards import Card, of
from abut.io.deck.mesh_cards import MeshCards
from abut.io.deck.reasons import Reasons


def nodal_thickness(cards: Sequence[Card], mesh: MeshCards, reasons: Reasons) -> dict[int, tuple[float, float]]:
    """Node -> thickness, and that along the second direction of beams; the later of two holds."""
    result: dict[int, tuple[float, float]] = {}
    for card in of(cards, "NODAL THICKNESS"):
        with reasons.gathered():
            for line in card.lines:
                value = line.number(1, "thickness")
                second = line.number(2, "second thickness", value)
                if not min(value, second) > 0.0:
                    raise line.error(f"thickness: expected a number > 0, got {min(value, second):g}")
                result |= dict.fromkeys(mesh.existing(line, 0).tolist(), (value, second))
    return result


def normals(
    cards: Sequence[Card], mesh: MeshCards, reasons: Reasons
) -> dict[tuple[int, int], tuple[float, float, float]]:
    """(element, node) -> normal of the shell there."""
    result: dict[tuple[int, int], tuple[float, float, float]] = {}
    for card in of(cards, "NORMAL"):
        with reasons.gathered():
            for line in card.lines:
                x, y, z = (line.number(i, "component of the normal", 0.0) for i in (2, 3, 4))
                if x == y == z == 0.0:
                    raise line.error("the normal has no length; give three components")
                for element in mesh.element_sets.resolve(line, 0, "element").tolist():
                    if element not in mesh.kinds:
                        raise line.unknown(f"element {element} does not exist")
                    result |= {(element, node): (x, y, z) for node in mesh.existing(line, 1).tolist()}
    return result

"""What nodes and elements of a deck have before the first step: temperatures and stresses."""

from __future__ import annotations

from collections.abc import Iterable, Iterator

from abut.io.deck.cards import Card, Line, key
from abut.io.deck.mesh_cards import MeshCards
from abut.io.deck.reasons import Reasons

Stress = tuple[float, ...]  # xx yy zz xy yz zx
NUMBERED = 8  # fields of a line with an integration point before six stresses, as CalculiX has them


def initial_temperature(cards: Iterable[Card], mesh: MeshCards, reasons: Reasons) -> dict[int, float]:
    """Temperature of nodes."""
    result: dict[int, float] = {}
    for card in _of_kind(cards, "TEMPERATURE"):
        with reasons.gathered(defines=True):
            for line in card.lines:
                value = line.number(1, "temperature")
                result |= dict.fromkeys(mesh.node_sets.resolve(line, 0, "node").tolist(), value)
    return result


def initial_stress(cards: Iterable[Card], mesh: MeshCards, reasons: Reasons) -> dict[int, tuple[Stress, ...]]:
    """Stresses of elements: one, or those at integration points, in turn."""
    result: dict[int, dict[int, Stress]] = {}
    for card in cards:
        if card.key != "INITIALCONDITIONS":
            continue
        with reasons.gathered(defines=True):
            kind = key(card.need("TYPE"))
            if kind not in ("TEMPERATURE", "STRESS"):
                raise card.error(f"TYPE={kind} is not supported; temperatures and stresses are read")
            for line in card.lines if kind == "STRESS" else ():
                point, stress = _stress(line)
                for element in mesh.element_sets.resolve(line, 0, "element").tolist():
                    result.setdefault(element, {})[point] = stress
    return {element: tuple(stress for _, stress in sorted(given.items())) for element, given in result.items()}


def _of_kind(cards: Iterable[Card], kind: str) -> Iterator[Card]:
    for card in cards:
        if card.key == "INITIALCONDITIONS" and key(card.get("TYPE") or "") == kind:
            yield card


def _stress(line: Line) -> tuple[int, Stress]:
    """Integration point (0: all) and stress of a line. The order of both codes is 11 22 33 12 13 23."""
    numbered = len(line.fields) >= NUMBERED
    first = 2 if numbered else 1
    point = int(line.number(1, "integration point")) if numbered else 0
    xx, yy, zz, xy, xz, yz = (line.number(first + i, f"stress {i + 1}", 0.0) for i in range(6))
    return point, (xx, yy, zz, xy, yz, xz)

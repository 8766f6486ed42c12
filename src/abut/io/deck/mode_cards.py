"""*FREQUENCY and *BUCKLE in the last step of a deck: what they ask for, and the static steps that are left."""

from __future__ import annotations

from collections.abc import Collection, Sequence
from dataclasses import dataclass

from abut.io.deck.cards import Card, key

PROCEDURES = ("FREQUENCY", "BUCKLE")
CHANGES = (
    "BOUNDARY",
    "CLOAD",
    "DLOAD",
    "DSLOAD",
    "TEMPERATURE",
    "MODELCHANGE",
    "CHANGEFRICTION",
    "CONTACTINTERFERENCE",
)


@dataclass(frozen=True)
class Modes:
    """What the last step asks for. kind: "FREQUENCY" or "BUCKLE"; count: how many; loaded: about the state after the steps
    before, stresses included; note: what is done otherwise than the deck says, empty for nothing."""

    kind: str
    count: int
    loaded: bool
    note: str = ""


def without_modes(cards: Sequence[Card], ignore: Collection[str] = ()) -> tuple[tuple[Card, ...], Modes | None]:
    """The cards without what asks for modes, and that; all of them and None where abut finds none such: but in the last
    step, below a limit of frequencies, with loads that a state of its own would need, of cyclic symmetry with nodal
    diameters from above 0 on; or ``ignore`` names the card.

    As the only step it becomes a static one: unloaded for frequencies, with its loads for buckling. *FREQUENCY after static
    steps needs PERTURBATION, as the state is otherwise not that of these steps."""
    starts = [i for i, card in enumerate(cards) if card.key == "STEP"]
    if not starts:
        return tuple(cards), None
    before, step = list(cards[: starts[-1]]), list(cards[starts[-1] :])
    asking = [card for card in step if card.key in PROCEDURES]
    count = _count(asking[0]) if len(asking) == 1 else None
    left_out = {key(name.lstrip("*")) for name in ignore}
    if count is None or asking[0].key in left_out:
        return tuple(cards), None
    card, perturbed = asking[0], step[0].has("PERTURBATION")
    changed = {other.key for other in step} & set(CHANGES)
    cyclic = any(other.key == "CYCLICSYMMETRYMODEL" for other in before)
    if cyclic and card.key == "FREQUENCY" and _lowest_diameter(step):
        return tuple(cards), None
    if len(starts) == 1 and not perturbed and (card.key == "BUCKLE" or changed <= {"BOUNDARY"}):
        static = Card("STATIC", "*STATIC", {}, (), card.place)
        return (*before, *(static if other is card else other for other in step)), Modes(
            card.key, count, False, _note(card, cyclic)
        )
    if len(starts) > 1 and perturbed and card.key == "FREQUENCY" and not changed:
        return tuple(before), Modes(card.key, count, True, _note(card, cyclic))
    return tuple(cards), None


def _note(card: Card, cyclic: bool) -> str:
    fields, told = card.lines[0].fields, []
    if card.key == "FREQUENCY" and len(fields) > 1 and fields[1].strip():
        told.append(f"frequencies below the lower limit of {fields[1].strip()} are given and counted, too")
    if cyclic:
        told.append("modes alike in all sectors (nodal diameter 0) are given, none that differ between sectors")
    return f"{card.place}: {'; '.join(told)}" if told else ""


def _lowest_diameter(step: Sequence[Card]) -> int:
    """Lowest nodal diameter that is asked for, 0 where nothing says."""
    texts = [card.get("NMIN") or "0" for card in step if card.key == "SELECTCYCLICSYMMETRYMODES"]
    return max((int(text) if text.strip().isdecimal() else 0 for text in texts), default=0)


def _count(card: Card) -> int | None:
    """How many modes; None where there is no such number, or an upper limit beside it."""
    known = {"SOLVER", "STORAGE"} if card.key == "FREQUENCY" else {"SOLVER"}
    if not card.lines or set(card.parameters) - known or (card.get("STORAGE") or "NO").upper() != "NO":
        return None
    fields = [text.strip() for text in card.lines[0].fields]
    upper = fields[2:3] if card.key == "FREQUENCY" else []
    if any(upper) or not fields[0].isdecimal() or not int(fields[0]):
        return None
    return int(fields[0])

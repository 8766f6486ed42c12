"""*CONTACT INTERFERENCE and *MODEL CHANGE of a deck: overlap that contact allows, and pairs that come and go."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np

from abut.errors import nearest
from abut.io.deck.cards import Card, Line, key
from abut.io.deck.contact_cards import sides
from abut.io.deck.mesh_cards import MeshCards
from abut.io.deck.mode_cards import Modes
from abut.io.deck.reasons import Reasons
from abut.io.deck.record import Amplitude, Pair, Prescribed, Step
from abut.io.deck.removed_elements import of_elements

CARD, CHANGE = "CONTACTINTERFERENCE", "MODELCHANGE"
FAR = 10.0  # sizes of the model: the overlap that a pair which is removed would allow


STAYS = " stays"  # a blank first: no name of a deck


@dataclass(frozen=True)
class Scene:
    """What the cards refer to."""

    mesh: MeshCards
    pairs: Sequence[Pair]
    amplitudes: Mapping[str, Amplitude]


def with_interferences(
    every: Sequence[Step], groups: Sequence[Sequence[Card]], scene: Scene, reasons: Reasons
) -> tuple[tuple[Step, ...], dict[str, Amplitude]]:
    """The steps with what their cards, in ``groups``, allow: values of kind "interference", whose numbers are those of
    pairs, or "shrink", of which the overlap of the mesh is the size; the amplitudes, with those by which they go down to
    zero. A pair that *MODEL CHANGE removes allows any overlap that can be, until it is added."""
    known, result = dict(scene.amplitudes), []
    for step, cards in zip(every, groups):
        values: list[Prescribed] = []
        new: set[str] = set()
        for card in cards:
            if card.key == CHANGE and not of_elements(card):
                with reasons.gathered():
                    known[STAYS] = Amplitude(((0.0, 1.0), (step.period, 1.0)), False)
                    values += _changes(card, scene)
            elif card.key == CARD:
                with reasons.gathered():
                    down = f" down over {step.period!r}"  # a blank first: no name of a deck
                    known[down] = Amplitude(((0.0, 1.0), (step.period, 0.0)), False)
                    values += _values(card, step, scene, down)
                    new |= {"interference"} if _operation(card) == "NEW" else set()
        result.append(replace(step, values=(*step.values, *values), new=step.new | new))
    return tuple(result), known


def _operation(card: Card) -> str:
    operation = key(card.get("OP", "MOD") or "")
    if operation not in ("NEW", "MOD"):
        raise card.error(f"OP={operation}: expected NEW or MOD")
    return operation


def _values(card: Card, step: Step, scene: Scene, down: str) -> Iterator[Prescribed]:
    if key(card.get("TYPE", "CONTACT PAIR") or "") != "CONTACTPAIR":
        raise card.error(f"TYPE={card.get('TYPE')}: contact elements are not supported; name surfaces of *CONTACT PAIR")
    shrinks, name = card.has("SHRINK"), (card.get("AMPLITUDE") or "").upper()
    if shrinks and step.number > 1:
        raise card.error("SHRINK: stands in the first step; move it there, or give the overlap as a number")
    if name and name not in scene.amplitudes:
        raise card.unknown(f"no *AMPLITUDE named {card.get('AMPLITUDE')!r}{nearest(name, scene.amplitudes)}")
    for line, slave, master in sides(card, scene.mesh):
        number = np.array([_number(line, slave, master, scene.pairs)])
        if shrinks:
            yield Prescribed("shrink", number, (0,), 1.0, down, line.place)
        else:
            size = line.number(2, "interference")
            yield Prescribed("interference", number, (0,), size, name or down, line.place)


def _changes(card: Card, scene: Scene) -> Iterator[Prescribed]:
    """Of *MODEL CHANGE."""
    if card.has("ADD") == card.has("REMOVE"):
        raise card.error("expected either ADD or REMOVE")
    far = FAR * float(np.ptp(scene.mesh.points, axis=0).max())
    for line, slave, master in sides(card, scene.mesh):
        number = np.array([_number(line, slave, master, scene.pairs)])
        yield Prescribed("interference", number, (0,), far if card.has("REMOVE") else 0.0, STAYS, line.place)


def opened(modes: Modes | None, scene: Scene, reasons: Reasons) -> Modes | None:
    """With the numbers of the pairs that steps which ask for modes take out."""
    if modes is None:
        return None
    result = []
    for asked in modes.asked:
        numbers: list[int] = []
        with reasons.gathered():
            for card in asked.removed:
                numbers += [
                    _number(line, slave, master, scene.pairs) for line, slave, master in sides(card, scene.mesh)
                ]
        result.append(replace(asked, open=tuple(numbers)))
    return replace(modes, asked=tuple(result))


def _number(line: Line, slave: str, master: str, pairs: Sequence[Pair]) -> int:
    found = [i for i, pair in enumerate(pairs) if {pair.slave, pair.master} == {slave, master}]
    if not found:
        raise line.unknown(f"'{slave}' and '{master}' are no *CONTACT PAIR")
    if pairs[found[0]].tied:
        raise line.error(f"'{slave}' and '{master}' are tied, and do neither overlap nor go; take the line out")
    if pairs[found[0]].span is not None:
        raise line.error(
            f"'{slave}' and '{master}' are glued in some steps only (*CHANGE SURFACE BEHAVIOR), and neither overlap nor go "
            "beside; take the line out, or make a deck for each state"
        )
    if slave == master:
        raise line.error(f"'{slave}' touches itself, which has no interference; take the line out")
    return found[0]

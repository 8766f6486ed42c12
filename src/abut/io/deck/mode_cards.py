"""*FREQUENCY and *BUCKLE of a deck: what they ask for, and the static steps that are left."""

from __future__ import annotations

from collections.abc import Collection, Sequence
from dataclasses import dataclass, replace

from abut.io.deck.cards import Card, as_float, key
from abut.io.deck.response_cards import Shaking, parted

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


# What makes the state after static steps another one than that of the unloaded model, but for stresses
NOT_LINEAR = ("CONTACTPAIR", "CONTACT", "PLASTIC", "HYPERELASTIC", "MODELCHANGE")


@dataclass(frozen=True)
class Modes:
    """What steps ask for beside statics. kind: "FREQUENCY" or "BUCKLE"; count: how many; loaded: about the state after the
    steps before, stresses included; note: what is done otherwise than the deck says, empty for nothing; diameters: nodal
    ones, of each of which there are ``count``; shaking: steps at the end whose loads shake what vibrates so;
    unloaded: at the end of the first step, too, which has no loads."""

    kind: str
    count: int
    loaded: bool
    note: str = ""
    diameters: tuple[int, ...] = (0,)
    shaking: tuple[Shaking, ...] = ()
    unloaded: bool = False


def without_modes(cards: Sequence[Card], ignore: Collection[str] = ()) -> tuple[tuple[Card, ...], Modes | None]:
    """The cards without what asks for modes, and that; all of them and None where abut finds none such: below a limit of
    frequencies, with loads that a state of its own would need; or ``ignore`` names the card.

    As the only step, or in several of nodal diameters, it becomes a static one: unloaded for frequencies, with its loads for
    buckling. *FREQUENCY after static steps is about their state with PERTURBATION; without, about the unloaded model, which
    has the same stiffness where nothing but stresses changes (``NOT_LINEAR``, and no NLGEOM). The first of two is about the
    end of an unloaded first step. Steps at the end that shake what vibrates are kept as static ones, with their loads."""
    starts = [i for i, card in enumerate(cards) if card.key == "STEP"]
    if not starts:
        return tuple(cards), None
    every = [list(cards[i:j]) for i, j in zip(starts, [*starts[1:], len(cards)])]
    found = parted(every)
    if found is None or not found[2]:
        return _without(cards, list(cards[: starts[0]]), every, ignore)
    steps, shaken, shaking = found
    left, modes = _without(cards, list(cards[: starts[0]]), steps, ignore)
    if modes is None or modes.kind != "FREQUENCY" or 0 not in modes.diameters:
        return tuple(cards), None
    return (*left, *(card for step in shaken for card in step)), replace(modes, shaking=shaking)


def _without(
    cards: Sequence[Card], before: list[Card], steps: list[list[Card]], ignore: Collection[str]
) -> tuple[tuple[Card, ...], Modes | None]:
    """``without_modes`` of cards before and in steps; all cards and None where abut finds no such modes."""
    asking = [step for step in steps if any(card.key in PROCEDURES for card in step)]
    wanted = [_wanted(step, before) for step in asking]
    left_out = {key(name.lstrip("*")) for name in ignore}
    first = next((found for found in wanted if found is not None), None)
    if first is None or any(found is None or found.kind in left_out for found in wanted):
        return tuple(cards), None
    if len({(found.kind, found.count, found.note) for found in wanted if found is not None}) > 1:
        return tuple(cards), None
    modes = replace(first, diameters=tuple(dict.fromkeys(d for found in wanted if found for d in found.diameters)))
    perturbed = [step[0].has("PERTURBATION") for step in asking]
    changed = {card.key for step in asking for card in step} & set(CHANGES)
    if len(steps) == len(asking) and not any(perturbed):
        if (len(steps) == 1 and (modes.kind == "BUCKLE" or changed <= {"BOUNDARY"})) or not changed:
            return (*before, *map(_as_static, steps[0])), modes
    elif len(asking) == 1 and modes.kind == "FREQUENCY" and not changed:
        where = steps.index(asking[0])
        others = [card for step in steps if step is not asking[0] for card in step]
        if perturbed[0] and where == len(steps) - 1:
            return (*before, *others), replace(modes, loaded=True)
        after = {card.key for step in steps[where + 1 :] for card in step}
        every = (*before, *others)
        linear = not any(card.key in NOT_LINEAR or card.has("NLGEOM") or card.has("NONLINEAR") for card in every)
        if not perturbed[0] and linear and not after & {"BOUNDARY"}:
            return every, modes
    elif [steps[0], steps[-1]] == asking and perturbed == [False, True] and modes.kind == "FREQUENCY" and not changed:
        if any(card.key in ("CONTACTPAIR", "CONTACT") for card in before):
            return tuple(cards), None  # where bodies just touch without load CalculiX has them apart, abut together
        start = [_as_large(card, steps[1][0]) for card in map(_as_static, steps[0])]
        loading = [card for step in steps[1:-1] for card in step]
        return (*before, *start, *loading), replace(modes, loaded=True, unloaded=True)
    return tuple(cards), None


def _as_large(card: Card, after: Card) -> Card:
    """*STEP of what has no loads, with the displacements, small or large, of the one after it."""
    if card.key != "STEP" or not after.has("NLGEOM"):
        return card
    return replace(card, parameters={**card.parameters, "NLGEOM": after.get("NLGEOM")})


def _as_static(card: Card) -> Card:
    return Card("STATIC", "*STATIC", {}, (), card.place) if card.key in PROCEDURES else card


def _wanted(step: Sequence[Card], before: Sequence[Card]) -> Modes | None:
    """What a step asks for; None where abut does not find it."""
    asking = [card for card in step if card.key in PROCEDURES]
    count = _count(asking[0]) if len(asking) == 1 else None
    if count is None:
        return None
    chosen = [card for card in step if card.key == "SELECTCYCLICSYMMETRYMODES"]
    models = [card for card in before if card.key == "CYCLICSYMMETRYMODEL"]
    if not models or asking[0].key != "FREQUENCY" or not chosen:
        return Modes(asking[0].key, count, False, _note(asking[0], bool(models)))
    diameters = _diameters(chosen[-1], models)
    return None if diameters is None else Modes("FREQUENCY", count, False, _note(asking[0], False), diameters)


def _diameters(card: Card, models: Sequence[Card]) -> tuple[int, ...] | None:
    """From NMIN, 0 where it is left out, to NMAX, or as many as there are; None for what are none."""
    sectors = {as_float(model.get("N") or "") for model in models}
    size = sectors.pop()
    if sectors or size is None:
        return None
    texts = [card.get("NMIN") or "0", card.get("NMAX") or str(int(size / 2.0))]
    if not all(text.strip().isdecimal() for text in texts):
        return None
    lowest, highest = map(int, texts)
    return tuple(range(lowest, highest + 1)) if lowest <= highest <= size / 2.0 else None


def _note(card: Card, cyclic: bool) -> str:
    fields, told = card.lines[0].fields, []
    if card.key == "FREQUENCY" and len(fields) > 1 and fields[1].strip():
        told.append(f"frequencies below the lower limit of {fields[1].strip()} are given and counted, too")
    if cyclic:
        told.append("modes alike in all sectors (nodal diameter 0) are given, none that differ between sectors")
    return f"{card.place}: {'; '.join(told)}" if told else ""


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

"""*FREQUENCY and *BUCKLE of a deck: what they ask for, and the static steps that are left."""

from __future__ import annotations

from collections.abc import Collection, Sequence
from dataclasses import dataclass, replace

from abut.io.deck.cards import Card, as_float, key
from abut.io.deck.reasons import Place
from abut.io.deck.response_cards import Shaking, parted, stored

COMPLEX = "COMPLEXFREQUENCY"
PROCEDURES = ("FREQUENCY", "BUCKLE", COMPLEX)
REMOVAL = "MODELCHANGE"
CHANGES = (
    "BOUNDARY",
    "CLOAD",
    "DLOAD",
    "DSLOAD",
    "TEMPERATURE",
    REMOVAL,
    "CHANGEFRICTION",
    "CHANGESOLIDSECTION",
    "CONTACTINTERFERENCE",
)


@dataclass(frozen=True)
class Asked:
    """What a step asks for, or several for more nodal diameters. place: of the step; count: how many; after: how many steps
    with loads come before; loaded: about the state that these end with, else about the model before anything acts;
    diameters: nodal ones, of each of which there are ``count``; removed: *MODEL CHANGE, by which contacts hold nothing;
    open: their numbers, once they are known; by: what makes modes complex, "CORIOLIS", "FRICTION" or nothing."""

    place: Place
    count: int
    after: int
    loaded: bool
    diameters: tuple[int, ...] = (0,)
    removed: tuple[Card, ...] = ()
    open: tuple[int, ...] = ()
    by: str = ""


@dataclass(frozen=True)
class Modes:
    """What steps ask for beside statics. kind: "FREQUENCY" or "BUCKLE"; asked: how many, and when; notes: what is done
    otherwise than the deck says; shaking: steps at the end whose loads shake what vibrates so, as the last ones say."""

    kind: str
    asked: tuple[Asked, ...]
    notes: tuple[str, ...] = ()
    shaking: tuple[Shaking, ...] = ()


def without_modes(cards: Sequence[Card], ignore: Collection[str] = ()) -> tuple[tuple[Card, ...], Modes | None]:
    """The cards without what asks for modes, and that; all of them and None where abut finds none such: below a limit of
    frequencies, with loads that a state of its own would need; or ``ignore`` names the card.

    Where there are no other steps the first becomes a static one, with its loads for buckling. *FREQUENCY with PERTURBATION
    is about the state that static steps before it end with; without, about the model before anything acts, as in CalculiX.
    *COMPLEX FREQUENCY is about the loaded state of the *FREQUENCY before it.
    Steps at the end that shake what vibrates are kept as static ones, with their loads."""
    starts = [i for i, card in enumerate(cards) if card.key == "STEP"]
    if not starts:
        return tuple(cards), None
    every = [list(cards[i:j]) for i, j in zip(starts, [*starts[1:], len(cards)])]
    found = parted(every)
    if found is None or not found[2]:
        return _without(cards, list(cards[: starts[0]]), every, ignore)
    steps, shaken, shaking = found
    left, modes = _without(cards, list(cards[: starts[0]]), steps, ignore)
    if modes is None or modes.kind != "FREQUENCY" or 0 not in modes.asked[-1].diameters:
        return tuple(cards), None
    return (*left, *(card for step in shaken for card in step)), replace(modes, shaking=shaking)


def _without(
    cards: Sequence[Card], before: list[Card], steps: list[list[Card]], ignore: Collection[str]
) -> tuple[tuple[Card, ...], Modes | None]:
    """``without_modes`` of cards before and in steps; all cards and None where abut finds no such modes."""
    asking = [i for i, step in enumerate(steps) if any(card.key in PROCEDURES for card in step)]
    if any(card.key == COMPLEX for step in steps for card in step):  # of modes that *FREQUENCY stores
        steps = [list(map(stored, step)) for step in steps]
    every = [card for i in asking for card in steps[i] if card.key in PROCEDURES]
    kinds, left_out = {card.key for card in every}, {key(name.lstrip("*")) for name in ignore}
    if not kinds or len(every) > len(asking) or kinds & left_out or ("BUCKLE" in kinds and len(steps) > 1):
        return tuple(cards), None
    asked = _asked(steps, asking, before)
    if asked is None:
        return tuple(cards), None
    cyclic = any(card.key == "CYCLICSYMMETRYMODEL" for card in before)
    notes = [_note(card, cyclic and not _chosen(steps[i])) for i, card in zip(asking, every)]
    others = [card for i, step in enumerate(steps) if i not in asking for card in step]
    left = others or map(_as_static, steps[0])
    return (*before, *left), Modes("BUCKLE" if "BUCKLE" in kinds else "FREQUENCY", asked, tuple(filter(None, notes)))


def _asked(steps: Sequence[Sequence[Card]], asking: Sequence[int], before: Sequence[Card]) -> tuple[Asked, ...] | None:
    """When and where modes are asked for; None where a step changes what abut does not change, or is about a loaded state
    that no step before it has."""
    result: list[Asked] = []
    alone = len(steps) == len(asking)
    for number, i in enumerate(asking):
        step, after = steps[i], i - number
        loaded, removed = step[0].has("PERTURBATION"), tuple(card for card in step if _removes(card))
        changed = {card.key for card in step if card not in removed} & set(CHANGES)
        allowed = set(CHANGES if _of_buckling(step) else ("BOUNDARY",)) if len(steps) == 1 else set()
        kept = removed and any(j not in asking for j in range(i, len(steps)))  # gone in steps with loads, too
        how = next(card for card in step if card.key in PROCEDURES)
        count, diameters, by = _count(how), _diameters(step, before), ""
        if how.key == COMPLEX:
            by, loaded = "CORIOLIS" if how.has("CORIOLIS") else "FRICTION", True
            if not result or not result[-1].loaded or result[-1].after < after or any(diameters or ()):
                return None
        if changed - allowed or kept or not count or diameters is None or (loaded and not after and not alone):
            return None
        gone = (*(result[-1].removed if result else ()), *removed)
        if (
            result
            and result[-1] == replace(result[-1], count=count, after=after, loaded=loaded, removed=gone, by=by)
            and not by
        ):
            diameters = tuple(dict.fromkeys((*result.pop().diameters, *diameters)))
        result.append(Asked(step[0].place, count, after, loaded, diameters, gone, by=by))
    return tuple(result)


def _of_buckling(step: Sequence[Card]) -> bool:
    """Whether a step asks for buckling loads."""
    return any(card.key == "BUCKLE" for card in step)


def _removes(card: Card) -> bool:
    """Whether a card takes contacts out."""
    return card.key == REMOVAL and card.has("REMOVE") and key(card.get("TYPE") or "") == "CONTACTPAIR"


def _as_static(card: Card) -> Card:
    if card.key == "STEP":
        return replace(
            card, parameters={name: value for name, value in card.parameters.items() if name != "PERTURBATION"}
        )
    return Card("STATIC", "*STATIC", {}, (), card.place) if card.key in PROCEDURES else card


def _chosen(step: Sequence[Card]) -> list[Card]:
    return [card for card in step if card.key == "SELECTCYCLICSYMMETRYMODES"]


def _diameters(step: Sequence[Card], before: Sequence[Card]) -> tuple[int, ...] | None:
    """From NMIN, 0 where it is left out, to NMAX, or as many as there are; None for what are none."""
    chosen, models = _chosen(step), [card for card in before if card.key == "CYCLICSYMMETRYMODEL"]
    if not (chosen and models) or _of_buckling(step):
        return (0,)
    sectors = {as_float(model.get("N") or "") for model in models}
    size = sectors.pop()
    if sectors or size is None:
        return None
    texts = [chosen[-1].get("NMIN") or "0", chosen[-1].get("NMAX") or str(int(size / 2.0))]
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
    known = {"FREQUENCY": {"SOLVER", "STORAGE"}, "BUCKLE": {"SOLVER"}, COMPLEX: {"CORIOLIS"}}[card.key]
    if not card.lines or set(card.parameters) - known or (card.get("STORAGE") or "NO").upper() != "NO":
        return None
    fields = [text.strip() for text in card.lines[0].fields]
    upper = fields[2:3] if card.key != "BUCKLE" else []
    if any(upper) or not fields[0].isdecimal() or not int(fields[0]):
        return None
    return int(fields[0])

"""*STEADY STATE DYNAMICS and *MODAL DYNAMIC of a deck: what they ask for, and steps that hold their loads."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

from abut.io.deck.cards import Card, as_float

STEADY, MODAL, DAMPING = "STEADYSTATEDYNAMICS", "MODALDYNAMIC", "MODALDAMPING"
POINTS, BIAS, STEPS, MOST_STEPS = 20, 3.0, 200, 10_000
KNOWN = {STEADY: {"HARMONIC", "SOLVER"}, MODAL: {"DIRECT", "DELTMX", "SOLVER"}}


@dataclass(frozen=True)
class Shaking:
    """A step of the kind. between: first and last frequency, None of what is transient; points, bias: as in
    ``abut.Harmonic``; period, steps: as in ``abut.Transient``; ratios: (first, last mode, share of critical damping);
    rayleigh: of mass and stiffness."""

    between: tuple[float, float] | None
    points: int
    bias: float
    period: float
    steps: int
    ratios: tuple[tuple[int, int, float], ...]
    rayleigh: tuple[float, float]

    def damping(self, count: int) -> tuple[float, ...]:
        """Of each of some modes."""
        result = [0.0] * count
        for first, last, ratio in self.ratios:
            result[first - 1 : last] = [ratio] * max(min(last, count) - first + 1, 0)
        return tuple(result) if any(result) else ()


def parted(steps: Sequence[list[Card]]) -> tuple[list[list[Card]], list[list[Card]], tuple[Shaking, ...]] | None:
    """Steps that come first, those at the end that shake, with *STATIC in place of what says how, and that; None where some
    step among others does so, or is not one that abut solves."""
    shaking = [any(card.key in KNOWN for card in step) for step in steps]
    first = shaking.index(True) if True in shaking else len(steps)
    loaded = any(step[0].has("PERTURBATION") and any(c.key == "FREQUENCY" for c in step) for step in steps[:first])
    found = [_shaking(step, loaded) for step in steps[first:]]
    kept = tuple(one for one in found if one is not None)
    if len(kept) < len(found) or sum(one.between is None for one in kept) > 1:
        return None
    return [list(map(stored, step)) for step in steps[:first]], [_static(step) for step in steps[first:]], kept


def stored(card: Card) -> Card:
    """*FREQUENCY without STORAGE, which it needs for what follows."""
    if card.key != "FREQUENCY":
        return card
    return replace(card, parameters={name: value for name, value in card.parameters.items() if name != "STORAGE"})


def _static(step: Sequence[Card]) -> list[Card]:
    kept = [card for card in step if card.key != DAMPING]
    first = replace(kept[0], parameters={name: v for name, v in kept[0].parameters.items() if name != "PERTURBATION"})
    return [first, *(Card("STATIC", "*STATIC", {}, (), card.place) if card.key in KNOWN else card for card in kept[1:])]


def _shaking(step: Sequence[Card], loaded: bool) -> Shaking | None:
    """loaded: whether modes are about a loaded state, which PERTURBATION then says of what is made of them, too."""
    procedures = [card for card in step if card.key in KNOWN]
    if len(procedures) != 1 or not procedures[0].lines or step[0].has("NLGEOM"):
        return None
    card = procedures[0]
    if step[0].has("PERTURBATION") and not (loaded and card.key == STEADY):
        return None
    if set(card.parameters) - KNOWN[card.key] or (card.get("HARMONIC") or "YES").upper() != "YES":
        return None
    numbers = [as_float(text.strip()) if text.strip() else 0.0 for text in card.lines[0].fields]
    damping = _damping([card for card in step if card.key == DAMPING])
    if damping is None or None in numbers or len(numbers) < 2:
        return None
    first, second, third, fourth, *_ = [number or 0.0 for number in (*numbers, 0.0, 0.0)]
    if card.key == STEADY:
        if not 0.0 <= first <= second:
            return None
        return Shaking((first, second), int(third) or POINTS, max(fourth or BIAS, 1.0), 1.0, 1, *damping)
    if not 0.0 < first <= second:
        return None
    fixed = (card.get("DIRECT") or "YES").upper() != "NO"
    steps = min(max(round(second / first), 1), MOST_STEPS) if fixed else STEPS
    return Shaking(None, POINTS, BIAS, second, steps, *damping)


def _damping(cards: Sequence[Card]) -> tuple[tuple[tuple[int, int, float], ...], tuple[float, float]] | None:
    """Shares by mode, and Rayleigh's; None where they cannot be read."""
    ratios, rayleigh = [], (0.0, 0.0)
    for card in cards:
        if set(card.parameters) - {"RAYLEIGH", "MODAL"}:
            return None
        for line in card.lines:
            values = [as_float(text.strip()) if text.strip() else 0.0 for text in line.fields]
            if None in values:
                return None
            first, last, third, fourth, *_ = [value or 0.0 for value in (*values, *[0.0] * 4)]
            if card.has("RAYLEIGH"):
                rayleigh = (third, fourth)
            elif first < 1.0:
                return None
            else:
                ratios.append((int(first), int(last or first), third))
    return tuple(ratios), rayleigh

"""Vibrations under loads that a deck asks for."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import replace

import numpy as np

from abut.decks.modes import time_of
from abut.io.deck.reasons import DeckError
from abut.io.deck.record import Amplitude, Deck, Step
from abut.io.deck.response_cards import Shaking
from abut.model import Harmonic, Load, Transient

AT_ONCE = " at once"  # no name of a deck: what acts from the outset


def without_shaking(deck: Deck) -> tuple[Deck, tuple[Deck, ...]]:
    """A deck without the steps that shake it, and for each of these the deck with its loads alone, on a time of its own."""
    count = len(deck.modes.shaking) if deck.modes is not None else 0
    still = [value for step in deck.steps[: len(deck.steps) - count] for value in step.values]
    for value in (*deck.fixed, *still):
        if value.imaginary:
            raise DeckError(value.place, "LOADCASE: imaginary parts belong to *STEADY STATE DYNAMICS; take it out")
    if not count:
        return deck, ()
    amplitudes = {**deck.amplitudes, AT_ONCE: Amplitude(((0.0, 1.0),), False)}
    alone = [
        replace(deck, steps=(_loads_alone(step, one),), amplitudes=amplitudes)
        for step, one in zip(deck.steps[-count:], deck.modes.shaking if deck.modes else ())
    ]
    return replace(deck, steps=deck.steps[:-count]), tuple(alone)


def _loads_alone(step: Step, shaking: Shaking) -> Step:
    values = []
    for value in step.values:
        if value.kind == "boundary":
            continue
        if value.kind in ("temperature", "centrifugal"):
            raise DeckError(value.place, f"{value.kind}: it does not vibrate; give forces in this step")
        if value.imaginary and shaking.between is None:
            raise DeckError(value.place, "LOADCASE: imaginary parts belong to *STEADY STATE DYNAMICS; take it out")
        if value.amplitude and shaking.between is not None:
            raise DeckError(
                value.place,
                "AMPLITUDE over frequency is not read; leave it out, and scale what comes out of each frequency",
            )
        values.append(replace(value, amplitude=value.amplitude or AT_ONCE))
    return replace(step, values=tuple(values), period=shaking.period, total=0.0, number=1)


def _part(alone: Deck, imaginary: bool) -> Deck:
    """With the loads of one part: real ones, or those a quarter of a period ahead."""
    (step,) = alone.steps
    kept = tuple(value for value in step.values if value.imaginary == imaginary)
    return replace(alone, steps=(replace(step, values=kept),))


def base(deck: Deck, step: Step, shaking: Shaking) -> tuple[float, ...] | None:
    """The shift of everything that is held, of which the supports of a step say that. Raises InputError for others."""
    moved = [value for value in step.values if value.kind == "boundary" and value.value]
    if any(value.imaginary for value in moved):
        raise DeckError(moved[0].place, "LOADCASE: supports move in phase with the loads only; leave it out")
    if not moved:
        return None
    place = moved[0].place
    if shaking.between is None:
        raise DeckError(
            place, "*BOUNDARY that moves in *MODAL DYNAMIC is not read; give *DLOAD, GRAV of the opposite acceleration"
        )
    held = [value for value in (*deck.fixed, *(v for s in deck.steps for v in s.values)) if value.kind == "boundary"]
    result = [0.0] * 3
    for direction in sorted({d for value in moved for d in value.directions}):
        of = [value for value in moved if direction in value.directions]
        every = [value.numbers for value in held if direction in value.directions]
        same = len({value.value for value in of}) == 1 and not any(value.amplitude for value in of)
        nodes = np.unique(np.concatenate([value.numbers for value in of]))
        if direction > 3 or not every or not same or not np.array_equal(nodes, np.unique(np.concatenate(every))):
            raise DeckError(
                place,
                "*BOUNDARY that moves: all that is held in a direction must be shaken, by one value; write it so",
            )
        result[direction - 1] = of[0].value
    return tuple(result)


def responses(
    deck: Deck, alone: Sequence[Deck], steps: Sequence[Step], dim: int, loads: Callable[[Deck], list[Load]]
) -> list[Harmonic | Transient]:
    """What the steps that shake ask for. alone: as from ``without_shaking``; loads: those of a deck; steps: its own."""
    result: list[Harmonic | Transient] = []
    if deck.modes is None:
        return result
    time = time_of(deck, deck.modes.asked[-1])
    for one, step, shaking in zip(alone, steps, deck.modes.shaking):
        shift, damping = base(deck, step, shaking), shaking.damping(deck.modes.asked[-1].count)
        found = loads(_part(one, False))
        if shaking.between is None:
            result.append(Transient(shaking.period, found, shaking.steps, damping or 0.0, shaking.rayleigh, time=time))
            continue
        ahead = loads(_part(one, True))
        result.append(
            Harmonic(
                shaking.between, [replace(load, amplitude=None) for load in found],
                [replace(load, amplitude=None) for load in ahead], shift[:dim] if shift else None,
                points=shaking.points, bias=shaking.bias, damping=damping or 0.0, rayleigh=shaking.rayleigh, time=time,
            )
        )  # fmt: skip
    return result

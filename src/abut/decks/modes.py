"""Frequencies and buckling loads that a deck asks for."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

from abut.decks.large import is_finite
from abut.io.deck.groups import Groups
from abut.io.deck.mode_cards import Asked
from abut.io.deck.passing_supports import passing
from abut.io.deck.reasons import DeckError
from abut.io.deck.record import Block, Deck
from abut.io.deck.sectors import turned_side
from abut.io.deck.time_histories import ends
from abut.model import Buckling, Frequencies


def modes(deck: Deck, groups: Groups, contacts: Sequence[str]) -> tuple[Frequencies | Buckling, ...]:
    """Of the steps that ask for them; contacts: names of the deck's pairs. Raises InputError for sectors of which no nodal
    diameters but 0 are found, and where the model before anything acts is another one than that of the step."""
    if deck.modes is None:
        return ()
    if deck.modes.kind == "BUCKLE":
        return (Buckling(deck.modes.asked[0].count),)
    return tuple(_frequencies(deck, groups, contacts, asked) for asked in deck.modes.asked)


def _frequencies(deck: Deck, groups: Groups, contacts: Sequence[str], asked: Asked) -> Frequencies:
    if not asked.loaded:
        _check_unloaded(deck, asked)
    names = tuple(contacts[number] for number in asked.open)
    wanted = Frequencies(asked.count, stiffening=asked.loaded, time=time_of(deck, asked), open=names)
    if asked.by:
        return replace(wanted, complex=asked.by == "FRICTION", coriolis=asked.by == "CORIOLIS")
    if not any(asked.diameters):
        return wanted
    side = groups.node_set(turned_side(deck, groups), "sector-side")
    return replace(wanted, diameters=asked.diameters, sectors=deck.cyclic[0].sectors, side=side)


def time_of(deck: Deck, asked: Asked) -> float | None:
    """Of the state that a step is about; None for the end."""
    share = ends(deck)[max(asked.after, 1) - 1] if asked.loaded else 0.0
    return None if share == 1.0 else share


def _check_unloaded(deck: Deck, asked: Asked) -> None:
    """Raise InputError where supports or elements at the time of a step are not those before anything acts."""
    now = ends(deck)[asked.after - 1] if asked.after else 0.0
    come = any(
        (stay.since < now and (stay.until is None or stay.until > now)) or (stay.since, asked.after) == (0.0, 0)
        for stays in passing(deck).values()
        for stay in stays
    )
    if come or (deck.absences and asked.after):
        raise DeckError(
            asked.place,
            "*FREQUENCY without PERTURBATION is about the unloaded model, and supports or elements come or go between the "
            "steps: not supported; make a deck of its own for this step, or add PERTURBATION",
        )


def loading_notes(deck: Deck) -> list[str]:
    """What CalculiX has about a loaded state, and abut does not; that contact holds nothing in an unloaded one."""
    if deck.modes is None or deck.modes.kind == "BUCKLE":
        return []
    touching = bool(deck.pairs or deck.general)
    told = [
        f"{asked.place}: *FREQUENCY without PERTURBATION is about the unloaded model, in which contact holds nothing, as in "
        "CalculiX; with *STEP, PERTURBATION what presses is held"
        for asked in deck.modes.asked
        if touching and not asked.loaded
    ]
    pushed = any(value.kind == "pressure" for step in deck.steps for value in step.values)
    if is_finite(deck) or not pushed or not any(asked.loaded for asked in deck.modes.asked):
        return told
    return [
        *told,
        f"{deck.steps[-1].place}: *FREQUENCY: pressures keep their direction as the loaded state vibrates, CalculiX "
        "lets them turn",
    ]


def with_stiff_beams(deck: Deck) -> Deck:
    """The deck with its beams fully integrated where it asks for modes: single cells with less have motions that no
    stiffness resists, which would be the lowest modes."""
    if deck.modes is None:
        return deck
    return replace(deck, blocks=tuple(map(_stiff, deck.blocks)))


def _stiff(block: Block) -> Block:
    if block.type.thin != "beam" or block.type.integration == "full":
        return block
    why = "full integration (C3D20) for modes: with less, single cells have motions without stiffness"
    told = f"{block.type.instead}; {why}" if block.type.instead else why
    return replace(block, type=replace(block.type, integration="full", instead=told))

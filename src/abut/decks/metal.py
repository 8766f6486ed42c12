"""Metal that yields of a deck, with its constants over the temperature."""

from __future__ import annotations

import numpy as np

from abut.decks.elastic import between, initial_temperature
from abut.io.deck.groups import Piece
from abut.io.deck.plastic_cards import table_at
from abut.io.deck.record import Deck
from abut.materials.plastic import Plastic
from abut.materials.temperature import OverTemperature


def metal_law(deck: Deck, piece: Piece) -> Plastic | OverTemperature:
    """Of a body. Raises InputError for constants that no material has."""
    material = piece.section.material
    elastic, swelling, metal = material.elastic.rows, material.expansion.rows, material.hardening
    several = [[at for at, _ in rows] for rows in (elastic, swelling, metal) if len(rows) > 1]
    temperatures = sorted({at for rows in several for at in rows}) or [0.0]
    given, tables = [at for at, _ in metal], [(at, own.table) for at, own in metal]
    moduli = [own.backstresses[0][0] for _, own in metal if own.backstresses]
    laws = []
    for at in temperatures:
        young, poisson = between(elastic, at)
        back = ((float(np.interp(at, given, moduli)), 0.0),) if moduli else ()
        expansion = between(swelling, at)[0]
        laws.append(
            Plastic(
                young, poisson, table_at(tables, at), backstresses=back, density=material.density, expansion=expansion
            )
        )
    if not several:
        return laws[0]
    return OverTemperature(temperatures, laws, initial_temperature(deck, piece), material.expansion.zero)

"""Rubber of a deck as abut's materials."""

from __future__ import annotations

from collections.abc import Callable, Mapping

from abut.io.deck.record import Deck, Rubber
from abut.materials.hyperelastic import NeoHooke
from abut.materials.material import Material
from abut.materials.rubber import ArrudaBoyce, MooneyRivlin, Ogden, Yeoh

Constants = tuple[float, ...]
LAWS: Mapping[str, Callable[[Constants, Constants, tuple[float, float]], Material]] = {
    "neo-hooke": lambda c, v, rest: NeoHooke(None, None, 2.0 * c[0], 2.0 * v[0], None, "isochoric", *rest),
    "mooney-rivlin": lambda c, v, rest: MooneyRivlin(2.0 * v[0], *rest, c10=c[0], c01=c[1]),
    "yeoh": lambda c, v, rest: Yeoh(v, *rest, c10=c[0], c20=c[1], c30=c[2]),
    "ogden": lambda c, v, rest: Ogden(v, *rest, terms=[(2.0 * mu / a, a) for mu, a in zip(c[::2], c[1::2])]),
    "arruda-boyce": lambda c, v, rest: ArrudaBoyce(2.0 * v[0], *rest, shear=c[0], locking=c[1]),
}


def of_rubber(rubber: Rubber, rest: tuple[float, float]) -> Material:
    """rest: density and expansion. Raises InputError for constants that no material has."""
    return LAWS[rubber.kind](rubber.constants, rubber.volume, rest)


def rubber_notes(deck: Deck) -> list[str]:
    """What volume changes are resisted by where a deck says nothing of it."""
    materials = {section.material.name: section.material for section in deck.sections}
    return [
        f"{material.place}: *MATERIAL '{name}': D1 = 0 is taken as 0.1 over the shear modulus, Poisson's ratio .475, as "
        "CalculiX does; Abaqus means no change of volume at all (hybrid elements)"
        for name, material in materials.items()
        if material.rubber is not None and material.rubber.assumed
    ]

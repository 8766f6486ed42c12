"""What a deck becomes before CalculiX runs it for comparison, and how its results are read. Needs no CalculiX."""

from __future__ import annotations

import sys
from pathlib import Path

import numpy as np
import pytest

sys.path.insert(0, str(Path(__file__).parents[1] / "bench" / "decks"))

import cards as deck_cards
import frd

import reference

DECK = """** a comment
*NODE, NSET=ALL
1, 0., 0., 0.
2, 2., 1., 1.
*ELEMENT, TYPE=C3D20R,
 ELSET=E
1, 1
*MATERIAL, NAME=M
*ELASTIC
100., 0.3
*SURFACE INTERACTION, NAME=A
*Surface  Behavior, pressure-overclosure=EXPONENTIAL
1.E-4, .1
*FRICTION
.2, 1.E3
*SURFACE INTERACTION, NAME=B
*SURFACE BEHAVIOR, PRESSURE-OVERCLOSURE=TIED
7.
*FRICTION
.1, 5.
*STEP, NLGEOM, INC=3
*STATIC
.1, 2.
*NODE PRINT, NSET=ALL
U
*END STEP
*STEP
*FREQUENCY
10
*END STEP
"""
RESULT = """    1C
  100CL  101 1.000000000           2                     0    1           1
 -4  DISP        4    1
 -5  D1          1    2    1    0
 -1         1 1.00000E+00-2.00000E+00 3.00000E-01
 -1     70000-1.00000E-10 0.00000E+00 4.00000E+00
 -3
 -4  STRESS      6    1
 -1         1 9.00000E+00 9.00000E+00 9.00000E+00
 -3
 -4  DISP        4    1
 -1         1 5.00000E+00 0.00000E+00 0.00000E+00
 -3
"""


@pytest.fixture
def deck(tmp_path: Path) -> list[deck_cards.Card]:
    path = tmp_path / "deck.inp"
    path.write_text(DECK, encoding="ascii")
    return deck_cards.read(path)


def test_an_edited_deck_has_stiff_contact_and_nothing_that_abut_ignores(deck: list[deck_cards.Card]) -> None:
    edited = reference.edit(deck, 5e6, ["NLGEOM", "FREQUENCY", "FRICTION"], "MORTAR")
    text = "\n".join(card.text() for card in edited)
    assert "NLGEOM" not in text
    assert "FREQUENCY\n10" not in text
    assert text.count("*STEP") == 1
    behaviors = [card for card in edited if card.name == "SURFACE BEHAVIOR"]
    assert [card.options["PRESSURE-OVERCLOSURE"] for card in behaviors] == ["LINEAR", "TIED"]
    assert [float(card.data[0].split(",")[0]) for card in behaviors] == [5e6, 5e6]
    friction = [card for card in edited if card.name == "FRICTION"]  # that of the tied interaction: its stick stiffness
    assert len(friction) == 1
    assert float(friction[0].data[0].split(",")[1]) == 5e6
    static = next(card for card in edited if card.name == "STATIC")
    assert [float(x) for x in static.data[0].split(",")[:2]] == [2.0, 2.0]
    assert [card.name for card in edited][-2:] == ["NODE FILE", "END STEP"]
    assert "NODE PRINT" not in text
    element = next(card for card in edited if card.name == "ELEMENT")
    assert element.options == {"TYPE": "C3D20R", "ELSET": "E"}  # a keyword line that went on


def test_displacements_are_read_by_columns(tmp_path: Path) -> None:
    path = tmp_path / "deck.frd"
    path.write_text(RESULT, encoding="ascii")
    first, last = frd.displacements(path)
    assert sorted(first) == [1, 70000]
    assert np.array_equal(first[1], [1.0, -2.0, 0.3])
    assert np.array_equal(first[70000], [-1e-10, 0.0, 4.0])
    assert np.array_equal(last[1], [5.0, 0.0, 0.0])


def test_differences_are_over_the_largest_displacement_of_their_step() -> None:
    big = {1: np.array([10.0, 0.0, 0.0]), 2: np.zeros(3)}
    small = {1: np.array([0.0, 0.1, 0.0]), 2: np.zeros(3)}
    near = {1: np.array([0.0, 0.1, 0.0]), 2: np.array([0.0, 0.0, 0.005])}
    assert reference.difference([big, small], [big, near]) == pytest.approx(0.05)

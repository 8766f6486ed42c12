"""What a deck becomes before CalculiX runs it for comparison, and how its results are read. Needs no CalculiX."""

from __future__ import annotations

import sys
from pathlib import Path

import numpy as np
import pytest

sys.path.insert(0, str(Path(__file__).parents[2] / "bench" / "decks"))

import cards as deck_cards
import count
import frd
import refine

import reference
from models.decks import BRICKS, HELD, PAIR, PUSH, write

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
    kept = [card for card in reference.edit(deck, 5e6, ["NLGEOM", "FREQUENCY"]) if card.name == "FRICTION"]
    assert [[float(x) for x in card.data[0].split(",")] for card in kept] == [[0.2, 5e6], [1e30, 5e6]]
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


CUBE = [(0, 0, 0), (1, 0, 0), (1, 1, 0), (0, 1, 0), (0, 0, 1), (1, 0, 1), (1, 1, 1), (0, 1, 1)]


def cubes(quadratic: bool) -> list[deck_cards.Card]:
    """Two cubes, 0.01 apart; the lower one's side at x = 1 held, the upper one pressed."""
    places = np.array(CUBE, dtype=float)
    if quadratic:
        places = np.vstack([places, [0.5 * (places[i] + places[j]) for i, j in refine.EDGES]])
    count = len(places)
    both = np.vstack([places, places + np.array([0.0, 0.0, 1.01])])
    cell = ["C3D8", "C3D20"][quadratic]
    numbers = [[e + 1, *range(1 + e * count, 1 + (e + 1) * count)] for e in range(2)]
    text = [
        "*NODE", *(f"{n}, {x!r}, {y!r}, {z!r}" for n, (x, y, z) in enumerate(both.tolist(), start=1)),
        f"*ELEMENT, TYPE={cell}", *(line for row in numbers for line in refine._lines(row)), "*NSET, NSET=SIDE",
        *(f"{n}," for n, x in enumerate(places, start=1) if x[0] == 1.0), "*SURFACE, NAME=UP", "1, S2",
        "*SURFACE, NAME=DOWN", "2, S1", "*CONTACT PAIR, INTERACTION=I, ADJUST=0.02", "DOWN, UP", "*DLOAD", "2, P2, 3.",
    ]  # fmt: skip
    return list(deck_cards._cards(text))


@pytest.mark.parametrize(("quadratic", "nodes", "on_a_face"), [(False, 27, 9), (True, 81, 21)])
def test_cut_cells_keep_sets_and_faces(quadratic: bool, nodes: int, on_a_face: int) -> None:
    cut = refine.refine(cubes(quadratic))
    by_name = {(card.name, card.options.get("NAME", "")): card for card in cut}
    at = {int(line.split(",")[0]): np.array(line.split(",")[1:], dtype=float) for line in by_name["NODE", ""].data}
    assert len(at) == 2 * nodes  # the two cubes do not grow together
    elements = refine._elements(by_name["ELEMENT", ""])
    assert [own[0] for own in elements] == list(range(1, 17))
    for own in elements:
        x = np.array([at[n] for n in own[1:9]])
        assert x - x[0] == pytest.approx(0.5 * np.array(CUBE, dtype=float))
    side = [int(line.rstrip(",")) for line in by_name["NSET", ""].data]
    assert len(side) == on_a_face
    assert {float(at[n][0]) for n in side} == {1.0}
    cells = {own[0]: np.array([at[n] for n in own[1:9]]) for own in elements}
    for name, z in (("UP", 1.0), ("DOWN", 1.01)):
        rows = [line.split(", ") for line in by_name["SURFACE", name].data]
        assert len(rows) == 4
        assert all((cells[int(n)][:, 2] == z).sum() == 4 for n, _ in rows)
    assert [line.split(", ")[1:] for line in by_name["DLOAD", ""].data] == [["P2", "3."]] * 4


def test_adjusted_nodes_lie_on_the_master_surface() -> None:
    card, *_, pair, _ = refine.adjusted(cubes(True))
    heights = {round(float(line.split(",")[3]), 9) for line in card.data}
    assert heights == {0.0, 0.5, 1.0, 1.51, 2.01}
    assert "ADJUST" not in pair.options


@pytest.mark.parametrize(
    ("more", "why"),
    [
        ("", ""),
        ("*DYNAMIC", "dynamics"),
        ("*HEAT TRANSFER", "heat transfer"),
        ("*FLUID CONSTANTS", "flow of fluids"),
        ("*SUBSTRUCTURE GENERATE", "substructures"),
        ("*CHANGE SOLID SECTION", "elements, materials and contact laws that change"),
    ],
)
def test_reasons_of_refused_decks(more: str, why: str, tmp_path: Path) -> None:
    text = BRICKS + PAIR + HELD + PUSH.replace("*STATIC", f"*STATIC\n{more}" if more else "*STATIC")
    found = count.read(write(tmp_path, text))
    assert found.startswith(why)
    assert bool(found) == bool(why)

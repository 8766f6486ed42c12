"""Sides of contact pairs as users of Abaqus name them: bodies all round, one surface alone."""

from __future__ import annotations

import pytest

from abut.errors import InputError
from abut.io.deck.elements import ELEMENTS
from models.decks import BRICKS, HELD, PAIR, PUSH, load

DECK = BRICKS + PAIR + HELD + PUSH


def test_a_surface_all_round_may_have_more_that_looks_the_other_way(tmp_path):
    """The upper brick's top, wider than its bottom, looks where the master looks; its bottom does not."""
    wide = (
        DECK.replace("15, 0,0,2", "15, -1,0,2").replace("18, 0,1,2", "18, -1,1,2").replace("2, S1\n", "2, S1\n2, S2\n")
    )
    assert load(tmp_path, wide).model.contacts[0].contactor == "SLAVE"


def test_one_surface_alone_touches_itself(tmp_path):
    alone = DECK.replace("SLAVE, MASTER\n", "SLAVE,\n")
    contact = load(tmp_path, alone.replace("*STEP", "*STEP, NLGEOM")).model.contacts[0]
    assert contact.contactor == contact.target == "SLAVE"
    with pytest.raises(InputError, match=r'a body touches itself only where it folds, .*kinematics = "finite"'):
        load(tmp_path, alone)


@pytest.mark.parametrize(
    ("old", "code", "integration", "words"),
    [("C3D8", "C3D8RH", "b-bar", "a pressure unknown"), ("C3D8", "C3D8H", "b-bar", "C3D8H: mean dilatation")],
)
def test_hybrid_elements_become_cells_that_do_not_lock(old, code, integration, words, tmp_path):
    model = load(tmp_path, DECK.replace(f"TYPE={old}", f"TYPE={code}"))
    assert {solid.integration for solid in model.model.solids} == {integration}
    assert any(words in note for note in model.notes)


@pytest.mark.parametrize(
    ("code", "integration"),
    [("CPE4H", "b-bar"), ("CAX4RH", "b-bar"), ("CPE8RH", "reduced"), ("CAX8H", "reduced"), ("CPE6MH", "reduced"),
     ("CPS4I", "full"), ("CPE4I", "b-bar"), ("CPS6M", "reduced"), ("C3D10MH", "reduced"), ("C3D20RH", "reduced")],
)  # fmt: skip
def test_hybrid_and_modified_elements_integrate_so_that_they_do_not_lock(code, integration):
    assert ELEMENTS[code].integration == integration
    assert ELEMENTS[code].instead

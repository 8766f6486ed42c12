"""Changes between steps that are ignored leave the first state, not the last."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

import abut
from abut.decks.translation import load_deck
from abut.errors import InputError
from models.decks import BRICKS, HELD, PAIR, PUSH, load, step


def test_an_ignored_change_of_contact_leaves_it_as_it_was(tmp_path: Path) -> None:
    pair = """*SURFACE INTERACTION, NAME=I
*SURFACE BEHAVIOR, PRESSURE-OVERCLOSURE=TIED
1.E7
*CONTACT PAIR, INTERACTION=I, TYPE=SURFACE TO SURFACE
SLAVE, MASTER
"""
    change = "*CHANGE SURFACE BEHAVIOR, INTERACTION=I\n*SURFACE BEHAVIOR, PRESSURE-OVERCLOSURE=LINEAR\n1.E7"
    text = BRICKS + pair + HELD + step("*BOUNDARY", "TOP, 3, 3, .1") + step(change)
    assert load(tmp_path, text, "CHANGE SURFACE BEHAVIOR").model.contacts[0].kind == "tied"
    with pytest.raises(
        InputError, match=r"\*CHANGE SURFACE BEHAVIOR: surfaces that are glued.*--ignore \"CHANGE SURFACE"
    ):
        load(tmp_path, text)
    with pytest.raises(InputError, match="glued"):
        load(tmp_path, text.replace("=LINEAR", "=X").replace("=TIED", "=HARD").replace("=X", "=TIED"))


def test_another_law_of_contact_is_no_other_contact(tmp_path: Path) -> None:
    """Contact without penetration is the same under every slope; a card without effect on what contact carries."""
    change = ["*CHANGE SURFACE BEHAVIOR, INTERACTION=I", "*SURFACE BEHAVIOR, PRESSURE-OVERCLOSURE=LINEAR", "1.E4"]
    job = load(tmp_path, BRICKS + PAIR + HELD + PUSH + step(*change, "*DLOAD", "2, P2, 20."))
    assert any("exact contact before and after" in note for note in job.notes)
    forces = [each.contacts[0].force[2] for each in abut.solve(job.model).steps]
    assert np.abs(forces) == pytest.approx([10.0, 20.0], rel=1e-9)
    deck = tmp_path / "deck.inp"
    with pytest.raises(InputError, match="changes between steps, which --soft-contact does not do"):
        load_deck(deck, soft=True)
    unknown = BRICKS + PAIR + HELD + PUSH + step(change[0].replace("=I", "=J"), *change[1:])
    with pytest.raises(InputError, match="no \\*SURFACE INTERACTION named 'J'"):
        load(tmp_path, unknown)

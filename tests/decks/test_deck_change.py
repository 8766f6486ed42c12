"""Changes between steps that are ignored leave the first state, not the last."""

from __future__ import annotations

from pathlib import Path

from models.decks import BRICKS, HELD, load, step


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

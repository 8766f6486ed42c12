"""Contact that changes between steps: another law, glue that lets go or sets. A change that is ignored leaves the first
state, not the last."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

import abut
from abut.decks.translation import load_deck
from abut.errors import InputError
from models.decks import BRICKS, HELD, PAIR, PUSH, load, step

GLUE = """*SURFACE INTERACTION, NAME=I
*SURFACE BEHAVIOR, PRESSURE-OVERCLOSURE={}
1.E7
*FRICTION
.2
*CONTACT PAIR, INTERACTION=I, TYPE=SURFACE TO SURFACE
SLAVE, MASTER
"""
CHANGE = "*CHANGE SURFACE BEHAVIOR, INTERACTION=I\n*SURFACE BEHAVIOR, PRESSURE-OVERCLOSURE={}\n1.E7"
PULLED = BRICKS + GLUE.format("TIED") + HELD + step("*BOUNDARY", "TOP, 3, 3, .1") + step(CHANGE.format("LINEAR"))


def _forces(model: abut.Model) -> list[list[float]]:
    return [[float(c.force[2]) for c in each.contacts] for each in abut.solve(model).steps]


def test_glue_lets_go_and_sets(tmp_path: Path) -> None:
    """Glued in the first step, in which it is pulled, and in contact in the second one, in which nothing holds it any more;
    the other way round it is pressed, and glued as it is then, so that it carries the same."""
    job = load(tmp_path, PULLED)
    (glue, touch), ends = job.model.contacts, (0.5, 0.5)
    assert [glue.kind, touch.kind, glue.until, touch.since, touch.friction] == ["tied", "contact", *ends, 0.2]
    assert glue.friction == 0.0
    assert any("glued in steps 1 to 1" in note for note in job.notes)
    assert any("exact contact from step 2 on" in note for note in job.notes)
    pulled, loose = _forces(job.model)
    assert abs(pulled[0]) > 1.0
    assert pulled[1] == 0.0
    assert loose == pytest.approx([0.0, 0.0], abs=1e-9 * abs(pulled[0]))
    pressed = BRICKS + GLUE.format("LINEAR") + HELD + step("*BOUNDARY", "TOP, 3, 3, -.1")
    before, after = _forces(load(tmp_path, pressed + step(CHANGE.format("TIED"))).model)
    assert after[1] == pytest.approx(before[0], rel=1e-9)
    assert (before[1], after[0]) == (0.0, 0.0)
    assert load(tmp_path, PULLED, "CHANGE SURFACE BEHAVIOR").model.contacts[0].until is None


def test_where_glue_cannot_change(tmp_path: Path) -> None:
    """With large displacements it does not set on the way; overlap of contact that is glued in some steps is not read."""
    pressed = (
        BRICKS + GLUE.format("LINEAR") + HELD + step("*BOUNDARY", "TOP, 3, 3, -.1").replace("*STEP", "*STEP, NLGEOM")
    )
    with pytest.raises(InputError, match="since: a tie begins on the way with kinematics"):
        load(tmp_path, pressed + step(CHANGE.format("TIED")))
    with pytest.raises(InputError, match="are tied, and do neither overlap nor go"):
        load(tmp_path, PULLED + step("*MODEL CHANGE, TYPE=CONTACT PAIR, REMOVE", "SLAVE, MASTER"))
    with pytest.raises(InputError, match="glued in some steps only"):
        load(
            tmp_path,
            pressed + step(CHANGE.format("TIED")) + step("*MODEL CHANGE, TYPE=CONTACT PAIR, REMOVE", "SLAVE, MASTER"),
        )
    with pytest.raises(InputError, match="NO SEPARATION goes without friction"):
        load(tmp_path, PULLED.replace("OVERCLOSURE=LINEAR", "OVERCLOSURE=LINEAR, NO SEPARATION"))


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

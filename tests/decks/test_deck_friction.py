"""Friction in decks: forms of *FRICTION, changes between steps, and what is refused."""

from __future__ import annotations

from pathlib import Path

import pytest

import abut
from abut.errors import InputError
from models.decks import BRICKS, PAIR, load, step

BEFORE, CARD = PAIR.split("*CONTACT PAIR")[0], "*FRICTION\n0.25, 1.E4\n"
AFTER = "*CONTACT PAIR" + PAIR.split("*CONTACT PAIR")[1]
HELD = "*BOUNDARY\nBOTTOM, 1, 3\nALL, 2, 2\nTOP, 1, 1\n"
PRESSED = step("*DLOAD", "2, P2, 10.")


def slid(far: float, *cards: str) -> str:
    return step("*BOUNDARY", f"TOP, 1, 1, {far}", *cards)


def deck(card: str = CARD, steps: str = PRESSED + slid(0.5)) -> str:
    return BRICKS + BEFORE + card + AFTER + HELD + steps


def change(coefficient: object, name: str = "I") -> tuple[str, ...]:
    return f"*CHANGE FRICTION, INTERACTION={name}", "*FRICTION", f"{coefficient}"


@pytest.mark.parametrize(
    ("card", "expected"),
    [
        ("*FRICTION\n0.25, 1.E4", 0.25),
        ("*FRICTION, SLIP TOLERANCE=0.005\n0.25,", 0.25),
        ("*FRICTION, ELASTIC SLIP=1.E-4\n0.25", 0.25),
        ("*FRICTION, LAGRANGE\n0.25", 0.25),
        ("*FRICTION, ROUGH", "rough"),
        ("*Friction, rough", "rough"),
        ("*FRICTION\n1.E20, 1.E7", "rough"),
        ("*FRICTION\n0.3, 0., 0.\n0.2, 0., 100.", ((0.0, 0.3), (100.0, 0.2))),
        ("*FRICTION\n0.3, , 0., 20.\n0.2, , 100., 20.", ((0.0, 0.3), (100.0, 0.2))),
    ],
)
def test_forms(tmp_path: Path, card: str, expected: object) -> None:
    job = load(tmp_path, deck(card + "\n"))
    assert job.model.contacts[0].friction == expected
    assert job.model.contacts[0].friction_amplitude is None
    soft = any(word in card for word in ("1.E4", "1.E7", "SLIP"))
    assert sum("stick slope is left out" in note for note in job.notes) == soft
    assert sum("taken as rough" in note for note in job.notes) == ("1.E20" in card)
    assert sum("each step of the deck is one load step" in note for note in job.notes) == 1


def test_no_word_of_increments_without_friction(tmp_path: Path) -> None:
    assert not [note for note in load(tmp_path, deck("*FRICTION\n0.\n")).notes if "friction" in note]


def test_interactions_as_abaqus_cae_writes_them(tmp_path: Path) -> None:
    """The thickness out of plane on a line of its own; general contact takes the same friction."""
    card = "*Surface Interaction, name=I\n1.,\n*Friction, slip tolerance=0.005\n 0.25,\n"
    card += "*Surface Behavior, pressure-overclosure=HARD\n"
    general = "*Contact\n*Contact Inclusions, ALL EXTERIOR\n*Contact Property Assignment\n , , I\n"
    for contact in (AFTER, general):
        (own,) = load(tmp_path, BRICKS + card + contact + HELD + PRESSED).model.contacts
        assert own.friction == 0.25


def test_table_over_pressure_when_all_slides(tmp_path: Path) -> None:
    """A mean pressure of 10, and 4 at the least: the last coefficient everywhere."""
    job = load(tmp_path, deck("*FRICTION\n0.3, 0., 0.\n0.28, 0., 2.\n"))
    assert abut.solve(job.model).contacts[0].force == pytest.approx([-2.8, 0.0, 10.0], abs=1e-9)


def test_change_from_the_beginning_of_a_step(tmp_path: Path) -> None:
    """Slides on with each step's coefficient: 0.25 in the second, 0.1 in the third, 0.4 in the fifth."""
    steps = PRESSED + slid(0.5) + slid(1.0, *change(0.1)) + slid(1.5) + slid(2.0, *change(0.4))
    solution = abut.solve(load(tmp_path, deck(steps=steps)).model)
    assert solution.converged
    along = [step.contacts[0].force[0] for step in solution.steps]
    assert along[1:] == pytest.approx([-2.5, -1.0, -1.0, -4.0], abs=1e-9)


def test_change_to_and_from_no_friction(tmp_path: Path) -> None:
    for first, later, expected in ((0.2, 0.0, [-2.0, 0.0]), (0.0, 0.2, [0.0, -2.0])):
        steps = PRESSED + slid(0.5) + slid(1.0, *change(later))
        solution = abut.solve(load(tmp_path, deck(f"*FRICTION\n{first}\n", steps)).model)
        assert [step.contacts[0].force[0] for step in solution.steps[1:]] == pytest.approx(expected, abs=1e-9)


def test_changes_left_out(tmp_path: Path) -> None:
    """The change alone, or all friction with it."""
    text = deck(steps=PRESSED + slid(0.5, *change(0.1)))
    job = load(tmp_path, text, "CHANGE FRICTION")
    assert (job.model.contacts[0].friction, job.model.contacts[0].friction_amplitude) == (0.25, None)
    assert len(job.ignored) == 2
    assert load(tmp_path, text, "FRICTION").model.contacts[0].friction == 0.0


def test_friction_of_tied_contact_is_none(tmp_path: Path) -> None:
    """Before or after the card that ties."""
    tie = "*SURFACE BEHAVIOR, PRESSURE-OVERCLOSURE=TIED\n1.E7\n"
    for cards in ("*FRICTION\n0.2, 1.E5\n" + tie, tie + "*FRICTION\n0.2, 1.E5\n"):
        job = load(tmp_path, BRICKS + "*SURFACE INTERACTION, NAME=I\n" + cards + AFTER + HELD + PRESSED)
        assert job.model.contacts[0].kind == "tied"
        assert sum("tied exactly instead" in note for note in job.notes) == 1


@pytest.mark.parametrize(
    ("card", "words"),
    [
        ("*FRICTION\n0.3, 1.\n0.2, 2.", "over the slip rate"),
        ("*FRICTION\n0.3, 0., 0., 20.\n0.2, 0., 0., 30.", "over the temperature"),
        ("*FRICTION\n0.3, 0., 100.\n0.2, 0., 50.", "contact pressures .* must increase from line to line, but 50"),
        ("*FRICTION\n0.3, 0., -1.\n0.2, 0., 50.", "must be >= 0, got -1"),
        ("*FRICTION\n0.3, 0., 0.\n-0.2, 0., 50.", "expected a coefficient >= 0, got '-0.2'"),
        ("*FRICTION, ROUGH\n0.1", "take the data line out"),
        ("*FRICTION, TAUMAX=50.\n0.1", "give the coefficient over pressure"),
        ("*FRICTION, EXPONENTIAL DECAY\n0.3, 0.2, 1.", "over the slip rate"),
        ("*FRICTION, ANISOTROPIC\n0.3, 0.2", "depends on the direction"),
        ("*FRICTION, DEPENDENCIES=1\n0.3, , , , 1.", "field variables"),
    ],
)
def test_refused(tmp_path: Path, card: str, words: str) -> None:
    with pytest.raises(InputError, match=words):
        load(tmp_path, deck(card + "\n"))


@pytest.mark.parametrize(
    ("first", "cards", "words"),
    [
        (CARD, change(0.1, "J"), "no \\*SURFACE INTERACTION named 'J'"),
        (CARD, ("*CHANGE FRICTION", "*FRICTION", "0.1"), "parameter INTERACTION is missing"),
        ("*FRICTION, ROUGH\n", change(0.1), "not from or to tables"),
        (CARD, ("*CHANGE FRICTION, INTERACTION=I", "*FRICTION, ROUGH"), "not from or to tables"),
        (CARD, ("*CHANGE FRICTION, INTERACTION=I, AMPLITUDE=A", "*FRICTION", "0.1"), "changes as a step begins"),
    ],
)
def test_changes_refused(tmp_path: Path, first: str, cards: tuple[str, ...], words: str) -> None:
    with pytest.raises(InputError, match=words):
        load(tmp_path, deck(first, PRESSED + slid(0.5, *cards)))

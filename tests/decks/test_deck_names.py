"""What a deck defines twice, sets in their own order, and cards and parameters that changed results in silence."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

import abut
from models.decks import BRICKS, HELD, PAIR, PUSH, load, solve, step

E = 1000.0
DECK = BRICKS + PAIR + HELD + PUSH
TWICE = "is defined a second time (first"


def test_of_two_materials_the_first_counts(tmp_path: Path) -> None:
    """As in CalculiX, with the cards that belong to it."""
    second = "*MATERIAL, NAME=el\n*ELASTIC\n2000., 0.\n*DENSITY\n7.\n*SOLID SECTION"
    job = load(tmp_path, DECK.replace("*SOLID SECTION", second))
    material = job.model.solids[0].material
    assert (material.young, material.density) == (1000.0, 2.0)
    assert any(f"*MATERIAL 'el' {TWICE}" in note and "the first counts" in note for note in job.notes)


def test_of_two_amplitudes_the_first_counts(tmp_path: Path) -> None:
    tables = "*AMPLITUDE, NAME=A\n0., 0., 1., 1.\n*AMPLITUDE, NAME=A\n0., 0., 1., 2.\n"
    text = BRICKS + PAIR + HELD + tables + step("*DLOAD, AMPLITUDE=A", "2, P2, 10.")
    assert any(f"*AMPLITUDE 'A' {TWICE}" in note for note in load(tmp_path, text).notes)
    assert solve(tmp_path, text).contacts[0].force[2] == pytest.approx(10.0, rel=1e-10)


def test_of_two_interactions_the_first_counts(tmp_path: Path) -> None:
    two = "*FRICTION\n0.2\n*SURFACE INTERACTION, NAME=I\n*FRICTION\n0.5\n*CONTACT PAIR"
    job = load(tmp_path, DECK.replace("*CONTACT PAIR", two))
    assert job.model.contacts[0].friction == 0.2
    assert any(f"*SURFACE INTERACTION 'I' {TWICE}" in note for note in job.notes)


@pytest.mark.parametrize("faces", [("2, S3", "2, S1"), ("2, S1", "2, S3")])
def test_two_surfaces_are_one_of_both(faces: tuple[str, str], tmp_path: Path) -> None:
    """As in CalculiX; with nodes, too."""
    both = "*SURFACE, NAME=SLAVE\n{}\n*SURFACE, NAME=SLAVE\n{}".format(*faces)
    job = load(tmp_path, DECK.replace("*SURFACE, NAME=SLAVE\n2, S1", both))
    assert len(job.model.mesh.surfaces["SLAVE"]) == 2
    assert any("both together make it up" in note for note in job.notes)
    assert abut.solve(job.model).contacts[0].force[2] == pytest.approx(10.0, rel=1e-10)
    halves = "*SURFACE, NAME=SLAVE, TYPE=NODE\n11\n12\n*SURFACE, NAME=SLAVE, TYPE=NODE\n13\n14"
    nodes = load(tmp_path, DECK.replace("*SURFACE, NAME=SLAVE\n2, S1", halves))
    assert len(nodes.model.mesh.surfaces["SLAVE"]) == 1


@pytest.mark.parametrize("a", ["", ", UNSORTED"])
@pytest.mark.parametrize("b", ["", ", UNSORTED"])
def test_equations_of_sets_go_by_their_order(a: str, b: str, tmp_path: Path) -> None:
    """Each node of A, free without its equation, follows one of B, whose displacement is its number."""
    extra = "31, 0,0,5\n32, 1,0,5\n33, 1,1,5\n34, 0,1,5\n*ELEMENT"
    sets = f"*NSET, NSET=A{a}\n18, 15, 17, 16\n*NSET, NSET=B{b}\n32, 31\n*NSET, NSET=B{b}\n34, 33\n"
    text = BRICKS.replace("*ELEMENT", extra, 1) + PAIR.replace("HARD", "TIED") + HELD + sets
    text += "*EQUATION\n2\nA, 3, 1., B, 3, -1.\n"
    given = {n: 1e-3 * n for n in (31, 32, 33, 34)}
    text += step("*BOUNDARY", *(f"{n}, 3, 3, {value}" for n, value in given.items()))
    order = [(18, 15, 17, 16) if a else (15, 16, 17, 18), (32, 31, 34, 33) if b else (31, 32, 33, 34)]
    expected = {n: given[m] for n, m in zip(*order)}
    top = solve(tmp_path, text).displacement[12:16, 2]
    assert top == pytest.approx([expected[n] for n in (15, 16, 17, 18)], rel=1e-12)


def test_ties_of_nodes_go_by_the_order_of_their_sets(tmp_path: Path) -> None:
    sets = "*NSET, NSET=A, UNSORTED\n14, 11, 13, 12\n*NSET, NSET=B, UNSORTED\n8, 5, 7, 6\n*MPC\nTIE, A, B\n"
    text = BRICKS + HELD.replace("ALL, 1, 2", "TOP, 1, 2") + sets + PUSH
    assert solve(tmp_path, text).displacement[12:16, 2] == pytest.approx(-0.02, rel=1e-9)
    assert len(load(tmp_path, text).model.equations) == 12


def test_all_displacements_given_by_equations(tmp_path: Path) -> None:
    """Nothing is left to solve for."""
    text = BRICKS + HELD + "*BOUNDARY\nALL, 3\n*EQUATION\n2\n15, 3, 1., 5, 3, -1.\n" + step()
    assert np.abs(solve(tmp_path, text).displacement).max() == 0.0


def test_nodes_in_cylindrical_coordinates(tmp_path: Path) -> None:
    """Radius, degrees, z; a spherical system is refused, without an option that leaves it out."""
    turned = DECK.replace(
        "2, 1,0,0\n3, 1,1,0\n", "*NODE, NSET=ALL, SYSTEM=C\n2, 1,360,0\n3, 1.4142135623730951,45,0\n*NODE\n"
    )
    points = load(tmp_path, turned.replace("*NODE\n4,", "*NODE, NSET=ALL\n4,")).model.mesh.points
    assert points[:4] == pytest.approx(np.array([[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0]]), abs=1e-15)
    with pytest.raises(abut.InputError, match="SYSTEM=S is not read") as raised:
        load(tmp_path, DECK.replace("NSET=ALL", "NSET=ALL, SYSTEM=S", 1))
    assert "--ignore" not in str(raised.value)


@pytest.mark.parametrize("card", ["*NODE, NSET=ALL", "*ELEMENT, TYPE=C3D8", "*NSET, NSET=TOP", "*ELSET, ELSET=EALL"])
def test_what_numbers_mean_cannot_be_left_out(card: str, tmp_path: Path) -> None:
    with pytest.raises(abut.InputError, match="STRANGE: abut does not know this parameter") as raised:
        load(tmp_path, DECK.replace(card, f"{card}, STRANGE=1", 1))
    assert "--ignore" not in str(raised.value)


def test_restarts(tmp_path: Path) -> None:
    """What is written is without effect; what is read would be."""
    assert load(tmp_path, "*RESTART, WRITE\n" + DECK).model
    with pytest.raises(abut.InputError, match="READ: the state at the end of an earlier run is not read") as raised:
        load(tmp_path, "*RESTART, READ, STEP=1\n" + DECK)
    assert "--ignore" not in str(raised.value)


@pytest.mark.parametrize(
    ("second", "more"), [("SLAVE, MASTER", ""), ("MASTER, SLAVE", ", and keep the one whose slave")]
)
def test_the_same_pair_twice(second: str, more: str, tmp_path: Path) -> None:
    pairs = f"SLAVE, MASTER\n*CONTACT PAIR, INTERACTION=I, TYPE=SURFACE TO SURFACE\n{second}"
    with pytest.raises(
        abut.InputError, match=r":\d+: .* are a pair already \(.*:\d+\): .* take one of the two out" + more
    ):
        load(tmp_path, DECK.replace("SLAVE, MASTER", pairs))


def test_parameters_for_shells(tmp_path: Path) -> None:
    """Solids have no thickness that contact could count, and no rotations."""
    assert load(tmp_path, DECK.replace("INTERACTION=I,", "INTERACTION=I, NO THICKNESS,")).model.contacts
    tie = "*TIE, NAME=T, NO THICKNESS, NO ROTATION\nSLAVE, MASTER\n"
    assert load(tmp_path, BRICKS + tie + HELD + PUSH).model.contacts[0].kind == "tied"


def test_sets_with_a_frequency(tmp_path: Path) -> None:
    """Stands in decks of CalculiX's own tests, without effect."""
    assert load(tmp_path, DECK.replace("*NSET, NSET=TOP", "*NSET, NSET=TOP, FREQUENCY=100")).model.contacts


@pytest.mark.parametrize("what", ["NSET=FACE", "ELSET=LOW"])
def test_rigid_bodies_that_are_a_part(what: str, tmp_path: Path) -> None:
    """Couple their nodes to the reference node: its force is that of a pressure, whose strain the brick above has; the one
    below, of which all nodes are rigid with ELSET, has none. CalculiX agrees to its digits."""
    tower = BRICKS.replace("2, 11,12,13,14,15", "2, 5,6,7,8,15").replace("2, S1", "2, S2")
    text = tower + "*NODE\n90, 0.5,0.5,1.5\n*NSET, NSET=FACE\n5,6,7,8\n"
    held = "*BOUNDARY\nTOP, 1, 3\n" + ("BOTTOM, 1, 2\n" if "NSET" in what[:4] else "")
    text += f"*RIGID BODY, {what}, REF NODE=90\n" + held + step("*CLOAD", "90, 3, 5.")
    job = load(tmp_path, text)
    assert any("*RIGID BODY is part of a body" in note for note in job.notes)
    solution = abut.solve(job.model)
    middle = (solution.model.mesh.points == [0, 0, 1]).all(axis=1)
    assert solution.displacement[middle, 2] == pytest.approx(5.0 / E, rel=1e-9)


def test_a_load_acts_once_on_a_member_that_its_set_names_twice(tmp_path: Path) -> None:
    """As in Abaqus; CalculiX adds it each time, so a note says so. Gravity acts once in both."""
    sets = "*NSET, NSET=DUP\n15, 15, 16\n*NSET, NSET=DUP\n16, 17, 18\n*ELSET, ELSET=DUP\n2, 2\n"
    text = BRICKS + sets + PAIR + HELD
    for card, line, total in (("*CLOAD", "DUP, 3, -2.5", 10.0), ("*DLOAD", "DUP, P2, 10.", 10.0)):
        job = load(tmp_path, text + step(card, line))
        (note,) = (note for note in job.notes if "more than once" in note)
        assert f"{card}: set 'DUP' names {'node 15' if card == '*CLOAD' else 'element 2'}" in note
        assert abut.solve(job.model).contacts[0].force[2] == pytest.approx(total, rel=1e-10)
    assert not any(
        "more than once" in note for note in load(tmp_path, text + step("*DLOAD", "DUP, GRAV, 1, 0,0,-1")).notes
    )

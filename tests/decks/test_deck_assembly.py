"""Decks with parts, instances and an assembly, as Abaqus/CAE writes them."""

from __future__ import annotations

import numpy as np
import pytest

from abut.errors import InputError
from abut.io.deck import read_deck
from abut.mesh.mesh import Mesh
from models.decks import BRICKS, HELD, load, solve, step, write

PART = """*HEADING
*PART, NAME=Brick
*NODE
1, 0,0,0
2, 1,0,0
3, 1,1,0
4, 0,1,0
5, 0,0,1
6, 1,0,1
7, 1,1,1
8, 0,1,1
*ELEMENT, TYPE=C3D8
1, 1,2,3,4,5,6,7,
8
*NSET, NSET=FOOT, GENERATE
1, 4, 1
*ELSET, ELSET=ALL
1
*ELSET, ELSET=_TOP_S2, INTERNAL
ALL
*SURFACE, TYPE=ELEMENT, NAME=TOP
_TOP_S2, S2
*SOLID SECTION, ELSET=ALL, MATERIAL=EL
,
*END PART
"""
PLACES = """*ASSEMBLY, NAME=Assembly
*INSTANCE, NAME=Brick-1, PART=Brick
*END INSTANCE
*INSTANCE, NAME="Brick 2", PART=Brick
0., 0., 1.
0.5, 0.5, 1.5, 1.5, 0.5, 1.5, 180.
*END INSTANCE
*NSET, NSET=FAR, INSTANCE="Brick 2"
1, 2
FOOT
*NSET, NSET=SIDES
Brick-1.1, "Brick 2".FOOT
*ELSET, ELSET=UPPER, INSTANCE="Brick 2"
1
*SURFACE, TYPE=ELEMENT, NAME=PRESSED
UPPER, S1
*END ASSEMBLY
"""
MODEL = """*MATERIAL, NAME=EL
*ELASTIC
1000., 0.
*SURFACE INTERACTION, NAME=I
*SURFACE BEHAVIOR, PRESSURE-OVERCLOSURE=HARD
*CONTACT PAIR, INTERACTION=I, TYPE=SURFACE TO SURFACE
"Brick 2".TOP, Brick-1.TOP
*BOUNDARY
Brick-1.FOOT, ENCASTRE
Assembly.FAR, 1, 2
"""
DECK = PART + PLACES + MODEL + step("*DSLOAD", "PRESSED, P, 10.")


def test_instances_stand_where_they_are_moved_and_turned(tmp_path):
    deck = read_deck(write(tmp_path, DECK))
    at = dict(zip(deck.nodes.tolist(), deck.points))
    np.testing.assert_allclose(at[1], (0, 0, 0), atol=1e-15)  # the first keeps its numbers
    assert deck.nodes.tolist() == [*range(1, 9), *range(11, 19)]
    np.testing.assert_allclose(at[11], (0, 1, 2), atol=1e-12)  # moved up by 1, then upside down about y = 0.5, z = 1.5
    np.testing.assert_allclose(at[15], (0, 1, 1), atol=1e-12)
    assert deck.node_sets["FAR"].tolist() == [11, 12, 13, 14]
    assert deck.node_sets["SIDES"].tolist() == [1, 11, 12, 13, 14]
    assert any("'Brick 2' + 10" in note for note in deck.notes)


def test_two_instances_press_on_each_other(tmp_path):
    solution = solve(tmp_path, DECK)
    assert solution.contacts[0].max_pressure == pytest.approx(10.0, rel=1e-9)  # Poisson's ratio 0: the pressure alone
    assert solution.displacement[:, 2].min() == pytest.approx(-10.0 / 1000.0 * 2.0, rel=1e-9)
    assert set(solution.model.mesh.bodies) == {"Brick-1.ALL", "Brick 2.ALL"}


def test_a_turn_is_by_the_right_hand(tmp_path):
    turned = DECK.replace("0.5, 0.5, 1.5, 1.5, 0.5, 1.5, 180.", "0, 0, 1, 0, 0, 2, 90.")
    deck = read_deck(write(tmp_path, turned))
    at = dict(zip(deck.nodes.tolist(), deck.points))
    np.testing.assert_allclose(at[12], (0, 1, 1), atol=1e-12)  # x becomes y
    np.testing.assert_allclose(at[14], (-1, 0, 1), atol=1e-12)


def test_the_mesh_alone_has_the_instances(tmp_path):
    mesh = Mesh.read(write(tmp_path, DECK))
    assert set(mesh.bodies) == {"Brick-1.ALL", "Brick 2.ALL"}
    assert {"Brick-1.TOP", "Brick 2.TOP", "PRESSED"} <= set(mesh.surfaces)


def test_reference_nodes_of_the_assembly_and_of_a_part(tmp_path):
    rigid = DECK.replace("*NSET, NSET=FAR", "*NODE\n1, 0.5, 0.5, 2.\n*NSET, NSET=RP\n1\n*NSET, NSET=FAR")
    rigid = rigid.replace("*END ASSEMBLY", '*RIGID BODY, REF NODE=RP, ELSET="Brick 2".ALL\n*END ASSEMBLY')
    rigid = rigid.replace("Assembly.FAR, 1, 2\n", "RP, 1, 2\nRP, 4, 6\n")
    end = step("*BOUNDARY", "RP, 3, 3, -0.01")
    solution = solve(tmp_path, rigid.partition("*STEP")[0] + end)
    assert solution.contacts[0].max_pressure == pytest.approx(0.01 * 1000.0, rel=1e-9)
    inside = DECK.replace("*ELEMENT, TYPE", "*NODE, NSET=RP\n9, 0.5, 0.5, 0.5\n*ELEMENT, TYPE", 1)
    inside = inside.replace("*END PART", "*RIGID BODY, REF NODE=RP, ELSET=ALL\n*END PART")
    assert [body.reference for body in read_deck(write(tmp_path, inside)).rigid] == [9, 19]


@pytest.mark.parametrize(
    ("old", "new", "words"),
    [
        ("PART=Brick\n*END", "PART=Bric\n*END", r"\*INSTANCE: no \*PART named 'Bric'; did you mean 'Brick'\?$"),
        ("*END PART\n", "", r"\*PART: \*END PART is missing; add it before line 26"),
        ("*END INSTANCE\n*INST", "*INST", r"\*INSTANCE: \*END INSTANCE is missing; add it before line 28"),
        ('INSTANCE="Brick 2"\n1, 2', "INSTANCE=Brick-2\n1, 2", r"\*NSET: no \*INSTANCE named 'Brick-2'; did you mean"),
        ("*END PART", "*BOUNDARY\nFOOT, 1\n*END PART", r"\*BOUNDARY: it is not read within a \*PART; move it behind"),
        ("1.5, 0.5, 1.5, 180.", "0.5, 0.5, 1.5, 180.", "the two points of the axis are the same"),
        ("1.5, 0.5, 1.5, 180.", "1.5, 0.5, 1.5", "angle in degrees is missing"),
        ("REF NODE=RP", "REF NODE=FAR", r"REF NODE: expected one node, but the set 'FAR' has 4"),
        ("REF NODE=RP", "REF NODE=RQ", r"REF NODE: expected a node number or a set of one node, got 'RQ'; known: "),
    ],
)  # fmt: skip
def test_faults_of_an_assembly_are_named(old, new, words, tmp_path):
    deck = DECK.replace("*NSET, NSET=FAR", "*NODE\n1, 0.5, 0.5, 2.\n*NSET, NSET=RP\n1\n*NSET, NSET=FAR")
    deck = deck.replace("*END ASSEMBLY", '*RIGID BODY, REF NODE=RP, ELSET="Brick 2".ALL\n*END ASSEMBLY')
    assert old in deck
    with pytest.raises(InputError, match=words):
        load(tmp_path, deck.replace(old, new, 1))


def test_a_part_without_instance_is_left_out_with_a_note(tmp_path):
    spare = PART.replace("*HEADING\n", "").replace("NAME=Brick", "NAME=Spare")
    assert any("part 'Spare' has no instance: left out" in note for note in load(tmp_path, spare + DECK).notes)


def test_surfaces_may_stand_before_the_sets_they_are_made_of(tmp_path):
    late = DECK.replace("*ELSET, ELSET=_TOP_S2, INTERNAL\nALL\n", "")
    late = late.replace("*SOLID SECTION", "*ELSET, ELSET=_TOP_S2, INTERNAL\nALL\n*SOLID SECTION")
    assert "Brick-1.TOP" in read_deck(write(tmp_path, late)).surfaces


def test_sets_that_abaqus_makes_for_itself_are_not_proposed(tmp_path):
    with pytest.raises(InputError, match=r"no node set named 'QQQ'; known: Brick 2\.FOOT, Brick-1\.FOOT, FAR, SIDES$"):
        load(
            tmp_path,
            DECK.replace("*END ASSEMBLY", "*NSET, NSET=_PICKED, INTERNAL\nFAR\n*END ASSEMBLY").replace(
                "Assembly.FAR", "QQQ"
            ),
        )


def test_what_is_left_of_an_assembly_taken_out_by_hand(tmp_path):
    flat = (
        BRICKS + HELD + "*NSET, NSET=MORE, INSTANCE=Part-1-1\n15, 16\n*END ASSEMBLY\n" + step("*CLOAD", "MORE, 3, 1.")
    )
    job = load(tmp_path, flat)
    told = [note.partition(": ")[2] for note in job.notes if "left out" in note]
    assert told == [
        "*NSET: INSTANCE: the deck has no instances: left out",
        "*END ASSEMBLY: nothing begins that ends here: left out",
    ]
    plain = load(tmp_path, flat.replace(", INSTANCE=Part-1-1", "").replace("*END ASSEMBLY\n", ""))
    assert plain.model.loads == job.model.loads

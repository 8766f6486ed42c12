"""*TIE and how close its surfaces must be. Limits in these tests are those that runs of CalculiX 2.20 found by bisection."""

from __future__ import annotations

from pathlib import Path

import pytest

import abut
from abut.cli import main
from abut.job import load_job
from models.decks import load, step

E = 1000.0
TWO_ON_ONE = """*NODE, NSET=ALL
1, 0,0,0
2, 2,0,0
3, 2,1,0
4, 0,1,0
5, 0,0,1
6, 2,0,1
7, 2,1,1
8, 0,1,1
11, 0,0,{a}
12, 1,0,{a}
13, 1,1,{a}
14, 0,1,{a}
15, 0,0,2
16, 1,0,2
17, 1,1,2
18, 0,1,2
21, 1,0,{b}
22, 2,0,{b}
23, 2,1,{b}
24, 1,1,{b}
25, 1,0,2
26, 2,0,2
27, 2,1,2
28, 1,1,2
*ELEMENT, TYPE=C3D8, ELSET=LOW
1, 1,2,3,4,5,6,7,8
*ELEMENT, TYPE=C3D8, ELSET=HIGH
2, 11,12,13,14,15,16,17,18
3, 21,22,23,24,25,26,27,28
*NSET, NSET=BOTTOM, GENERATE
1, 4
*NSET, NSET=TOP
15,16,17,18,25,26,27,28
*SURFACE, NAME=MASTER
1, S2
*SURFACE, NAME=SLAVE
HIGH, S1
*MATERIAL, NAME=EL
*ELASTIC
1000., 0.
*SOLID SECTION, ELSET=LOW, MATERIAL=EL
*SOLID SECTION, ELSET=HIGH, MATERIAL=EL
*TIE, NAME=T{more}
SLAVE, MASTER
*BOUNDARY
BOTTOM, 1, 3
ALL, 1, 2
"""
PULL = step("*BOUNDARY", "TOP, 3, 3, 0.01")
# CalculiX's default: 0.025 of the mean distance of the two triangles' centroids from a side, 1/3 and (2/sqrt 5)/3 of 2 x 1
DEFAULT = 0.025 * (1.0 / 3.0 + 2.0 / 5.0**0.5 / 3.0) / 2.0


def deck(a: float = 1.0, b: float = 1.0, more: str = "") -> str:
    return TWO_ON_ONE.format(a=a, b=b, more=more) + PULL


def forces(folder: Path, text: str) -> float:
    solution = abut.solve(load(folder, text).model)
    assert solution.converged
    return sum(abs(contact.force[2]) for contact in solution.contacts)


def test_faces_beyond_the_position_tolerance_are_not_tied(tmp_path: Path) -> None:
    """The second brick hangs 0.1 above: only the first pulls, by half the area, until the tolerance takes in the other."""
    both = forces(tmp_path, deck())
    assert both == pytest.approx(2.0 * E * 0.01 / 2.0, rel=1e-9)
    job = load(tmp_path, deck(b=1.1, more=", POSITION TOLERANCE=0.05"))
    assert any(
        "1 of 2 faces of 'SLAVE' are farther than 0.05 from 'MASTER', up to 0.1, and are" in n for n in job.notes
    )
    alone = abut.solve(job.model)
    assert alone.displacement[16:20, 2] == pytest.approx(0.01, abs=1e-12)  # goes with the top as it is
    assert abs(alone.contacts[0].force[2]) < 0.6 * both
    reached = load(tmp_path, deck(b=1.1, more=", POSITION TOLERANCE=0.15"))
    assert any("up to 0.1 apart are tied as they stand; CalculiX and Abaqus move" in note for note in reached.notes)
    assert abs(abut.solve(reached.model).contacts[0].force[2]) == pytest.approx(both, rel=0.06)  # one brick is 0.9 high


@pytest.mark.parametrize(
    ("more", "limit"),
    [
        ("", DEFAULT),
        (", POSITION TOLERANCE=0.", DEFAULT),
        (", POSITION TOLERANCE=0.03", 0.03),
        (", ADJUST=YES", 0.05 * 5.0**0.5),  # Abaqus: of the diagonal of the master's faces
        (", TYPE=SURFACE TO SURFACE", 0.05 * 5.0**0.5),
    ],
)
def test_what_is_near_enough(more: str, limit: float, tmp_path: Path) -> None:
    near = load(tmp_path, deck(b=1.0 + 0.99 * limit, more=more))
    assert not any("and are not tied" in note for note in near.notes)
    far = load(tmp_path, deck(b=1.0 + 1.01 * limit, more=more))
    assert any("1 of 2 faces" in note for note in far.notes)
    overlap = load(tmp_path, deck(b=1.0 - 1.01 * limit, more=more))
    assert any("1 of 2 faces" in note for note in overlap.notes)


def test_a_tie_that_holds_nothing_is_refused(tmp_path: Path) -> None:
    with pytest.raises(
        abut.InputError, match=r"the nearest is 0.1 away; write \*TIE, POSITION TOLERANCE=0.101 or more"
    ):
        load(tmp_path, deck(1.1, 1.2))
    for text in ("near", "-1."):
        with pytest.raises(abut.InputError, match=f"POSITIONTOLERANCE: expected a distance >= 0, got '{text}'"):
            load(tmp_path, deck(more=f", POSITION TOLERANCE={text}"))


def test_a_slave_that_is_larger_than_its_master(tmp_path: Path) -> None:
    """Faces beside the master, in its plane, count as near: what lies opposite is tied."""
    text = deck().replace("2, 2,0,0", "2, 1.5,0,0").replace("3, 2,1,0", "3, 1.5,1,0")
    text = text.replace("6, 2,0,1", "6, 1.5,0,1", 1).replace("7, 2,1,1", "7, 1.5,1,1", 1)
    assert not any("not tied" in note for note in load(tmp_path, text).notes)


QUADRATIC = """*NODE, NSET=ALL
1, 0,0
2, 1,0
3, 1,1
4, 0,1
5, .5,0
6, 1,.5
7, .5,1
8, 0,.5
11, 0,{y}
12, 1,{y}
13, 1,2
14, 0,2
15, .5,{y}
16, 1,1.5
17, .5,2
18, 0,1.5
*ELEMENT, TYPE=CPS8, ELSET=E
1, 1,2,3,4,5,6,7,8
2, 11,12,13,14,15,16,17,18
*SURFACE, NAME=MASTER
1, S3
*SURFACE, NAME=SLAVE
2, S1
*MATERIAL, NAME=EL
*ELASTIC
1000., 0.
*SOLID SECTION, ELSET=E, MATERIAL=EL
*TIE, NAME=T, POSITION TOLERANCE=0.1
SLAVE, MASTER
*BOUNDARY
1, 1, 2
"""


def test_edges_of_plane_elements(tmp_path: Path) -> None:
    text = QUADRATIC + step("*CLOAD", "13, 2, 1.")
    assert len(load(tmp_path, text.format(y=1.09)).model.contacts) == 1
    with pytest.raises(
        abut.InputError, match=r"no face of 'SLAVE' is within 0.1 of 'MASTER', the nearest is 0.11 away"
    ):
        load(tmp_path, text.format(y=1.11))


INSIDE = """*NODE, NSET=ALL
1, 0,0,0
2, 1,0,0
3, 1,1,0
4, 0,1,0
5, 0,0,1
6, 1,0,1
7, 1,1,1
8, 0,1,1
11, 0,0,0
12, .4,0,0
13, .4,1,0
14, 0,1,0
15, 0,0,1
16, .4,0,1
17, .4,1,1
18, 0,1,1
22, 1,0,0
23, 1,1,0
26, 1,0,1
27, 1,1,1
*ELEMENT, TYPE=C3D8, ELSET=LOW
1, 1,2,3,4,5,6,7,8
*ELEMENT, TYPE=C3D8, ELSET=HIGH
2, 11,12,13,14,15,16,17,18
3, 12,22,23,13,16,26,27,17
*SURFACE, NAME=MASTER
1, S2
*SURFACE, NAME=SLAVE
HIGH, S2
*SURFACE, NAME=PUSHED
HIGH, S1
*MATERIAL, NAME=EL
*ELASTIC
1000., 0.
*SOLID SECTION, ELSET=LOW, MATERIAL=EL
*SOLID SECTION, ELSET=HIGH, MATERIAL=EL
*TIE, NAME=T
SLAVE, MASTER
*BOUNDARY
1, 1, 3
2, 1, 3
3, 1, 3
4, 1, 3
11, 1, 2
12, 1, 2
13, 1, 2
14, 1, 2
22, 1, 2
23, 1, 2
"""


def test_surfaces_that_look_the_same_way(tmp_path: Path) -> None:
    """Two bars in one place, joined at their tops only: a pressure p on the foot of the one presses it and draws the other,
    each by p L / E."""
    job = load(tmp_path, INSIDE + step("*DSLOAD", "PUSHED, P, 10."))
    assert any("look the same way" in note and "6 slave nodes are tied one by one" in note for note in job.notes)
    assert not job.model.contacts
    solution = abut.solve(job.model)
    z, u = job.model.mesh.points[:, 2], solution.displacement[:, 2]
    assert u[z == 1.0] == pytest.approx(10.0 / E, rel=1e-9)
    assert u[8:][z[8:] == 0.0] == pytest.approx(20.0 / E, rel=1e-9)
    assert main(["convert", str(tmp_path / "deck.inp"), str(tmp_path / "job.toml"), "--quiet"]) == 0
    again = abut.solve(load_job(tmp_path / "job.toml").model)
    assert again.displacement == pytest.approx(solution.displacement, abs=1e-12)


def test_a_master_beside_its_slave_is_refused(tmp_path: Path) -> None:
    text = INSIDE
    for number, x, y in ((1, 0, 0), (2, 1, 0), (3, 1, 1), (4, 0, 1)):
        for n, z in ((number, 0), (number + 4, 1)):
            text = text.replace(f"\n{n}, {x},{y},{z}\n", f"\n{n}, {x + 9},{y},{z}\n")
    with pytest.raises(abut.InputError, match=r"\*TIE: no (node|face) of 'SLAVE'"):
        load(tmp_path, text + step("*DSLOAD", "PUSHED, P, 10."))

"""SPRING1, SPRING2 and SPRINGA of decks: springs side by side and in a row, and CalculiX's displacements."""

from __future__ import annotations

import shutil
import subprocess
from pathlib import Path

import numpy as np
import pytest

import abut
from abut.errors import InputError
from abut.job.convert import write_job
from abut.job.load import load_job
from models.decks import BRICKS, load, solve, step

CCX = shutil.which("ccx")
SAME = 1e-6  # of the largest displacement: CalculiX prints seven digits
EXACT = 1e-9
HIGH = [str(node) for node in range(11, 19)]  # of the upper brick
BAR = 1000.0  # E A / L of each of the two bricks, with nu = 0
AROUND = "*BOUNDARY\nALL, 1, 2\n"
PULL = step("*CLOAD", "TOP, 3, 2.5")  # 10 in all
FAR = (
    "*NODE\n20, 0, 0, -1\n21, 1, 0, -1\n22, 1, 1, -1\n23, 0, 1, -1\n*BOUNDARY\n20, 1, 3\n21, 1, 3\n22, 1, 3\n23, 1, 3\n"
)
BETWEEN = "*ELEMENT, TYPE={}, ELSET=MID\n101, 5, 11\n102, 6, 12\n103, 7, 13\n104, 8, 14\n*SPRING, ELSET=MID\n"
LOOSE = "*NODE\n30, 0, 0, -1\n"
FOOT = "*ELEMENT, TYPE=SPRING1, ELSET=FOOT\n201, 1\n202, 2\n203, 3\n204, 4\n*SPRING, ELSET=FOOT\n3\n25.\n"


def top(solution: abut.Solution) -> float:
    return float(solution.displacement[solution.model.mesh.points[:, 2] == 2.0, 2].mean())


def test_in_a_row(tmp_path: Path) -> None:
    """Bricks on four springs of 25, and four of 12.5 between both: 10 (1/100 + 1/1000 + 1/50 + 1/1000)."""
    solution = solve(tmp_path, BRICKS + AROUND + FOOT + BETWEEN.format("SPRING2") + "3, 3\n12.5\n" + PULL)
    assert top(solution) == pytest.approx(10.0 * (1 / 100 + 2 / BAR + 1 / 50), rel=EXACT)
    assert [spring.name for spring in solution.model.springs] == ["FOOT", "MID"]  # one of each card
    assert solution.steps[-1].springs["FOOT"] == pytest.approx([0.0, 0.0, -10.0], abs=1e-7)
    moved = BRICKS + AROUND + FOOT + BETWEEN.format("SPRINGA") + "\n12.5\n" + PULL
    apart = "\n".join(  # bricks a length of 1 apart, which gives springs along their line a direction
        line[:-1] + str(int(line[-1]) + 1) if line[:2] in HIGH and line.count(",") == 3 else line
        for line in moved.splitlines()
    )
    found = solve(tmp_path, apart + "\n")
    high = found.displacement[found.model.mesh.points[:, 2] == 3.0, 2].mean()
    assert high == pytest.approx(10.0 * (1 / 100 + 2 / BAR + 1 / 50), rel=EXACT)


@pytest.mark.parametrize(("kind", "law"), [("SPRING2", "3, 3\n25.\n"), ("SPRINGA", "25.\n"), ("SPRINGA", "\n25.\n")])
def test_to_the_ground(kind: str, law: str, tmp_path: Path) -> None:
    """Nodes of no element that are held are the ground; a spring twice as often at one node is twice as stiff there."""
    tied = BETWEEN.format("SPRING2") + "3, 3\n1.e9\n"
    springs = f"*ELEMENT, TYPE={kind}, ELSET=G\n201, 1, 20\n202, 2, 21\n203, 3, 22\n204, 4, 23\n*SPRING, ELSET=G\n{law}"
    once = solve(tmp_path, BRICKS + AROUND + FAR + tied + springs + PULL)
    assert top(once) == pytest.approx(10.0 * (1 / 100 + 2 / BAR), rel=1e-6)  # what is tied gives 10 / 4e9
    assert not any("node 20" in note for note in load(tmp_path, BRICKS + AROUND + FAR + tied + springs + PULL).notes)
    twice = springs.replace("201, 1, 20\n", "201, 1, 20\n301, 1, 20\n302, 2, 21\n303, 3, 22\n304, 4, 23\n")
    assert top(solve(tmp_path, BRICKS + AROUND + FAR + tied + twice + PULL)) == pytest.approx(
        10.0 * (1 / 200 + 2 / BAR), rel=1e-6
    )


def test_aslant_to_the_ground(tmp_path: Path) -> None:
    """Springs at the foot along (0, 3, 4) / 5 resist upward displacements by 16 / 25 of their stiffness."""
    far = FAR.replace(", 0, -1\n", ", -3, -4\n").replace(", 1, -1\n", ", -2, -4\n")
    springs = "*ELEMENT, TYPE=SPRINGA, ELSET=G\n201, 1, 20\n202, 2, 21\n203, 3, 22\n204, 4, 23\n*SPRING, ELSET=G\n25.\n"
    text = BRICKS + AROUND + far + springs + step("*BOUNDARY", "11, 1, 3", "12, 1, 3", "13, 1, 3", "14, 1, 3", "*CLOAD",
                                                  "5, 3, 2.5", "6, 3, 2.5", "7, 3, 2.5", "8, 3, 2.5")  # fmt: skip
    solution = solve(tmp_path, text)
    rise = solution.displacement[:4, 2]
    assert rise == pytest.approx(np.full(4, 2.5 / (25.0 * 16 / 25)), rel=EXACT)


@pytest.mark.parametrize("card", ["*STEP", "*STEP, NLGEOM"])
def test_tables(card: str, tmp_path: Path) -> None:
    """Each of four carries 2.5: 1 at .1, then 2 a length more; beyond its end the force is constant, as in CalculiX."""
    law = "3\n-1., -.1\n0., 0.\n1., .1\n21., 10.1\n"
    foot = FOOT.replace("*SPRING, ELSET=FOOT\n3\n25.\n", "*SPRING, ELSET=FOOT, NONLINEAR\n" + law)
    low = "".join(f"*BOUNDARY\n{n}, 1, 3\n" for n in (11, 12, 13, 14))
    text = BRICKS + AROUND + low + foot + step("*CLOAD", "1, 3, 2.5", "2, 3, 2.5", "3, 3, 2.5", "4, 3, 2.5")
    loaded = load(tmp_path, text.replace("*STEP", card))
    assert abut.solve(loaded.model).displacement[0, 2] == pytest.approx(0.1 + 1.5 / 2.0, rel=1e-8)
    assert any("slope at no elongation" in note for note in loaded.notes) == ("NLGEOM" not in card)
    bent = text.replace("21., 10.1\n", "2., .6\n").replace("2.5", "1.5")
    assert solve(tmp_path, bent.replace("*STEP", card)).displacement[0, 2] == pytest.approx(0.1 + 0.5 / 2.0, rel=1e-8)
    spring = load(tmp_path, bent).model.springs[0].z
    assert spring[-1][1] == spring[-2][1] == pytest.approx(4 * 2.0)  # of four together


def test_of_a_part_and_converted(tmp_path: Path) -> None:
    """Within a *PART, and in the job file that abut convert writes of it: the same answer."""
    inside, _, steps = (BRICKS + FOOT + BETWEEN.format("SPRING2") + "3, 3\n12.5\n").partition("*NONE")
    material = inside[inside.index("*MATERIAL") : inside.index("*SOLID")]
    text = (
        f"*PART, NAME=P\n{inside.replace(material, '')}*END PART\n*ASSEMBLY, NAME=A\n"
        "*INSTANCE, NAME=I, PART=P\n*END INSTANCE\n"
        f"*END ASSEMBLY\n{material}*BOUNDARY\nI.ALL, 1, 2\n{steps}" + step("*CLOAD", "I.TOP, 3, 2.5")
    )
    wanted = 10.0 * (1 / 100 + 2 / BAR + 1 / 50)
    assert top(solve(tmp_path, text)) == pytest.approx(wanted, rel=EXACT)
    far = BRICKS + AROUND + FAR + BETWEEN.format("SPRING2") + "3, 3\n12.5\n"
    ground = (
        "*ELEMENT, TYPE=SPRINGA\n201, 1, 20\n202, 2, 21\n203, 3, 22\n204, 4, 23\n*ELSET, ELSET=G, GENERATE\n201, 204\n"
    )
    job = load(tmp_path, far + ground + "*SPRING, ELSET=G\n25.\n" + PULL)
    assert not any("does not exist" in note for note in job.notes)
    write_job(tmp_path / "job.toml", job)
    assert top(abut.solve(load_job(tmp_path / "job.toml").model)) == pytest.approx(wanted, rel=EXACT)


@pytest.mark.parametrize(
    ("before", "after", "says"),
    [
        ("3\n25.", "4\n25.", "direction 4: solids have displacements only"),
        ("3\n25.", "3", "stiffness is missing"),
        ("3\n25.", "3\n-25.", r"\*SPRING: z: expected a number > 0"),
        ("3\n25.", "3\n25.\n30., 100.", "several temperatures"),
        ("*SPRING, ELSET=FOOT", "*SPRING, ELSET=EALL", "no spring elements"),
        ("*SPRING, ELSET=FOOT\n3\n25.\n", "", r"SPRING1 201 and 3 more without \*SPRING"),
        ("204, 4", "204, 99", "node 99 does not exist"),
        ("ELSET=FOOT\n3", "ELSET=FOOT, ORIENTATION=O\n3", "ORIENTATION: axes of its own are not read"),
        (FOOT, "*TRANSFORM, NSET=BOTTOM\n0, 1, 0, -1, 0, 0\n" + FOOT, "has axes of its own"),
        (FOOT, FOOT.replace("SPRING1", "SPRING2").replace("\n3\n", "\n3,2\n").replace("201, 1", "201, 1, 5")
         .replace("202, 2", "202, 2, 6").replace("203, 3", "203, 3, 7").replace("204, 4", "204, 4, 8"), "need the same one"),
        (FOOT, FAR + "*ELEMENT, TYPE=SPRINGA, ELSET=S\n201, 20, 21\n*SPRING, ELSET=S\n5.\n",
         "no end is a node of an element"),
    ],
)  # fmt: skip
def test_refused(before: str, after: str, says: str, tmp_path: Path) -> None:
    text = BRICKS + AROUND + FOOT + PULL
    assert before in text
    with pytest.raises(InputError, match=says):
        load(tmp_path, text.replace(before, after))


def test_left_out(tmp_path: Path) -> None:
    """With --ignore SPRING elements and card go, and are listed."""
    job = load(tmp_path, BRICKS + AROUND + "*BOUNDARY\nBOTTOM, 3\n" + FOOT + PULL, "SPRING")
    assert not job.model.springs
    assert any("SPRING" in what for what in job.ignored)


SLANT = """*ELEMENT, TYPE=SPRINGA, ELSET=S
101, 7, 20
102, 6, 3
103, 3, 8
*SPRING, ELSET=S
60.
*ELEMENT, TYPE=SPRING1, ELSET=T
104, 6
105, 7
*SPRING, ELSET=T
2
20.
*ELEMENT, TYPE=SPRING2, ELSET=V
106, 7, 4
107, 2, 21
*SPRING, ELSET=V
1, 1
15.
"""


@pytest.mark.skipif(CCX is None, reason="CalculiX is not installed")
def test_as_calculix(tmp_path: Path) -> None:
    """Springs aslant between nodes and to the ground, in directions, on a soft brick: every displacement."""
    text = (
        BRICKS[: BRICKS.index("11, 0,0,1")]
        + "20, 3,2,1\n21, 2,1,1\n*ELEMENT, TYPE=C3D8, ELSET=LOW\n1, 1,2,3,4,5,6,7,8\n"
    )
    text += "*MATERIAL, NAME=EL\n*ELASTIC\n1000., .3\n*SOLID SECTION, ELSET=LOW, MATERIAL=EL\n" + SLANT
    text += "*BOUNDARY\n1, 1, 3\n2, 2, 3\n3, 3\n4, 3\n20, 1, 3\n21, 1, 3\n"
    text += step("*CLOAD", "7, 1, 10.", "7, 2, 4.", "*NODE PRINT, NSET=ALL", "U")
    here = load(tmp_path, text)
    subprocess.run([str(CCX), "deck"], cwd=tmp_path, check=True, capture_output=True, timeout=60)
    lines = [line.split() for line in (tmp_path / "deck.dat").read_text().splitlines()]
    table = np.array([[float(x) for x in line] for line in lines if len(line) == 4 and line[0].isdigit()])
    wanted = table[np.argsort(table[:, 0])][:8, 1:]
    found = abut.solve(here.model).displacement[:8]
    assert np.abs(found - wanted).max() < SAME * np.abs(wanted).max()


@pytest.mark.skipif(CCX is None, reason="CalculiX is not installed")
def test_dashpots_have_no_effect(tmp_path: Path) -> None:
    """In static steps, as in CalculiX, whose displacements these are; a note says so."""
    held = BRICKS + AROUND + FOOT + BETWEEN.format("SPRING2") + "3, 3\n12.5\n"
    dashpots = "*ELEMENT, TYPE=DASHPOTA, ELSET=DAMP\n301, 1, 5\n302, 2, 6\n*ELSET, ELSET=SOME\n301\n"
    dashpots += "*DASHPOT, ELSET=DAMP\n\n1.e6\n"
    text = held + dashpots + step("*CLOAD", "TOP, 3, 2.5", "*NODE PRINT, NSET=ALL", "U")
    here = load(tmp_path, text)
    assert any("without effect" in note and "*DASHPOT" in note for note in here.notes)
    subprocess.run([str(CCX), "deck"], cwd=tmp_path, check=True, capture_output=True, timeout=60)
    lines = [line.split() for line in (tmp_path / "deck.dat").read_text().splitlines()]
    table = np.array([[float(x) for x in line] for line in lines if len(line) == 4 and line[0].isdigit()])
    wanted = table[np.argsort(table[:, 0]), 1:]
    found = abut.solve(here.model).displacement
    assert np.abs(found - wanted).max() < SAME * np.abs(wanted).max()


def test_dashpots_are_refused_where_they_act(tmp_path: Path) -> None:
    """In what is shaken after *FREQUENCY they damp in CalculiX."""
    text = BRICKS.replace("*ELASTIC", "*DENSITY\n1.\n*ELASTIC") + AROUND + FOOT
    text += "*ELEMENT, TYPE=DASHPOTA, ELSET=DAMP\n301, 1, 5\n*DASHPOT, ELSET=DAMP\n\n1.e6\n"
    text += "*STEP\n*FREQUENCY, STORAGE=YES\n3\n*END STEP\n"
    text += "*STEP\n*STEADY STATE DYNAMICS\n1., 2.\n*CLOAD\nTOP, 3, 2.5\n*END STEP\n"
    with pytest.raises(InputError, match=r"\*DASHPOT: vibrations have no dashpots; give \*MODAL DAMPING"):
        load(tmp_path, text)
    load(tmp_path, text, "DASHPOT")

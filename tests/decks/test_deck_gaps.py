"""GAPUNI of decks between two bars in a row, and springs at corners of shells: closed forms."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from scipy.optimize import brentq

import abut
from abut.errors import InputError
from models.decks import BRICKS, load, step

BAR = 1000.0  # E A / L of each of the two bricks, with nu = 0
HELD = "*BOUNDARY\nALL, 1, 2\nBOTTOM, 3\n"
GAPS = "*ELEMENT, TYPE=GAPUNI, ELSET=MID\n101, 5, 11\n102, 6, 12\n103, 7, 13\n104, 8, 14\n*GAP, ELSET=MID\n{}\n"


def opening(directory: Path, gap: str, moved: float) -> float:
    """How far the upper bar is from the lower one at the end, less how far it was, the top moved by so much."""
    text = BRICKS + HELD + GAPS.format(gap) + step("*BOUNDARY", f"TOP, 3, 3, {moved}")
    solution = abut.solve(load(directory, text).model)
    z, u = solution.model.mesh.points[:, 2], solution.displacement[:, 2]
    at = np.flatnonzero(np.isclose(z, 1.0))
    assert len(at) == 8  # four of each bar
    return float(u[at[4:]].mean() - u[at[:4]].mean())


@pytest.mark.parametrize("direction", ["0., 0., 1.", "0., 0., 3."])
def test_a_gap_closes(direction: str, tmp_path: Path) -> None:
    """By its clearance and no more: it is rigid. Of 1 from node 5 to 11 the ends come closer by 0.1."""
    assert opening(tmp_path, f"0.1, {direction}", -0.3) == pytest.approx(-0.1, abs=1e-3 * 0.1)
    assert opening(tmp_path, f"0.1, {direction}", -0.05) == pytest.approx(-0.05, rel=1e-9)  # still open


def test_a_gap_the_other_way(tmp_path: Path) -> None:
    """Along -z it stops the second node from going up."""
    assert opening(tmp_path, "0.1, 0., 0., -1.", 0.3) == pytest.approx(0.1, abs=1e-3 * 0.1)


@pytest.mark.parametrize("moved", [-0.3, 0.3])
def test_with_a_spring_constant(moved: float, tmp_path: Path) -> None:
    """Four gaps in a row with two bars, and the force over the penetration that the manual of CalculiX has: within what the
    table of it is off, .002 of the tension, over the stiffness."""
    stiffness, tension = 50.0, 0.5
    width = np.pi * tension / stiffness

    def left(p: float) -> float:
        force = 4.0 * stiffness * p * (0.5 + np.arctan(p / width) / np.pi)
        return p + moved + 2.0 * force / BAR

    wanted = -float(brentq(left, -1.0, 1.0))
    found = opening(tmp_path, f"0., 0., 0., 1., , {stiffness}, {tension}", moved)
    assert found == pytest.approx(wanted, abs=0.002 * 4.0 * tension * 2.0 / BAR)


@pytest.mark.parametrize(
    ("gap", "words"),
    [
        ("0.1, 0., 1., 1.", r"\*GAP: expected a direction along one global axis"),
        ("0.1, 0., 0., 0.", r"\*GAP: expected a direction along one global axis"),
        ("0.1, 0., 0., 1., , -5.", r"\*GAP: expected a spring constant > 0"),
    ],
)
def test_refused(gap: str, words: str, tmp_path: Path) -> None:
    with pytest.raises(InputError, match=words):
        load(tmp_path, BRICKS + HELD + GAPS.format(gap) + step("*CLOAD", "TOP, 3, -1."))


def test_with_the_card_of_another(tmp_path: Path) -> None:
    text = BRICKS + HELD + GAPS.format("0.1, 0., 0., 1.").replace("*GAP", "*SPRING") + step("*CLOAD", "TOP, 3, -1.")
    with pytest.raises(InputError, match=r"it has elements GAPUNI; give their set \*GAP"):
        load(tmp_path, text)


PLATE = """*NODE, NSET=ALL
1, 0,0,0
2, 1,0,0
3, 1,1,0
4, 0,1,0
5, .5,0,0
6, 1,.5,0
7, .5,1,0
8, 0,.5,0
9, -1,0,0
*ELEMENT, TYPE=S8, ELSET=E
1, 1,2,3,4,5,6,7,8
*ELEMENT, TYPE=SPRINGA, ELSET=S
2, 9,1
*SPRING, ELSET=S
40.
*MATERIAL, NAME=M
*ELASTIC
1000., .3
*SHELL SECTION, ELSET=E, MATERIAL=M
.1
*BOUNDARY
9, 1, 3
ALL, 3
1, 2
2, 2
"""


def test_a_spring_at_the_corner_of_a_shell(tmp_path: Path) -> None:
    """It carries all of a force along its line: halfway through the thickness the corner moves by force over stiffness."""
    solution = abut.solve(load(tmp_path, PLATE + step("*CLOAD", "2, 1, 2.")).model)
    corner = np.flatnonzero(np.linalg.norm(solution.model.mesh.points, axis=1) < 1e-12)
    assert solution.displacement[corner, 0] == pytest.approx(2.0 / 40.0, rel=1e-9)


def test_a_spring_in_the_middle_of_an_edge(tmp_path: Path) -> None:
    with pytest.raises(InputError, match=r"\*SPRING: node 8: .* use corners of shells"):
        load(tmp_path, PLATE.replace("2, 9,1", "2, 9,8") + step("*CLOAD", "2, 1, 2."))

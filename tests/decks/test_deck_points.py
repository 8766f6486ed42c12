"""Nodes of springs that belong to no element, in decks: points that move freely, with and without bodies beside."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

import abut
from abut.errors import InputError
from models.decks import BRICKS, load, step

AROUND = "*BOUNDARY\nALL, 1, 2\n"
SAME = 1e-9
TWO = "*NODE\n1, 0, 0, 0\n2, 1, 0, 0\n3, 2, 0, 0\n*BOUNDARY\n1, 1, 3\n"


def moved(solution: abut.Solution, at: tuple[float, float, float]) -> np.ndarray:
    points = solution.model.mesh.points
    return solution.displacement[np.linalg.norm(points - at, axis=1).argmin()]


@pytest.mark.parametrize("card", ["*STEP", "*STEP, NLGEOM"])
def test_springs_in_a_row(card: str, tmp_path: Path) -> None:
    """Springs of 10 and 40 and nothing else: 8 (1/10 + 1/40) at the end, the fixed node loaded as well."""
    text = TWO + (
        "*BOUNDARY\n2, 2, 3\n3, 2, 3\n*ELEMENT, TYPE=SPRINGA, ELSET=A\n1, 1, 2\n*ELEMENT, TYPE=SPRINGA, ELSET=B\n2, 2, 3\n"
        "*SPRING, ELSET=A\n10.\n*SPRING, ELSET=B\n40.\n"
    )
    job = load(tmp_path, (text + step("*CLOAD", "3, 1, 8.", "1, 1, 5.")).replace("*STEP", card))
    assert any("belong to no element" in note for note in job.notes)
    solution = abut.solve(job.model)
    assert moved(solution, (2.0, 0.0, 0.0)) == pytest.approx([8.0 * (1 / 10 + 1 / 40), 0.0, 0.0], rel=SAME)
    assert moved(solution, (1.0, 0.0, 0.0)) == pytest.approx([0.8, 0.0, 0.0], rel=SAME)
    assert np.abs(solution.steps[-1].stress).max() <= 1e-9  # of what stands for the points


def test_a_cable_of_springs(tmp_path: Path) -> None:
    """Two springs of the length 1 in a line, pulled across in the middle: 2 k (l - 1) h / l, l^2 = 1 + h^2."""
    text = TWO + (
        "*BOUNDARY\n3, 1, 3\n2, 3\n2, 1\n*ELEMENT, TYPE=SPRINGA, ELSET=A\n1, 1, 2\n2, 2, 3\n*SPRING, ELSET=A\n10.\n"
    )
    rise = 0.75
    length = np.hypot(1.0, rise)
    force = 2.0 * 10.0 * (length - 1.0) * rise / length
    text = (text + step("*BOUNDARY", f"2, 2, 2, {rise}")).replace("*STEP", "*STEP, NLGEOM")
    solution = abut.solve(load(tmp_path, text).model)
    left, right = (solution.steps[-1].springs[name] for name in ("A-1", "A-2"))
    assert left + right == pytest.approx([0.0, -force, 0.0], rel=1e-8, abs=1e-9)


def test_between_bodies_and_points(tmp_path: Path) -> None:
    """A brick on springs of 25 to points that stand on springs of 50: 10 (1/100 + 1/200)."""
    low = "*NODE\n" + "".join(f"{20 + i}, {x}, {y}, -1\n" for i, (x, y) in enumerate(((0, 0), (1, 0), (1, 1), (0, 1))))
    springs = (
        "*ELEMENT, TYPE=SPRINGA, ELSET=UP\n101, 1, 20\n102, 2, 21\n103, 3, 22\n104, 4, 23\n*SPRING, ELSET=UP\n25.\n"
        "*ELEMENT, TYPE=SPRING1, ELSET=DOWN\n201, 20\n202, 21\n203, 22\n204, 23\n*SPRING, ELSET=DOWN\n3\n50.\n"
    )
    held = "*BOUNDARY\n20, 1, 2\n21, 1, 2\n22, 1, 2\n23, 1, 2\n11, 1, 3\n12, 1, 3\n13, 1, 3\n14, 1, 3\n"
    pull = step("*CLOAD", *(f"{n}, 3, -2.5" for n in (1, 2, 3, 4)))
    solution = abut.solve(load(tmp_path, BRICKS + AROUND + low + springs + held + pull).model)
    assert solution.displacement[:4, 2] == pytest.approx(np.full(4, -10.0 * (1 / 100 + 1 / 200)), rel=SAME)


def test_tables_from_the_ground(tmp_path: Path) -> None:
    """SPRING2 whose first node is the ground: its elongation is that less the displacement of the second."""
    law = "*SPRING, ELSET=A, NONLINEAR\n1, 1\n-4., -2.\n0., 0.\n1., 2.\n"
    text = TWO + "*BOUNDARY\n2, 2, 3\n*ELEMENT, TYPE=SPRING2, ELSET=A\n1, 1, 2\n" + law + step("*CLOAD", "2, 1, 3.")
    solution = abut.solve(load(tmp_path, text).model)
    assert moved(solution, (1.0, 0.0, 0.0))[0] == pytest.approx(1.5, rel=1e-8)  # force 4 at 2, on the negative branch


def test_all_surfaces_may_touch(tmp_path: Path) -> None:
    """Cubes in place of points would be bodies there."""
    loose = "*NODE\n30, 0, 0, -1\n*ELEMENT, TYPE=SPRINGA, ELSET=S\n201, 1, 30\n*SPRING, ELSET=S\n5.\n"
    text = BRICKS + AROUND + loose + "*CONTACT\n*CONTACT INCLUSIONS, ALL EXTERIOR\n" + step("*CLOAD", "TOP, 3, 2.5")
    with pytest.raises(InputError, match="node 30 belongs to no element, and all surfaces may touch"):
        load(tmp_path, text)

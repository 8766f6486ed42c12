"""Point masses of decks: what they weigh."""

from __future__ import annotations

from pathlib import Path

import pytest

from abut.errors import InputError
from models.decks import BRICKS, load, solve, step

COLUMN = BRICKS.replace("2, 11,12,13,14", "2, 5,6,7,8").replace("2, S1", "2, S2") + "*BOUNDARY\nBOTTOM, 1, 3\n"
TOP = (15, 16, 17, 18)  # of a column 1 x 1 x 2, E = 1000
MASSES = "*ELEMENT, TYPE=MASS, ELSET=M\n" + "".join(f"{100 + n}, {n}\n" for n in TOP) + "*MASS, ELSET=M\n0.5\n"
PULL = "GRAV, 10., 0., 0., 2."  # any length of the direction


@pytest.mark.parametrize("on", ["M", "", "BOTH", "EACH"])
def test_masses_weigh(on: str, tmp_path: Path) -> None:
    """Four masses of 0.5 under 10: a force of 20 stretches the column by F L / E A, whatever set names them."""
    sets = "*ELSET, ELSET=BOTH\nM\n"
    lines = [f"{100 + n}, {PULL}" for n in TOP] if on == "EACH" else [f"{on}, {PULL}"]
    text = COLUMN.replace("*SOLID", "*DENSITY\n1e-12\n*SOLID", 1)
    solution = solve(tmp_path, text + MASSES + sets + step("*DLOAD", *lines))
    top = solution.model.mesh.points[:, 2] == 2.0
    assert solution.displacement[top, 2].mean() == pytest.approx(4 * 0.5 * 10.0 * 2.0 / 1000.0, rel=1e-9)


def test_masses_without_gravity_do_nothing(tmp_path: Path) -> None:
    plain = solve(tmp_path, COLUMN + step("*CLOAD", "15, 3, 1.")).displacement
    assert solve(tmp_path, COLUMN + MASSES + step("*CLOAD", "15, 3, 1.")).displacement == pytest.approx(plain, abs=0.0)


@pytest.mark.parametrize(
    ("text", "words"),
    [
        (step("*DLOAD", "M, CENTRIF, 1., 0., 0., 0., 0., 0., 1."), "CENTRIF on point masses is not supported, GRAV is"),
        (step("*DLOAD", "M, GRAV, 1., 0., 0., 0."), "the direction of gravity is missing"),
        (step("*DLOAD, OP=NEW", f"M, {PULL}"), "OP=NEW with gravity on point masses is not read"),
        (step("*CLOAD", "15, 3, 1.") + step("*DLOAD", f"M, {PULL}"), "node 15 has a point mass and a force"),
        ("*ELEMENT, TYPE=MASS\n999, 15\n" + step("*CLOAD", "16, 3, 1."), r"element 999 without \*MASS"),
        (step("*CLOAD", "16, 3, 1.") + "*STEP\n*FREQUENCY\n2\n*END STEP\n", "not there in frequencies"),
    ],
)
def test_refused(text: str, words: str, tmp_path: Path) -> None:
    with pytest.raises(InputError, match=words):
        load(tmp_path, COLUMN + MASSES + text)

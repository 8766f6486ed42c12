"""Supports of decks that come and go between steps. Numbers of CalculiX 2.20 for each deck, at the nodes named."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from decks.test_deck_time import BAR

import abut
from abut.cli import main
from abut.errors import InputError
from abut.job import load_job
from models.decks import load, step

CUBE = BAR.replace("1000., 0.", "1000., .3").replace("BOTTOM, 1, 3\nALL, 1, 2\n", "BOTTOM, 1, 3\n")
RELEASED = ["*BOUNDARY, OP=NEW", "BOTTOM, 1, 3"]
PUSHED = ["*BOUNDARY", "TOP, 3, 3, -0.02"]
NEAR = 1e-8  # CalculiX writes seven digits; what holds gives a millionth of the displacement
CASES = {  # steps of the deck; displacements of nodes 6 and 7 at the end of each
    "let go": (
        (PUSHED, [*RELEASED, "*DLOAD", "1, P2, 5."], ["*DLOAD", "1, P2, 9."]),
        [
            [[4.285714e-3, -4.285714e-3, -2e-2], [4.285714e-3, 4.285714e-3, -2e-2]],
            [[9.75e-4, -9.75e-4, -4.55e-3], [9.75e-4, 9.75e-4, -4.55e-3]],
            [[1.755e-3, -1.755e-3, -8.19e-3], [1.755e-3, 1.755e-3, -8.19e-3]],
        ],
    ),
    "held": (
        (
            ["*DLOAD", "1, P2, 10."],
            ["*BOUNDARY", "TOP, 3, 3, 0.", "*DLOAD", "1, P2, 0."],
            ["*BOUNDARY", "TOP, 3, 3, 0.01"],
        ),
        [
            [[1.95e-3, -1.95e-3, -9.1e-3], [1.95e-3, 1.95e-3, -9.1e-3]],
            [[0.0, 0.0, 0.0], [0.0, 0.0, 0.0]],
            [[-2.142857e-3, 2.142857e-3, 1e-2], [-2.142857e-3, -2.142857e-3, 1e-2]],
        ],
    ),
    "let go and held again": (
        (PUSHED, RELEASED, ["*BOUNDARY", "TOP, 1, 1, 0.01", "TOP, 3, 3, 0.005"]),
        [
            [[4.285714e-3, -4.285714e-3, -2e-2], [4.285714e-3, 4.285714e-3, -2e-2]],
            [[0.0, 0.0, 0.0], [0.0, 0.0, 0.0]],
            [[1e-2, 1.5e-3, 5e-3], [1e-2, -1.5e-3, 5e-3]],
        ],
    ),
}


@pytest.mark.parametrize("case", CASES)
def test_as_calculix(case: str, tmp_path: Path) -> None:
    lines, wanted = CASES[case]
    solution = abut.solve(load(tmp_path, CUBE + "".join(step(*each) for each in lines)).model)
    assert all(check.passed for check in solution.certificate)
    for number, values in enumerate(wanted, start=1):
        (end,) = [s for s in solution.steps if abs(s.factor - number / len(wanted)) < 1e-9]
        assert end.displacement[5:7] == pytest.approx(np.array(values), abs=NEAR)


def test_the_job_file_says_the_same(tmp_path: Path) -> None:
    deck = load(tmp_path, CUBE + step(*PUSHED) + step(*RELEASED, "*DLOAD", "1, P2, 5."))
    assert main(["convert", str(tmp_path / "deck.inp"), str(tmp_path / "job.toml"), "--quiet"]) == 0
    assert load_job(tmp_path / "job.toml").model.holds == deck.model.holds


@pytest.mark.parametrize(
    ("more", "words"),
    [
        ("*TRANSFORM, NSET=TOP\n1., 1., 0., -1., 1., 0.\n", "has axes of its own"),
        ("*EQUATION\n2\n5, 3, 1., 6, 3, -1.\n", "stands in an equation"),
    ],
)
def test_what_cannot_come_or_go(more: str, words: str, tmp_path: Path) -> None:
    with pytest.raises(InputError, match=words):
        load(tmp_path, CUBE + more + step(*PUSHED) + step(*RELEASED))

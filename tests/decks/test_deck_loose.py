"""What CalculiX takes although it is not said in full: words before the first card, rigid bodies without reference node."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

import abut
from abut.errors import InputError
from abut.job.load import load_job
from abut.mesh import make

BRICK = make.box((0.0, 1.0), (0.0, 1.0), (0.0, 4.0), (1, 1, 4), "hex8")


def deck(rigid: str, loads: str) -> str:
    """A bar along z, held at z = 0, its end rigid."""
    nodes = [f"{i}, {x}, {y}, {z}" for i, (x, y, z) in enumerate(BRICK.points.tolist(), start=1)]
    cells = [f"{i}, " + ", ".join(map(str, row)) for i, row in enumerate((BRICK.blocks[0].nodes + 1).tolist(), start=1)]
    foot, end = ([f"{i + 1}," for i in np.unique(BRICK.nodes_of(side)).tolist()] for side in ("bottom", "top"))
    return "\n".join(
        [
            "*NODE", *nodes, "98, 0.5, 0.5, 4.", "99, 0.5, 0.5, 4.", "*ELEMENT, TYPE=C3D8, ELSET=BAR", *cells,
            "*NSET, NSET=FOOT", *foot, "*NSET, NSET=END", *end, "*MATERIAL, NAME=M", "*ELASTIC", "1000., 0.",
            "*SOLID SECTION, ELSET=BAR, MATERIAL=M", rigid, "*BOUNDARY", "FOOT, 1, 3", "*STEP", "*STATIC", "*CLOAD", loads,
            "*END STEP",
        ]
    )  # fmt: skip


def solved(folder: Path, text: str) -> abut.Solution:
    path = folder / "deck.inp"
    path.write_text(text, encoding="utf-8")
    return abut.solve(load_job(path).model)


def test_a_rigid_body_without_reference_node(tmp_path: Path) -> None:
    """A moment on its ROT NODE is a couple, which does not ask where the reference node is."""
    here = solved(tmp_path, deck("*RIGID BODY, NSET=END, REF NODE=99, ROT NODE=98", "98, 1, 0.01"))
    free = solved(tmp_path, deck("*RIGID BODY, NSET=END, ROT NODE=98", "98, 1, 0.01"))
    largest = np.abs(here.displacement).max()
    assert largest > 0.0
    np.testing.assert_allclose(free.displacement, here.displacement, atol=1e-9 * largest)
    assert any("no REF NODE" in note for note in load_job(tmp_path / "deck.inp").notes)


@pytest.mark.parametrize("words", [">** a beam\n>** of one material\n", "CALC PROBLEM=bar\n"])
def test_words_before_the_first_card(tmp_path: Path, words: str) -> None:
    path = tmp_path / "deck.inp"
    path.write_text(words + deck("", "END, 3, 1."), encoding="utf-8")
    assert any("text before the first card" in note for note in load_job(path).notes)


def test_numbers_before_the_first_card_are_refused(tmp_path: Path) -> None:
    with pytest.raises(InputError, match="a data line before the first card"):
        solved(tmp_path, "1, 0., 0., 0.\n" + deck("", "END, 3, 1."))

"""Steps of a deck whose periods are shorter than 1, one after the other or alone."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

import abut
from abut.decks.translation import translate
from abut.io.deck import read_deck

DECK = """*NODE, NSET=N
1, 0., 0., 0.
2, 1., 0., 0.
3, 1., 1., 0.
4, 0., 1., 0.
5, 0., 0., 1.
6, 1., 0., 1.
7, 1., 1., 1.
8, 0., 1., 1.
*NSET, NSET=FOOT
1, 2, 3, 4
*NSET, NSET=TOP
5, 6, 7, 8
*ELEMENT, TYPE=C3D8, ELSET=E
1, 1, 2, 3, 4, 5, 6, 7, 8
*MATERIAL, NAME=M
*ELASTIC
1000., 0.
*SOLID SECTION, ELSET=E, MATERIAL=M
*BOUNDARY
FOOT, 1, 3
*STEP{nlgeom}
*STATIC
{increment}, {period}
*BOUNDARY
TOP, 3, 3, 0.001
*END STEP
*STEP{nlgeom}
*STATIC
{increment}, {period}
*BOUNDARY
TOP, 3, 3, 0.003
*END STEP
"""


@pytest.mark.parametrize("nlgeom", ["", ", NLGEOM"])
@pytest.mark.parametrize("period", [0.0001, 0.25, 1.0, 40.0])
def test_periods(period: float, nlgeom: str, tmp_path: Path) -> None:
    """The top is where the deck puts it at the end of either step, and times are the deck's."""
    path = tmp_path / "a.inp"
    path.write_text(DECK.format(nlgeom=nlgeom, increment=period, period=period))
    model = translate(read_deck(path)).model
    assert model.solve.end == pytest.approx(2 * period)
    steps = abut.solve(model).steps
    for share, top in ((0.5, 0.001), (1.0, 0.003)):
        step = min(steps, key=lambda step, share=share: abs(step.factor - share))
        assert step.factor == pytest.approx(share)
        assert np.abs(step.displacement[:, 2]).max() == pytest.approx(top, rel=1e-9)

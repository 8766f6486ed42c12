"""*TEMPERATURE, LINTEMP of decks: warmth that changes evenly from one plane to another; elastic laws by CalculiX's names."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

import abut
from abut.errors import InputError
from models.decks import BRICKS, HELD, load, step

COLD = "*INITIAL CONDITIONS, TYPE=TEMPERATURE\nALL, 0.\n"
ROW = "*TEMPERATURE, LINTEMP"


@pytest.mark.parametrize("row", ["0, 0, 2, .5, 10, 2., 40", "0, 0, -1, -.5, 10, -2., 40", "0, 0, 1, 2., 40, .5, 10"])
def test_evenly_between_two_planes(row: str, tmp_path: Path) -> None:
    """Degrees at heights 0, 1, 2 between planes at .5 and 2, in either order, whatever the length of the normal: nodes that
    are not between them stay cold."""
    model = load(tmp_path, BRICKS + COLD + HELD + step(ROW, row)).model
    given = {node: load.value for load in model.loads for node in model.mesh.nodes_of(load.on)}
    heights = {0.0: 0.0, 1.0: 20.0, 2.0: 40.0}
    for node, z in enumerate(model.mesh.points[:, 2]):
        assert given.get(node, 0.0) == pytest.approx(heights[float(z)])


def test_planes_that_coincide(tmp_path: Path) -> None:
    with pytest.raises(InputError, match="two planes that lie apart"):
        load(tmp_path, BRICKS + HELD + step(ROW, "0, 0, 1, 2., 40, 2., 10"))


@pytest.mark.parametrize(
    ("name", "constants"),
    [
        ("LIN_ISO_EL", "*USER MATERIAL, CONSTANTS=2\n1000., .25"),
        ("UNDO_NLGEOM_LIN_ISO_EL_1", "*USER MATERIAL, CONSTANTS=2\n1000., .25"),
        (
            "UNDO_NLGEOM_LIN_EL_1",
            "*USER MATERIAL, CONSTANTS=9\n1200., 400., 1200., 400., 400., 1200., 400., 400.\n400., 20.",
        ),
    ],
)
def test_elastic_laws_by_name(name: str, constants: str, tmp_path: Path) -> None:
    """E = 1000, nu = .25 by names that CalculiX knows: as *ELASTIC."""
    named = BRICKS.replace("NAME=EL\n*ELASTIC\n1000., 0.", f"NAME={name}\n{constants}").replace(
        "MATERIAL=EL", f"MATERIAL={name}"
    )
    assert name in named
    text = HELD.replace("ALL, 1, 2\n", "") + step(
        "*BOUNDARY", "5, 3, 3, .001", "6, 3, 3, .001", "15, 1, 3", "16, 1, 3", "17, 1, 3", "18, 1, 3"
    )
    wanted = abut.solve(load(tmp_path, BRICKS.replace("1000., 0.", "1000., .25") + text).model).displacement
    found = load(tmp_path, named + text)
    assert any("stretches" in note for note in found.notes) == name.startswith("UNDO")
    assert np.abs(abut.solve(found.model).displacement - wanted).max() < 1e-12
    other = named.replace(name, "MY_OWN")
    with pytest.raises(InputError, match="user materials are not supported"):
        load(tmp_path, other + text)

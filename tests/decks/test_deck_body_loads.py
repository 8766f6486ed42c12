"""Gravity and centrifugal forces of decks, on bodies and on parts of them. CalculiX 2.20 gives the same displacements."""

from __future__ import annotations

from pathlib import Path

import pytest

import abut
from abut.problem.loads import applied_load
from models.decks import BRICKS, HELD, MESH, PAIR, load, solve, step

CONTACT = BRICKS + PAIR + HELD
TOWER = MESH.replace(
    "*ELEMENT, TYPE=C3D8, ELSET=HIGH\n2, 11,12,13,14,", "*ELEMENT, TYPE=C3D8, ELSET=HIGH\n2, 5,6,7,8,"
) + (
    "*ELSET, ELSET=EALL\nLOW, HIGH\n*NSET, NSET=BOTTOM, GENERATE\n1, 4\n*MATERIAL, NAME=EL\n*ELASTIC\n1000., 0.\n"
    "*DENSITY\n2.\n*SOLID SECTION, ELSET=EALL, MATERIAL=EL\n*NSET, NSET=USED, GENERATE\n1, 8\n"
    "*NSET, NSET=USED, GENERATE\n15, 18\n*BOUNDARY\nBOTTOM, 1, 3\nUSED, 1, 2\n"
)


def top(folder: Path, text: str) -> float:
    solution = solve(folder, text)
    return float(solution.displacement[solution.model.mesh.points[:, 2] == 2.0, 2].mean())


def test_gravity_on_a_part_of_a_body(tmp_path: Path) -> None:
    """Two bricks that share a face, weight 2 g each: what hangs above shortens those below."""
    g = 5.0
    assert top(tmp_path, TOWER + step("*DLOAD", f"EALL, GRAV, {g}, 0., 0., -1.")) == pytest.approx(-2.0 * g * 2.0 / 1e3)
    assert top(tmp_path, TOWER + step("*DLOAD", f"HIGH, GRAV, {g}, 0., 0., -1.")) == pytest.approx(-2.0 * g * 1.5 / 1e3)
    assert top(tmp_path, TOWER + step("*DLOAD", f"1, GRAV, {g}, 0., 0., -1.")) == pytest.approx(-2.0 * g * 0.5 / 1e3)
    both = step("*DLOAD", f"1, GRAV, {g}, 0., 0., -1.", f"EALL, GRAV, {g}, 0., 0., -1.")
    assert top(tmp_path, TOWER + both) == pytest.approx(-2.0 * g * 2.5 / 1e3)


def test_centrifugal_forces(tmp_path: Path) -> None:
    """An axis across, through the tower's foot: the force density is 2 * 9 * z, and u(2) = 2 * 9 * 2^3 / (3 E); three nodes
    a brick along z find it at the nodes exactly."""
    text = TOWER + step("*DLOAD", "EALL, CENTRIF, 9., 0., 0., 0., 0., 1., 0.")
    assert top(tmp_path, text) == pytest.approx(2.0 * 9.0 * 8.0 / 3e3, rel=1e-9)
    model = load(tmp_path, TOWER + step("*DLOAD", "HIGH, CENTRIF, 9., 0., 0., 0., 0., 1., 0.")).model
    assert applied_load(model).sum(axis=1)[2::3].sum() == pytest.approx(2.0 * 9.0 * 1.5, rel=1e-12)
    faster = text + step("*DLOAD", "EALL, CENTRIF, 36., 0., 0., 0., 0., 1., 0.")
    assert top(tmp_path, faster) == pytest.approx(2.0 * 36.0 * 8.0 / 3e3, rel=1e-9)
    large = load(tmp_path, text.replace("*STEP", "*STEP, NLGEOM"))
    assert any("CENTRIF with distances from the axis of the undeformed bodies" in note for note in large.notes)


@pytest.mark.parametrize(
    ("line", "says"),
    [
        ("EALL, CENTRIF, -9., 0., 0., 0., 0., 1., 0.", "square of the angular speed: expected a number >= 0"),
        ("EALL, CENTRIF, 9., 0., 0., 0.", "direction of the axis is missing"),
        ("EALL, SPIN, 9.", "GRAV and CENTRIF are"),
    ],
)
def test_what_is_refused(line: str, says: str, tmp_path: Path) -> None:
    with pytest.raises(abut.InputError, match=says):
        load(tmp_path, CONTACT + step("*DLOAD", line))


def test_density_is_needed(tmp_path: Path) -> None:
    text = (CONTACT + step("*DLOAD", "EALL, CENTRIF, 9., 0., 0., 0., 0., 1., 0.")).replace("*DENSITY\n2.\n", "")
    with pytest.raises(abut.InputError, match=r"CENTRIF needs a .DENSITY of material 'EL'"):
        load(tmp_path, text)


RING = """*NODE
1, 20,0
2, 30,0
3, 30,5
4, 20,5
*ELEMENT, TYPE=CAX4, ELSET=E
1, 1,2,3,4
*MATERIAL, NAME=M
*ELASTIC
1000., 0.3
*DENSITY
1.
*SOLID SECTION, ELSET=E, MATERIAL=M
*BOUNDARY
1, 2
2, 2
"""


def test_the_axis_of_plane_models(tmp_path: Path) -> None:
    spun = load(tmp_path, RING + step("*DLOAD", "E, CENTRIF, 4., 0., 7., 0., 0., -1., 0.")).model.loads[0]
    assert spun == abut.Centrifugal(2.0, on="E")
    for line in ("0., 0., 0., 1., 0., 0.", "1., 0., 0., 0., 1., 0."):
        with pytest.raises(abut.InputError, match="the axis of this model is y, through the origin"):
            load(tmp_path, RING + step("*DLOAD", f"E, CENTRIF, 4., {line}"))
    flat = RING.replace("CAX4", "CPS4").replace("2, 2\n", "2, 2\n1, 1\n", 1)
    spun = load(tmp_path, flat + step("*DLOAD", "E, CENTRIF, 4., 3., 1., 9., 0., 0., 1.")).model.loads[0]
    assert spun == abut.Centrifugal(2.0, through=(3.0, 1.0), on="E")

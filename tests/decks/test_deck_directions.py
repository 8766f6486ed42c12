"""Elasticity by direction and over temperature in decks: what is read, and displacements beside CalculiX at every node."""

from __future__ import annotations

import re
import shutil
import subprocess
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

import abut
from abut.decks.translation import Translation, load_deck
from abut.errors import InputError
from abut.job import load_job
from abut.job.convert import write_job
from abut.mesh.make import box, rectangle
from abut.mesh.mesh import Mesh

CCX = shutil.which("ccx")
SAME = 1e-6  # of the largest displacement: CalculiX prints seven digits
ENGINEERING = (
    "*ELASTIC, TYPE=ENGINEERING CONSTANTS\n50., 200., 90., 0.1, 0.15, 0.3, 40., 30.\n35., 20.\n"
    "40., 150., 90., 0.1, 0.15, 0.25, 30., 30.\n20., 220.\n"
)
ORTHO = "*ELASTIC, TYPE=ORTHO\n500., 157., 400., 157., 157., 300., 126., 110.\n140., 294.\n"
ANISO = (
    "*ELASTIC, TYPE=ANISO\n300., 110., 320., 130., 140., 350., 16., 17.\n"
    "18., 390., 20., 21., 22., 23., 440., 25.\n26., 27., 28., 29., 500., 20.\n"
)
WARM = "*EXPANSION, TYPE=ORTHO, ZERO=-50.\n1e-4, 2e-5, 3e-5, 20.\n2e-4, 1e-5, 2e-5, 150.\n"
TABLE = "*ELASTIC\n210., 0.3, 0.\n150., 0.35, 400.\n*EXPANSION, ZERO=20.\n1e-4, 0.\n2e-4, 150.\n"
SPACE = "*ORIENTATION, NAME=O\n1., 0.5, 0.2, 0., 1., 0.7\n"
TURNED = "*ORIENTATION, NAME=O\n1., 0.5, 0.2, 0., 1., 0.7\n{axis}, 35.\n"
ROUND = "*ORIENTATION, NAME=O, SYSTEM=CYLINDRICAL\n0., 0., 0., 0., 0., 1.\n"
PLANE = "*ORIENTATION, NAME=O\n1., 0.5, 0., -0.5, 1., 0.\n"


def tube() -> Mesh:
    flat = box((1.0, 2.0), (0.0, 90.0), (0.0, 0.5), (2, 3, 1), "hex20")
    r, turn = flat.points[:, 0], np.deg2rad(flat.points[:, 1])
    return replace(flat, points=np.column_stack([r * np.cos(turn), r * np.sin(turn), flat.points[:, 2]]))


def listed(numbers: np.ndarray) -> str:
    return "".join(f"{number + 1},\n" for number in numbers)


def deck(mesh: Mesh, code: str, material: str, held: str, loads: str) -> str:
    """One element type, node sets by surface, at 20 degrees to begin with."""
    (block,) = mesh.blocks
    points = np.zeros((len(mesh.points), 3))
    points[:, : mesh.points.shape[1]] = mesh.points
    lines = ["*NODE"] + [f"{i}, {x:.12e}, {y:.12e}, {z:.12e}" for i, (x, y, z) in enumerate(points, start=1)]
    lines.append(f"*ELEMENT, TYPE={code}, ELSET=E")
    for i, nodes in enumerate(block.nodes + 1, start=1):
        row = [str(i), *map(str, nodes)]
        lines.append(",\n".join(", ".join(row[k : k + 10]) for k in range(0, len(row), 10)))
    text = "\n".join(lines) + "\n"
    for name in mesh.surfaces:
        text += f"*NSET, NSET={name}\n" + listed(np.unique(mesh.nodes_of(name)))
    text += "*NSET, NSET=ALL\n" + listed(np.arange(len(points))) + f"*MATERIAL, NAME=M\n{material}"
    text += "*SOLID SECTION, ELSET=E, MATERIAL=M" + (", ORIENTATION=O" if "*ORIENTATION" in material else "")
    text += f"\n*INITIAL CONDITIONS, TYPE=TEMPERATURE\nALL, 20.\n*BOUNDARY\n{held}"
    return text + f"*STEP\n*STATIC\n{loads}*NODE PRINT, NSET=ALL\nU\n*END STEP\n"


def by_calculix(folder: Path) -> np.ndarray:
    subprocess.run([str(CCX), "deck"], cwd=folder, check=True, capture_output=True, timeout=60)
    rows = re.findall(r"^ +(\d+) +(\S+) +(\S+) +(\S+)$", (folder / "deck.dat").read_text(), re.MULTILINE)
    return np.array([[float(value) for value in row[1:]] for row in rows])


def loaded(folder: Path, text: str) -> Translation:
    path = folder / "deck.inp"
    path.write_text(text, encoding="utf-8")
    return load_deck(path)


TUBE_HELD = "front, 2, 2\nback, 1, 1\nbottom, 3, 3\n"
FOOT = "bottom, 1, 3\n"
HOT = "*TEMPERATURE\nALL, 170.\n"
BLOCK = box((0.0, 1.0), (0.0, 2.0), (0.0, 1.0), (1, 2, 2), "hex20")
BRICKS = box((0.0, 1.0), (0.0, 2.0), (0.0, 1.0), (2, 2, 2), "hex8")
DECKS = {
    "engineering": deck(tube(), "C3D20", ENGINEERING + WARM + ROUND, TUBE_HELD, HOT + "*CLOAD\nright, 1, 0.01\n"),
    "reduced": deck(tube(), "C3D20R", ENGINEERING + WARM + ROUND, TUBE_HELD, HOT + "*CLOAD\nright, 1, 0.01\n"),
    "ortho": deck(BLOCK, "C3D20", ORTHO + SPACE, FOOT, "*CLOAD\ntop, 1, 0.1\ntop, 3, 0.2\n"),
    "aniso": deck(BLOCK, "C3D20R", ANISO + WARM + SPACE, FOOT, HOT + "*CLOAD\ntop, 1, 0.1\n"),
    **{
        f"turned about {axis}": deck(BLOCK, "C3D20", ORTHO + TURNED.format(axis=axis), FOOT, "*CLOAD\ntop, 1, 0.1\n")
        for axis in (1, 2, 3)
    },
    "bricks": deck(BRICKS, "C3D8", ENGINEERING + WARM + SPACE, FOOT, "*TEMPERATURE\nbottom, 60.\ntop, 200.\n"),
    "table": deck(BRICKS, "C3D8", TABLE, FOOT, "*TEMPERATURE\nbottom, 60.\ntop, 300.\n*CLOAD\ntop, 1, 0.1\n"),
    "plane strain": deck(rectangle((1, 2), (0, 1), (2, 2), "quad8"), "CPE8", ENGINEERING + WARM + PLANE, FOOT[:-2] + "2\n",
                         HOT + "*CLOAD\nright, 1, 0.1\n"),
}  # fmt: skip


@pytest.mark.skipif(CCX is None, reason="CalculiX is not installed")
@pytest.mark.parametrize("name", DECKS)
def test_beside_calculix(name: str, tmp_path: Path) -> None:
    """Displacements of every node."""
    model = loaded(tmp_path, DECKS[name]).model
    theirs = by_calculix(tmp_path)[:, : model.dim]
    assert np.abs(abut.solve(model).displacement - theirs).max() < SAME * np.abs(theirs).max()


@pytest.mark.parametrize("name", ["engineering", "aniso", "bricks", "table"])
def test_converted(name: str, tmp_path: Path) -> None:
    """The job that a deck becomes has the same material."""
    path = tmp_path / "deck.inp"
    path.write_text(DECKS[name], encoding="utf-8")
    job = load_job(path)
    written, _ = write_job(tmp_path / "job.toml", job)
    assert load_job(written).model.solids[0].material == job.model.solids[0].material


def test_isotropic_material_needs_no_orientation(tmp_path: Path) -> None:
    """Axes that mean nothing are not looked at: a deck with others than abut knows is read."""
    text = deck(BRICKS, "C3D8", "*ELASTIC\n200., 0.3\n*ORIENTATION, NAME=O, SYSTEM=SPHERICAL\n0., 0., 0.\n", FOOT, "")
    assert loaded(tmp_path, text).model.solids[0].material == abut.LinearElastic(200.0, 0.3)


def test_an_origin_of_its_own(tmp_path: Path) -> None:
    """Abaqus: the points a and b of rectangular axes are seen from the third one."""
    here = deck(BLOCK, "C3D20", ORTHO + SPACE, FOOT, "")
    moved = deck(BLOCK, "C3D20", ORTHO + "*ORIENTATION, NAME=O\n2., 3.5, 4.2, 1., 4., 4.7, 1., 3., 4.\n", FOOT, "")
    one, other = (loaded(tmp_path, text).model.solids[0].material.axes for text in (here, moved))
    np.testing.assert_allclose(np.array([one.x, one.xy]), np.array([other.x, other.xy]), atol=1e-12)


@pytest.mark.parametrize(
    ("old", "new", "said"),
    [
        ("SYSTEM=CYLINDRICAL", "SYSTEM=SPHERICAL", r"\*ORIENTATION: SYSTEM=SPHERICAL is not supported"),
        ("0., 0., 0., 0., 0., 1.\n", "0., 0., 0., 0., 0., 1.\n3, 20.\n", r"\*ORIENTATION: a turn of cylindrical axes"),
        ("0., 0., 0., 0., 0., 1.\n", "0., 0., 0., 0., 0., 0.\n", r"\*ORIENTATION: the two points are the same"),
        ("*ORIENTATION, NAME=O", "*ORIENTATION, NAME=P", "no orientation named 'O'"),
        ("TYPE=ORTHO, ZERO=-50.", "TYPE=ANISO", r"\*EXPANSION: TYPE=ANISO is not supported"),
        ("ZERO=-50.", "ZERO=cold", r"\*EXPANSION: ZERO: expected a temperature, got 'cold'"),
        ("0.15, 0.3, 40., 30.", "0.15, 1.9, 40., 30.", r"\*MATERIAL 'M': poisson: nu23 must lie within"),
        ("20., 220.", "20., 10.", "temperature: must grow from row to row"),
        ("ALL, 20.", "ALL, 20.\n1, 30.", "the body begins with temperatures from 20 to 30"),
        ("*EXPANSION", "*PLASTIC\n1., 0.\n*EXPANSION", "metal that yields is isotropic"),
    ],
)  # fmt: skip
def test_refused(old: str, new: str, said: str, tmp_path: Path) -> None:
    text = DECKS["engineering"]
    assert old in text
    with pytest.raises(InputError, match=said):
        loaded(tmp_path, text.replace(old, new, 1))


def test_axes_that_differ_from_element_to_element(tmp_path: Path) -> None:
    """A distribution gives the answer of a section for each set of elements with its own axes; later lines count."""
    parts = "*ELSET, ELSET=A, GENERATE\n1, 2\n*ELSET, ELSET=B, GENERATE\n3, 4\n"
    first, second = "1., .5, .2, 0., 1., .7", "0., 1., 0., 0., 0., 1."
    whole = deck(BLOCK, "C3D20", ORTHO + SPACE, FOOT, "*CLOAD\ntop, 1, 0.1\ntop, 3, 0.2\n")
    section = "*SOLID SECTION, ELSET=E, MATERIAL=M, ORIENTATION=O"
    rows = f"B, {first}\n, {first}\n3, {second}\nB, {second}\n"
    table = f"*DISTRIBUTION, NAME=D\n{rows}*ORIENTATION, NAME=OD\nD\n"
    axes = f"*ORIENTATION, NAME=O1\n{first}\n*ORIENTATION, NAME=O2\n{second}\n"
    each = "".join(f"*SOLID SECTION, ELSET={s}, MATERIAL=M, ORIENTATION=O{k}\n" for s, k in (("A", 1), ("B", 2)))
    distributed = whole.replace(section, parts + table + section + "D")
    found, wanted, alike = (
        abut.solve(loaded(tmp_path, text).model).displacement
        for text in (distributed, whole.replace(section, parts + axes + each[:-1]), whole)
    )
    assert found == pytest.approx(wanted, abs=1e-9 * np.abs(wanted).max())
    assert np.abs(alike - wanted).max() > 0.01 * np.abs(wanted).max()
    for bad, words in (
        (distributed.replace("=OD\nD", "=OD\nE2"), "no .DISTRIBUTION named 'E2'"),
        (distributed.replace(rows, f"B, {first}\n"), "element 1 of 'E' has no line"),
        (distributed.replace(rows, ""), "its data line is missing"),
    ):
        with pytest.raises(InputError, match=words):
            loaded(tmp_path, bad)

"""*SUBMODEL: displacements from the result file of a global model, beside CalculiX at every node."""

from __future__ import annotations

import shutil
import subprocess
from pathlib import Path

import numpy as np
import pytest

import abut
from abut.decks.translation import load_deck
from abut.errors import InputError

CCX = shutil.which("ccx")
SAME = 2e-6  # of the largest displacement: both read six digits of the file, and CalculiX prints seven


def block(x: tuple[float, float], y: tuple[float, float], z: tuple[float, float], cells: tuple[int, int, int]) -> str:
    """Nodes and C3D8 of a box, with sets of its end x[0], its end x[1], and both of these."""
    axes = [np.linspace(*span, n + 1) for span, n in zip((x, y, z), cells)]
    number = np.arange(1, np.prod([n + 1 for n in cells]) + 1).reshape([n + 1 for n in cells])
    text = "*NODE, NSET=ALL\n"
    for i, j, k in np.ndindex(number.shape):
        text += f"{number[i, j, k]}, {axes[0][i]:.6f}, {axes[1][j]:.6f}, {axes[2][k]:.6f}\n"
    text += "*ELEMENT, TYPE=C3D8, ELSET=BODY\n"
    for e, (i, j, k) in enumerate(np.ndindex(*cells), start=1):
        foot = [number[i, j, k], number[i + 1, j, k], number[i + 1, j + 1, k], number[i, j + 1, k]]
        head = [number[i, j, k + 1], number[i + 1, j, k + 1], number[i + 1, j + 1, k + 1], number[i, j + 1, k + 1]]
        text += ", ".join(map(str, [e, *foot, *head])) + "\n"
    for name, nodes in (("START", number[0]), ("END", number[-1])):
        text += f"*NSET, NSET={name}\n" + "\n".join(map(str, nodes.ravel())) + "\n"
    return text + "*MATERIAL, NAME=EL\n*ELASTIC\n1000., .3\n*SOLID SECTION, ELSET=BODY, MATERIAL=EL\n"


GLOBAL = block((0, 6), (0, 1), (0, 1), (6, 2, 2)) + "*BOUNDARY\nSTART, 1, 3\n"
for force in (0.2, -0.5):
    GLOBAL += f"*STEP\n*STATIC\n*CLOAD, OP=NEW\nEND, 3, {force}\nEND, 2, 0.1\n*NODE FILE\nU\n*END STEP\n"
PART = block((2.3, 4.6), (0, 1), (0, 1), (5, 3, 3))  # whose ends lie within cells of the whole
SUB = "*SUBMODEL, TYPE=NODE, INPUT=whole.frd\nSTART, END\n"
STEP = "*STEP\n*STATIC\n*BOUNDARY, SUBMODEL, STEP={}\nSTART, 1, 3\nEND, 1, 3\n*NODE PRINT, NSET=ALL\nU\n*END STEP\n"


def ran(folder: Path, name: str, text: str) -> np.ndarray:
    """Displacements that CalculiX prints at the end."""
    (folder / f"{name}.inp").write_text(text)
    subprocess.run([str(CCX), name], cwd=folder, check=True, capture_output=True, timeout=60)
    printed = folder / f"{name}.dat"
    last = printed.read_text().split("displacements")[-1] if printed.exists() else ""
    lines = [line.split() for line in last.splitlines()]
    rows = np.array([[float(x) for x in line] for line in lines if len(line) == 4 and line[0].isdigit()])
    return rows[np.argsort(rows[:, 0]), 1:] if len(rows) else rows


@pytest.mark.skipif(CCX is None, reason="CalculiX is not installed")
@pytest.mark.parametrize("step", [1, 2])
def test_as_calculix(step: int, tmp_path: Path) -> None:
    """A part of a bent bar, finer than the whole and with ends within its cells, at either step: every node."""
    ran(tmp_path, "whole", GLOBAL)
    wanted = ran(tmp_path, "part", PART + SUB + STEP.format(step))
    found = abut.solve(load_deck(tmp_path / "part.inp").model).displacement
    assert wanted.shape == found.shape
    assert np.abs(found - wanted).max() < SAME * np.abs(wanted).max()


FRD = """    1C
    2C                             4                                     1
 -1         1 0.00000E+00 0.00000E+00 0.00000E+00
 -1         2 9.00000E+00 0.00000E+00 0.00000E+00
 -1         3 0.00000E+00 9.00000E+00 0.00000E+00
 -1         4 0.00000E+00 0.00000E+00 9.00000E+00
 -3
    3C                             1                                     1
 -1         1    3    0    1
 -2         1         2         3         4
 -3
    1PSTEP                         1           1           1
  100CL  101 1.000000000           4                     0    1           1
 -4  DISP        4    1
 -5  D1          1    2    1    0
 -5  D2          1    2    2    0
 -5  D3          1    2    3    0
 -5  ALL         1    2    0    0    1ALL
 -1         1 0.00000E+00 0.00000E+00 0.00000E+00
 -1         2 9.00000E-03 0.00000E+00 0.00000E+00
 -1         3 0.00000E+00 0.00000E+00 0.00000E+00
 -1         4 0.00000E+00 0.00000E+00 9.00000E-02
 -3
 9999
"""


def test_values_of_a_linear_field(tmp_path: Path) -> None:
    """u_x = x / 1000, u_z = z / 100 between the four nodes of the global model."""
    (tmp_path / "whole.frd").write_text(FRD)
    small = block((0, 1), (0, 1), (0, 1), (2, 2, 2))
    everywhere = "*SUBMODEL, INPUT=whole.frd\nALL\n" + STEP.format(1).replace("START, 1, 3\nEND", "ALL")
    (tmp_path / "part.inp").write_text(small + everywhere)
    solution = abut.solve(load_deck(tmp_path / "part.inp").model)
    points = solution.model.mesh.points
    assert solution.displacement == pytest.approx(points * [1e-3, 0.0, 1e-2], abs=1e-12)


@pytest.mark.parametrize(
    ("old", "new", "words"),
    [
        ("STEP=1", "STEP=2", r"no values named 'DISP' at its points in step 2"),
        ("SUBMODEL, STEP=1", "SUBMODEL", "SUBMODEL and STEP go together"),
        ("STEP=1", "STEP=one", "expected the number of a step"),
        ("END, 1, 3", "END, 1, 3, 0.5", "take their values out"),
        ("START, END", "START", r"node \d+ is in no \*SUBMODEL"),
        ("whole.frd", "nowhere.frd", "no such file; run the global model first"),
        ("whole.frd", "whole.txt", "expected the .frd file"),
        ("TYPE=NODE", "TYPE=SURFACE", "give TYPE=NODE"),
        ("TYPE=NODE", "TYPE=NODE, GLOBAL ELSET=BODY", "parts of the global model are not told apart"),
        ("SUBMODEL, STEP=1", "SUBMODEL, DATA SET=1", "modes of another run are not read"),
        ("", "", r"lies .* outside its mesh"),
    ],
)
def test_refused(old: str, new: str, words: str, tmp_path: Path) -> None:
    (tmp_path / "whole.frd").write_text(
        FRD if old else FRD.replace("9.00000E+00", "2.00000E+00")
    )  # which ends before the part
    text = PART + SUB + STEP.format(1)
    (tmp_path / "part.inp").write_text(text.replace(old, new) if old else text)
    with pytest.raises(InputError, match=words):
        load_deck(tmp_path / "part.inp")

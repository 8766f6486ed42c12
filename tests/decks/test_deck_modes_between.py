"""*FREQUENCY beside contact and large displacements, where the step stands before, between and after those with loads."""

from __future__ import annotations

import re
import shutil
import subprocess
from pathlib import Path

import numpy as np
import pytest

import abut
from abut.errors import InputError
from abut.job.load import load_job

YOUNG, DENSITY, SIDE = 210e3, 7.85e-9, 4.0
CELLS = (8, 12)  # over 40 and 60
SPEED = np.sqrt(YOUNG / DENSITY)
FREQUENCY = "*STEP\n*FREQUENCY\n4\n*END STEP"
LOADED = FREQUENCY.replace("*STEP", "*STEP, PERTURBATION", 1)
REMOVED = LOADED.replace("*END", "*MODEL CHANGE, TYPE=CONTACT PAIR, REMOVE\nA, B\n*END")
PUSH = "*STEP\n*STATIC\n*BOUNDARY\nFAR, 1, 1, -0.01\n*END STEP"


def bars(*steps: str, overlap: float = 0.0) -> str:
    """Two bars of C3D8 in a row along x, 40 and 60 long, held at their far ends and at their sides."""
    corners = [(0.0, 0.0), (SIDE, 0.0), (SIDE, SIDE), (0.0, SIDE)]
    nodes, cells = [], []
    for (start, end), count in zip(((0.0, 40.0), (40.0 - overlap, 100.0)), CELLS):
        first = len(nodes)
        for x in np.linspace(start, end, count + 1):
            nodes += [f"{len(nodes) + k}, {x}, {y}, {z}" for k, (y, z) in enumerate(corners, 1)]
        for i in range(count):
            cells.append(f"{len(cells) + 1}, " + ", ".join(str(first + 4 * i + k) for k in range(1, 9)))
    last = len(nodes)
    return "\n".join(
        [
            "*NODE, NSET=ALL", *nodes, "*ELEMENT, TYPE=C3D8, ELSET=BARS", *cells,
            "*NSET, NSET=NEAR", "1, 2, 3, 4", "*NSET, NSET=FAR", f"{last - 3}, {last - 2}, {last - 1}, {last}",
            "*SURFACE, NAME=A", f"{CELLS[0]}, S2", "*SURFACE, NAME=B", f"{CELLS[0] + 1}, S1",
            "*MATERIAL, NAME=STEEL", "*ELASTIC", f"{YOUNG}, 0.", "*DENSITY", f"{DENSITY}",
            "*SOLID SECTION, ELSET=BARS, MATERIAL=STEEL", "*SURFACE INTERACTION, NAME=SI",
            "*SURFACE BEHAVIOR, PRESSURE-OVERCLOSURE=LINEAR", "1e9, 3.",
            "*CONTACT PAIR, INTERACTION=SI, TYPE=SURFACE TO SURFACE", "A, B",
            "*BOUNDARY", "ALL, 2, 3", "NEAR, 1", "FAR, 1", *steps,
        ]
    )  # fmt: skip


def modes(folder: Path, text: str) -> tuple[abut.solution.ModesResult, ...]:
    path = folder / "deck.inp"
    path.write_text(text, encoding="utf-8")
    return abut.solve(load_job(path).model).modes


def calculix(folder: Path) -> list[float]:
    subprocess.run(["ccx", "deck"], cwd=folder, check=True, capture_output=True, timeout=60)
    rows = re.findall(r"^ +\d+ +(\S+) +\S+ +\S+ +\S+ *$", (folder / "deck.dat").read_text(), re.MULTILINE)
    return [float(value) for value in rows]


SINGLE = np.sort([(2 * i + 1) * SPEED / (4.0 * length) for length in (40.0, 60.0) for i in range(3)])[:4]
JOINED = np.arange(1, 5) * SPEED / 200.0


@pytest.mark.parametrize("overlap", [0.0, 0.01])
@pytest.mark.parametrize("steps", [(FREQUENCY,), (FREQUENCY, PUSH), (PUSH, FREQUENCY)])
def test_without_perturbation_contact_holds_nothing(tmp_path: Path, steps: tuple[str, ...], overlap: float) -> None:
    """Two bars by themselves, quarters of a wave each, whatever they do in other steps; cells of first order are too stiff
    by (k h)^2 / 24 at most, 2.6 % of the fourth frequency."""
    found = modes(tmp_path, bars(*steps, overlap=overlap))[0].values
    np.testing.assert_allclose(found, SINGLE, rtol=0.03)
    assert found[0] == pytest.approx(SINGLE[0], rel=2e-3)


def test_frequencies_before_between_and_after(tmp_path: Path) -> None:
    """Apart, joined (one bar held at both ends, halves of a wave), joined by more, and apart again where the pair goes."""
    found = modes(tmp_path, bars(FREQUENCY, PUSH, LOADED, PUSH.replace("-0.01", "-0.02"), LOADED, REMOVED))
    assert len(found) == 4
    for result, expected in zip(found, (SINGLE, JOINED, JOINED, SINGLE)):
        np.testing.assert_allclose(result.values, expected, rtol=0.03)
    np.testing.assert_allclose(found[1].values, found[2].values, rtol=1e-3)  # stresses of E / 10^4 and twice that


@pytest.mark.skipif(shutil.which("ccx") is None, reason="CalculiX is not installed")
@pytest.mark.parametrize("more", ["", ", NLGEOM"])
def test_beside_calculix(tmp_path: Path, more: str) -> None:
    """What presses gives way by E / 40 / 1e9 of the length there, 5e-6; without NLGEOM CalculiX has strains of 1e-4 in the
    stiffness, too."""
    push = PUSH.replace("*STEP", f"*STEP{more}", 1)
    found = modes(tmp_path, bars(FREQUENCY, push, REMOVED))
    np.testing.assert_allclose(np.concatenate([each.eigenvalues for each in found]), calculix(tmp_path), rtol=4e-4)
    found = modes(tmp_path, bars(push, LOADED))
    np.testing.assert_allclose(found[0].eigenvalues, calculix(tmp_path), rtol=4e-4)


def test_supports_that_come_later_hold_nothing_before(tmp_path: Path) -> None:
    """The middle is held from the second step on."""
    middle = f"*STEP\n*STATIC\n*BOUNDARY\n{4 * CELLS[0] + 1}, 1\n*END STEP"
    found = modes(tmp_path, bars(FREQUENCY, PUSH, middle))[0].values
    np.testing.assert_allclose(found, modes(tmp_path, bars(FREQUENCY))[0].values, rtol=1e-8)
    with pytest.raises(InputError, match="come or go between the steps"):
        modes(tmp_path, bars(PUSH, middle, FREQUENCY))


def test_a_pair_that_goes_for_later_loads_too_is_refused(tmp_path: Path) -> None:
    with pytest.raises(InputError, match="FREQUENCY"):
        modes(tmp_path, bars(PUSH, REMOVED, PUSH))


def test_that_contact_holds_nothing_is_told(tmp_path: Path) -> None:
    path = tmp_path / "deck.inp"
    for steps, told in (((FREQUENCY, PUSH), True), ((PUSH, LOADED), False)):
        path.write_text(bars(*steps), encoding="utf-8")
        assert any("contact holds nothing" in note for note in load_job(path).notes) == told


def turning(*steps: str) -> str:
    """The bars, apart from each other and clamped at their far ends, turn about their axis."""
    spin = "*STEP, NLGEOM\n*STATIC\n*DLOAD\nBARS, CENTRIF, 4e6, 0., 2., 2., 1., 0., 0.\n*END STEP"
    text = bars(spin, *steps, overlap=-1.0)
    left_out = ("ALL, 2, 3", "NEAR, 1", "FAR, 1")
    kept = "\n".join(line for line in text.splitlines() if line not in left_out)
    return kept.replace("*BOUNDARY\n", "*BOUNDARY\nNEAR, 1, 3\nFAR, 1, 3\n", 1)


STORED = LOADED.replace("*FREQUENCY\n4", "*FREQUENCY, STORAGE=YES\n40")
CORIOLIS = "*STEP, PERTURBATION\n*COMPLEX FREQUENCY, CORIOLIS\n4\n*END STEP"


@pytest.mark.skipif(shutil.which("ccx") is None, reason="CalculiX is not installed")
def test_coriolis_forces_beside_calculix(tmp_path: Path) -> None:
    """Bending in two planes whirls with and against the rotation; CalculiX makes it of 40 real modes."""
    real, whirling = modes(tmp_path, turning(STORED, CORIOLIS))
    assert not len(real.whirl)
    subprocess.run(["ccx", "deck"], cwd=tmp_path, check=True, capture_output=True, timeout=60)
    table = (tmp_path / "deck.dat").read_text().split("MODE NO                     FREQUENCY")[1]
    theirs = [float(value) for value in re.findall(r"^ +\d+ +\S+ +(\S+) +\S+ *$", table, re.MULTILINE)[:4]]
    np.testing.assert_allclose(whirling.values, theirs, rtol=1e-3)
    assert np.abs(whirling.values / real.values[:4] - 1.0).max() > 0.01


@pytest.mark.parametrize(
    "steps",
    [
        (STORED, CORIOLIS.replace("CORIOLIS", "FLUTTER")),
        (STORED.replace(", PERTURBATION", ""), CORIOLIS),
        (CORIOLIS,),
        (STORED, PUSH, CORIOLIS),
    ],
)
def test_other_complex_frequencies_are_refused(tmp_path: Path, steps: tuple[str, ...]) -> None:
    with pytest.raises(InputError, match="COMPLEX FREQUENCY"):
        modes(tmp_path, turning(*steps))


def test_friction_makes_them_complex_without_a_parameter(tmp_path: Path) -> None:
    path = tmp_path / "deck.inp"
    path.write_text(bars(PUSH, LOADED, CORIOLIS.replace(", CORIOLIS", "")), encoding="utf-8")
    assert [(each.complex, each.coriolis) for each in load_job(path).model.modes] == [(False, False), (True, False)]


@pytest.mark.skipif(shutil.which("ccx") is None, reason="CalculiX is not installed")
def test_the_mass_of_a_rigid_body_counts(tmp_path: Path) -> None:
    """A bar with a heavy head of the same elements, to the seven digits that CalculiX prints."""
    corners = [(0.0, 0.0), (SIDE, 0.0), (SIDE, SIDE), (0.0, SIDE)]
    nodes = [f"{4 * i + k}, {5.0 * i}, {y}, {z}" for i in range(15) for k, (y, z) in enumerate(corners, 1)]
    cells = [f"{i + 1}, " + ", ".join(str(4 * i + k) for k in range(1, 9)) for i in range(14)]
    text = [
        "*NODE", *nodes, "999, 60., 2., 2.", "*ELEMENT, TYPE=C3D8, ELSET=BAR", *cells[:10],
        "*ELEMENT, TYPE=C3D8, ELSET=HEAD", *cells[10:], "*MATERIAL, NAME=STEEL", "*ELASTIC", f"{YOUNG}, 0.",
        "*DENSITY", f"{DENSITY}", "*MATERIAL, NAME=LEAD", "*ELASTIC", f"{YOUNG}, 0.", "*DENSITY", "30e-9",
        "*SOLID SECTION, ELSET=BAR, MATERIAL=STEEL", "*SOLID SECTION, ELSET=HEAD, MATERIAL=LEAD",
        "*RIGID BODY, ELSET=HEAD, REF NODE=999", "*BOUNDARY", *(f"{i}, 1, 3" for i in (1, 2, 3, 4)), FREQUENCY,
    ]  # fmt: skip
    found = modes(tmp_path, "\n".join(text))[0]
    np.testing.assert_allclose(found.eigenvalues, calculix(tmp_path), rtol=1e-6)

"""*FREQUENCY and *BUCKLE in decks: known answers, and what is refused."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

import abut
from abut.errors import InputError
from abut.job.load import load_job

LENGTH, CELLS = 100.0, 20
YOUNG, DENSITY = 210e3, 7.85e-9
SPEED = np.sqrt(YOUNG / DENSITY)


def bar(sides: str, *steps: str) -> str:
    """A bar along x of C3D8 cells, side 4, held at x = 0; ``sides``: further *BOUNDARY lines."""
    corners = [(0, 0), (4, 0), (4, 4), (0, 4)]
    nodes = [
        f"{4 * i + k + 1}, {LENGTH * i / CELLS}, {y}, {z}" for i in range(CELLS + 1) for k, (y, z) in enumerate(corners)
    ]
    cells = [f"{i + 1}, " + ", ".join(str(4 * i + k + 1) for k in range(8)) for i in range(CELLS)]
    last = 4 * CELLS
    return "\n".join(
        [
            "*NODE, NSET=ALL", *nodes, "*ELEMENT, TYPE=C3D8, ELSET=BAR", *cells,
            "*NSET, NSET=HELD", "1, 2, 3, 4", "*NSET, NSET=FREE", ", ".join(str(last + k) for k in (1, 2, 3, 4)),
            "*MATERIAL, NAME=STEEL", "*ELASTIC", f"{YOUNG}, 0.", "*DENSITY", f"{DENSITY}",
            "*SOLID SECTION, ELSET=BAR, MATERIAL=STEEL", "*BOUNDARY", "HELD, 1, 3", *([sides] if sides else []), *steps,
        ]
    )  # fmt: skip


def solution(folder: Path, text: str) -> abut.Solution:
    path = folder / "deck.inp"
    path.write_text(text, encoding="utf-8")
    return abut.solve(load_job(path).model)


FREQUENCY = "*STEP\n*FREQUENCY\n2\n*END STEP"


def test_a_bar_vibrates_along_its_length(tmp_path: Path) -> None:
    """A quarter of a wave, then three; twenty cells of first order are too stiff by (pi/40)^2 / 24, nine times that."""
    values = solution(tmp_path, bar("ALL, 2, 3", FREQUENCY)).modes[0].values
    np.testing.assert_allclose(values, np.array([1.0, 3.0]) * SPEED / (4.0 * LENGTH), rtol=3e-3)


def test_tension_changes_frequencies_of_perturbation_steps_only(tmp_path: Path) -> None:
    """Without bending there is nothing that a tension stiffens but the stretched bar: f^2 grows by sigma / E."""
    pull = "*STEP\n*STATIC\n*CLOAD\nFREE, 1, 8400.\n*END STEP\n*STEP, PERTURBATION\n*FREQUENCY\n1\n*END STEP"
    free = solution(tmp_path, bar("ALL, 2, 3", FREQUENCY)).modes[0].values[0]
    pulled = solution(tmp_path, bar("ALL, 2, 3", pull)).modes[0].values[0]
    np.testing.assert_allclose((pulled / free) ** 2, 1.0 + 4.0 * 8400.0 / 16.0 / YOUNG, rtol=1e-6)


def test_a_buckling_step_has_its_own_loads(tmp_path: Path) -> None:
    """pi^2 E I / (4 L^2), which fully integrated cells of first order with nu = 0 overestimate by shear: by
    (l / h)^2 / 2 at most, l being a cell's length, G = E / 2 and h the height."""
    push = "*STEP\n*BUCKLE\n1\n*CLOAD\nFREE, 1, -0.25\n*END STEP"
    value = solution(tmp_path, bar("ALL, 3, 3", push)).modes[0].values[0]
    euler = np.pi**2 * YOUNG * (4.0**4 / 12.0) / (4.0 * LENGTH**2)
    assert euler < value < euler * (1.0 + 0.5 * (LENGTH / CELLS / 4.0) ** 2)


@pytest.mark.parametrize(
    "steps",
    [
        FREQUENCY + "\n*STEP\n*STATIC\n*END STEP",
        "*STEP\n*STATIC\n*END STEP\n" + FREQUENCY,
        FREQUENCY.replace("\n2\n", "\n2, , 100.\n"),
        FREQUENCY.replace("*FREQUENCY", "*FREQUENCY, STORAGE=YES"),
        FREQUENCY.replace("\n2\n", "\n2\n*CLOAD\nFREE, 1, 1.\n"),
        FREQUENCY.replace("*FREQUENCY", "*COMPLEX FREQUENCY"),
    ],
)
def test_what_is_not_read_is_refused(tmp_path: Path, steps: str) -> None:
    with pytest.raises(InputError, match="FREQUENCY"):
        solution(tmp_path, bar("", steps))


def test_a_lower_limit_is_told(tmp_path: Path) -> None:
    path = tmp_path / "deck.inp"
    path.write_text(bar("", FREQUENCY.replace("\n2\n", "\n2, 0.01\n")), encoding="utf-8")
    assert any("lower limit" in note for note in load_job(path).notes)


@pytest.mark.parametrize("code", ["B31", "B31R", "B32", "B32R"])
def test_beams_vibrate_as_solids_do(tmp_path: Path, code: str) -> None:
    """A cantilever of 10 x 0.4 x 0.2 in ten or twenty elements: 1.875^2 sqrt(E I / (rho A)) / L^2 about either axis. One
    cell through it, without a Poisson contraction at the clamp, is stiffer by about 1 %."""
    step = 1 if code.startswith("B31") else 2
    nodes = [f"{i}, 0., 0., {0.5 * (i - 1)}" for i in range(1, 22)]
    cells = [f"{i}, " + ", ".join(str(i + k) for k in range(step + 1)) for i in range(1, 21, step)]
    text = "\n".join(
        [
            "*NODE", *nodes, f"*ELEMENT, TYPE={code}, ELSET=BEAM", *cells, "*MATERIAL, NAME=M", "*ELASTIC", "1e7, .3",
            "*DENSITY", "7.8e-9", "*BEAM SECTION, ELSET=BEAM, MATERIAL=M, SECTION=RECT", ".4, .2", "1., 0., 0.",
            "*BOUNDARY", "21, 1, 6", FREQUENCY,
        ]
    )  # fmt: skip
    found = solution(tmp_path, text)
    assert all(check.passed for check in found.certificate)
    bending = 1.87510407**2 * np.sqrt(1e7 / 7.8e-9 / 12.0) / 10.0**2 / (2.0 * np.pi)
    np.testing.assert_allclose(found.modes[0].values, bending * np.array([0.2, 0.4]), rtol=0.015)
    assert any("full integration" in note for note in load_job(tmp_path / "deck.inp").notes) == (code != "B32")

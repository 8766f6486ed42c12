"""*FREQUENCY and *BUCKLE in decks: known answers, and what is refused."""

from __future__ import annotations

import re
import shutil
import subprocess
from itertools import product
from pathlib import Path

import numpy as np
import pytest

import abut
from abut.errors import InputError
from abut.job.convert import write_job
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
        FREQUENCY.replace("*STEP", "*STEP, PERTURBATION") + "\n*STEP\n*STATIC\n*END STEP",
        FREQUENCY.replace("\n2\n", "\n2, , 100.\n"),
        FREQUENCY.replace("*FREQUENCY", "*FREQUENCY, STORAGE=YES"),
        FREQUENCY.replace("\n2\n", "\n2\n*CLOAD\nFREE, 1, 1.\n"),
        FREQUENCY.replace("*FREQUENCY", "*COMPLEX FREQUENCY"),
    ],
)
def test_what_is_not_read_is_refused(tmp_path: Path, steps: str) -> None:
    with pytest.raises(InputError, match="FREQUENCY"):
        solution(tmp_path, bar("", steps))


@pytest.mark.parametrize("first", [True, False])
def test_a_step_without_perturbation_is_about_the_unloaded_model(tmp_path: Path, first: bool) -> None:
    """A pull that would raise the square of the frequency by sigma / E = 0.01 does not."""
    pull = "*STEP\n*STATIC\n*CLOAD\nFREE, 1, 8400.\n*END STEP"
    steps = [FREQUENCY, pull] if first else [pull, FREQUENCY]
    both = solution(tmp_path, bar("ALL, 2, 3", *steps))
    alone = solution(tmp_path, bar("ALL, 2, 3", FREQUENCY)).modes[0].values
    np.testing.assert_allclose(both.modes[0].values, alone, rtol=1e-12)
    stretched = 4.0 * 8400.0 * LENGTH / (YOUNG * 16.0)
    np.testing.assert_allclose(np.abs(both.displacement).max(), stretched, rtol=1e-9)


def sector(*steps: str) -> str:
    """A twelfth of a ring of C3D8, bore 1, outer radius 3, 0.5 thick, held at its bore."""
    number: dict[tuple[int, int, int], int] = {}
    nodes = []
    for i, (r, turn, z) in enumerate(
        product(np.linspace(1.0, 3.0, 4), np.radians(np.linspace(0.0, 30.0, 4)), (0.0, 0.5))
    ):
        number[i // 8, i // 2 % 4, i % 2] = i + 1
        nodes.append(f"{i + 1}, {r * np.cos(turn):.12e}, {r * np.sin(turn):.12e}, {z}")
    corners = [(0, 0, 0), (1, 0, 0), (1, 1, 0), (0, 1, 0), (0, 0, 1), (1, 0, 1), (1, 1, 1), (0, 1, 1)]
    cells = [
        f"{k + 1}, " + ", ".join(str(number[i + a, j + b, c]) for a, b, c in corners)
        for k, (i, j) in enumerate(product(range(3), range(3)))
    ]
    sides = [[str(n) for (i, j, _), n in number.items() if i and j == side] for side in (0, 3)]
    rim = [str(n) for (i, *_), n in number.items() if i == 3]
    held = [f"{n}, 1, 3" for (i, *_), n in number.items() if not i]
    return "\n".join(
        [
            "*NODE, NSET=ALL", *nodes, "*ELEMENT, TYPE=C3D8, ELSET=RING", *cells, "*NSET, NSET=FIRST", ",\n".join(sides[0]),
            "*NSET, NSET=LAST", ",\n".join(sides[1]), "*SURFACE, NAME=SF, TYPE=NODE", "FIRST",
            "*SURFACE, NAME=SL, TYPE=NODE", "LAST", "*TIE, CYCLIC SYMMETRY, NAME=T", "SL, SF",
            "*CYCLIC SYMMETRY MODEL, N=12, TIE=T, ELSET=RING", "0., 0., 0., 0., 0., 1.",
            "*NSET, NSET=RIM", ",\n".join(rim), "*TRANSFORM, NSET=RIM, TYPE=C", "0., 0., 0., 0., 0., 1.",
            "*MATERIAL, NAME=STEEL", "*ELASTIC", f"{YOUNG}, 0.3", "*DENSITY", f"{DENSITY}",
            "*SOLID SECTION, ELSET=RING, MATERIAL=STEEL", "*BOUNDARY", *held, *steps,
        ]
    )  # fmt: skip


def around(lowest: int, highest: int) -> str:
    chosen = f"*SELECT CYCLIC SYMMETRY MODES, NMIN={lowest}, NMAX={highest}\n"
    return FREQUENCY.replace("\n2\n", f"\n6\n{chosen}")


@pytest.mark.skipif(shutil.which("ccx") is None, reason="CalculiX is not installed")
@pytest.mark.parametrize("loaded", [False, True])
def test_nodal_diameters_beside_calculix(tmp_path: Path, loaded: bool) -> None:
    """Squares of angular frequencies to the seven digits that CalculiX prints; pulled outwards, with NLGEOM, by stresses of
    Young's modulus over a hundred. (Without NLGEOM CalculiX has strains of the loaded state in the stiffness, too.)"""
    steps = [around(1, 3)]
    if loaded:
        pull = "*STEP, NLGEOM\n*STATIC\n*CLOAD\nRIM, 1, 200.\n*END STEP"
        steps = [pull, around(1, 3).replace("*STEP", "*STEP, PERTURBATION", 1)]
    found = solution(tmp_path, sector(*steps)).modes
    assert [result.diameter for result in found] == [1, 2, 3]
    subprocess.run(["ccx", "deck"], cwd=tmp_path, check=True, capture_output=True, timeout=60)
    rows = re.findall(r"^ +([123]) +\d+ +(\S+) +\S+ +\S+ +\S+ *$", (tmp_path / "deck.dat").read_text(), re.MULTILINE)
    for result in found:
        theirs = [float(value) for diameter, value in rows if int(diameter) == result.diameter]
        np.testing.assert_allclose(result.eigenvalues, theirs, rtol=2e-6)


@pytest.mark.skipif(shutil.which("ccx") is None, reason="CalculiX is not installed")
@pytest.mark.parametrize(("more", "tolerance"), [("", 3e-5), (", NLGEOM", 2e-6)])
def test_what_turns_beside_calculix(tmp_path: Path, more: str, tolerance: float) -> None:
    """Stiffer by the pull, softer by forces that grow with the distance, 3.2 % of the lowest square. Without NLGEOM CalculiX
    has the strains in the stiffness, too, 1e-5; with it forces are those of the deformed bar."""
    spin = f"*STEP{more}\n*STATIC\n*DLOAD\nBAR, CENTRIF, 250000., 0., 2., 2., 0., 0., 1.\n*END STEP\n"
    asked = FREQUENCY.replace("*STEP", "*STEP, PERTURBATION", 1).replace("\n2\n", "\n6\n")
    found = solution(tmp_path, bar("", spin + asked)).modes[0]
    subprocess.run(["ccx", "deck"], cwd=tmp_path, check=True, capture_output=True, timeout=60)
    rows = re.findall(r"^ +\d+ +(\S+) +\S+ +\S+ +\S+ *$", (tmp_path / "deck.dat").read_text(), re.MULTILINE)
    np.testing.assert_allclose(found.eigenvalues, [float(value) for value in rows[:6]], rtol=tolerance)


@pytest.mark.parametrize("count", [6, 10])
def test_converted_decks_ask_for_the_same(tmp_path: Path, count: int) -> None:
    """Ten loaded modes are what a job file has where nothing is said."""
    path = tmp_path / "deck.inp"
    steps = [
        "*STEP\n*STATIC\n*END STEP",
        around(0, 2).replace("*STEP", "*STEP, PERTURBATION", 1).replace("\n6\n", f"\n{count}\n"),
    ]
    path.write_text(sector(*steps), encoding="utf-8")
    job = load_job(path)
    written, _ = write_job(tmp_path / "job.toml", job)
    assert load_job(written).model.modes == job.model.modes
    path.write_text(
        bar("", steps[0], steps[1].replace("*SELECT CYCLIC SYMMETRY MODES, NMIN=0, NMAX=2\n", "")), encoding="utf-8"
    )
    job = load_job(path)
    written, _ = write_job(tmp_path / "plain.toml", job)
    assert load_job(written).model.modes == job.model.modes == (abut.Frequencies(count),)


def test_several_steps_of_nodal_diameters(tmp_path: Path) -> None:
    """The same as one step for all."""
    one = solution(tmp_path, sector(around(0, 2))).modes
    three = solution(tmp_path, sector(around(0, 0), around(1, 1), around(2, 2))).modes
    assert [result.diameter for result in three] == [0, 1, 2]
    for a, b in zip(one, three):
        np.testing.assert_allclose(a.eigenvalues, b.eigenvalues, rtol=1e-10)


@pytest.mark.parametrize(
    ("old", "new", "said"),
    [
        ("*MATERIAL", "*EQUATION\n2\nLAST, 1, 1., 9, 1, -1.\n*MATERIAL", "stands in an equation, too"),
        ("NMIN=1, NMAX=1", "NMIN=3, NMAX=9", "FREQUENCY"),
    ],
)
def test_diameters_that_cannot_be_are_refused(tmp_path: Path, old: str, new: str, said: str) -> None:
    with pytest.raises(InputError, match=said):
        solution(tmp_path, sector(around(1, 1)).replace(old, new, 1))


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


SHAKEN = FREQUENCY.replace("*FREQUENCY\n2", "*FREQUENCY, STORAGE=YES\n6")


def answers(folder: Path, *steps: str) -> tuple[abut.Solution, abut.solution.ResponseResult]:
    solved = solution(folder, bar("ALL, 2, 3", SHAKEN, *steps))
    return solved, solved.responses[0]


def test_steady_state_dynamics_of_a_bar(tmp_path: Path) -> None:
    """u = F tan(k l) / (E A k) at its end, with E (1 + i beta omega) of Rayleigh's damping by stiffness; twenty cells of
    first order are too stiff by 3e-4 of the second mode's square, which resonance would sharpen."""
    step = (
        "*STEP\n*STEADY STATE DYNAMICS\n2000., 9000., 5, 1.\n*MODAL DAMPING, RAYLEIGH\n,, 0., 1.E-6\n*CLOAD\nFREE, 1, 2.\n"
        "*CLOAD, LOAD CASE=2\nFREE, 1, 1.\n*NODE PRINT, NSET=FREE\nU\n*END STEP"
    )
    _, result = answers(tmp_path, step)
    np.testing.assert_allclose(result.at, np.linspace(2000.0, 9000.0, 5))
    omega = 2.0 * np.pi * result.at
    young = YOUNG * (1.0 + 1e-6j * omega)
    k = omega * np.sqrt(DENSITY / young)
    expected = 4.0 * (2.0 + 1.0j) * np.tan(k * LENGTH) / (young * 16.0 * k)
    np.testing.assert_allclose(result.probes[0].displacement[:, 0, 0], expected, rtol=2e-3)


def test_steady_state_dynamics_about_a_loaded_state(tmp_path: Path) -> None:
    """Pulled a little, with NLGEOM, a bar answers as at rest, within its strain. PERTURBATION needs modes about the loaded
    state."""
    shaken = (
        "*STEP\n*STEADY STATE DYNAMICS\n2000., 9000., 5, 1.\n*CLOAD\nFREE, 1, 2.\n*NODE PRINT, NSET=FREE\nU\n*END STEP"
    )
    pull = "*STEP, NLGEOM\n*STATIC\n*CLOAD\nFREE, 1, 1.\n*END STEP"
    loaded = [SHAKEN.replace("*STEP", "*STEP, PERTURBATION", 1), shaken.replace("*STEP", "*STEP, PERTURBATION", 1)]
    at_rest = answers(tmp_path, shaken)[1].probes[0].displacement[:, 0, 0]
    found = solution(tmp_path, bar("ALL, 2, 3", pull, *loaded)).responses[0].probes[0].displacement[:, 0, 0]
    np.testing.assert_allclose(found, at_rest, rtol=1e-3)
    assert np.abs(found - at_rest).max() > 0.0  # of the state that is pulled
    with pytest.raises(InputError, match="STEADY STATE DYNAMICS"):
        solution(tmp_path, bar("ALL, 2, 3", pull, SHAKEN, loaded[1]))


def test_everything_that_is_held_shakes_together(tmp_path: Path) -> None:
    """1 / cos(k l) at the free end of a bar whose held end moves by 1."""
    step = (
        "*STEP\n*STEADY STATE DYNAMICS\n2000., 9000., 5, 1.\n*BOUNDARY\nHELD, 1, 1, 1.\n"
        "*NODE PRINT, NSET=FREE\nU\n*END STEP"
    )
    _, result = answers(tmp_path, step)
    expected = 1.0 / np.cos(2.0 * np.pi * result.at / SPEED * LENGTH)
    np.testing.assert_allclose(result.probes[0].displacement[:, 0, 0], expected, rtol=2e-3)


def test_modal_dynamic_of_a_bar_that_is_pulled_suddenly(tmp_path: Path) -> None:
    """The end moves at F c / (E A), away for the time in which waves go there and back, then home again: in the mean of a
    period as far as at rest, at most twice that; six of the modes of a step leave out 1 / 13 of its corners."""
    period = 4.0 * LENGTH / SPEED
    step = f"*STEP\n*MODAL DYNAMIC\n{period / 64}, {period}\n*CLOAD\nFREE, 1, 2.\n*NODE PRINT, NSET=FREE\nU\n*END STEP"
    _, result = answers(tmp_path, step)
    assert len(result.at) == 65
    static = 8.0 * LENGTH / (YOUNG * 16.0)
    wave = static * (1.0 - np.abs(1.0 - result.at / (period / 2.0))) * 2.0
    moved = result.probes[0].displacement[:, 0, 0]
    np.testing.assert_allclose(moved, wave, atol=2.0 * static / 13.0)
    assert moved[:-1].mean() == pytest.approx(static, rel=2e-3)


def test_an_amplitude_runs_over_the_time_of_its_step(tmp_path: Path) -> None:
    """Slow against the first period, 1 / 12930: the end follows at rest."""
    step = (
        "*STEP\n*MODAL DYNAMIC\n.001, .02\n*MODAL DAMPING\n1, 6, .3\n*CLOAD, AMPLITUDE=SLOW\nFREE, 1, 2.\n"
        "*NODE PRINT, NSET=FREE\nU\n*END STEP"
    )
    text = bar("ALL, 2, 3", "*AMPLITUDE, NAME=SLOW\n0., 0., .01, 1., .02, 0.", SHAKEN, step)
    result = solution(tmp_path, text).responses[0]
    static = 8.0 * LENGTH / (YOUNG * 16.0)
    expected = static * (1.0 - np.abs(1.0 - result.at / 0.01))
    np.testing.assert_allclose(result.probes[0].displacement[:, 0, 0], expected, atol=5e-3 * static)
    assert result.damping[:6] == pytest.approx(0.3)


@pytest.mark.parametrize(
    "step",
    [
        "*STEADY STATE DYNAMICS, HARMONIC=NO\n1., 2.\n*CLOAD\nFREE, 1, 2.",
        "*STEADY STATE DYNAMICS\n1., 2.",
        "*STEADY STATE DYNAMICS\n1., 2.\n*CLOAD, AMPLITUDE=SLOW\nFREE, 1, 2.",
        "*STEADY STATE DYNAMICS\n1., 2.\n*BOUNDARY\n1, 1, 1, 1.",
        "*MODAL DYNAMIC\n.1, 1.\n*BOUNDARY\nHELD, 1, 1, 1.",
        "*MODAL DYNAMIC\n.1, 1.\n*CLOAD, LOAD CASE=2\nFREE, 1, 2.",
        "*MODAL DYNAMIC, STEADY STATE\n.1, 1.\n*CLOAD\nFREE, 1, 2.",
    ],
)
def test_other_vibrations_are_refused(tmp_path: Path, step: str) -> None:
    text = bar("ALL, 2, 3", "*AMPLITUDE, NAME=SLOW\n0., 0., 1., 1.", SHAKEN, f"*STEP\n{step}\n*END STEP")
    with pytest.raises(InputError):
        solution(tmp_path, text)


def test_modes_before_and_after_a_load_are_both_found(tmp_path: Path) -> None:
    """Unloaded those of the bar; stretched by 1 % under NLGEOM those of a longer and stiffer one: at nu = 0, a logarithmic
    or any other law near, within a few per cent of each other, but not the same."""
    pull = "*STEP, NLGEOM\n*STATIC\n*CLOAD\nFREE, 1, 8400.\n*END STEP"
    both = bar("ALL, 2, 3", FREQUENCY, pull, FREQUENCY.replace("*STEP", "*STEP, PERTURBATION"))
    before, after = solution(tmp_path, both).modes
    alone = solution(tmp_path, bar("ALL, 2, 3", FREQUENCY)).modes[0]
    loaded = solution(tmp_path, bar("ALL, 2, 3", pull, FREQUENCY.replace("*STEP", "*STEP, PERTURBATION"))).modes[0]
    np.testing.assert_allclose(before.values, alone.values, rtol=1e-8)
    np.testing.assert_allclose(after.values, loaded.values, rtol=1e-8)
    assert abs(after.values[0] / before.values[0] - 1.0) > 1e-4

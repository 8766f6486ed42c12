"""Time in decks: several steps, amplitudes over step and total time. A bar of one brick, E = 1000, 1 x 1 x 1 without
Poisson's ratio, sides held, so that a pressure p shortens it by p / 1000; CalculiX 2.20 gives the same in each case."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from scipy.optimize import brentq

import abut
from abut.io.deck.time_histories import tidy
from models.decks import load, step

E = 1000.0
BAR = """*NODE, NSET=ALL
1, 0,0,0
2, 1,0,0
3, 1,1,0
4, 0,1,0
5, 0,0,1
6, 1,0,1
7, 1,1,1
8, 0,1,1
*ELEMENT, TYPE=C3D8, ELSET=E
1, 1,2,3,4,5,6,7,8
*NSET, NSET=BOTTOM, GENERATE
1, 4
*NSET, NSET=TOP, GENERATE
5, 8
*MATERIAL, NAME=EL
*ELASTIC
1000., 0.
*EXPANSION
1.E-3
*SOLID SECTION, ELSET=E, MATERIAL=EL
*INITIAL CONDITIONS, TYPE=TEMPERATURE
ALL, 0.
*BOUNDARY
BOTTOM, 1, 3
ALL, 1, 2
"""
TABLE = "*AMPLITUDE, NAME=A{}\n0., 0., 3., 3.\n"
TOTAL, LOCAL = TABLE.format(", TIME=TOTAL TIME"), TABLE.format("")


def heights(folder: Path, text: str, ends: int) -> np.ndarray:
    """How far the top has come down at the end of each of so many steps of length 1."""
    solution = abut.solve(load(folder, text).model)
    assert solution.converged
    found = []
    for k in range(1, ends + 1):
        (step,) = [each for each in solution.steps if abs(each.factor - k / ends) < 1e-12]
        found.append(-step.displacement[4:, 2].mean())
    return np.array(found)


@pytest.mark.parametrize("pressures", [(10.0, 30.0, 20.0), (10.0, 20.0, 30.0), (10.0, -10.0, 20.0)])
@pytest.mark.parametrize("increments", ["", "\n0.1, 1.", "\n0.1, 1., , 0.25"])
def test_every_step_is_solved_without_contact(pressures: tuple[float, ...], increments: str, tmp_path: Path) -> None:
    """NLGEOM: the force on the held area is p = -E (l^2 - 1) l / 2 with the stretch l (Saint Venant and Kirchhoff)."""
    steps = [step("*DLOAD", f"1, P2, {p}", card=f"*STATIC{increments}") for p in pressures]
    found = heights(tmp_path, BAR + "".join(steps).replace("*STEP", "*STEP, NLGEOM"), 3)
    exact = [1.0 - brentq(lambda s, p=p: E * (s * s - 1.0) * s / 2.0 + p, 0.8, 1.2) for p in pressures]
    assert found == pytest.approx(exact, rel=1e-8)


@pytest.mark.parametrize(
    ("card", "line", "size"),
    [("*DLOAD", "1, P2, 10.", 0.01), ("*CLOAD", "TOP, 3, -2.5", 0.01), ("*BOUNDARY", "TOP, 3, 3, -0.01", 0.01),
     ("*TEMPERATURE", "ALL, 10.", -0.01), ("*DLOAD", "E, GRAV, 20., 0., 0., -1.", 0.01)],
)  # fmt: skip
def test_an_amplitude_over_the_total_time_goes_on(card: str, line: str, size: float, tmp_path: Path) -> None:
    """Steps that do not name the load go on with its table; one over the step's own time stays at its last value."""
    text = BAR.replace("*EXPANSION", "*DENSITY\n1.\n*EXPANSION")
    going = step(f"{card}, AMPLITUDE=A", line) + step() + step()
    assert heights(tmp_path, text + TOTAL + going, 3) == pytest.approx(size * np.array([1.0, 2.0, 3.0]), rel=1e-9)
    assert heights(tmp_path, text + LOCAL + going, 3) == pytest.approx(size * np.array([1.0, 1.0, 1.0]), rel=1e-9)


def test_it_ends_where_another_value_or_op_new_comes(tmp_path: Path) -> None:
    text = BAR + TOTAL + step("*DLOAD, AMPLITUDE=A", "1, P2, 10.")
    replaced = heights(tmp_path, text + step("*DLOAD", "1, P2, 5.") + step(), 3)
    assert replaced == pytest.approx([0.01, 0.005, 0.005], rel=1e-9)
    ended = heights(tmp_path, text + step("*DLOAD, OP=NEW") + step(), 3)
    assert ended == pytest.approx([0.01, 0.0, 0.0], abs=1e-12)


def test_corners_of_tables_that_go_on_are_met(tmp_path: Path) -> None:
    table = "*AMPLITUDE, NAME=A, TIME=TOTAL TIME\n0., 0., 1.5, 3., 2., 0.\n"
    model = load(tmp_path, BAR + table + step("*DLOAD, AMPLITUDE=A", "1, P2, 10.") + step()).model
    assert model.solve.times == pytest.approx([0.5, 0.75, 1.0])


@pytest.mark.parametrize(
    ("cards", "times"),
    [
        (("*STATIC, TOTAL TIME AT START=1.5", "*STATIC"), (2.5, 3.0)),
        (("*STATIC", "*STATIC, TOTAL TIME AT START=0.25"), (1.0, 1.25)),
        (("*STATIC, TIME RESET", "*STATIC"), (0.0, 1.0)),
        (("*STATIC", "*STATIC, TIME RESET", "*STATIC"), (1.0, 1.0, 2.0)),
    ],
)
def test_total_time_that_is_set(cards: tuple[str, ...], times: tuple[float, ...], tmp_path: Path) -> None:
    """TOTAL TIME AT START begins a step at that time; TIME RESET ends it at the time at which the step before ended, before
    the first one 0. The table ends at 3."""
    text = step("*DLOAD, AMPLITUDE=A", "1, P2, 10.", card=cards[0]) + "".join(step(card=card) for card in cards[1:])
    assert heights(tmp_path, BAR + TOTAL + text, len(cards)) == pytest.approx(0.01 * np.array(times), abs=1e-11)


def test_a_time_at_the_start_that_is_no_number(tmp_path: Path) -> None:
    with pytest.raises(abut.InputError, match="TOTALTIMEATSTART: expected a time, got 'soon'"):
        load(tmp_path, BAR + step(card="*STATIC, TOTAL TIME AT START=soon"))


@pytest.mark.parametrize(("table", "expected"), [(TOTAL, (0.01, 0.02, 0.03)), (LOCAL, (0.01, 0.01, 0.01))])
@pytest.mark.parametrize("last", [False, True])
def test_amplitudes_outside_the_steps(table: str, expected: tuple[float, ...], last: bool, tmp_path: Path) -> None:
    """A support before the first step may have one, which may be defined after it."""
    held = "*BOUNDARY, AMPLITUDE=A\nTOP, 3, 3, -0.01\n"
    text = BAR + (held + table if last else table + held) + step() + step() + step()
    assert heights(tmp_path, text, 3) == pytest.approx(expected, rel=1e-9)


def test_an_amplitude_that_begins_elsewhere_jumps_there(tmp_path: Path) -> None:
    """It acts from the beginning of its step on: twice the load, not a ramp from what the step before has left."""
    jump = "*AMPLITUDE, NAME=B\n0., 2., 1., 3.\n"
    text = BAR + jump + step("*DLOAD", "1, P2, 10.") + step("*DLOAD, AMPLITUDE=B", "1, P2, 10.")
    (load_,) = load(tmp_path, text).model.loads
    found = [load_.value * load_.amplitude(time) for time in (0.25, 0.5, 0.5 + 1e-6, 0.75, 1.0)]
    assert found == pytest.approx([5.0, 10.0, 20.0, 25.0, 30.0], rel=1e-5)


def test_of_values_given_twice_the_later_one_holds(tmp_path: Path) -> None:
    """In a step, of temperatures and of supports; loads given twice add up."""
    text = BAR + step("*TEMPERATURE", "ALL, 4.\nALL, 10.")
    assert heights(tmp_path, text, 1) == pytest.approx([-0.01], rel=1e-9)
    both = BAR + step("*TEMPERATURE", "ALL, 4.", "*TEMPERATURE", "ALL, 10.")
    assert heights(tmp_path, both, 1) == pytest.approx([-0.01], rel=1e-9)
    held = BAR + step("*BOUNDARY", "TOP, 3, 3, -0.004\nTOP, 3, 3, -0.01")
    assert heights(tmp_path, held, 1) == pytest.approx([0.01], rel=1e-9)
    loads = BAR + step("*DLOAD", "1, P2, 4.", "*DLOAD", "1, P2, 10.")
    assert heights(tmp_path, loads, 1) == pytest.approx([0.014], rel=1e-9)


def test_of_two_values_at_one_time_the_later_one_holds() -> None:
    """A course is a function of time, and points on the line between their neighbours say nothing."""
    assert tidy([(0.0, 0.0), (1.0, 1.0), (1.0, 2.0), (2.0, 3.0)]) == ((0.0, 0.0), (1.0, 2.0), (2.0, 3.0))
    assert tidy([(0.0, 0.0), (0.5, 1.0), (1.0, 2.0), (1.0, 2.0), (1.0, 2.0)]) == ((0.0, 0.0), (1.0, 2.0))

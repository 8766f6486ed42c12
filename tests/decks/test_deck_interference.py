"""*CONTACT INTERFERENCE: two bricks of E = 1000, 1 x 1 x 1 without Poisson's ratio, that overlap by 0.1 between two planes:
each takes half of the overlap that is not allowed, h - v, so that the pressure is 1000 (h - v) / 2."""

from __future__ import annotations

import re
from pathlib import Path

import pytest

from abut.errors import InputError
from models.decks import BRICKS, PAIR, load, solve, step

BETWEEN = "*BOUNDARY\nBOTTOM, 1, 3\nTOP, 1, 3\nALL, 1, 2\n"


def lower(text: str, by: float) -> str:
    """The upper brick lower by a length."""
    return re.sub(
        r"(?m)^(1[1-8], .*,)(\d)$", lambda found: f"{found[1]}{float(found[2]) - by:.17g}", text
    )  # fmt: skip


DECK = lower(BRICKS, 0.1) + PAIR + "*AMPLITUDE, NAME=A\n0., 1., 0.5, 0.25, 1., 0.\n" + BETWEEN


def pressures(folder: Path, text: str) -> list[float]:
    solution = solve(folder, DECK + text)
    assert solution.converged
    return [-float(each.contacts[0].force[2]) for each in solution.steps]


def interference(*data: str, more: str = "") -> list[str]:
    return [f"*CONTACT INTERFERENCE{more}", *data]


@pytest.mark.parametrize(
    ("lines", "expected"),
    [
        ([], [50.0]),
        (interference("SLAVE, MASTER, 0.1"), [50.0]),  # down to zero at the end of the step
        (interference("MASTER, SLAVE, 0.06", more=", AMPLITUDE=A"), [50.0 - 30.0 / 4, 50.0]),
        (interference("SLAVE, MASTER, -0.04", more=", AMPLITUDE=A"), [50.0 + 20.0 / 4, 50.0]),
        (interference("SLAVE, MASTER, 0.2", more=", AMPLITUDE=A"), [25.0, 50.0]),
        (interference("SLAVE, MASTER", more=", SHRINK"), [50.0]),
    ],
)
def test_the_overlap_that_is_left(lines: list[str], expected: list[float], tmp_path: Path) -> None:
    found = pressures(tmp_path, step(*lines))
    assert [abs(p) for p in found] == pytest.approx(expected, rel=1e-9)


def test_it_is_allowed_from_the_beginning_of_its_step(tmp_path: Path) -> None:
    """In the first step it is there at time 0, halfway half of it; in a later one it comes at once; OP=NEW ends it."""
    first = load(tmp_path, DECK + step(*interference("SLAVE, MASTER, 0.1"))).model.contacts[0]
    assert (first.offset, first.amplitude(0.0), first.amplitude(0.5), first.amplitude(1.0)) == (0.1, 1.0, 0.5, 0.0)
    shrunk = load(tmp_path, DECK + step(*interference("SLAVE, MASTER", more=", SHRINK"))).model.contacts[0]
    assert (shrunk.offset, shrunk.amplitude(0.25)) == (pytest.approx(0.1, rel=1e-12), 0.75)
    half = DECK.replace("1., 0.\n", "1., 0.5\n")
    text = step() + step(*interference("SLAVE, MASTER, 0.04", more=", AMPLITUDE=A")) + step()
    later = load(tmp_path, half + text + step(*interference("SLAVE, MASTER, 0.", more=", OP=NEW"))).model.contacts[0]
    times = (0.0, 0.25, 0.25 + 1e-6, 0.375, 0.5, 0.75, 1.0)
    assert [later.offset * later.amplitude(t) for t in times] == pytest.approx(
        [0.0, 0.0, 0.04, 0.01, 0.02, 0.02, 0.0], abs=1e-6
    )


def test_with_a_clearance(tmp_path: Path) -> None:
    """A clearance takes the place of the mesh's gap, here an overlap of 0.02: of that the interference is allowed."""
    text = "*CLEARANCE, SLAVE=SLAVE, MASTER=MASTER, VALUE=-0.02\n"
    lines = interference("SLAVE, MASTER, 0.02", more=", AMPLITUDE=A")
    assert [abs(p) for p in pressures(tmp_path, text + step(*lines))] == pytest.approx([7.5, 10.0], rel=1e-9)


def test_large_displacements_take_it_too(tmp_path: Path) -> None:
    """Saint Venant and Kirchhoff: with stretches 1 - e, pressure 1000 (e - e^2 / 2) (1 - e), e half of the overlap."""
    lines = interference("SLAVE, MASTER", more=", SHRINK")
    found = pressures(tmp_path, step(*lines).replace("*STEP", "*STEP, NLGEOM"))
    assert abs(found[-1]) == pytest.approx(1000.0 * (0.05 - 0.05**2 / 2.0) * 0.95, rel=1e-6)


@pytest.mark.parametrize(
    ("lines", "message"),
    [
        (interference("SLAVE, TOP, 0.1"), "no master surface named 'TOP'"),
        (interference("SLAVE, MASTER"), "interference"),
        (interference("SLAVE, MASTER, 0.1", more=", AMPLITUDE=B"), r"no \*AMPLITUDE named 'B'"),
        (interference("SLAVE, MASTER, 0.1", more=", TYPE=ELEMENT"), "contact elements are not supported"),
        (interference("SLAVE, MASTER, 0.1", more=", OP=OLD"), "OP=OLD: expected NEW or MOD"),
        (interference("SLAVE, SLAVE, 0.1"), r"'SLAVE' and 'SLAVE' are no \*CONTACT PAIR"),
    ],
)
def test_what_is_refused(lines: list[str], message: str, tmp_path: Path) -> None:
    with pytest.raises(InputError, match=message):
        load(tmp_path, DECK + step(*lines))


def test_shrink_stands_in_the_first_step(tmp_path: Path) -> None:
    with pytest.raises(InputError, match="SHRINK: stands in the first step"):
        load(tmp_path, DECK + step() + step(*interference("SLAVE, MASTER", more=", SHRINK")))


def change(way: str) -> list[str]:
    return [f"*MODEL CHANGE, TYPE=CONTACT PAIR, {way}", "SLAVE, MASTER"]


@pytest.mark.long
@pytest.mark.parametrize("nlgeom", ["", ", NLGEOM"])
def test_pairs_that_come_and_go(nlgeom: str, tmp_path: Path) -> None:
    """All of the overlap is carried, nothing while the pair is removed, and all again."""
    text = "".join(
        step(*lines).replace("*STEP", f"*STEP{nlgeom}") for lines in ([], change("REMOVE"), [], change("ADD"), [])
    )
    solution = solve(tmp_path, DECK + text)
    assert solution.converged
    ends = [next(s for s in solution.steps if abs(s.factor - t) < 1e-9) for t in (0.2, 0.4, 0.6, 0.8, 1.0)]
    full = 1000.0 * (0.05 - 0.05**2 / 2.0) * 0.95 if nlgeom else 50.0
    assert [abs(s.contacts[0].force[2]) for s in ends] == pytest.approx(
        [full, 0.0, 0.0, full, full], rel=1e-6, abs=1e-9
    )


@pytest.mark.parametrize(
    ("card", "message"),
    [
        ("*MODEL CHANGE, ADD\n1", "element 1 is there already"),
        ("*MODEL CHANGE, TYPE=CONTACT PAIR\nSLAVE, MASTER", "either ADD or REMOVE"),
        ("*MODEL CHANGE, TYPE=CONTACT PAIR, REMOVE\nSLAVE, SLAVE", "no .CONTACT PAIR"),
    ],
)
def test_changes_that_are_refused(card: str, message: str, tmp_path: Path) -> None:
    with pytest.raises(InputError, match=message):
        load(tmp_path, DECK + step(*card.split("\n")))

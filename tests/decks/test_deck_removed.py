"""*MODEL CHANGE, TYPE=ELEMENT: what is not there, goes, or comes back."""

from __future__ import annotations

from pathlib import Path

import pytest
from decks.test_deck_multipoint import BLOCK

import abut
from abut.errors import InputError
from models.decks import load, step

# Of the block of 2 x 2 x 2 bricks, without Poisson's ratio, columns 1 by 1 at x = 0..1
COLUMNS = BLOCK.replace("1000., .3", "1000., 0.") + "*BOUNDARY\nALL, 1, 2\n"
PRESSED = ["*DLOAD", "5, P2, 10.", "6, P2, 10.", "7, P2, 10.", "8, P2, 10."]
REMOVE = ["*MODEL CHANGE, TYPE=ELEMENT, REMOVE"]


def test_what_is_removed_is_not_there(tmp_path: Path) -> None:
    """The lower half of the block: pressures on the elements that are gone go with them, each pressed column is 1 high."""
    pressed = ["*DLOAD", *(f"{e}, P2, 10." for e in range(1, 9))]
    text = COLUMNS.replace("*BOUNDARY", "*SURFACE, NAME=LID\nE, S2\n*BOUNDARY", 1)
    job = load(tmp_path, text + step(*REMOVE, "5, 6", "7, 8", *pressed))
    assert any("4 elements are taken out from the beginning on" in note for note in job.notes)
    solution = abut.solve(job.model)
    points = solution.model.mesh.points
    assert points[:, 2].max() == 1.0
    assert solution.displacement[points[:, 2] == 1.0, 2] == pytest.approx(-10.0 / 1000.0, rel=1e-9)


def test_a_set_of_elements_and_a_later_step(tmp_path: Path) -> None:
    text = COLUMNS.replace("*NSET, NSET=BOTTOM", "*ELSET, ELSET=UPPER\n5,6,7,8\n*NSET, NSET=BOTTOM")
    first = step(*REMOVE, "UPPER", "*DLOAD", "1, P2, 10.", "2, P2, 10.", "3, P2, 10.", "4, P2, 10.")
    solution = abut.solve(load(tmp_path, text + first + step("*DLOAD", "E, P2, 20.")).model)
    assert solution.displacement[:, 2].min() == pytest.approx(-20.0 / 1000.0, rel=1e-9)


def test_elements_come_back_without_strain(tmp_path: Path) -> None:
    """Pressed by 10, each half is 0.01 shorter. The upper one goes, keeps its shape, and comes back without strain: pressed
    anew it is another 0.01 shorter, the lower one, unloaded meanwhile, 0.01 in all."""
    first, second, third = PRESSED, [*REMOVE, "5, 6, 7, 8"], ["*MODEL CHANGE, TYPE=ELEMENT, ADD", "5, 6, 7, 8"]
    job = load(tmp_path, COLUMNS + "".join(step(*lines) for lines in (first, second, third)))
    assert any("4 elements come back without strain" in note for note in job.notes)
    solution = abut.solve(job.model)
    heights, ends = solution.model.mesh.points[:, 2], (1 / 3, 2 / 3, 1.0)
    moved = [next(s for s in solution.steps if abs(s.factor - end) < 1e-9).displacement[:, 2] for end in ends]
    for u, middle, top in zip(moved, (-0.01, 0.0, -0.01), (-0.02, -0.01, -0.03)):
        assert u[heights == 1.0] == pytest.approx(middle, abs=1e-9)
        assert u[heights == 2.0] == pytest.approx(top, abs=1e-6)  # nodes that are away follow within a billionth


def test_elements_come_back_with_strain(tmp_path: Path) -> None:
    """The lower half pressed by 10 alone, the upper one back with the strain that its nodes then have, none, or taken out
    under the pressure on it and back: .02 shorter again, as though it had never gone."""
    first, second, third = (
        PRESSED,
        [*REMOVE, "5, 6, 7, 8"],
        ["*MODEL CHANGE, TYPE=ELEMENT, ADD=WITH STRAIN", "5, 6, 7, 8"],
    )
    job = load(tmp_path, COLUMNS + "".join(step(*lines) for lines in (first, second, third)))
    assert not any("without strain" in note for note in job.notes)
    solution = abut.solve(job.model)
    assert solution.displacement[solution.model.mesh.points[:, 2] == 2.0, 2] == pytest.approx(-0.02, abs=1e-8)


SOFTER = "*MATERIAL, NAME=OTHER\n*ELASTIC\n{}., 0.\n*DENSITY\n2.\n"
LID = [
    "*CLOAD",
    *(
        f"{n}, 3, {-10.0 * share}"
        for n, share in zip((201, 202, 203, 211, 212, 213, 221, 222, 223), (1, 2, 1, 2, 4, 2, 1, 2, 1))
    ),
]


@pytest.mark.parametrize(("first", "shorter"), [(False, (-0.08, -0.12)), (True, (-0.12, -0.12))])
def test_materials_change(first: bool, shorter: tuple[float, float], tmp_path: Path) -> None:
    """The upper half is half as stiff from the second step on, or from the first: all of its strain counts."""
    text = COLUMNS.replace(
        "*NSET, NSET=BOTTOM", "*ELSET, ELSET=UPPER\n5,6,7,8\n" + SOFTER.format(500) + "*NSET, NSET=BOTTOM", 1
    )
    change = ["*CHANGE SOLID SECTION, ELSET=UPPER, MATERIAL=OTHER"]
    steps = step(*(change if first else []), *LID) + step(*([] if first else change), *LID)
    solution = abut.solve(load(tmp_path, text + steps).model)
    top = solution.model.mesh.points[:, 2] == 2.0
    ends = [next(s for s in solution.steps if abs(s.factor - end) < 1e-9).displacement[top, 2] for end in (0.5, 1.0)]
    for u, wanted in zip(ends, shorter):
        assert u == pytest.approx(wanted, rel=1e-6)


@pytest.mark.parametrize(
    ("card", "more", "says"),
    [
        ("MATERIAL=NONE", [], "no material named 'NONE'"),
        ("MATERIAL=OTHER", PRESSED, "elements that change have no pressures"),
        ("MATERIAL=OTHER", [*REMOVE, "5"], "elements that change twice, or go and change"),
    ],
)
def test_changes_that_are_refused(card: str, more: list[str], says: str, tmp_path: Path) -> None:
    text = COLUMNS.replace(
        "*NSET, NSET=BOTTOM", "*ELSET, ELSET=UPPER\n5,6,7,8\n" + SOFTER.format(500) + "*NSET, NSET=BOTTOM", 1
    )
    with pytest.raises(InputError, match=says):
        load(tmp_path, text + step(*LID) + step(f"*CHANGE SOLID SECTION, ELSET=UPPER, {card}", *more))


@pytest.mark.parametrize(
    ("steps", "words"),
    [
        (([*REMOVE, "9"],), "element 9 does not exist"),
        (([*REMOVE, "TOPS"],), "no element set named 'TOPS'"),
        ((["*MODEL CHANGE, TYPE=ELEMENT, ADD", "5"],), "element 5 is there already"),
        ((["*MODEL CHANGE, TYPE=ELEMENT", "5"],), "expected one of ADD and REMOVE"),
        (([*REMOVE, "5"], ["*MODEL CHANGE, TYPE=ELEMENT, ADD=X", "5"]), "ADD=X: expected STRAIN FREE, WITH STRAIN"),
        (([*REMOVE, "5", "*MODEL CHANGE, TYPE=ELEMENT, ADD", "5"],), "taken out and brought back in one step"),
    ],
)
def test_what_is_no_change_is_refused(steps: tuple[list[str], ...], words: str, tmp_path: Path) -> None:
    with pytest.raises(InputError, match=words):
        load(tmp_path, COLUMNS + "".join(step(*lines) for lines in steps))

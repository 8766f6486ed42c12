"""Supports that freeze what they find (FIXED), loads that come later (TIME DELAY), turning nodes of parts that are rigid:
closed forms for a cube without Poisson's ratio, E = 1000, which a pressure p shortens by p / 1000."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from decks.test_deck_time import BAR, TOTAL, heights

import abut
from abut.cli import main
from abut.errors import InputError
from abut.job import load_job
from models.decks import load, step, write

PUSH, FREE = ["*DLOAD", "1, P2, 10."], ["*DLOAD, OP=NEW"]
FROZEN = ["*BOUNDARY, FIXED", "TOP, 3, 3"]


def test_nodes_stay_where_they_were(tmp_path: Path) -> None:
    """Pressed by 10 in the first step, frozen as the load goes in the second, let go in the third."""
    text = BAR + step(*PUSH) + step(*FREE, *FROZEN) + step("*BOUNDARY, OP=NEW", "BOTTOM, 1, 3", "ALL, 1, 2")
    assert heights(tmp_path, text, 3) == pytest.approx([0.01, 0.01, 0.0], abs=1e-8)  # what holds gives a millionth
    job = tmp_path / "job.toml"
    assert main(["convert", str(tmp_path / "deck.inp"), str(job), "--quiet"]) == 0
    assert load_job(job).model.holds == load(tmp_path, text).model.holds


def test_what_is_held_already_stays_there(tmp_path: Path) -> None:
    pushed = step("*BOUNDARY", "TOP, 3, 3, -0.02")
    assert heights(tmp_path, BAR + pushed + step(*FROZEN), 2) == pytest.approx([0.02, 0.02], rel=1e-9)
    assert heights(tmp_path, BAR + step(*FROZEN, *PUSH), 1) == pytest.approx([0.0], abs=1e-12)


@pytest.mark.parametrize(
    ("lines", "words"),
    [
        (["*BOUNDARY, FIXED", "TOP, 3, 3, 0.1"], "neither a displacement nor an amplitude"),
        (["*BOUNDARY, FIXED, AMPLITUDE=A", "TOP, 3, 3"], "neither a displacement nor an amplitude"),
        (["*DLOAD, TIME DELAY=1.", "1, P2, 10."], "TIMEDELAY goes with AMPLITUDE"),
        (["*DLOAD, AMPLITUDE=A, TIME DELAY=late", "1, P2, 10."], "TIMEDELAY: expected a time, got 'late'"),
    ],
)
def test_what_makes_no_sense(lines: list[str], words: str, tmp_path: Path) -> None:
    with pytest.raises(InputError, match=words):
        load(tmp_path, BAR + TOTAL + step(*PUSH) + step(*lines))


def test_what_was_frozen_is_not_led_on(tmp_path: Path) -> None:
    with pytest.raises(InputError, match="held where it was"):
        load(tmp_path, BAR + step(*PUSH) + step(*FROZEN) + step("*BOUNDARY", "TOP, 3, 3, 0.1"))


def test_a_load_that_comes_later(tmp_path: Path) -> None:
    """A factor t from 0 to 3, a time 1 later: none until 1, 1 at 2, 2 at 3."""
    lines = ["*DLOAD, AMPLITUDE=A, TIME DELAY=1.", "1, P2, 10."]
    assert heights(tmp_path, BAR + TOTAL + step(*lines) + step() + step(), 3) == pytest.approx(
        [0.0, 0.01, 0.02], abs=1e-9
    )


def test_the_turning_node_of_a_part(tmp_path: Path) -> None:
    """Two cubes that share a face; the top face of the upper one is rigid and turned about z by its turning node: as a twist
    prescribed at a kinematic coupling's node."""
    more = "9, 0,0,2\n10, 1,0,2\n11, 1,1,2\n12, 0,1,2\n98, 0,0,0\n99, 0.5,0.5,2.\n*ELEMENT"
    text = BAR.replace("*ELEMENT", more, 1).replace("7,8\n*NSET", "7,8\n2, 5,6,7,8,9,10,11,12\n*NSET", 1)
    text = text.replace("ALL, 1, 2\n", "").replace("5, 8", "9, 12")
    rigid = "*RIGID BODY, NSET=TOP, REF NODE=99, ROT NODE=98\n"
    coupled = "*KINEMATIC COUPLING, REF NODE=99\nTOP, 1, 6\n"
    moved = ["*BOUNDARY", "99, 1, 3, 0.01", "{}, 0.02"]
    one = abut.solve(load(tmp_path, text + rigid + step(*moved[:2], moved[2].format("98, 3, 3"))).model)
    other = abut.solve(load(tmp_path, text + coupled + step(*moved[:2], moved[2].format("99, 6, 6"))).model)
    assert np.abs(other.displacement[8:12, 0] - 0.01) == pytest.approx(
        0.01, rel=1e-9
    )  # 0.5 from the axis, turned by 0.02
    assert one.displacement == pytest.approx(other.displacement, abs=1e-12)


def test_a_line_with_more_nodes_than_an_element_has(tmp_path: Path) -> None:
    """Where the line ends with a comma, as CalculiX's own examples have it."""
    text = BAR.replace("1, 1,2,3,4,5,6,7,8\n", "1, 1,2,3,4,5,6,7,8, 9, 10,\n") + step(*PUSH)
    job = load(tmp_path, text)
    assert any("more nodes on a line than C3D8 has: the first 8 count" in note for note in job.notes)
    assert abut.solve(job.model).displacement[4:, 2] == pytest.approx(-0.01, rel=1e-9)


def test_thin_elements_with_incompatible_modes_are_noted(tmp_path: Path) -> None:
    thin = BAR.replace("C3D8", "C3D8I")
    assert not any("as long as thick" in note for note in load(tmp_path, thin + step(*PUSH)).notes)
    for number in range(5, 9):
        thin = thin.replace(f"{number}, 0,0,1", f"{number}, 0,0,.2").replace(f"{number}, 1,0,1", f"{number}, 1,0,.2")
        thin = thin.replace(f"{number}, 1,1,1", f"{number}, 1,1,.2").replace(f"{number}, 0,1,1", f"{number}, 0,1,.2")
    assert any(
        "1 of 1 elements are more than 3 times as long" in note for note in load(tmp_path, thin + step(*PUSH)).notes
    )


def test_a_force_beside_the_nodes_that_carry_it_is_noted(tmp_path: Path) -> None:
    for x, beside in ((0.5, False), (0.7, True)):
        text = BAR.replace("*ELEMENT", f"99, {x},0.5,1.\n*ELEMENT", 1)
        text += "*ELEMENT, TYPE=DCOUP3D, ELSET=D\n9, 99\n*DISTRIBUTING COUPLING, ELSET=D\nTOP, 1.\n"
        text += "*SOLID SECTION, ELSET=D, MATERIAL=EL\n" + step("*CLOAD", "99, 3, -10.")
        assert any("is not amid its nodes" in note for note in load(tmp_path, text).notes) == beside


def test_packed_decks_are_told(tmp_path: Path) -> None:
    path = write(tmp_path, "")
    path.write_bytes(b"\x1f\x8b\x08\x00")
    with pytest.raises(InputError, match=r"packed by gzip; unpack it first \(gunzip deck.inp\)"):
        load_job(path)

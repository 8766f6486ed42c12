"""NO SEPARATION: bilateral contact, theory (L16). Two bricks of E = 1000, 1 x 1 x 1 without Poisson's ratio."""

from __future__ import annotations

from pathlib import Path

import pytest

from abut.errors import InputError
from abut.job import load_job
from abut.job.convert import write_job
from models.decks import BRICKS, HELD, PAIR, load, solve, step

KEPT = PAIR.replace("=HARD", "=HARD, NO SEPARATION")
FREE = "*BOUNDARY\nBOTTOM, 1, 3\n15, 1, 2\n16, 2\n"
PULL = step("*DLOAD", "2, P2, -10.")


def test_it_is_pulled_and_slides(tmp_path: Path) -> None:
    """Pulled by 10: the pressure is -10, the top rises by 2 x 10 / 1000."""
    solution = solve(tmp_path, BRICKS + KEPT + HELD + PULL)
    assert solution.model.contacts[0].kind == "bilateral"
    assert solution.steps[-1].contacts[0].pressure[0, :4] == pytest.approx(-10.0, rel=1e-9)
    assert solution.displacement[solution.model.mesh.points[:, 2] > 1.5, 2] == pytest.approx(0.02, rel=1e-9)
    slid = solve(tmp_path, BRICKS + KEPT + FREE.replace("15, 1, 2\n", "TOP, 1, 1, 0.1\n15, 2\n") + PULL)
    assert abs(slid.steps[-1].contacts[0].force[0]) < 1e-9


def test_notes_and_jobs(tmp_path: Path) -> None:
    kept = load(tmp_path, BRICKS + KEPT + HELD + PULL)
    assert [note for note in kept.notes if note.endswith("NO SEPARATION: bilateral from the beginning on")]
    again = load_job(write_job(tmp_path / "job.toml", kept)[0]).model
    assert again.contacts == kept.model.contacts
    apart = load(tmp_path, BRICKS.replace("0,0,1\n12", "0,0,1.001\n12") + KEPT + HELD + PULL)
    assert [note for note in apart.notes if "gaps of up to 0.001 are closed" in note]


def test_without_friction_only(tmp_path: Path) -> None:
    with pytest.raises(InputError, match="NO SEPARATION goes without friction"):
        load(tmp_path, BRICKS + KEPT.replace("*CONTACT PAIR", "*FRICTION\n0.1\n*CONTACT PAIR") + HELD + PULL)

"""Friction from job files and decks, in output, beside other features: materials, checks before a run, halved steps."""

from __future__ import annotations

import csv
import json
from dataclasses import replace
from pathlib import Path

import pytest

import abut
from abut import write
from abut.diagnosis.examine import check
from abut.errors import InputError
from abut.job import load_job
from models.decks import BRICKS, PAIR, load
from models.friction import FRICTION, Hooke, on_a_slope, pushed

EXAMPLE = Path(__file__).parents[2] / "examples" / "pushed-block" / "job.toml"
DECK = BRICKS + PAIR.replace("HARD\n", "HARD\n*FRICTION\n0.25, 1.E4\n")
DRIVEN = """*BOUNDARY
BOTTOM, 1, 3
ALL, 2, 2
TOP, 1, 1
*STEP
*STATIC
*DLOAD
2, P2, 10.
*END STEP
*STEP
*STATIC
*BOUNDARY
TOP, 1, 1, 0.5
*END STEP
"""


@pytest.fixture(scope="module")
def written(tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder = tmp_path_factory.mktemp("friction")
    write(abut.solve(pushed()), folder)
    return folder


def test_summary_and_history(written: Path) -> None:
    steps = json.loads((written / "summary.json").read_text())["steps"]
    own = steps[2]["contacts"][0]["friction"]
    assert own["coefficient"] == FRICTION
    assert own["sticking_area"] + own["slipping_area"] == pytest.approx(steps[2]["contacts"][0]["area"])
    assert own["work"] > 0.0
    assert steps[4]["contacts"][0]["friction"]["max_total_slip"] > 0.0
    rows = list(csv.DictReader((written / "history.csv").open()))
    assert float(rows[2]["slipping_area"]) == own["slipping_area"]
    assert float(rows[2]["friction_work"]) == own["work"]


def test_fields_of_the_contact(written: Path) -> None:
    (file,) = written.glob("contact_*_0003.vtu")
    text = file.read_bytes()
    assert all(f'Name="{name}"'.encode() in text for name in ("traction", "slip", "total_slip", "friction_status"))


def test_no_columns_without_friction(tmp_path: Path) -> None:
    write(abut.solve(pushed(friction=0.0)), tmp_path)
    assert "slipping_area" not in (tmp_path / "history.csv").read_text()
    assert "friction" not in json.loads((tmp_path / "summary.json").read_text())["steps"][0]["contacts"][0]


def test_job_key(tmp_path: Path) -> None:
    text = EXAMPLE.read_text()
    assert load_job(EXAMPLE).model.contacts[0].friction == 0.3
    path = tmp_path / "job.toml"
    path.write_text(text.replace("friction = 0.3", 'friction = "rough"'))
    assert load_job(path).model.contacts[0].friction == "rough"
    path.write_text(text.replace("friction = 0.3", "friction = -1"))
    with pytest.raises(InputError, match="friction"):
        load_job(path)


def test_deck(tmp_path: Path) -> None:
    """The coefficient counts, the stick slope does not; all of it slides in the end: 0.25 of the load of 10."""
    job = load(tmp_path, DECK + DRIVEN)
    assert job.model.contacts[0].friction == 0.25
    assert sum("stick slope is left out" in note for note in job.notes) == 1
    force = abut.solve(job.model).contacts[0].force
    assert force == pytest.approx([-2.5, 0.0, 10.0], abs=1e-9)
    ignored = load(tmp_path, DECK + DRIVEN, "FRICTION")
    assert ignored.model.contacts[0].friction == 0.0
    assert len(ignored.ignored) == 1


@pytest.mark.parametrize(
    ("card", "words"),
    [
        ("*FRICTION\n-0.1", "expected a coefficient >= 0"),
        ("*FRICTION\nmuch", "expected a number"),
        ("*FRICTION", "its data line is missing"),
        ("*FRICTION\n0.1\n0.2", "contact pressure is missing"),
        ("*FRICTION, ROUGH\n0.1", "ROUGH"),
    ],
)
def test_decks_refused(tmp_path: Path, card: str, words: str) -> None:
    with pytest.raises(InputError, match=words):
        load(tmp_path, DECK.replace("*FRICTION\n0.25, 1.E4", card) + DRIVEN)


def test_what_friction_alone_holds_is_not_free() -> None:
    assert not [finding for finding in check(on_a_slope(0.2)).findings if finding.severity in ("error", "warning")]
    beyond = [finding.what for finding in check(on_a_slope(0.4)).findings if finding.severity == "error"]
    assert any("friction only up to its coefficient" in text for text in beyond)


def test_materials_of_ones_own() -> None:
    model = pushed()
    own = replace(model, solids=[abut.Solid(solid.body, Hooke()) for solid in model.solids])
    one, other = abut.solve(model), abut.solve(own)
    assert other.converged
    for a, b in zip(one.steps, other.steps):
        assert a.contacts[0].force == pytest.approx(b.contacts[0].force, abs=1e-7 * 200.0)
    assert one.contacts[0].friction.total_slip[0, 0] == pytest.approx(
        other.contacts[0].friction.total_slip[0, 0], rel=1e-6
    )


def test_a_step_that_does_not_converge_is_halved(monkeypatch: pytest.MonkeyPatch) -> None:
    """Two iterations are too few for the push, and enough for parts of it. In the end all of it slides: the same force."""
    monkeypatch.setattr("abut.nonlinear.friction._without_friction", lambda *_: None)  # no second start
    model = pushed(far=0.05)
    few = abut.solve(replace(model, solve=abut.SolveOptions(times=model.solve.times, max_iterations=2)))
    assert few.converged
    assert len(few.steps) > 5
    assert any("iterations: it goes to time" in note for note in few.notes)
    assert few.steps[-1].factor == 1.0
    assert few.contacts[0].force == pytest.approx(abut.solve(model).contacts[0].force, rel=1e-9)

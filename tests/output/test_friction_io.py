"""Friction from job files and decks, in output, beside other features: materials, checks before a run, halved steps."""

from __future__ import annotations

import csv
import json
import re
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

import abut
from abut import write
from abut.cli.progress import Progress
from abut.diagnosis.advice import remedies, unsettled
from abut.diagnosis.examine import check
from abut.errors import InputError
from abut.job import load_job
from abut.output.restart import description, load_steps, save_step
from abut.solution.grids import contact_grid
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
    names = {"friction_work": "work", "total_friction_work": "total_work", "friction_force_by_area": "force_by_area"}
    names |= {"friction_force_limit": "force_limit", "largest_friction_share": "largest_share"}
    names |= {name: name for name in ("slipping_area", "max_traction", "max_slip", "max_total_slip")}
    assert {name: float(rows[2][name]) for name in names} == {name: own[key] for name, key in names.items()}
    assert float(rows[2]["friction_force_x"]) == own["force"][0]
    assert sum(step["contacts"][0]["friction"]["work"] for step in steps) == pytest.approx(
        steps[4]["contacts"][0]["friction"]["total_work"]
    )
    assert list(rows[0])[-9:-7] == ["max_total_slip", "energy_loads"]  # more columns come last


def test_numbers_of_sliding(tmp_path: Path) -> None:
    """All of it slides: friction is the coefficient times the load of 100 on a width of 2, on the block's bottom against
    its way; it takes that force times the slip, which is the same all over but for what the blocks give way."""
    solution = abut.solve(pushed(far=0.05))
    own = solution.steps[2].contacts[0].friction
    assert own.force == pytest.approx([-FRICTION * 200.0, 0.0], abs=1e-7)
    assert own.force_by_area == pytest.approx(FRICTION * 200.0, rel=1e-9)
    assert own.force_limit == pytest.approx(FRICTION * 200.0, rel=1e-9)
    assert own.largest_share == pytest.approx(1.0, abs=1e-9)
    used = np.isfinite(own.traction_limit)
    assert np.linalg.norm(own.traction, axis=2)[used] == pytest.approx(own.traction_limit[used], rel=1e-6, abs=1e-6)
    least = np.linalg.norm(own.slip, axis=2)[own.status > 0].min()
    assert own.force_by_area * least < own.work < own.force_by_area * own.max_slip
    both = [solution.steps[i].contacts[0].friction for i in (1, 2)]
    assert np.nansum(both[1].total_work_per_area) == pytest.approx(
        np.nansum(both[0].total_work_per_area) + np.nansum(both[1].work_per_area)
    )


def test_energy_in_the_summary(written: Path) -> None:
    for step in json.loads((written / "summary.json").read_text())["steps"]:
        own = step["energy"]
        assert own["loads"] + own["supports"] + own["contact"] == pytest.approx(
            own["stored"] + own["friction"] + own["stepping"]
        )
        assert own["friction"] == step["contacts"][0]["friction"]["work"]


def test_log_counts_points(written: Path) -> None:
    """With friction every iteration says how many points stick and slip: all that are in contact."""
    rows = [json.loads(line) for line in (written / "run.jsonl").read_text().splitlines() if "iteration" in line]
    rows = [row for row in rows if "iteration" in row]
    assert rows
    assert all(row["sticking"] + row["slipping"] == row["active"] <= 12 for row in rows)  # 11 facets, 12 nodes
    assert any(row["slipping"] for row in rows)
    assert any(row["sticking"] for row in rows)


def test_table_of_the_run(capsys: pytest.CaptureFixture[str]) -> None:
    """Columns for stick and slip with friction, the usual ones without."""
    for model, words in ((pushed(), "sticks    slips"), (pushed(friction=0.0), "active  changed")):
        with Progress(plain=True) as show:
            rows = [row for step in abut.solve(model).steps for row in step.iterations]
            show(rows[0])
        head, line = capsys.readouterr().out.splitlines()
        assert words in head
        assert len(head.split()) == len(line.split())
        assert line.split()[2] == str(rows[0].active)


def test_fields_of_the_contact(written: Path) -> None:
    """On the contactor what the record says, on the target nothing."""
    solution = abut.solve(pushed())
    grid = contact_grid(solution.steps[2], solution.steps[2].contacts[0])
    (file,) = written.glob("contact_*_0003.vtu")
    text = file.read_bytes()
    own, data = solution.steps[2].contacts[0].friction, grid.point_data
    names = {"traction": own.traction, "slip": own.slip, "total_slip": own.total_slip, "friction_status": own.status}
    names |= {"friction_work": own.work_per_area, "total_friction_work": own.total_work_per_area}
    count = 3 * len(own.status)  # line3
    for name, values in names.items():
        assert f'Name="{name}"'.encode() in text
        wanted = values[:, :3].reshape(count, *values.shape[2:])
        shown = data[name][:count] if values.ndim == 2 else data[name][:count, :2]
        assert np.array_equal(shown, wanted), name
        assert not data[name][count:].any()


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


@pytest.mark.long
def test_a_step_that_does_not_converge_is_halved(monkeypatch: pytest.MonkeyPatch) -> None:
    """Two iterations are too few for the push, and enough for parts of it. In the end all of it slides: the same force."""
    monkeypatch.setattr("abut.nonlinear.friction.search", lambda *_: None)  # nothing takes over
    model = pushed(far=0.05)
    few = abut.solve(replace(model, solve=abut.SolveOptions(times=model.solve.times, max_iterations=2)))
    assert few.converged
    assert [step.factor for step in few.steps] == list(model.solve.times)  # its parts are no steps of the results
    assert any("iterations: it goes to time" in note for note in few.notes)
    assert any(re.match(r"step \d was taken in \d+ parts, to times", note) for note in few.notes)
    whole = abut.solve(model)
    assert few.contacts[0].force == pytest.approx(whole.contacts[0].force, rel=1e-9)
    for one, other in zip(few.steps, whole.steps):
        slips = one.contacts[0].friction.slip, other.contacts[0].friction.slip
        assert np.nanmax(np.abs(slips[0] - slips[1])) < 0.02 * 0.05  # paths differ where stick turns into slip
        assert one.energy.error <= one.energy.limit
    assert all(check.passed for check in few.certificate)


@pytest.mark.long
def test_restart_after_a_step_in_parts(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    """All of the results, those of the steps done before among them."""
    monkeypatch.setattr("abut.nonlinear.friction.search", lambda *_: None)
    model = pushed(far=0.05)
    model = replace(model, solve=abut.SolveOptions(times=model.solve.times, max_iterations=2))
    named = description(model)
    whole = abut.solve(model, on_step=lambda _, saved: save_step(tmp_path, named, saved))
    for late in sorted((tmp_path / "restart").glob("*.npz"))[3:]:
        late.unlink()
    done = load_steps(tmp_path, named)
    assert any(saved.parts for saved in done)
    again = abut.solve(model, resume=done)
    assert len(again.steps) == 5
    assert np.array_equal(whole.displacement, again.displacement)
    for one, other in zip(whole.steps, again.steps):
        assert one.iterations == other.iterations or one.number > 3  # of the others the seconds differ
        mine, its = one.contacts[0].friction, other.contacts[0].friction
        assert np.array_equal(mine.slip, its.slip, equal_nan=True)
        assert np.array_equal(mine.total_slip, its.total_slip, equal_nan=True)
        assert mine.work == its.work
        assert one.energy == other.energy


def test_giving_up(monkeypatch: pytest.MonkeyPatch) -> None:
    """One iteration is never enough: what has converged is kept, the best state of the last attempt follows it, and nodes
    are named that have not settled."""
    model = pushed(far=0.05)
    asked = replace(model, solve=abut.SolveOptions(times=model.solve.times, max_iterations=1))
    solution = abut.solve(asked)
    assert not solution.converged
    *before, last = solution.steps
    assert all(step.converged for step in before)
    assert np.abs(last.displacement).max() < 0.2  # four times the push
    (place,) = unsettled(last)
    assert re.match(r"contact 'upper.bottom-lower.top': node \d+ at \(.*\) is (open|sticking) and", str(place))
    assert set(place.nodes) <= set(last.contacts[0].contactor.node_ids)
    (remedy,) = remedies(solution)
    assert remedy.action == "solve.max_iterations = 50"
    assert abut.solve(replace(asked, solve=replace(asked.solve, max_iterations=50))).converged

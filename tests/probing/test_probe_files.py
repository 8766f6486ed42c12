"""Probes in files: tables, summary, history, report, jobs written and gone on with."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import abut
from abut.cli import main
from abut.errors import Stopped
from abut.job import load_job
from abut.job.convert import write_job
from abut.output.restart import description
from abut.output.stream import Stream
from abut.probing.table import columns, peaks
from abut.report import write_report
from abut.report.origin import comparison, quantities
from models.page import Page
from models.probes import PROBES, TEXT, table, two_blocks


def test_files_of_several_steps(tmp_path: Path) -> None:
    """Every value at every step in probe_NAME.csv; the same in few numbers in summary.json and history.csv."""
    probes = (
        abut.Probe("mid point", at=[1.0, 0.5]),
        abut.Probe("top", line=([0.0, 1.0], [2.0, 1.0]), points=9, contact="blocks", body="lower"),
        abut.Probe("edge", line=([0.3, 1.0], [1.7, 1.0]), points=9, of=["pressure"]),
        abut.Probe("held", on="lower.bottom", of=["displacement"]),
    )
    solution = abut.solve(two_blocks(*probes, solve=abut.SolveOptions(steps=3)))
    abut.write(solution, tmp_path)
    summary = json.loads((tmp_path / "summary.json").read_text())
    assert [[p["name"] for p in step["probes"]] for step in summary["steps"]] == [[p.name for p in probes]] * 3
    assert [p["file"] for p in summary["steps"][0]["probes"]] == [
        "probe_mid_point.csv", "probe_top.csv", "probe_edge.csv", "probe_held.csv",
    ]  # fmt: skip
    for number, (step, said) in enumerate(zip(solution.steps, summary["steps"])):
        for result, few in zip(step.probes, said["probes"]):
            rows = table(tmp_path / few["file"])
            own = [row for row in rows if row["step"] == str(number + 1)]
            assert len(own) == len(result.points) == few["points"]
            for name, values in columns(result).items():
                listed = [float(row[name]) if row[name] else np.nan for row in own]
                assert listed == pytest.approx(values.tolist(), nan_ok=True, rel=1e-15, abs=0), name
                assert few[name] == peaks(result)[name]
            assert [float(row["x"]) for row in own] == pytest.approx(result.points[:, 0])
    edge = table(tmp_path / "probe_edge.csv")
    assert [row["pressure"] == "" for row in edge[:9]] == [True, True] + [False] * 5 + [True, True]
    assert [row["distance"] for row in edge[:2]] == ["0.0", "0.175"]
    assert "node" in table(tmp_path / "probe_held.csv")[0]
    history = table(tmp_path / "history.csv")
    assert [row["probe"] for row in history if row["step"] == "2"] == ["", *(p.name for p in probes)]
    of_point = [row for row in history if row["probe"] == "mid point"]
    assert [float(row["displacement_y"]) for row in of_point] == pytest.approx(
        [step.probes[0].values["displacement"][0, 1] for step in solution.steps], rel=1e-15
    )
    assert of_point[0]["pressure"] == of_point[0]["max_pressure"] == ""
    assert float(history[0]["max_pressure"]) == solution.steps[0].contacts[0].max_pressure


def test_peaks_keep_their_sign() -> None:
    """Of several points the value farthest from zero; what is missing does not count, and where all is there is none."""
    nothing = np.full(3, np.nan)
    values = {
        "displacement": np.array([[1.0, 0.0], [-3.0, 0.5], [2.0, 0.25]]),
        "pressure": np.array([np.nan, 2.0, 1.0]),
        "gap": nothing,
    }
    result = abut.solution.ProbeResult("p", np.zeros((3, 2)), None, None, values)
    assert peaks(result) == {"displacement_x": -3.0, "displacement_y": 0.5, "pressure": 2.0, "gap": None}


def test_without_probes_files_are_as_before(tmp_path: Path) -> None:
    abut.write(abut.solve(two_blocks()), tmp_path)
    head = (tmp_path / "history.csv").read_text().splitlines()[0]
    assert head.startswith("step,factor,converged,contact,force_x,force_y,max_pressure,area,max_penetration,active,")
    assert not {"probe", "displacement_x", "stress_xx", "pressure", "gap"} & set(head.split(","))
    assert "<h2>Probes</h2>" not in (tmp_path / "report.html").read_text()
    assert not list(tmp_path.glob("probe_*"))


def test_the_report_shows_them(tmp_path: Path) -> None:
    """A table with units, lines over their length, points over time; broken where there is no value."""
    probes = (
        abut.Probe("<b>spot</b>", at=[1.0, 0.5]),
        abut.Probe("edge", line=([0.3, 1.0], [1.7, 1.0]), points=9, of=["pressure", "gap"]),
        abut.Probe("held", on="lower.bottom", of=["displacement"]),
    )
    solution = abut.solve(two_blocks(*probes, solve=abut.SolveOptions(steps=2)))
    page = Page(write_report(solution, tmp_path / "report.html"))
    for words in ("Probes", "<b>spot</b>", "at (1, 0.5)", "9 points from (0.3, 1) to (1.7, 1)", "displacement [length]",
                  "stress xx yy zz xy yz zx [force/length²]", "von Mises [force/length²]", "pressure [force/length²]",
                  "gap [length]", "nodes of lower.bottom", f"{peaks(solution.probes[1])['pressure']:.6g}"):  # fmt: skip
        assert words in page.text, words
    charts = {chart["title"]: chart for chart in json.loads(page.data)["probes"]}
    assert list(charts) == [
        "<b>spot</b>: displacement [length]",
        "<b>spot</b>: stress [force/length²]",
        "edge: pressure [force/length²] in the last step",
        "held: displacement [length], value farthest from zero",
    ]
    stress = charts["<b>spot</b>: stress [force/length²]"]
    assert [s["label"] for s in stress["series"]] == ["stress xx", "stress yy", "stress zz", "stress xy", "von Mises"]
    assert stress["x"] == [0.5, 1.0]
    edge = charts["edge: pressure [force/length²] in the last step"]
    assert edge["x"] == pytest.approx(np.linspace(0.0, 1.4, 9), rel=1e-6, abs=1e-12)
    assert [s["label"] for s in edge["series"]] == ["pressure"]  # the gap is rounding all along, and left out
    assert edge["series"][0]["values"][:2] == [None, None]
    assert edge["series"][0]["values"][2:7] == pytest.approx(solution.probes[1].values["pressure"][2:7], rel=1e-6)
    one = abut.solve(two_blocks(probes[0]))
    page = Page(write_report(one, tmp_path / "one.html"))
    assert json.loads(page.data)["probes"] == []
    assert f"{one.probes[0].values['von_mises'][0]:.6g}" in page.text


def test_theory_may_speak_of_probes() -> None:
    solution = abut.solve(two_blocks(abut.Probe("spot", at=[1.0, 0.5])))
    value = solution.probes[0].values["stress"][0, 1]
    assert quantities(solution.steps[-1])["probe.spot.stress_yy"] == value
    (row,) = comparison(solution, {"probe.spot.stress_yy": {"value": 1.01 * value, "tolerance": 0.02, "source": "x"}})
    assert row["passed"]
    assert row["deviation"] == pytest.approx(-0.01 / 1.01 if value > 0 else 0.01 / 1.01, rel=1e-9)


def test_probes_survive_writing_a_job(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    """What is written says the same, and running it reads the same."""
    job = tmp_path / "job.toml"
    job.write_text(TEXT + PROBES)
    write_job(tmp_path / "copy.toml", load_job(job))
    first, second = load_job(job).model, load_job(tmp_path / "copy.toml").model
    assert first.probes == second.probes
    assert first.probes[0] == abut.Probe("edge", line=((1, 5, 10), (9, 5, 10)), points=7, of=("pressure", "gap"))
    capsys.readouterr()
    assert main(["run", str(job)]) == 0
    out = capsys.readouterr().out
    assert "probe 'edge': 7 points, farthest from zero: pressure " in out
    assert "probe 'spot': displacement_x " in out
    summary = json.loads((tmp_path / "results" / "summary.json").read_text())
    assert [p["name"] for p in summary["steps"][0]["probes"]] == ["edge", "spot", "held"]
    assert len(table(tmp_path / "results" / "probe_held.csv")) == summary["steps"][0]["probes"][2]["points"]


def test_a_restart_has_the_probes_of_all_steps(tmp_path: Path) -> None:
    """Steps done before are read anew, also by probes that came later: they do not change what is solved."""

    job = tmp_path / "job.toml"
    text = TEXT + "\n[solve]\nsteps = 3\n"
    job.write_text(text + PROBES)
    whole = abut.solve(load_job(job).model)
    job.write_text(text)
    loaded = load_job(job)

    def stop(item: object) -> None:
        if getattr(item, "step", 0) == 3:
            raise Stopped("now")

    with pytest.raises(Stopped), Stream(loaded.directory, description(loaded.model)) as stream:
        abut.analysis.solve(loaded.model, stop, stream.step)
    job.write_text(text + PROBES)
    assert main(["run", str(job), "--restart", "--quiet"]) == 0
    rows = table(tmp_path / "results" / "probe_spot.csv")
    assert [row["step"] for row in rows] == ["1", "2", "3"]
    exact = [step.probes[1].values["displacement"][0, 2] for step in whole.steps]
    assert [float(row["displacement_z"]) for row in rows] == pytest.approx(exact, rel=1e-9)


def test_results_come_step_by_step(tmp_path: Path) -> None:
    """After the first of two steps its rows are on disk."""

    model = two_blocks(abut.Probe("spot", at=[1.0, 0.5]), solve=abut.SolveOptions(steps=2))
    seen = []
    with Stream(tmp_path, description(model)) as stream:

        def keep(solution: abut.Solution, saved: Any) -> None:
            stream.step(solution, saved)
            seen.append(len(table(tmp_path / "probe_spot.csv")))

        abut.analysis.solve(model, None, keep)
    assert seen == [1, 2]

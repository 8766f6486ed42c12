"""What decks ask to be printed and written: tables and files of a run. A bar of two bricks, E = 1000, 1 x 1 x 2 without
Poisson's ratio, sides held, pressed together by 10: the top moves by -0.02, each corner below carries 2.5."""

from __future__ import annotations

import csv
from pathlib import Path

import pytest

from abut.cli import main
from abut.job import load_job
from models.decks import BRICKS, HELD, PAIR, load, step

ASKED = (
    "*NODE PRINT, NSET=BOTTOM, TOTALS=YES",
    "U, RF",
    "*EL PRINT, ELSET=LOW",
    "S, EVOL",
    "*CONTACT PRINT",
    "CSTR, CDIS",
)
DECK = BRICKS + PAIR + HELD


def rows(path: Path) -> list[dict[str, str]]:
    with open(path, newline="") as file:
        return list(csv.DictReader(file))


def test_tables_are_written(tmp_path: Path) -> None:
    """Displacement, reaction, stress, pressure and gap as the closed form says; EVOL is said not to be written."""
    job = load(tmp_path, DECK + step("*DLOAD", "2, P2, 10.", *ASKED, "*NODE PRINT, NSET=TOP", "U"))
    assert any("*EL PRINT: EVOL: not written" in note for note in job.notes)
    assert main(["run", str(tmp_path / "deck.inp"), "--quiet"]) == 0
    folder = tmp_path / "deck-results"
    held = rows(folder / "probe_BOTTOM_nodes.csv")
    assert [float(row["reaction_z"]) for row in held] == pytest.approx([2.5] * 4, rel=1e-9)
    top = rows(folder / "probe_TOP_nodes.csv")
    assert [float(row["displacement_z"]) for row in top] == pytest.approx([-0.02] * 4, rel=1e-9)
    assert "reaction_z" not in top[0]
    stress = rows(folder / "probe_LOW_elements.csv")
    assert [float(row["stress_zz"]) for row in stress] == pytest.approx([-10.0] * 8, rel=1e-9)
    touching = rows(folder / "probe_SLAVE-MASTER.csv")
    assert [float(row["pressure"]) for row in touching] == pytest.approx([10.0] * 4, rel=1e-9)
    assert [float(row["gap"]) for row in touching] == pytest.approx([0.0] * 4, abs=1e-12)
    said = [row for row in rows(folder / "history.csv") if row["probe"] == "BOTTOM nodes"]
    assert float(said[-1]["reaction_z"]) == pytest.approx(10.0, rel=1e-9)  # TOTALS: the sum


def test_steps_are_those_asked_for(tmp_path: Path) -> None:
    """FREQUENCY counts within each step, whose last load step always counts; a later card takes the place of an earlier
    one, and FREQUENCY=0 ends it."""
    table = "*AMPLITUDE, NAME=A\n0., 0., .25, .3, .5, .4, 1., 1.\n"  # load steps end at its corners
    text = DECK + table
    text += step("*DLOAD, AMPLITUDE=A", "2, P2, 10.", "*NODE PRINT, NSET=TOP, FREQUENCY=99", "U")
    text += step("*DLOAD, AMPLITUDE=A", "2, P2, 20.", "*NODE PRINT, NSET=BOTTOM", "RF", "*NODE FILE, FREQUENCY=2", "U")
    text += step("*DLOAD, AMPLITUDE=A", "2, P2, 30.", "*NODE PRINT, NSET=BOTTOM, FREQUENCY=0", "RF")
    job = load(tmp_path, text)
    assert job.model.ends == pytest.approx([t / 12.0 for t in (1, 2, 4, 5, 6, 8, 9, 10, 12)])
    assert {probe.name: probe.steps for probe in job.model.probes} == {"TOP nodes": [3], "BOTTOM nodes": [4, 5, 6]}
    assert (job.output.steps, job.output.formats) == ([5, 6, 8, 9], ("vtu", "frd"))


def test_files_and_history_of_abaqus(tmp_path: Path) -> None:
    """After *OUTPUT, HISTORY what follows is tables, after *OUTPUT, FIELD result files; RF goes to forces.csv."""
    lines = ("*OUTPUT, FIELD", "*NODE OUTPUT", "U, RF", "*ELEMENT OUTPUT", "S, PHS", "*OUTPUT, HISTORY",
             "*NODE OUTPUT, NSET=TOP", "U3")  # fmt: skip
    job = load(tmp_path, DECK + step("*DLOAD", "2, P2, 10.", *lines))
    assert [(probe.name, probe.of) for probe in job.model.probes] == [("TOP nodes", ("displacement",))]
    assert "principal-stress" in job.output.fields
    assert job.output.formats == ("vtu",)
    assert any("RF: not written; the forces of supports are in forces.csv" in note for note in job.notes)


def test_job_file_keeps_what_was_asked(tmp_path: Path) -> None:
    """abut convert writes the same probes and output."""
    deck = load(tmp_path, DECK + step("*DLOAD", "2, P2, 10.", *ASKED, "*NODE FILE", "U"))
    assert main(["convert", str(tmp_path / "deck.inp"), str(tmp_path / "job.toml"), "--quiet"]) == 0
    job = load_job(tmp_path / "job.toml")
    assert [(p.name, p.of, p.steps) for p in job.model.probes] == [(p.name, p.of, p.steps) for p in deck.model.probes]
    assert tuple(job.output.formats) == tuple(deck.output.formats)


def test_sets_that_do_not_exist_are_told(tmp_path: Path) -> None:
    job = load(tmp_path, DECK + step("*DLOAD", "2, P2, 10.", "*NODE PRINT, NSET=NOWHERE", "U"))
    assert any("no set 'NOWHERE' with nodes: nothing is written" in note for note in job.notes)
    assert job.model.probes == ()

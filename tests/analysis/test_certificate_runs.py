"""The certificate tells true from false: every run of the catalogue, and every failed line names its cure."""

from __future__ import annotations

import pytest

import abut
from abut.diagnosis.cures import MODEL, OF_CONTACT, cures
from models.certificate_runs import RUNS, SOUND_RUNS, UNSOUND_RUNS, Run, verdict


def test_the_catalogue_is_large_enough() -> None:
    assert min(len(SOUND_RUNS), len(UNSOUND_RUNS)) >= 30
    assert len({(run.sound, run.name) for run in RUNS}) == len(RUNS)


LARGE = ("flat stiff punch 10 times as fine, tri6", "Hertz octant tet4 finer")  # run with the long tests


@pytest.mark.parametrize(
    "run",
    [
        pytest.param(run, id=run.name.replace(" ", "-"), marks=[pytest.mark.long] if run.name in LARGE else [])
        for run in RUNS
    ],
)
def test_true_from_false(run: Run) -> None:
    """With defaults, unless a bad choice is the point of the run: sound ones pass all lines, unsound ones fail where they
    should, and say what to do."""
    solution = abut.solve(run.model())
    assert verdict(run, solution, run.error(solution)) == ""
    for check, text in cures(solution):
        assert len(text) > 20, check.name


def test_every_line_has_a_cure() -> None:
    """Those of contacts and of the model that any of a dozen runs has."""
    seen = {(bool(c.contact), c.name) for run in SOUND_RUNS[-12:] for c in abut.solve(run.model()).certificate}
    assert {name for contact, name in seen if contact} <= set(OF_CONTACT)
    assert {name for contact, name in seen if not contact} <= set(MODEL)

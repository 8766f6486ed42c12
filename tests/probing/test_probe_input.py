"""Probes that cannot be read: what is wrong, where, how to mend it, before anything is solved."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path
from typing import Any

import pytest

import abut
from abut.cli import main
from abut.diagnosis import check
from abut.mesh import make
from abut.probing import find_place
from models.probes import PROBES, STEEL, TEXT, distorted, free, two_blocks

BAD_RECORDS: dict[str, tuple[dict[str, Any], str]] = {
    "no place": ({}, "give one of at (a point), line, on (a node set or surface); got none of them"),
    "two places": ({"at": [0, 0], "on": "lower.top"}, "got at and on"),
    "one number": ({"at": [1.0]}, "expected 2 or 3 numbers, got 1"),
    "no numbers": ({"at": []}, "expected 2 or 3 numbers, got 0"),
    "a number": ({"at": 3.0}, "expected 2 or 3 numbers, got 3.0"),
    "nan": ({"at": [0.0, float("nan")]}, "expected a finite number"),
    "text": ({"at": ["a", 0]}, "expected a number, got 'a'"),
    "one end": ({"line": [[0, 0]]}, "expected two points, its start and its end, got 1"),
    "no length": ({"line": [[0, 1], [0, 1]]}, "starts where it ends, at (0, 1)"),
    "one point": (
        {"line": [[0, 0], [1, 0]], "points": 1},
        "expected a whole number from 2 (both ends) to 10000, got 1",
    ),
    "half a point": ({"line": [[0, 0], [1, 0]], "points": 2.5}, "expected a whole number from 2"),
    "too many": ({"line": [[0, 0], [1, 0]], "points": 10**9}, "to 10000, got 1000000000"),
    "points of a point": ({"at": [0, 0], "points": 5}, "points is for lines"),
    "unknown quantity": ({"at": [0, 0], "of": ["presure"]}, "did you mean 'pressure'?"),
    "no quantity": ({"at": [0, 0], "of": []}, "the list is empty; leave it out for all"),
    "one word": ({"at": [0, 0], "of": "pressure"}, "expected a list of names, got 'pressure'"),
    "contact for nothing": ({"at": [0, 0], "of": ["stress"], "contact": "blocks"}, "contact is for pressure and gap"),
    "body of a set": ({"on": "lower.top", "body": "lower"}, "body is for points and lines"),
    "no name": ({"name": " ", "at": [0, 0]}, "expected a text that is not empty"),
}


@pytest.mark.parametrize("case", BAD_RECORDS)
def test_records_check_themselves(case: str) -> None:
    given, message = BAD_RECORDS[case]
    with pytest.raises(abut.InputError) as error:
        abut.Probe(**{"name": "p", **given})
    assert message in str(error.value)
    assert case == "no name" or "probe 'p'" in str(error.value)


BAD_MODELS: dict[str, tuple[Sequence[dict[str, Any]], str]] = {
    "three numbers in 2D": ([{"at": [0, 0, 0]}], "probes[0].at: expected 2 numbers for a point, got 3"),
    "a line in 3D": ([{"line": [[0, 0], [0, 0, 1]]}], "probes[0].line: expected 2 numbers for a point, got 3"),
    "unknown set": ([{"on": "lower.topp"}], "probes[0].on: no surface, node set or body named 'lower.topp'; did you mean"),
    "reaction at a point": ([{"at": [1, 0.5], "of": ["reaction"]}], "reaction is the force on nodes; give on"),
    "steps": ([{"on": "lower", "steps": 0}], "probe 'p': steps: expected \"all\", \"last\", a number > 0"),
    "unknown body": ([{"at": [1, 0.5], "body": "lover"}], "probes[0].body: no body named 'lover'; did you mean 'lower'?"),
    "unknown contact": ([{"at": [1, 1], "contact": "block"}], "no contact named 'block'; did you mean 'blocks'?"),
    "twice": ([{"at": [1, 0.5]}, {"at": [1, 0.6]}], "probes[1].name: 'p' is used twice"),
}  # fmt: skip
BAD_PLACES: dict[str, tuple[dict[str, Any], str]] = {
    "outside": ({"at": [1.0, 2.25]}, "(1, 2.25) lies outside every body, 0.25 from the nearest, 'upper'; move it"),
    "outside its body": ({"at": [1.0, 1.5], "body": "lower"}, "lies outside body 'lower', 0.5 from it"),
    "line outside": ({"line": [[0, 1.5], [2, 1.5]], "points": 9}, "4 of its 9 points, the first at (0, 1.5), lie outside"),
    "set off the contact": ({"on": "lower.bottom", "of": ["pressure"]}, "no node of 'lower.bottom' is on a surface of"),
    "beside": ({"at": [1.8, 1.0], "of": ["pressure"], "body": "upper"}, "no point of it lies over surface 'upper.bottom'"),
    "gap of the target": ({"on": "lower.top", "of": ["gap"]}, "is known on its contactor 'upper.bottom'"),
}  # fmt: skip


@pytest.mark.parametrize("case", BAD_MODELS)
def test_models_check_probes(case: str) -> None:
    given, message = BAD_MODELS[case]
    with pytest.raises(abut.InputError) as error:
        two_blocks(*(abut.Probe(**{"name": "p", **one}) for one in given))
    assert message in str(error.value)


@pytest.mark.parametrize("case", BAD_PLACES)
def test_places_are_checked_before_solving(case: str) -> None:
    """By solve before anything else, and by check as an error that stands for exit status 2."""
    given, message = BAD_PLACES[case]
    model = two_blocks(abut.Probe("p", **given))
    told: list[object] = []
    with pytest.raises(abut.InputError) as error:
        abut.solve(model, told.append)
    assert message in str(error.value)
    assert str(error.value).startswith("probe 'p': ")
    assert told == []
    report = check(model)
    assert any(f.severity == "error" and f.where == "probes[0]" and "'p'" in f.line for f in report.findings)
    assert report.status == 2


def test_no_contact_no_pressure() -> None:
    with pytest.raises(abut.InputError, match=r"probes\[0\].of: the model has no contacts, and so no pressure"):
        free(distorted("quad4"), abut.Probe("p", at=[0.5, 0.5], of=["pressure"]))


def test_ambiguous_contacts_are_not_guessed() -> None:
    """A line through a pile crosses two contacts and asks for neither; where it does ask, it must choose."""
    parts = {name: make.rectangle([0, 1], [i, i + 1], cells=[2, 2]) for i, name in enumerate("abc")}
    contacts = [
        abut.Contact(contactor="b.bottom", target="a.top", name="low"),
        abut.Contact(contactor="c.bottom", target="b.top", name="high"),
    ]
    given: dict[str, Any] = {
        "plane": "strain",
        "solids": [abut.Solid(name, STEEL) for name in parts],
        "supports": [
            abut.Support("a.bottom", x=0, y=0),
            abut.Support("c.top", x=0, y=-0.01),
            abut.Support("b.left", x=0),
        ],
        "contacts": contacts,
    }
    through = abut.Probe("p", line=([0.5, 0], [0.5, 3]), points=31)
    mesh = make.join(parts)
    assert find_place(abut.Model(mesh, probes=[through], **given), through).of == (
        "displacement",
        "stress",
        "von-mises",
    )
    for probe, names in (
        (replace(through, of=("pressure",)), "touches"),
        (abut.Probe("p", at=[0.5, 1.5], of=["gap"]), ""),
    ):
        with pytest.raises(abut.InputError, match="of contacts 'low' and 'high'; choose with contact"):
            find_place(abut.Model(mesh, probes=[probe], **given), probe)
        chosen = replace(probe, contact="high")
        place = find_place(abut.Model(mesh, probes=[chosen], **given), chosen)
        assert place.surface is not None
        assert place.surface.contact == 1, names


BAD_JOBS = {
    "two numbers in 3D": ("at = [5, 5, 5]", "at = [5, 5]", "probes[1].at: expected 3 numbers for a point, got 2"),
    "nan": ("at = [5, 5, 5]", "at = [5, 5, nan]", "probes[1].at[2]: expected a finite number"),
    "empty": ("at = [5, 5, 5]", "at = []", "probe 'spot': at: expected 2 or 3 numbers, got 0"),
    "unknown key": ("points = 7", "pionts = 7", "probes[0].pionts: unknown key; did you mean 'points'?"),
    "unknown set": ('"lower.bottom"\nof', '"lower.botom"\nof', "did you mean 'lower.bottom'?"),
    "one point": ("points = 7", "points = 1", "expected a whole number from 2 (both ends)"),
    "unknown quantity": ('"von-mises"', '"mises"', "probes[2].of[1]: expected 'displacement', 'stress', 'von-mises'"),
    "outside": ("at = [5, 5, 5]", "at = [5, 5, 80]", "probe 'spot': (5, 5, 80) lies outside every body"),
    "no name": ('name = "spot"\n', "", "probes[1].name: missing"),
}


@pytest.mark.parametrize("case", BAD_JOBS)
def test_bad_jobs(case: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    old, new, message = BAD_JOBS[case]
    text = TEXT + PROBES
    assert old in text
    job = tmp_path / "job.toml"
    job.write_text(text.replace(old, new))
    for command in ("run", "check"):
        assert main([command, str(job)]) == 2
        printed = capsys.readouterr()
        assert message.partition("; did")[0] in printed.out + printed.err
        assert "Traceback" not in printed.err
    assert [p.name for p in tmp_path.iterdir()] == ["job.toml"]

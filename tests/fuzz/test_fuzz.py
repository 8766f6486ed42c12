"""Damaged jobs and meshes through ``abut run``: a message and an exit status, whatever comes in (tests/fuzz)."""

from __future__ import annotations

from collections import Counter
from pathlib import Path

import pytest

from abut.cli import main
from fuzz.harness import SEEDS, make, run_all

FAST, MANY, ALL = 100, 1_000, 2_000


def check(numbers: range, folder: Path) -> None:
    results = list(run_all(numbers, 1, folder))
    assert sorted(result.number for result in results) == list(numbers)
    bad = [f"{result.number} ({result.kind}): {result.problem}" for result in results if result.problem]
    assert not bad, f"python tests/fuzz/run.py --only NUMBER makes one again\n{bad[:5]}"
    ends = Counter(result.status for result in results)
    assert ends[0] > 0.05 * len(numbers), "hardly any input gets as far as a solution"
    assert ends[2] > 0.2 * len(numbers), "hardly any input is bad"


def test_some_damaged_inputs(tmp_path: Path) -> None:
    check(range(FAST), tmp_path)


@pytest.mark.long
def test_many_damaged_inputs(tmp_path: Path) -> None:
    check(range(FAST, MANY), tmp_path)


@pytest.mark.exhaustive
def test_all_damaged_inputs(tmp_path: Path) -> None:
    check(range(MANY, ALL), tmp_path)


@pytest.mark.long
@pytest.mark.parametrize("number", [1461, 3007])
def test_a_target_without_a_normal_somewhere_has_its_report(number: int, tmp_path: Path) -> None:
    """Solved and written; the report, which comes last, used to refuse such a facet."""
    (result,) = run_all([number], 1, tmp_path)
    assert (result.status, result.problem) == (0, "")


@pytest.mark.long
@pytest.mark.parametrize("number", [4384, 8472])
def test_a_coefficient_of_nearly_nothing_is_none(number: int, tmp_path: Path) -> None:
    """In the constraint function: tractions over such a bound were too large to be squared."""
    (result,) = run_all([number], 1, tmp_path)
    assert (result.status, result.problem) == (0, "")


def test_an_input_is_made_by_its_number_alone() -> None:
    assert make(1, 17).files == make(1, 17).files
    assert make(1, 17).files != make(1, 18).files


def test_the_harness_sees_what_it_should(tmp_path: Path) -> None:
    """Tracebacks, bugs, warnings, leftovers: each is a problem."""
    from fuzz.worker import judge

    assert "status 1" in judge(1, "abut: internal error: this is a bug in abut", tmp_path)
    assert "status 2" in judge(2, "Traceback (most recent call last)", tmp_path)
    assert "status 4" in judge(4, "x.py:1: RuntimeWarning: overflow", tmp_path)
    assert judge(2, "abut: error: expected a number", tmp_path) == ""
    (tmp_path / ".fields.vtu.1.tmp.vtu").write_text("")
    assert "left behind" in judge(4, "abut: error: singular", tmp_path)


def test_facet_without_a_normal_is_named(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    """A hexahedron collapsed at an edge is sound where stiffness is integrated, but its side has no normal there."""
    text = (SEEDS / "solid-22-ascii.msh").read_text()
    assert "12 1 2 1\n" in text  # a corner of the upper block's underside; 9 is the next one
    (tmp_path / "mesh.msh").write_text(text.replace("12 1 2 1\n", "12 1 1 1\n"))
    (tmp_path / "job.toml").write_text((SEEDS / "solid-mesh.toml").read_text())
    assert main(["run", str(tmp_path / "job.toml")]) == 2
    error = capsys.readouterr().err
    assert "surface 'under': facet 0 has no normal at its point [1.0, 1.0, 1.0]" in error
    assert "prism instead of a collapsed hexahedron" in error

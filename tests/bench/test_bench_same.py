"""Whether two versions give the same numbers: reading of results and their comparison. Needs no second version."""

from __future__ import annotations

import json
import subprocess
import sys
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from abut.io.vtu import write_vtu

BENCH = Path(__file__).parents[2] / "bench"
sys.path.insert(0, str(BENCH))

import same_results  # noqa: E402
from same import models, runs, versions  # noqa: E402
from same.differences import Comparison, compare, difference  # noqa: E402
from same.quantities import Quantities, read  # noqa: E402

SUMMARY = {
    "status": "converged",
    "steps": [
        {
            "factor": 1.0,
            "converged": True,
            "reaction": [1e-12, -3e-12, 2e-11],
            "reactions": {"block.bottom": [0.0, 0.0, 100.0]},
            "contacts": [
                {"name": "lid", "force": [0.0, 0.0, 100.0], "max_pressure_at": None, "max_penetration": 1e-19}
            ],
            "max_displacement": 0.02,
            "balance_error": 3e-16,
            "probes": [{"name": "p", "stress_xx": 1e-15, "stress_yy": 7.0}],
        }
    ],
    "certificate": {"checks": [{"contact": c, "name": "tension", "value": 0.0} for c in ("", "lid")]},
    "notes": ["64 segments"],
    "timings": {"solve": 0.5},
    "versions": {"abut": "0.1.0"},
}
STEP, LID = "summary.json/steps/0", "summary.json/steps/0/contacts/lid"


def write(folder: Path, summary: dict, pressure: float = 5.0) -> Path:
    """A folder of results: a summary, a table and a triangle with fields."""
    folder.mkdir()
    (folder / "summary.json").write_text(json.dumps(summary))
    (folder / "history.csv").write_text("step,contact,force_x,force_y,rigid_x\n1,lid,1e-15,-3.5,\n2,lid,0.0,-7.0,\n")
    points, fields = np.array([[0.0, 0.0], [1.0, 0.0], [0.0, 1.0]]), {"pressure": np.array([0.0, pressure, 1.0])}
    write_vtu(folder / "fields_0001.vtu", points, [("tri3", np.array([[0, 1, 2]]))], fields, {"body": np.array([3])})
    (folder / "report.html").write_text("not read")
    return folder


@pytest.fixture
def results(tmp_path: Path) -> Quantities:
    return read(write(tmp_path / "before", SUMMARY))


def test_every_number_is_read(results: Quantities) -> None:
    """By its path, components together; without times and versions, words apart."""
    assert results.files == {"summary.json", "history.csv", "fields_0001.vtu"}
    numbers = results.numbers
    assert numbers[f"{STEP}/reactions/block.bottom"].tolist() == [0.0, 0.0, 100.0]
    assert numbers[f"{STEP}/probes/p/stress_*"].tolist() == [1e-15, 7.0]
    assert np.isnan(numbers[f"{LID}/max_pressure_at"])
    assert {f"summary.json/certificate/checks/{c}tension/value" for c in ("", "lid: ")} <= numbers.keys()
    assert numbers["history.csv/force_*"].tolist() == [[1e-15, -3.5], [0.0, -7.0]]
    assert np.isnan(numbers["history.csv/rigid_*"]).all()
    assert numbers["fields_0001.vtu/points/pressure"].tolist() == [0.0, 5.0, 1.0]
    assert numbers["fields_0001.vtu/cells/body"].tolist() == [3]
    assert numbers["fields_0001.vtu/coordinates"].shape == (3, 3)
    assert numbers["fields_0001.vtu/connectivity"].tolist() == [0, 1, 2]
    assert results.words["summary.json/notes/0"] == "64 segments"
    assert results.words["history.csv/contact"] == "lid\nlid"
    assert not any("timings" in name or "versions" in name for name in (*numbers, *results.words))


def test_damaged_files_are_refused(tmp_path: Path) -> None:
    folder = write(tmp_path / "damaged", SUMMARY)
    whole = (folder / "fields_0001.vtu").read_bytes()
    (folder / "fields_0001.vtu").write_bytes(whole[: len(whole) // 2])
    with pytest.raises(ValueError, match="VTK cannot read it"):
        read(folder)


def test_the_same_is_the_same(results: Quantities) -> None:
    """Bit for bit, with what is not a number."""
    found = compare(results, results)
    assert found.identical
    assert found.passes(0.0)
    assert found.count == sum(array.size for array in results.numbers.values())
    assert found == Comparison(found.differences, (), (), ())


def changed(results: Quantities, name: str, value: object) -> Quantities:
    return replace(results, numbers={**results.numbers, name: np.array(value)})


@pytest.mark.parametrize(
    ("name", "value", "relative"),
    [
        (f"{LID}/force", [0.0, 1e-9, 100.0], 1e-11),  # to the largest component
        (f"{STEP}/factor", 1.0 + 1e-11, 1e-11),
        (f"{STEP}/max_displacement", 0.02 * (1.0 + 1e-11), 1e-11),
        ("fields_0001.vtu/points/pressure", [0.0, 5.0, 1.0 + 5e-11], 1e-11),  # to the largest of the array
        ("history.csv/force_*", [[1e-15, -3.5], [7e-11, -7.0]], 7e-13),  # to the largest force of the run
        (f"{STEP}/reaction", [-1e-12, -3e-12, 1.2e-10], 1e-12),  # which is 100 N, what this sum cancels from
        (f"{LID}/max_penetration", 2e-14, 1e-12),  # to the displacement
        (f"{STEP}/balance_error", 1.3e-15, 1e-15),  # an error: as it is
        (f"{STEP}/converged", False, 1.0),
        (f"{LID}/max_pressure_at", 0.0, np.inf),  # a number where there was none
        ("fields_0001.vtu/points/pressure", [0.0, 5.0], np.inf),
    ],
)
def test_one_number_changes(results: Quantities, name: str, value: object, relative: float) -> None:
    """It alone is said to differ, whichever side is first, by what follows from the numbers."""
    other = changed(results, name, value)
    for found in (compare(results, other), compare(other, results)):
        assert [d.name for d in found.differences if not d.identical] == [name]
        assert found.worst is not None
        assert found.worst.name == name
        assert found.worst.relative == pytest.approx(relative, rel=1e-3)
        assert found.passes(1.01 * relative)
        assert np.isinf(relative) or not found.passes(0.99 * relative)
    if np.isinf(relative):
        assert not compare(results, other).passes(1e300)


def test_errors_above_rounding_are_relative() -> None:
    """An error of a discretization is a result like any other; its rounding (below 1e-10) is not."""
    assert difference("verify.json/energy/error", np.array([1e-3]), np.array([1.001e-3])).relative == pytest.approx(
        1e-3, rel=1e-2
    )
    assert difference("verify.json/energy/error", np.array([1e-14]), np.array([2e-14])).relative == pytest.approx(1e-14)
    assert difference("verify.json/energy/value", np.array([1e-3]), np.array([2e-3])).relative == pytest.approx(0.5)


def test_bits() -> None:
    """Equal numbers of other bits are told apart from the same bits: minus zero, another type."""
    for one, other in ((np.array([0.0]), np.array([-0.0])), (np.array([0.0]), np.array([0]))):
        assert difference("x", one, one).identical
        found = difference("x", one, other)
        assert (found.relative, found.identical) == (0.0, False)


def test_missing_and_new(tmp_path: Path, results: Quantities) -> None:
    """What AFTER lacks, file or number, is a difference; what is new there, and other words, are not."""
    more = {**SUMMARY, "notes": ["sixty-four segments"], "work": 3.0}
    folder = write(tmp_path / "after", more)
    (folder / "extra.csv").write_text("x\n1\n")
    after = read(folder)
    found = compare(results, after)
    assert found.new == ("extra.csv", "extra.csv/x", "summary.json/work")
    assert found.words == ("summary.json/notes/0",)
    assert found.passes(0.0)
    back = compare(after, results)
    assert back.missing == found.new
    assert not back.passes(1e300)
    assert not compare(Quantities(frozenset(), {}, {}), results).passes(1.0)  # nothing compared proves nothing


def test_report(results: Quantities) -> None:
    """A line a run, the names of what exceeds the tolerance, and a count in the end."""
    other = compare(results, changed(results, f"{STEP}/factor", 1.5))
    found = {"same": compare(results, results), "other": other, "none": "AFTER failed: no such thing"}
    lines = same_results.report(found, 1e-12)
    count = str(other.count)
    assert [line.split() for line in lines[2:5]] == [
        ["same", "same", count, "bit", "for", "bit"],
        ["DIFFERS", "other", count, "3.3e-01", f"{STEP}/factor"],
        ["DIFFERS", "none", "AFTER", "failed:", "no", "such", "thing"],
    ]
    assert f"  above the tolerance: 3.3e-01  {STEP}/factor" in lines
    assert lines[-1] == "1 of 3 runs the same within 1e-12, 1 of them bit for bit"


def test_runs_by_pattern() -> None:
    every = [
        runs.Run("example", "two-blocks/job"),
        runs.Run("example", "two-blocks/job", 3),
        runs.Run("benchmark", "beam"),
    ]
    assert same_results.chosen(every, None) == every
    assert same_results.chosen(every, ["*3 steps", "benchmark *"]) == every[1:]


def test_benchmark_numbers() -> None:
    """Where the reference is zero the value is an error."""
    rows = [
        {"quantity": name, "values": [2.0, 1.0], "reference": reference, "tolerance": 0.1, "passed": True}
        for name, reference in (("energy", 0.0), ("pressure", 1.0))
    ]
    assert {(name, key) for name, row in runs.benchmark_numbers(rows).items() for key in row} == {
        *(("energy", key) for key in ("error", "reference", "tolerance")),
        *(("pressure", key) for key in ("value", "reference", "tolerance")),
    }


def test_small_models() -> None:
    """Every group is run; friction has its own numbers, and both versions get numbers, not Python's records."""
    assert tuple(models.GROUPS) == runs.GROUPS
    assert {cell.partition(" ")[0] for cell in models.GROUPS["contact"]()} == {*models.PLANE, *models.SOLID}
    found = models.numbers(models.blocks("quad4", 2, friction=0.3))
    assert len(found["steps"]) == 2
    last = found["steps"][-1]
    assert last["iterations"] > 0
    assert np.nanmax(np.abs(last["traction"])) > 0.0
    assert json.loads(json.dumps(last)).keys() >= {"displacement", "pressure", "gap", "slip", "status"}


def test_examples_are_those_of_one_tree(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Both versions run the same files: an example that was changed is no change of the code."""
    given: list[tuple[str, ...]] = []
    monkeypatch.setattr(runs, "_child", lambda version, folder, code, *arguments, **_: given.append(arguments))
    version = versions.Version(tmp_path / "after", Path(sys.executable))
    runs.execute(runs.Run("example", "two-blocks/job"), version, tmp_path / "results", tmp_path / "before")
    assert given[0][1] == str(tmp_path / "before/examples/two-blocks/job.toml")


def test_working_tree_is_copied(tmp_path: Path) -> None:
    """Changed and new files as they are, without those that git ignores or that are removed."""
    root = tmp_path / "root"
    (root / "src").mkdir(parents=True)
    for name, text in ((".gitignore", "*.so\n"), ("src/a.py", "old"), ("gone.py", ""), ("core.so", "")):
        (root / name).write_text(text)
    for command in (["init", "-q"], ["add", "-A"]):
        subprocess.run(["git", *command], cwd=root, check=True)
    (root / "src/a.py").write_text("changed")
    (root / "new.py").write_text("")
    (root / "gone.py").unlink()
    versions.copy_working_tree(root, tmp_path / "copy")
    copied = {
        path.relative_to(tmp_path / "copy").as_posix() for path in (tmp_path / "copy").rglob("*") if path.is_file()
    }
    assert copied == {".gitignore", "src/a.py", "new.py"}
    assert (tmp_path / "copy/src/a.py").read_text() == "changed"


def test_versions_that_cannot_be(tmp_path: Path, capfd: pytest.CaptureFixture[str]) -> None:
    """A message and exit status 2: no commit, and a folder without compiled core."""
    for what, said in (("no-such-commit", "no folder, and no commit"), (str(tmp_path), "no compiled core")):
        assert same_results.main([what]) == same_results.NOT_BUILT
        assert said in capfd.readouterr().err

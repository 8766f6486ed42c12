"""``abut verify`` and ``abut infsup``: what they print, their exit status, and the records behind them."""

from __future__ import annotations

import importlib.util
import json
import sys
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest

import abut
from abut.benchmarks import BENCHMARKS, Benchmark, Reference, run
from abut.cli import main
from abut.errors import InputError
from abut.verify.interface_patch import EXACT

EXAMPLES = Path(__file__).parents[2] / "examples"
BLOCKS = EXAMPLES / "two-blocks" / "job.toml"
FAST = ("patch-punch", "patch-quad4-quad8")
RATE = "smooth-quad4"


def command(capsys: pytest.CaptureFixture[str], *arguments: object) -> tuple[int, str, str]:
    status = main([str(a) for a in arguments])
    captured = capsys.readouterr()
    return status, captured.out, captured.err


def test_list(capsys: pytest.CaptureFixture[str]) -> None:
    status, out, _ = command(capsys, "verify", "--list")
    assert status == 0
    lines = out.splitlines()
    assert [line.split()[0] for line in lines] == list(BENCHMARKS)
    assert all(benchmark.title in line for benchmark, line in zip(BENCHMARKS.values(), lines))
    assert command(capsys, "verify", "--list", FAST[0])[1].splitlines() == [
        line for line in lines if line.startswith(f"{FAST[0]} ")
    ]


def test_benchmarks_by_name(capsys: pytest.CaptureFixture[str]) -> None:
    """One line for each quantity with its verdict, and where the reference comes from."""
    status, out, err = command(capsys, "verify", *FAST)
    assert (status, err) == (0, "")
    lines = out.splitlines()
    for name in FAST:
        for quantity, reference in BENCHMARKS[name].references.items():
            (line,) = [row for row in lines if row.split()[1:3] == [name, quantity]]
            assert line.startswith("pass  ")
            assert f"source: {reference.source}" in out
    total = sum(len(BENCHMARKS[name].references) for name in FAST)
    assert lines[-1].startswith(f"{total} of {total} quantities pass")


def test_json(capsys: pytest.CaptureFixture[str]) -> None:
    status, out, _ = command(capsys, "verify", FAST[0], "--json")
    assert status == 0
    rows = json.loads(out)
    assert [(row["benchmark"], row["quantity"]) for row in rows] == [
        (FAST[0], quantity) for quantity in BENCHMARKS[FAST[0]].references
    ]
    for row in rows:
        assert row["source"]
        assert row["reason"]
        assert row["passed"] is (row["error"] <= row["tolerance"]) is True
        assert len(row["values"]) == BENCHMARKS[FAST[0]].levels
        assert row["rate"] is None


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        (["patch-punsh"], "no benchmark named 'patch-punsh'; did you mean 'patch-punch'?"),
        (["nonsense"], "no benchmark named 'nonsense'; abut verify --list names them"),
        (["patch-punch", "--levels", "0"], "--levels: expected a whole number >= 1, got 0"),
        (["--job", BLOCKS, "patch-punch"], "a job goes without benchmark names and --levels"),
        (["--job", BLOCKS, "--levels", "2"], "a job goes without benchmark names and --levels"),
        (["--job", "nowhere.toml"], "cannot read job file nowhere.toml"),
    ],
)
def test_bad_arguments(arguments: list[object], message: str, capsys: pytest.CaptureFixture[str]) -> None:
    status, out, err = command(capsys, "verify", *arguments)
    assert (status, out) == (2, "")
    assert message in err


def test_levels_and_rate(capsys: pytest.CaptureFixture[str]) -> None:
    """Errors by level fall at the rate of theory, and are drawn as bars."""
    references = BENCHMARKS[RATE].references
    status, out, _ = command(capsys, "verify", RATE, "--levels", 3)
    assert status == 0
    quantity, reference = next((q, r) for q, r in references.items() if r.rate is not None)
    (line,) = [row for row in out.splitlines() if row.split()[1:3] == [RATE, quantity]]
    assert f"(theory {reference.rate:g})" in line
    start = out.splitlines().index(
        next(r for r in out.splitlines() if r.startswith(f"{RATE} {quantity}: error by level"))
    )
    bars = [row.split() for row in out.splitlines()[start + 1 : start + 4]]
    assert [bar[0] for bar in bars] == ["0", "1", "2"]
    errors = [float(bar[1]) for bar in bars]
    assert errors[0] > errors[1] > errors[2]
    assert len(bars[0][2]) > len(bars[-1][2] if len(bars[-1]) > 2 else "")
    rows = json.loads(command(capsys, "verify", RATE, "--levels", 3, "--json")[1])
    own = next(row for row in rows if row["quantity"] == quantity)
    assert own["rate"] > own["expected_rate"] - reference.rate_tolerance
    assert own["values"] == pytest.approx(errors, rel=1e-2)


def test_rate_without_a_reference_rate(capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch) -> None:
    """Of any benchmark with two levels: errors 1/2, 1/8, 1/32 fall with h^2; those of rounding have no rate."""
    falling = record(lambda level: 2.0 + 0.25**level, Reference(2.0, 0.2, "a book", "none"))
    exact = record(lambda level: 2.0, Reference(2.0, 0.2, "a book", "none"))
    for benchmark, last in ((falling, "2.00"), (exact, "-")):
        monkeypatch.setitem(BENCHMARKS, "told", benchmark)
        status, out, _ = command(capsys, "verify", "told", "--levels", 3)
        assert status == 0
        (line,) = [row for row in out.splitlines() if row.startswith("pass")]
        assert line.split()[-1] == last
    assert command(capsys, "verify", "told", "--levels", 1)[1].splitlines()[1].split()[-1] == "2.0e-01"


def test_plot_needs_matplotlib(
    tmp_path: Path, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setitem(sys.modules, "matplotlib", None)
    status, out, err = command(capsys, "verify", FAST[0], "--levels", 2, "--plot", tmp_path / "p.png")
    assert (status, out) == (2, "")
    assert "pip install 'abut[picture]'" in err


@pytest.mark.skipif(importlib.util.find_spec("matplotlib") is None, reason="matplotlib is not installed")
def test_plot(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert command(capsys, "verify", FAST[0], "--levels", 2, "--plot", tmp_path / "p.svg")[0] == 0
    assert "<svg" in (tmp_path / "p.svg").read_text()
    status, _, err = command(capsys, "verify", FAST[0], "--levels", 2, "--plot", tmp_path / "no" / "p.svg")
    assert status == 2
    assert "--plot: cannot write" in err


def record(measured: Callable[[abut.Model], float], reference: Reference, levels: int = 3) -> Benchmark:
    """A benchmark that measures what it is told, level by level."""
    return Benchmark(
        "told", "What it is told", lambda level: level, lambda value: {"x": value}, {"x": reference}, levels,
        solve=measured,
    )  # fmt: skip


def test_outcomes() -> None:
    """Relative error of the finest level, absolute of a zero; order of errors h^p from a fit; NaN and slow ones fail."""
    (outcome,) = run(record(lambda level: 2.0 + 0.5**level, Reference(2.0, 0.2, "s", "r")))
    assert outcome.error == pytest.approx(0.125)
    assert outcome.passed
    assert outcome.errors == pytest.approx((0.5, 0.25, 0.125))
    assert outcome.rate == pytest.approx(1.0)  # fitted without a reference rate, too, which it then cannot fail
    (slow,) = run(record(lambda level: 2.1, Reference(2.0, 0.2, "s", "r")))
    assert slow.rate == pytest.approx(0.0, abs=1e-12)
    assert slow.passed
    for rate in (None, 2.0):  # errors of rounding follow no power, and are no reason to fail
        (exact,) = run(record(lambda level: 2.0 + 1e-11 * level, Reference(2.0, 0.2, "s", "r", rate)))
        assert exact.rate is None
        assert exact.passed
    (gap,) = run(record(lambda level: [0.1, float("nan"), 0.01][level], Reference(0.0, 1.0, "s", "r", 1.0)))
    assert not gap.passed
    assert not run(record(lambda level: 2.5, Reference(2.0, 0.2, "s", "r")))[0].passed
    assert not run(record(lambda level: float("nan"), Reference(2.0, 0.2, "s", "r")))[0].passed
    for order, passed in ((2.0, True), (1.95, True), (1.8, False), (3.0, True)):
        (outcome,) = run(record(lambda level, p=order: 0.5 ** (p * level), Reference(0.0, 1.0, "s", "r", 2.0)))
        assert outcome.rate == pytest.approx(order)
        assert outcome.passed == passed
    assert run(record(lambda level: 0.1, Reference(0.0, 1.0, "s", "r", 2.0)), levels=1)[0].rate is None
    with pytest.raises(InputError, match="expected a whole number >= 1"):
        run(record(lambda level: 0.0, Reference(0.0, 1.0, "s", "r")), levels=0)


def test_a_failing_benchmark_is_said_so(capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch) -> None:
    wrong = record(lambda level: 2.5, Reference(2.0, 0.2, "a book", "none"), levels=1)
    monkeypatch.setitem(BENCHMARKS, "told", wrong)
    status, out, _ = command(capsys, "verify", "told", FAST[0])
    assert status == 1
    (line,) = [row for row in out.splitlines() if row.startswith("FAIL")]
    assert line.split()[1:7] == ["told", "x", "2.5", "2", "2.50e-01", "2.0e-01"]
    assert "source: a book" in out
    assert json.loads(command(capsys, "verify", "told", "--json")[1])[0]["passed"] is False


@pytest.mark.parametrize("name", BENCHMARKS)
def test_records_are_complete(name: str) -> None:
    """Every quantity says where its reference comes from and why the tolerance is what it is; rates need levels."""
    benchmark = BENCHMARKS[name]
    assert benchmark.name == name
    assert benchmark.title
    assert benchmark.references
    for reference in benchmark.references.values():
        assert reference.source
        assert reference.reason
        assert reference.tolerance > 0.0
        assert np.isfinite(reference.value)
        assert reference.rate is None or (benchmark.levels > 1 and reference.value == 0.0)
    sizes = [benchmark.size(level) for level in range(3)]
    assert sizes[0] > sizes[1] > sizes[2] > 0.0


ELSEWHERE = (  # run by tests of their own
    *("smooth-", "signorini-", "shallow-ironing", "crushed-ring", "gears", "die-drawn", "wires", "capstan"),
    *("plastic-", "necking", "considere"),
)
LONG = (
    "hertz-sphere",
    "mindlin-ball",
    "mindlin-cycle",
    "belt-on-drum",
    "spence-ball",
    "contrast-hertz",
    "cattaneo-quad8",
)


@pytest.mark.parametrize(
    "name",
    [
        pytest.param(name, marks=[pytest.mark.long] if name.startswith(LONG) else [])
        for name in BENCHMARKS
        if not name.startswith(ELSEWHERE)
    ],
)
def test_benchmark_passes(name: str) -> None:
    for outcome in run(BENCHMARKS[name]):
        assert outcome.passed, (outcome.quantity, outcome.values, outcome.reference, outcome.rate)


def test_patch_of_a_job(capsys: pytest.CaptureFixture[str]) -> None:
    status, out, _ = command(capsys, "verify", "--job", BLOCKS)
    assert status == 0
    assert out.startswith("pass  blocks: plane interface")
    (row,) = json.loads(command(capsys, "verify", "--job", BLOCKS, "--json")[1])
    assert row["contact"] == "blocks"
    assert row["flat"] is row["passed"] is True
    assert max(row["pressure"], row["displacement"]) < EXACT


@pytest.mark.parametrize("job", ["quad4", "quad8"])
def test_patch_of_a_curved_job(job: str, capsys: pytest.CaptureFixture[str]) -> None:
    """A uniform pressure is no solution there: said so, and the balance of the two sides is what is checked."""
    path = EXAMPLES / "hertz-line" / f"{job}.toml"
    status, out, _ = command(capsys, "verify", "--job", path)
    assert status == 0
    assert "curved interface, where a uniform pressure is no exact solution: force balance" in out
    (row,) = json.loads(command(capsys, "verify", "--job", path, "--json")[1])
    assert row["pressure"] is row["displacement"] is None
    assert row["passed"] is True


def test_patch_of_a_job_that_integrates_badly(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    job = tmp_path / "job.toml"
    job.write_text(BLOCKS.read_text().replace("hex8", "hex20") + 'integration = { rule = "gauss", points = 1 }\n')
    status, out, _ = command(capsys, "verify", "--job", job)
    assert status == 1
    assert out.startswith("FAIL  blocks: plane interface")


def test_patch_of_a_job_without_contacts(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    text = BLOCKS.read_text()
    job = tmp_path / "job.toml"
    job.write_text(text[: text.index("[[contacts]]")])
    for words in (["verify", "--job"], ["infsup"]):
        status, _, err = command(capsys, *words, job)
        assert status == 2
        assert "the model has no contact" in err
        assert "[[contacts]]" in err


def test_infsup_of_a_job(capsys: pytest.CaptureFixture[str]) -> None:
    status, out, _ = command(capsys, "infsup", BLOCKS, "--levels", 2)
    assert status == 0
    assert out.startswith("contact 'blocks', pressure dual-P1")
    multipliers = [int(row.split()[0]) for row in out.splitlines() if row.split()[0].isdigit()]
    assert multipliers == [36, 121]  # nodes of 5 x 5 and 10 x 10 facets
    assert out.splitlines()[-1].startswith("  stable: beta = ")
    (result,) = json.loads(command(capsys, "infsup", BLOCKS, "--json", "--contact", "blocks")[1])
    assert result["stable"] is True
    assert [level["multipliers"] for level in result["levels"]] == [36]


def test_infsup_of_an_unstable_job(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    """Matching meshes with P0: exit status 1, and the trend says why."""
    text = BLOCKS.read_text().replace("[2, 8]", "[0, 10]").replace("cells = [6, 6, 6]", "cells = [3, 3, 3]")
    job = tmp_path / "job.toml"
    job.write_text(text.replace("cells = [5, 5, 4]", "cells = [3, 3, 2]") + 'pressure = "P0"\n')
    status, out, _ = command(capsys, "infsup", job, "--levels", 2)
    assert status == 1
    assert "fails: beta falls with the mesh" in out


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        (
            [EXAMPLES / "pin-lug" / "job.toml", "--levels", "2"],
            "only meshes that abut makes (mesh.bodies) can be refined",
        ),
        ([BLOCKS, "--levels", "0"], "--levels: expected a whole number >= 1, got 0"),
        ([BLOCKS, "--contact", "block"], "no contact named 'block'; did you mean 'blocks'?"),
    ],
)
def test_infsup_refuses(arguments: list[object], message: str, capsys: pytest.CaptureFixture[str]) -> None:
    status, _, err = command(capsys, "infsup", *arguments)
    assert status == 2
    assert message in err

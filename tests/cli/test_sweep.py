"""abut sweep: runs of one job with different parameters, in one table and on one page."""

from __future__ import annotations

import csv
from pathlib import Path

import pytest

from abut.cli import main
from abut.cli.sweep import combinations

JOB = """schema = 1
model.plane = "stress"
solids = [{ body = "lower", material = "steel" }, { body = "upper", material = "steel" }]
supports = [
  { on = "lower.bottom", y = 0 }, { on = "lower.left", x = 0 }, { on = "upper.left", x = 0 },
  { on = "upper.top", y = "= -press" },
]
contacts = [{ name = "joint", surfaces = ["lower.top", "upper.bottom"] }]

[parameters]
press = 0.01
width = 2
young = 1e5

[mesh.bodies]
lower = { kind = "rectangle", x = [0, "= width"], y = [0, 1], cells = [2, 2] }
upper = { kind = "rectangle", x = [0, "= width"], y = [1, 2], cells = [3, 2] }

[materials]
steel = { kind = "linear-elastic", young = "=young", poisson = 0.3 }
"""


def rows(path: Path) -> list[dict[str, str]]:
    with path.open(encoding="utf-8", newline="") as file:
        return list(csv.DictReader(file))


def test_a_stack_pressed(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    """Two blocks of height 1 on each other, free to widen: pressure E press / 2, force that times the width; a width that
    cannot be is a line of its own, and the exit status is that of bad input."""
    job = tmp_path / "job.toml"
    job.write_text(JOB)
    assert main(["sweep", str(job), "--set", "press=0.01, max(0.02,0.03)", "--set", "width=1,2,-1"]) == 2
    out = capsys.readouterr().out
    assert "6 of 6: press = max(0.02,0.03), width = -1: " in out
    found = rows(tmp_path / "job-sweep" / "sweep.csv")
    assert [(float(row["press"]), float(row["width"])) for row in found] == [
        (press, width) for press in (0.01, 0.03) for width in (1.0, 2.0, -1.0)
    ]
    for row in found:
        press, width = float(row["press"]), float(row["width"])
        if width < 0.0:
            assert "mesh.bodies.lower" in row["status"]
            assert row["joint: force"] == ""
            continue
        assert (row["status"], row["certificate"]) == ("converged", "pass")
        assert float(row["joint: largest pressure"]) == pytest.approx(1e5 * press / 2, rel=1e-9)
        assert float(row["joint: force"]) == pytest.approx(1e5 * press / 2 * width, rel=1e-9)
        assert float(row["upper.top: reaction"]) == pytest.approx(1e5 * press / 2 * width, rel=1e-9)
        assert (tmp_path / "job-sweep" / row["folder"] / "report.html").is_file()
    page = (tmp_path / "job-sweep" / "sweep.html").read_text()
    assert page.count("<svg") == len(found[0]) - 5  # a plot of every result
    assert 'href="002/report.html"' in page
    assert "width = 2" in page


def test_a_line_through_the_values(tmp_path: Path) -> None:
    """One parameter: a point for each value, joined in their order."""
    job = tmp_path / "job.toml"
    job.write_text(JOB)
    assert main(["sweep", str(job), "--set", "young=2e5,1e5", "--quiet", "--output", str(tmp_path / "here")]) == 0
    forces = {float(row["young"]): float(row["joint: force"]) for row in rows(tmp_path / "here" / "sweep.csv")}
    assert forces[2e5] == pytest.approx(2.0 * forces[1e5], rel=1e-12)


@pytest.mark.parametrize(
    ("options", "message"),
    [
        ([], "nothing changes"),
        (["--set", "press=1,,2"], "--set press: a value is missing"),
        (["--set", "pres=1,2"], "did you mean 'press'?"),
        (["--set", "press=" + ",".join("1" * 1001)], "1001 runs, more than 1000"),
    ],
)
def test_what_is_refused(options: list[str], message: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    job = tmp_path / "job.toml"
    job.write_text(JOB)
    assert main(["sweep", str(job), *options]) == 2
    assert message in capsys.readouterr().err


def test_commas_in_brackets() -> None:
    assert combinations({"a": "min(1,2),3", "b": "4"}) == [{"a": "min(1,2)", "b": "4"}, {"a": "3", "b": "4"}]

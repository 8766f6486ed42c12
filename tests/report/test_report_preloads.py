"""What the report and the certificate say of bolts: every one in every step, against bars in closed form."""

from __future__ import annotations

import json
import re
from dataclasses import replace
from pathlib import Path

import pytest

import abut
from abut.mesh.make import box, join

YOUNG, LENGTH, AREA = 1000.0, 10.0, 2.0
SHORT, FORCE, STEPS = 0.02, 5.0, 5


def _bolts() -> abut.Model:
    """Two bars clamped at both ends, nu = 0: one is shortened, one is drawn by a force until it is locked, and then one end
    of it is moved."""
    mesh = join({f"bar{i}": box([3 * i, 3 * i + 1], [0, 2], [0, LENGTH], cells=[1, 1, 4]) for i in range(2)})
    moved = abut.Amplitude(((0.0, 0.0), (0.6, 0.0), (1.0, 1.0)))
    ends = [abut.Support(f"bar{i}.bottom", x=0, y=0, z=0) for i in range(2)]
    ends += [abut.Support("bar0.top", x=0, y=0, z=0), abut.Support("bar1.top", x=0, y=0, z=0.01, amplitude=moved)]
    tight = abut.Amplitude(((0.0, 0.0), (0.6, 1.0), (1.0, 1.0)))
    return abut.Model(
        mesh,
        [abut.Solid(f"bar{i}", abut.LinearElastic(YOUNG, 0.0)) for i in range(2)],
        ends,
        preloads=[
            abut.Preload("short", body="bar0", shortening=SHORT),
            abut.Preload("drawn", body="bar1", force=FORCE, amplitude=tight, lock=0.6),
        ],
        solve=abut.SolveOptions(steps=STEPS),
    )


STIFFNESS = YOUNG * AREA / LENGTH
EXPECTED = {
    "short": [STIFFNESS * SHORT * n / STEPS for n in range(1, STEPS + 1)],
    "drawn": [FORCE / 3.0, FORCE * 2.0 / 3.0, FORCE, FORCE + STIFFNESS * 0.005, FORCE + STIFFNESS * 0.01],
}


def _rows(page: str, title: str) -> list[list[str]]:
    """Cells of the table after a title."""
    table = page[page.index(title) :]
    table = table[table.index("<table") : table.index("</table>")]
    rows = re.findall(r"<tr.*?</tr>", table, flags=re.DOTALL)
    return [re.findall(r"<t[dh][^>]*>(.*?)</t[dh]>", row, flags=re.DOTALL) for row in rows]


def test_every_bolt_in_every_step(tmp_path: Path) -> None:
    """E A / L times the shortening; what a force gives while it does, and after locking with what moves the end."""
    abut.write(abut.solve(_bolts()), tmp_path)
    head, *rows = _rows((tmp_path / "report.html").read_text(encoding="utf-8"), "What preloads carry")
    assert head[:3] == ["preload", "step", "tension"]
    said = {(row[0], int(row[1])): (float(row[2]), row[-1]) for row in rows}
    assert len(said) == len(rows) == 2 * STEPS
    for name, tensions in EXPECTED.items():
        assert [said[name, n][0] for n in range(1, STEPS + 1)] == pytest.approx(tensions, rel=1e-5)
    assert {said["short", n][1] for n in range(1, STEPS + 1)} == {"shortening given"}
    assert [said["drawn", n][1] for n in range(1, STEPS + 1)] == ["force given"] * 3 + ["locked"] * 2
    summary = json.loads((tmp_path / "summary.json").read_text(encoding="utf-8"))
    steps = [{name: one["tension"] for name, one in step["preloads"].items()} for step in summary["steps"]]
    for name, tensions in EXPECTED.items():
        assert [step[name] for step in steps] == pytest.approx(tensions, rel=1e-5)


def test_the_certificate_names_what_bolts_carry() -> None:
    """The range of every bolt's tension; a bolt that is pressed fails its line, by name."""
    solution = abut.solve(_bolts())
    lines = {check.name: check for check in solution.certificate}
    assert lines["preload"].passed
    assert lines["preload"].value < 1e-6
    assert lines["loose bolts"].passed
    for name, tensions in EXPECTED.items():
        low, high = map(float, re.search(rf"'{name}' (\S+) to ([^,]+)", lines["loose bolts"].meaning).groups())
        assert (low, high) == pytest.approx((min(tensions), max(tensions)), rel=1e-5)
    model = _bolts()
    pressed = [*model.supports[:3], replace(model.supports[3], z=-0.1)]
    line = next(c for c in abut.solve(replace(model, supports=pressed)).certificate if c.name == "loose bolts")
    assert not line.passed
    assert "does not: 'drawn'; tensions" in line.meaning

"""Jobs that start from the steps of another one: what one job with all steps gives."""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np
import pytest

from abut.analysis.step_records import check_order
from abut.cli import main
from abut.errors import InputError
from abut.job import load_job
from abut.output.start import load_start
from models.steps import arrays

BLOCKS = """schema = 1
[model]
plane = "strain"
[mesh.bodies.lower]
kind = "rectangle"
x = [0, 4]
y = [0, 1]
cells = [8, 2]
[mesh.bodies.upper]
kind = "rectangle"
x = [1, 3]
y = [1, 2]
cells = [6, 3]
[materials.steel]
kind = "linear-elastic"
young = 210e3
poisson = 0.3
[materials.metal]
kind = "plastic"
young = 210e3
poisson = 0.3
yield_stress = 200
hardening = 2e3
[[solids]]
body = "lower"
material = "steel"
[[solids]]
body = "upper"
material = "MATERIAL"
[[supports]]
on = "lower.bottom"
x = 0
y = 0
[[contacts]]
name = "fit"
contactor = "upper.bottom"
target = "lower.top"
friction = 0.3
offset = -0.0005
amplitude = AMPLITUDE
[[supports]]
on = "upper.top"
y = 0
x = 0.002
amplitude = PUSH
"""
A = '[[steps]]\nname = "assemble"\nincrements = 4\n[output]\ndirectory = "a"\nrestart = true\n'
LATER = '[[steps]]\nname = "assemble"\nincrements = 4\n[[steps]]\nname = "load"\nincrements = 5\n'


def text(material: str, later: bool) -> str:
    fit = '[["start", 0], ["assemble", 1]' + (', ["load", 1]]' if later else "]")
    push = '[["start", 0], ["assemble", 0.1]' + (', ["load", 1]]' if later else "]")
    return BLOCKS.replace("MATERIAL", material).replace("AMPLITUDE", fit).replace("PUSH", push)


def run(folder: Path, name: str, job: str) -> int:
    (folder / f"{name}.toml").write_text(job)
    return main(["run", "--quiet", str(folder / f"{name}.toml")])


def continued(name: str, results: str = "a") -> str:
    return f'[start]\nresults = "{results}"\ntime = "assemble"\n[output]\ndirectory = "{name}"\n'


@pytest.mark.parametrize("material", ["steel", "metal"])
def test_two_jobs_are_one_with_two_steps(material: str, tmp_path: Path) -> None:
    """A fit assembled in one job and pushed with friction in the next one: the same solution path, step by step, so that
    nothing but rounding differs."""
    assert run(tmp_path, "a", text(material, False) + A) == 0
    assert run(tmp_path, "b", text(material, True) + LATER + continued("b")) == 0
    assert run(tmp_path, "one", text(material, True) + LATER + '[output]\ndirectory = "one"\n') == 0
    files = sorted(path.name for path in (tmp_path / "one").rglob("*.vtu"))
    assert len(files) > 9
    for file in files:
        b, one = (next((tmp_path / name).rglob(file)) for name in ("b", "one"))
        for (key, x), (_, y) in zip(arrays(b), arrays(one)):
            np.testing.assert_allclose(x, y, rtol=1e-9, atol=1e-9 * np.nanmax(np.abs(y), initial=1e-3), err_msg=key)
    summary = json.loads((tmp_path / "b" / "summary.json").read_text())
    assert any("starts from the steps in" in note for note in summary["notes"])
    assert not (tmp_path / "b" / "restart").exists()
    assert (tmp_path / "a" / "restart").exists()


def bar(later: bool) -> str:
    """A bar without lateral contraction held, drawn to 300 and let go to 0."""
    pull = '[["start", 0], ["assemble", 1]' + (', ["load", 0]]' if later else "]")
    return f"""schema = 1
[mesh.bodies.bar]
kind = "box"
x = [0, 2]
y = [0, 1]
z = [0, 1]
cells = [2, 1, 1]
[materials.metal]
kind = "plastic"
young = 200e3
poisson = 0.3
yield_stress = 200
hardening = 1e4
[[solids]]
body = "bar"
material = "metal"
[[supports]]
on = "bar.left"
x = 0
[[supports]]
on = "bar.front"
y = 0
[[supports]]
on = "bar.bottom"
z = 0
[[loads]]
kind = "traction"
on = "bar.right"
value = [300, 0, 0]
amplitude = {pull}
[[probes]]
name = "end"
at = [2, 0, 0]
of = ["displacement"]
"""


def test_residual_strain_of_a_bar(tmp_path: Path) -> None:
    """Drawn beyond yield in one job, let go in the next: the plastic strain (300 - 200) / H stays, to what Newton leaves."""
    assert run(tmp_path, "a", bar(False) + A) == 0
    assert run(tmp_path, "b", bar(True) + LATER + continued("b")) == 0
    table = (tmp_path / "b" / "probe_end.csv").read_text().splitlines()
    head, last = table[0].split(","), table[-1].split(",")
    stretch = float(
        last[next(i for i, name in enumerate(head) if "displacement" in name and "x" in name.split("_")[-1])]
    )
    assert stretch == pytest.approx(2 * (300 - 200) / 1e4, rel=1e-8)


HELD = '[[supports]]\non = "bar.back"\ny = {y}\namplitude = [["start", 0], ["assemble", 0]{later}]\n'
SIDE = """[[loads]]
kind = "traction"
on = "bar.back"
value = [0, 50, 0]
amplitude = [["start", 0], ["assemble", 0], ["load", 1]]
"""


def elastic(later: bool) -> str:
    """The bar without yield and without lateral contraction, which stays drawn."""
    metal = 'kind = "plastic"\nyoung = 200e3\npoisson = 0.3\nyield_stress = 200\nhardening = 1e4'
    plain = bar(later).replace(metal, 'kind = "linear-elastic"\nyoung = 200e3\npoisson = 0.0')
    assert plain != bar(later)
    return plain.replace('["load", 0]', '["load", 1]')


@pytest.mark.parametrize(
    ("first", "second", "across"),
    [
        ("", HELD.format(y=-3e-4, later=', ["load", 1]'), -3e-4),
        (HELD.format(y=0, later=""), SIDE, 50 / 200e3),
    ],
    ids=["held by the second job", "let go by it"],
)
def test_other_supports_where_nothing_moved(first: str, second: str, across: float, tmp_path: Path) -> None:
    """A bar drawn by 300 does not move across for want of lateral contraction: a support there may come with the second
    job, or go with it. Along it stays at 2 * 300 / E; across it follows the support, or the traction over E."""
    assert run(tmp_path, "a", elastic(False) + first + A) == 0
    job = elastic(True).replace("at = [2, 0, 0]", "at = [2, 1, 0]") + second + LATER + continued("b")
    assert run(tmp_path, "b", job) == 0
    assert main(["check", str(tmp_path / "b.toml")]) == 0
    table = (tmp_path / "b" / "probe_end.csv").read_text().splitlines()
    last = dict(zip(table[0].split(","), table[-1].split(",")))
    moved = [float(value) for name, value in last.items() if "displacement" in name]
    np.testing.assert_allclose(moved[:3], [2 * 300 / 200e3, across, 0.0], rtol=1e-9, atol=1e-14)


GRIP = '[[supports]]\non = "bar.right"\nx = 0.05\n'
LET_GO = """[[holds]]
name = "grip"
on = "bar.right"
x = 0.05
reached = "assemble"
until = "assemble"
released = "load"
"""
CAUGHT = '[[holds]]\non = "bar.right"\nx = "stay"\nsince = "assemble"\n'


def pulled(later: bool, by: str) -> str:
    """The bar that yields, drawn by something else than the load."""
    whole = bar(later)
    return whole[: whole.index("[[loads]]")] + whole[whole.index("[[probes]]") :] + by


def forces(folder: Path, name: str) -> list[float]:
    """Along the bar, of what holds its end, step by step."""
    head, *rows = [line.split(",") for line in (folder / name / "forces.csv").read_text().splitlines()]
    return [float(row[head.index("force_x")]) for row in rows if row[head.index("name")] == "bar.right"]


@pytest.mark.parametrize("first", [GRIP, LET_GO.split("until")[0]], ids=["by a support", "by a hold"])
def test_what_moved_in_one_job_is_let_go_in_the_next(first: str, tmp_path: Path) -> None:
    """Drawn to a strain e beyond yield, E and H in a row: the stress (e + Y / H) / (1 / E + 1 / H), which fades in a
    straight line, and leaves the plastic strain. A hold gives a millionth of what a cell does."""
    assert run(tmp_path, "a", pulled(False, first) + A) == 0
    job = pulled(True, LET_GO) + LATER + continued("b")
    assert run(tmp_path, "b", job) == 0
    assert main(["check", str(tmp_path / "b.toml")]) == 0
    drawn = (0.05 / 2 + 200 / 1e4) / (1 / 200e3 + 1 / 1e4)
    np.testing.assert_allclose(forces(tmp_path, "b")[3:], drawn * np.linspace(1, 0, 6), rtol=1e-5, atol=1e-5 * drawn)
    table = (tmp_path / "b" / "probe_end.csv").read_text().splitlines()
    last = dict(zip(table[0].split(","), table[-1].split(",")))
    stretch = next(float(value) for name, value in last.items() if name.startswith("displacement") and "x" in name)
    assert stretch == pytest.approx(2 * (drawn - 200) / 1e4, rel=1e-5)


def test_what_moved_in_one_job_is_held_in_the_next(tmp_path: Path) -> None:
    """A bar drawn by a load and caught before that goes: the catch has all of the load, in proportion to what has gone."""
    assert run(tmp_path, "a", bar(False) + A) == 0
    assert run(tmp_path, "b", bar(True) + CAUGHT + LATER + continued("b")) == 0
    np.testing.assert_allclose(forces(tmp_path, "b"), [0] * 4 + [60, 120, 180, 240, 300], rtol=1e-5, atol=1e-6)


@pytest.mark.parametrize(
    ("holds", "said"),
    [("", "let a support go by a hold"), (LET_GO.replace("0.05", "0.04"), "hold 'grip' puts points up to 0.0025")],
    ids=["nothing holds", "elsewhere"],
)
def test_what_does_not_hold_as_before_is_told(
    holds: str, said: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    assert run(tmp_path, "a", pulled(False, GRIP) + A) == 0
    assert run(tmp_path, "b", pulled(True, holds) + LATER + continued("b")) == 2
    assert said in capsys.readouterr().err


def test_other_multipliers_are_told(tmp_path: Path) -> None:
    """Supports that hold other nodes of a contactor leave other multipliers."""
    assert run(tmp_path, "a", text("steel", False) + A) == 0
    (tmp_path / "b.toml").write_text(text("steel", True) + LATER + continued("b"))
    job = load_job(tmp_path / "b.toml")
    steps = load_start(tmp_path / "a", job.model, 0.5)
    free, multipliers = len(steps[0].state.unknowns), len(steps[0].state.multipliers)
    check_order(steps, free, multipliers)
    with pytest.raises(InputError, match="hold other nodes of contactors"):
        check_order(steps, free, multipliers - 2)


@pytest.mark.parametrize(
    ("old", "new", "said"),
    [
        ("young = 210e3", "young = 200e3", "of another model"),
        ("cells = [6, 3]", "cells = [5, 3]", "mesh."),
        ("friction = 0.3", "friction = 0.2", "contacts[0].friction"),
        ('results = "a"', 'results = "nowhere"', "restart = true"),
        ('["assemble", 0.1]', '["assemble", 0.2]', "supports of this job"),
        ("[[contacts]]", '[[supports]]\non = "lower.right"\nx = 0\n[[contacts]]', "'lower.right'"),
        ('["assemble", 1]', '["assemble", 0.9]', "not in balance"),
        ('time = "assemble"', 'time = "load"', "before the end"),
        ('directory = "b"', 'directory = "a"', "output.directory"),
        ('time = "assemble"', 'time = "later"', "no step named"),
    ],
)  # fmt: skip
def test_what_does_not_fit_is_told(
    old: str, new: str, said: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    """One message, exit status 2; and abut check says what of it can be seen before the run."""
    assert run(tmp_path, "a", text("steel", False) + A) == 0
    job = text("steel", True) + LATER + continued("b")
    assert old in job
    assert run(tmp_path, "b", job.replace(old, new)) == 2
    assert said in capsys.readouterr().err
    if said not in ("not in balance", "output.directory"):
        assert main(["check", str(tmp_path / "b.toml")]) == 2
        assert said in capsys.readouterr().out

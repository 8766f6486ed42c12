"""Times of a job file run from 0 to the end that it names: the same model as with shares of it."""

from __future__ import annotations

import json
import re
from pathlib import Path

import pytest

import abut
from abut.cli import main
from abut.job import load_job
from abut.job.convert import write_job
from models.decks import BRICKS, HELD, PAIR, load, step

JOB = """schema = 1
model.plane = "strain"
materials.steel = {{ kind = "linear-elastic", young = 1000, poisson = 0.3 }}
solids = [{{ body = "b", material = "steel" }}]
supports = [{{ on = "b.bottom", x = 0, y = 0 }}]
loads = [{{ kind = "pressure", on = "b.top", value = 1, amplitude = [[0, 0], [{0}, 1], [{1}, 0.5]] }}]
holds = [{{ on = "b.left", x = "stay", since = {0}, until = {1} }}]
mesh.bodies.b = {{ kind = "rectangle", x = [0, 2], y = [0, 1], cells = [4, 2] }}
solve = {{ times = [{0}, {1}, {2}]{3} }}
"""
WITH_END, SHARES = (2.0, 4.0, 8.0, ", end = 8"), (0.25, 0.5, 1.0, "")  # exact as binary numbers


def job(folder: Path, values: tuple[object, ...]) -> abut.Model:
    (folder / "job.toml").write_text(JOB.format(*values), encoding="utf-8")
    return load_job(folder / "job.toml").model


def test_the_model_is_the_same(tmp_path: Path) -> None:
    given, shares = (job(tmp_path, values) for values in (WITH_END, SHARES))
    assert (given.loads, given.holds, given.solve) == (shares.loads, shares.holds, shares.solve)
    assert (given.solve.end, shares.solve.end) == (8.0, 1.0)


def test_results_have_the_times(tmp_path: Path) -> None:
    job(tmp_path, WITH_END)
    assert main(["run", str(tmp_path / "job.toml"), "--quiet", "--frd"]) == 0
    folder = tmp_path / "results"
    times = re.findall(r'timestep="([^"]+)"', (folder / "fields.pvd").read_text())
    assert [float(time) for time in times] == [2.0, 4.0, 8.0]
    steps = json.loads((folder / "summary.json").read_text())["steps"]
    assert [(one["factor"], one["time"]) for one in steps] == [(0.25, 2.0), (0.5, 4.0), (1.0, 8.0)]


def test_a_job_is_written_with_its_times(tmp_path: Path) -> None:
    first = load_job(Path(tmp_path / "job.toml")) if job(tmp_path, WITH_END) else None
    assert first is not None
    copy, _ = write_job(tmp_path / "copy.toml", first)
    assert "times = [2.0, 4.0, 8.0]" in copy.read_text()
    again = load_job(copy).model
    assert (again.loads, again.holds, again.solve.ends, again.solve.end) == (
        first.model.loads, first.model.holds, first.model.solve.ends, 8.0,
    )  # fmt: skip


def test_decks_keep_theirs(tmp_path: Path) -> None:
    push = ["*DLOAD", "2, P2, 10."]
    assert load(tmp_path, BRICKS + PAIR + HELD + step("0.5, 3.", *push) + step("1., 2.", *push)).model.solve.end == 5.0


@pytest.mark.parametrize("end", ["-1", "0", "nan"])
def test_what_is_no_end(end: str, tmp_path: Path) -> None:
    with pytest.raises(abut.InputError, match="end"):
        job(tmp_path, (0.25, 0.5, 1.0, f", end = {end}"))


STEPS = """[[steps]]
name = "press"
period = 2

[[steps]]
name = "hold"
period = 2
increments = 2

[[steps]]
name = "rest"
period = 4
"""


def test_names_of_steps_are_times(tmp_path: Path) -> None:
    """The same model as with numbers; load steps end with the steps, and with the increments of the second."""
    shares = job(tmp_path, SHARES)
    text = JOB.format('"press"', '"hold"', '"rest"', "").replace("[[0, 0]", '[["start", 0]')
    text = "\n".join(line for line in text.splitlines() if not line.startswith("solve")) + "\n" + STEPS
    (tmp_path / "job.toml").write_text(text, encoding="utf-8")
    named = load_job(tmp_path / "job.toml").model
    assert (named.loads, named.holds) == (shares.loads, shares.holds)
    assert (named.solve.times, named.solve.end) == ((0.25, 0.375, 0.5, 1.0), 8.0)
    (tmp_path / "job.toml").write_text(text.replace('"press"', '"pres"', 1), encoding="utf-8")
    with pytest.raises(abut.InputError, match="no step named 'pres', whose end a time could be; did you mean 'press'"):
        load_job(tmp_path / "job.toml")
    (tmp_path / "job.toml").write_text(text.replace("period = 4", "period = -4"), encoding="utf-8")
    with pytest.raises(abut.InputError, match=r"steps\[2\].period"):
        load_job(tmp_path / "job.toml")
    (tmp_path / "job.toml").write_text(text.replace("[[steps]]", "[solve]\nend = 3\n[[steps]]", 1), encoding="utf-8")
    with pytest.raises(abut.InputError, match=r"solve.end: the time at the end is that of all steps together"):
        load_job(tmp_path / "job.toml")


@pytest.mark.parametrize(
    ("name", "why"), [("press", "is used twice"), ("start", "stands for the beginning of the time")]
)
def test_a_name_stands_for_one_time(name: str, why: str, tmp_path: Path) -> None:
    steps = f'[[steps]]\nname = "press"\n[[steps]]\nname = "{name}"\n'
    (tmp_path / "job.toml").write_text(JOB.format(*SHARES).replace("times = [0.25, 0.5, 1.0]", "") + steps)
    with pytest.raises(abut.InputError, match=rf"steps\[1\].name: '{name}' {why}; give each step a name of its own"):
        load_job(tmp_path / "job.toml")

"""Several runs into one directory: one at a time, and what an earlier one has left never looks like a later one's."""

from __future__ import annotations

import json
import os
import re
import subprocess
import sys
from pathlib import Path

import pytest

import abut
from abut.cli import main
from abut.errors import SingularModelError
from abut.job import load_job
from abut.output import lock
from abut.output.lock import Lock
from abut.output.restart import FOLDER
from abut.output.stream import LOG, Stream
from models.steps import BALL, job, stop_in

POSIX = pytest.mark.skipif(os.name != "posix", reason="locks and links as POSIX has them")
HOLDER = (
    "import sys; from pathlib import Path; from abut.output.lock import Lock; Lock(Path(sys.argv[1])); "
    "print(flush=True); input()"
)


def names(folder: Path) -> list[str]:
    return sorted(path.name for path in folder.iterdir())


@POSIX
def test_a_second_run_is_refused_while_the_first_one_goes_on(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    """Nor does the first one's end take away what belongs to a later one."""
    path = job(tmp_path, steps=1)
    folder = tmp_path / "results"
    with Stream(folder, {}) as stream:
        stream.observe("begun")
        assert main(["run", "--quiet", str(path)]) == 2
        error = capsys.readouterr().err
        assert f"process {os.getpid()} still writes results to {folder}" in error
        assert "choose another output directory" in error
        assert main(["run", "--quiet", "--restart", str(path)]) == 2
        assert "still writes" in capsys.readouterr().err
        assert (folder / LOG).read_text() == '{"note": "begun"}\n'
    assert not folder.exists()
    assert main(["run", "--quiet", str(path)]) == 0
    assert lock.NAME not in names(folder)


@POSIX
def test_writing_from_python_takes_the_same_lock(tmp_path: Path) -> None:
    solution = abut.solve(load_job(job(tmp_path, steps=1)).model)
    folder = tmp_path / "a" / "b"
    with Stream(folder, {}), pytest.raises(abut.InputError, match=f"process {os.getpid()} still writes results to"):
        abut.write(solution, folder)
    assert not folder.parent.exists()
    abut.write(solution, folder)
    assert "summary.json" in names(folder)
    assert lock.NAME not in names(folder)


@POSIX
def test_the_lock_of_a_process_that_has_died_holds_nobody(tmp_path: Path) -> None:
    folder = tmp_path / "results"
    process = subprocess.Popen(
        [sys.executable, "-c", HOLDER, str(folder)], stdin=subprocess.PIPE, stdout=subprocess.PIPE
    )
    assert process.stdout is not None
    process.stdout.readline()
    with pytest.raises(abut.InputError, match=f"process {process.pid} still writes"):
        Lock(folder)
    process.kill()
    process.wait()
    process.stdout.close()
    assert names(folder) == [lock.NAME]
    Lock(folder).release(empty=True)
    assert names(folder) == []  # it was there before


@POSIX
def test_a_run_that_ends_leaves_the_directory_of_the_next_one(tmp_path: Path) -> None:
    """The next one has begun though the first one has not ended, as its lock was removed by hand."""
    folder = tmp_path / "a" / "b"
    first = Lock(folder)
    (folder / lock.NAME).unlink()
    second = Lock(folder)
    first.release(empty=True)
    assert folder.exists()
    second.release(empty=True)
    assert names(tmp_path / "a") == ["b"]  # the first one has made it


@POSIX
@pytest.mark.parametrize("name", [LOG, lock.NAME])
def test_links_are_not_followed(name: str, tmp_path: Path) -> None:
    path = job(tmp_path, steps=1)
    other = tmp_path / "other"
    other.write_text("mine")
    folder = tmp_path / "results"
    folder.mkdir()
    (folder / name).symlink_to(other)
    assert main(["run", "--quiet", str(path)]) == (0 if name == LOG else 2)
    assert other.read_text() == "mine"


NAMED = next(line for line in BALL.splitlines() if line.startswith("name = "))
PROBE = '\n[[probes]]\nname = "{}"\nat = [0, 0, 1]\n'


def test_a_run_with_fewer_steps_and_other_names(tmp_path: Path) -> None:
    """Results of the user's own stay."""
    first = BALL.replace(NAMED, 'name = "first"') + PROBE.format("one")
    assert main(["run", "--quiet", str(job(tmp_path, first, steps=3))]) == 0
    folder = tmp_path / "results"
    mine = ["probe_measured.csv", "fields.txt", "contact.vtu"]
    for name in mine:
        (folder / name).write_text("force,displacement\n")
    second = BALL.replace(NAMED, 'name = "second"') + PROBE.format("two")
    other = job(tmp_path / "other", second, steps=1)
    assert main(["run", "--quiet", str(other)]) == 0
    assert main(["run", "--quiet", str(other), "--output", str(folder)]) == 0
    assert names(folder) == sorted([*names(tmp_path / "other" / "results"), *mine])
    abut.write(abut.solve(load_job(job(tmp_path, first, steps=1)).model), folder)
    assert not [name for name in names(folder) if "second" in name or "two" in name]


def test_a_run_that_fails_moves_earlier_results_aside(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    """No report or summary of the one before is taken for its own, nor its restart data."""
    path = job(tmp_path, steps=2)
    assert main(["run", "--quiet", str(path)]) == 0
    folder = tmp_path / "results"
    before = names(folder)
    free = re.sub(r"\[\[supports\]\]\non = \"plane[^\[]*", "", BALL)
    assert free != BALL
    job(tmp_path, free, steps=2)
    assert main(["run", str(path)]) == SingularModelError.exit_status
    assert f"results of an earlier run are now in {folder / 'earlier'}" in capsys.readouterr().out
    assert names(folder) == ["earlier"]
    assert names(folder / "earlier") == before
    job(tmp_path, free, steps=3)
    assert main(["run", "--quiet", str(path)]) == SingularModelError.exit_status
    assert names(folder / "earlier") == before  # nothing came after them


def test_a_first_step_that_does_not_converge_ends_restart_data_of_an_earlier_run(tmp_path: Path) -> None:
    path = job(tmp_path)
    stop_in(path, 4)
    job(tmp_path, BALL, steps=1, max_iterations=1)
    assert main(["run", "--quiet", str(path)]) == 3
    folder = tmp_path / "results"
    assert len(json.loads((folder / "summary.json").read_text())["steps"]) == 1
    assert not (folder / FOLDER).exists()
    assert "fields_0002.vtu" not in names(folder)

"""What is printed never steers the terminal, nor fails for want of a sign, whatever names are in files."""

from __future__ import annotations

import ast
import io
import os
import subprocess
import sys
from pathlib import Path

import pytest

import abut
from abut.cli import main
from abut.cli.terminal import plain, show
from models.steps import BALL, job

NAMED = next(line for line in BALL.splitlines() if line.startswith("name = "))
STEERING = "\x1b[2J\x07\x9b31m\u202e"


def test_only_one_place_prints() -> None:
    for path in (Path(abut.__file__).parent / "cli").glob("*.py"):
        calls = (node for node in ast.walk(ast.parse(path.read_text())) if isinstance(node, ast.Call))
        prints = [call for call in calls if isinstance(call.func, ast.Name) and call.func.id == "print"]
        assert not prints or path.name == "terminal.py", f"{path}: use abut.cli.terminal.show"


@pytest.mark.parametrize(
    "arguments", [("run",), ("run", "--json"), ("check",), ("verify", "--swap"), ("run", "--restart")]
)
def test_names_do_not_steer(arguments: tuple[str, ...], tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    escaped = STEERING.encode("unicode_escape").decode().replace("\\x", "\\u00")
    path = job(tmp_path, BALL.replace(NAMED, f'name = "{escaped}"').replace("cells = 4", "cells = 2"), steps=1)
    command, *options = arguments
    main([command, str(path), *options])
    out, error = capsys.readouterr()
    assert "2J" in out + error or arguments[-1] == "--restart"
    assert all(sign not in out + error for sign in STEERING if sign not in "[2J31m")


def test_arguments_do_not_steer(capsys: pytest.CaptureFixture[str]) -> None:
    with pytest.raises(SystemExit):
        main(["run", "job.toml", f"--{STEERING}"])
    error = capsys.readouterr().err
    assert "2J" in error
    assert "\x1b" not in error


def test_what_an_output_does_not_know_is_written_out() -> None:
    raw = io.BytesIO()
    out = io.TextIOWrapper(raw, "ascii", write_through=True)
    show("Bohrung \u00f8 \udcff", file=out)
    assert raw.getvalue() == b"Bohrung \\xf8 \\udcff\n"
    assert plain("\u2028\u200f") == "\\u2028\\u200f"


@pytest.mark.skipif(sys.platform != "linux", reason="names of any bytes")
def test_files_whose_names_are_no_text(tmp_path: Path) -> None:
    """A job is solved and reported; a folder for results is refused before, as VTK could not write into it."""
    path = job(tmp_path, BALL.replace("cells = 4", "cells = 2"), steps=1).rename(
        tmp_path / os.fsdecode(b"\xff \x1b[2J.toml")
    )
    for folder, status in ("results", 0), (os.fsdecode(b"\xff"), 2):
        done = subprocess.run(
            [sys.executable, "-m", "abut", "run", str(path), "--output", str(tmp_path / folder)],
            capture_output=True, timeout=120, env={**os.environ, "PYTHONIOENCODING": "ascii"},
        )  # fmt: skip
        assert done.returncode == status
        assert b"\x1b" not in done.stdout + done.stderr
    assert b"cannot create the output directory" in done.stderr
    assert (tmp_path / "results" / "report.html").is_file()

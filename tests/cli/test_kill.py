"""kill -9 at any moment leaves whole files only, and what is left can be gone on from."""

from __future__ import annotations

import csv
import json
import os
import subprocess
import sys
from pathlib import Path
from xml.etree import ElementTree

import numpy as np
import pytest

from abut.cli import main
from models.steps import arrays, job

KILLS = 24

# One process imports everything and forks a child for each run, which is then killed after some delay: importing takes
# longer than running. Nothing numerical happens before a fork, so no threads are lost in it.
RUNNER = """
import os, random, signal, sys, time
import abut.analysis, abut.output.stream, abut.io.vtu, abut.job, abut.cli.run, vtkmodules.vtkIOXML
import vtkmodules.util.numpy_support
from abut.cli import main

folder, kills = sys.argv[1], int(sys.argv[2])
chance = random.Random(20010607)
began = time.monotonic()
def start(number):
    child = os.fork()
    if child:
        return child
    os._exit(main(["run", "--quiet", f"{folder}/job.toml", "--output", f"{folder}/{number}"]))
os.waitpid(start("whole"), 0)
duration = time.monotonic() - began
for number in range(kills):
    child = start(number)
    time.sleep(duration * chance.random())
    os.kill(child, signal.SIGKILL)
    os.waitpid(child, 0)
print(duration)
"""


def assert_whole(path: Path) -> None:
    """A file that parses to its end."""
    if path.suffix == ".vtu":
        assert any(name == "displacement" for name, _ in arrays(path))
    elif path.suffix == ".pvd":
        for entry in ElementTree.parse(path).iter("DataSet"):
            assert (path.parent / entry.attrib["file"]).is_file()
    elif path.suffix == ".json":
        assert json.loads(path.read_text())["status"] in ("incomplete", "converged")
    elif path.suffix == ".csv":
        rows = list(csv.reader(path.read_text().splitlines()))
        assert {len(row) for row in rows} == {len(rows[0])}
    elif path.suffix == ".npz":
        with np.load(path) as data:
            assert len(data["unknowns"])
    elif path.suffix == ".html":
        assert path.read_text(encoding="utf-8").rstrip().endswith("</html>")
    else:
        assert path.name in ("run.jsonl", "run.jsonl.part"), path
        text = path.read_text()
        assert not text or text.endswith("\n")
        assert all(json.loads(line) for line in text.splitlines())


@pytest.mark.long
@pytest.mark.skipif(not hasattr(os, "fork"), reason="needs fork")
def test_files_are_whole_after_kill(tmp_path: Path) -> None:
    path = job(tmp_path, steps=12)
    environment = {**os.environ, "OMP_NUM_THREADS": "1"}
    runner = [sys.executable, "-c", RUNNER, str(tmp_path), str(KILLS)]
    subprocess.run(runner, check=True, env=environment, timeout=300, capture_output=True)
    whole = json.loads((tmp_path / "whole" / "summary.json").read_text())
    broken = []  # number of steps done in each run that was killed on the way
    for number in range(KILLS):
        folder = tmp_path / str(number)
        for file in sorted(folder.rglob("*")) if folder.exists() else []:
            if file.is_file() and not file.name.startswith("."):
                assert_whole(file)
            elif file.is_file():
                assert ".tmp" in file.name
        summary = folder / "summary.json"
        if summary.exists() and len(done := json.loads(summary.read_text())["steps"]) < 12:
            broken.append((len(done), number))
    assert len(broken) > KILLS // 4, "the delays no longer hit the run"
    _, number = max(broken)
    folder = tmp_path / str(number)
    (folder / ".fields_0001.vtu.999999999.tmp.vtu").write_text("left behind")
    restarted = main(["run", "--quiet", "--restart", str(path), "--output", str(folder)])
    assert restarted == 0
    assert not [p.name for p in folder.iterdir() if p.name.startswith(".") or p.suffix == ".part"]
    done = json.loads((folder / "summary.json").read_text())["steps"]
    assert len(done) == 12
    for one, two in zip(whole["steps"], done):
        assert one["contacts"][0]["max_pressure"] == pytest.approx(two["contacts"][0]["max_pressure"], rel=1e-12)

"""Ctrl-C while the program starts: one line, exit status 130, nothing written."""

from __future__ import annotations

import os
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest

from models.steps import job

INSIDE_NUMPY = f"numpy.{'core' if np.__version__.startswith('1.') else '_core'}.multiarray"

# A module that is looked for sends the signal, as a hand that comes just then would.
SCRIPT = """
import os, runpy, signal, sys
module = sys.argv.pop(1)
signal.signal(signal.SIGINT, signal.default_int_handler)  # ignored where the tests run in the background of a shell
class Hand:
    def find_spec(self, name, *_):
        if name == module:
            os.kill(os.getpid(), signal.SIGINT)
sys.meta_path.insert(0, Hand())
runpy.run_module("abut", run_name="__main__")
"""


@pytest.mark.skipif(os.name != "posix", reason="signals as POSIX has them")
@pytest.mark.parametrize(
    "module", ["argparse", "abut.cli", "numpy", INSIDE_NUMPY, "scipy.sparse", "pydantic", "abut.analysis"]
)
def test_ctrl_c_during_imports(module: str, tmp_path: Path) -> None:
    command = [sys.executable, "-c", SCRIPT, module, "run", str(job(tmp_path))]
    done = subprocess.run(command, capture_output=True, text=True, timeout=120)
    assert (done.returncode, done.stdout, done.stderr) == (130, "", "abut: stopped\n")
    assert [path.name for path in tmp_path.iterdir()] == ["job.toml"]

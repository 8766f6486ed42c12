"""Tests on several processes: they need petsc4py, mpi4py and mpiexec, and are skipped where these are not (`make mpi` has
them, and fails where they are skipped)."""

from __future__ import annotations

import os
import subprocess
import sys
from collections.abc import Callable
from pathlib import Path

import pytest

from launcher import environment, missing

Run = Callable[..., subprocess.CompletedProcess[str]]
MISSING = missing()
if MISSING and os.environ.get("ABUT_MPI_TESTS") == "required":
    raise pytest.UsageError(MISSING)


class Skipped(pytest.Module):
    """A test file that is not even imported."""

    def collect(self) -> list[pytest.Item]:
        pytest.skip(MISSING.splitlines()[0], allow_module_level=True)


def pytest_pycollect_makemodule(module_path: Path, parent: pytest.Collector) -> pytest.Module | None:
    return Skipped.from_parent(parent, path=module_path) if MISSING else None


@pytest.fixture(scope="session")
def mpirun() -> Run:
    """mpirun(n, "run", "job.toml", ...): abut on n processes, as its result with text; ``timeout`` in seconds, ``program``
    in place of ("-m", "abut.cli"); further names are environment variables."""

    def start(
        n: int,
        *arguments: str | Path,
        timeout: float = 120.0,
        program: tuple[str, ...] = ("-m", "abut.cli"),
        **more: str,
    ) -> subprocess.CompletedProcess[str]:
        command = ["mpiexec", "-n", str(n), sys.executable, *program, *map(str, arguments)]
        pipe = subprocess.PIPE
        process = subprocess.Popen(command, stdout=pipe, stderr=pipe, text=True, env=environment(**more))
        try:
            out, error = process.communicate(timeout=timeout)
        except subprocess.TimeoutExpired:
            process.terminate()  # unlike kill, mpiexec then ends its processes
            out, error = process.communicate(timeout=30.0)
            raise AssertionError(f"{command} took longer than {timeout} s\n{out}\n{error}") from None
        return subprocess.CompletedProcess(command, process.returncode, out, error)

    return start

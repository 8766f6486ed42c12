"""Run a command in a process of its own: on some of the cores, within limits of time and memory, and measure it."""

from __future__ import annotations

import json
import os
import re
import signal
import subprocess
import sys
import time
from dataclasses import dataclass
from pathlib import Path
from typing import Any

THREADS = ("OMP_NUM_THREADS", "MKL_NUM_THREADS", "OPENBLAS_NUM_THREADS")
MAXRSS = 2**10 if sys.platform == "linux" else 1  # bytes in a unit of ru_maxrss
PAGE = os.sysconf("SC_PAGE_SIZE")
PATIENCE = 0.02  # seconds between looks at the child


@dataclass(frozen=True)
class Run:
    """What became of a child: ``status`` is "ok", "time limit", "memory limit" or "failed: ..."; ``output`` is all it
    printed; ``peak_mb`` and ``cpu`` (user and system seconds) are those of this child alone."""

    status: str
    output: str
    wall: float
    cpu: float
    peak_mb: float

    def json(self) -> dict[str, Any] | None:
        """The last line that is a JSON object, if any."""
        for line in reversed(self.output.splitlines()):
            if line.startswith("{"):
                try:
                    return dict(json.loads(line))
                except ValueError:
                    return None
        return None


def memory_of_machine() -> float:
    """Bytes of main memory."""
    return float(os.sysconf("SC_PHYS_PAGES")) * PAGE


def available_cores() -> list[int]:
    """Cores this process may use."""
    if hasattr(os, "sched_getaffinity"):
        return sorted(os.sched_getaffinity(0))
    return list(range(os.cpu_count() or 1))


def run(
    command: list[str],
    folder: Path,
    cores: list[int],
    limit: float,
    memory: float,
    environment: dict[str, str] | None = None,
) -> Run:
    """Run ``command`` in ``folder`` on ``cores`` for ``limit`` seconds and ``memory`` bytes at most.

    Peak memory is the child's own: the caller must be small, since Linux counts what the parent holds at the fork.
    """
    environment = {**(environment or os.environ), **dict.fromkeys(THREADS, str(len(cores)))}
    before = available_cores()
    if hasattr(os, "sched_setaffinity"):
        os.sched_setaffinity(0, cores)
    log = folder / "output.txt"
    start = time.perf_counter()
    try:
        with log.open("wb") as file:
            child = subprocess.Popen(
                command, cwd=folder, env=environment, stdout=file, stderr=subprocess.STDOUT, start_new_session=True
            )
    finally:
        if hasattr(os, "sched_setaffinity"):
            os.sched_setaffinity(0, before)
    reason = ""
    try:
        while True:
            pid, code, usage = os.wait4(child.pid, os.WNOHANG)
            wall = time.perf_counter() - start
            if pid:
                break
            if not reason:
                reason = "time limit" if wall > limit else "memory limit" if _resident(child.pid) > memory else ""
                if reason:
                    os.killpg(child.pid, signal.SIGKILL)
            time.sleep(PATIENCE)
    except BaseException:
        os.killpg(child.pid, signal.SIGKILL)
        raise
    child.returncode = os.waitstatus_to_exitcode(code)
    output = log.read_text(encoding="utf-8", errors="replace")
    status = reason or ("ok" if child.returncode == 0 else f"failed: {_death(child.returncode, output)}")
    return Run(status, output, wall, usage.ru_utime + usage.ru_stime, usage.ru_maxrss * MAXRSS / 1e6)


def _resident(pid: int) -> float:
    """Bytes a process holds now; 0 where the system does not tell."""
    try:
        return float(Path(f"/proc/{pid}/statm").read_text(encoding="ascii").split()[1]) * PAGE
    except (OSError, IndexError):
        return 0.0


def _death(code: int, output: str) -> str:
    """Why a child died, in few words."""
    if code < 0:
        return signal.Signals(-code).name
    errors = [line.strip(" *") for line in output.splitlines() if re.search("error", line, re.IGNORECASE)]
    return errors[-1][:100] if errors else f"exit status {code}"

"""Where a job starts: from the undeformed mesh, or from the steps of another one."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path


@dataclass(frozen=True)
class Start:
    """The results of another job that a job starts from, and the share of its time at which they end."""

    results: Path
    share: float

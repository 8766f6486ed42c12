"""Findings of `abut check`, and its report."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from abut import checks
from abut.errors import AbutError

SEVERITIES = ("error", "warning", "advice", "info")
SOUND, BAD_INPUT = 0, 2


@dataclass(frozen=True)
class Finding:
    """severity: error (the run fails or its result is useless), warning (the result may be wrong), advice (a change would
    improve it) or info; what, where, and the cure: how to correct it, may be empty; details: further
    lines; status: exit status that an error stands for.
    """

    severity: str
    where: str
    what: str
    cure: str = ""
    details: tuple[str, ...] = ()
    status: int = BAD_INPUT

    def __post_init__(self) -> None:
        checks.choice(self.severity, "finding.severity", SEVERITIES)

    @property
    def line(self) -> str:
        """The finding in one line."""
        return f"{self.where}: {self.what}{'; ' if self.cure else ''}{self.cure}"


@dataclass(frozen=True)
class Motion:
    """A rigid-body mode that supports leave free: in words, what constrains it ("contact" or "nothing"), displacement
    (n_points, dim), a tenth of the body's size."""

    text: str
    resisted_by: str
    displacement: NDArray[np.float64]


@dataclass(frozen=True)
class Report:
    """All findings, the gravest first, and the rigid-body modes that supports leave free."""

    findings: tuple[Finding, ...]
    motions: tuple[Motion, ...] = ()

    @property
    def status(self) -> int:
        """Exit status: 0 no errors (warnings are for the reader), 2 or 4, the graver one, with errors."""
        errors = [f.status for f in self.findings if f.severity == "error"]
        return max(errors, default=SOUND)

    def count(self, severity: str) -> int:
        return sum(f.severity == severity for f in self.findings)


def in_order(findings: Sequence[Finding]) -> tuple[Finding, ...]:
    """The gravest first."""
    return tuple(sorted(findings, key=lambda finding: SEVERITIES.index(finding.severity)))


def from_error(error: AbutError, where: str) -> Finding:
    """What an error of abut says, as a finding; its message ends in the cure and may begin with a place in ``where``."""
    text = str(error)
    if text.startswith((f"{where}:", f"{where}.")):
        where, _, text = text.partition(": ")
    what, _, cure = text.rpartition("; ")
    return Finding("error", where, what or cure, cure if what else "", status=error.exit_status)

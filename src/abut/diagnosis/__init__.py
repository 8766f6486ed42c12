"""Checks of a model before it is solved, advice after: each finding with its remedy."""

from abut.diagnosis.examine import check
from abut.diagnosis.finding import Finding, Motion, Report, from_error

__all__ = ["Finding", "Motion", "Report", "check", "from_error"]

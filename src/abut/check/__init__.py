"""What is wrong with a model, and the cure, before it is solved."""

from abut.check.examine import check
from abut.check.finding import Finding, Motion, Report, from_error

__all__ = ["Finding", "Motion", "Report", "check", "from_error"]

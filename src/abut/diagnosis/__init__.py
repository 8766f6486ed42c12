"""What is wrong with a model, and the cure, before it is solved."""

from abut.diagnosis.examine import check
from abut.diagnosis.finding import Finding, Motion, Report, from_error

__all__ = ["Finding", "Motion", "Report", "check", "from_error"]

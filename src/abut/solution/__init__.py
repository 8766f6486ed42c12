"""What solving yields, as frozen records."""

from abut.solution.contacts import Check, ContactResult, PressureStatistics, Resultant
from abut.solution.progress import Iteration, Observer, Phase
from abut.solution.records import OnStep, ProbeResult, RigidResult, Saved, Solution, Step

__all__ = [
    "Check", "ContactResult", "Iteration", "Observer", "OnStep", "Phase", "PressureStatistics", "ProbeResult", "Resultant",
    "RigidResult", "Saved", "Solution", "Step",
]  # fmt: skip

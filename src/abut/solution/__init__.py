"""Results, as frozen records."""

from abut.solution.connectors import ConnectorResult
from abut.solution.contacts import Check, ContactResult, FrictionResult, PressureStatistics, Resultant
from abut.solution.energy import Energy
from abut.solution.flow import Flow
from abut.solution.modes import ModesResult
from abut.solution.penetrations import PenetrationResult
from abut.solution.preloads import PreloadResult
from abut.solution.progress import Iteration, Observer, Phase
from abut.solution.records import Flips, OnStep, ProbeResult, RigidResult, Saved, SavedPart, Solution, Step
from abut.solution.responses import ResponseAt, ResponseResult
from abut.solution.state import History, Largest, State

__all__ = [
    "Check", "ConnectorResult", "ContactResult", "Energy", "Flips", "Flow", "FrictionResult", "History", "Iteration",
    "Largest", "ModesResult", "Observer", "OnStep", "PenetrationResult", "Phase", "PreloadResult", "PressureStatistics",
    "ProbeResult", "ResponseAt", "ResponseResult", "Resultant", "RigidResult", "Saved", "SavedPart", "Solution", "State",
    "Step",
]  # fmt: skip

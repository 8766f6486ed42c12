"""What materials remember at the end of a load step."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from abut.analysis.initial_stress import initial_stress
from abut.bodies.evaluation import History
from abut.bodies.history_fields import integral, largest, names, nodal
from abut.bodies.solids import Solids
from abut.materials.plastic import EQUIVALENT, WORK
from abut.solution import Step
from abut.solution.flow import Flow


def remembered(solids: Solids, history: History, before: Sequence[Step]) -> dict[str, NDArray[np.float64]]:
    """Of all materials at the points, by name; and the stress that they had at the outset. before: the steps so far."""
    since = {name: nodal(solids, history, name) for name in names(solids)} if history else {}
    return {**since, **initial_stress(solids, before)}


def flow(solids: Solids, history: History) -> Flow | None:
    """How far bodies have yielded; None where no material does."""
    if EQUIVALENT not in names(solids) or not history:
        return None
    most, cell = largest(solids, history, EQUIVALENT)
    if cell < 0:
        return Flow(0.0, "", np.zeros(solids.mesh.dim), 0.0)
    body = list(solids.materials)[solids.body_of[cell]]
    block = int(np.searchsorted(solids.mesh.starts, cell, side="right")) - 1
    nodes = solids.mesh.blocks[block].nodes[cell - solids.mesh.starts[block]]
    return Flow(most, body, solids.points[nodes].mean(axis=0), integral(solids, history, WORK))

"""What resists rigid motions of a model: supports, contact, springs, and supports that come or go."""

from __future__ import annotations

from collections.abc import Sequence

from abut.model import Model
from abut.problem.connectors import Connectors
from abut.problem.constraints import Constraints
from abut.problem.dashpots import Dashpots
from abut.problem.holds import Holds
from abut.problem.pair import Pair
from abut.problem.restraint import Restraint, helped, restraint
from abut.problem.springs import Springs


def all_restraint(model: Model, constraints: Constraints, pairs: Sequence[Pair]) -> Restraint:
    """Of supports and ``pairs``, helped by springs, dashpots, holds and connectors, as a run has it."""
    joined = Connectors.of(model, constraints.bodies)
    return helped(
        restraint(model.mesh, constraints, pairs), (Springs.of(model), Dashpots.of(model), Holds.of(model), joined)
    )

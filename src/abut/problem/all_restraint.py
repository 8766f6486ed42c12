"""What resists rigid motions of a model: supports, contact, springs, and supports that come or go."""

from __future__ import annotations

from collections.abc import Sequence

from abut.model import Model
from abut.problem.constraints import Constraints
from abut.problem.holds import Holds
from abut.problem.pair import Pair
from abut.problem.restraint import Restraint, restraint
from abut.problem.springs import Springs


def all_restraint(model: Model, constraints: Constraints, pairs: Sequence[Pair]) -> Restraint:
    """Of supports and ``pairs``, helped by springs and holds; one for the run and for the check before it."""
    result = restraint(model.mesh, constraints, pairs)
    for helps in (Springs.of(model), Holds.of(model)):
        if helps is not None:
            result = result.helped_by(helps.resistance(result.rigid.modes))
    return result

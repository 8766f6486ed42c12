"""Steps of another job in the unknowns of a job with other supports: found again from the displacements of all points."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from abut.analysis.step_records import TAKEN, check_order
from abut.errors import InputError
from abut.model import Model
from abut.model.conditions import weights
from abut.problem.constraints import Constraints, supports
from abut.problem.contact_pairs import pairs
from abut.solution import Saved
from abut.solution.state import State


def taken_up(resume: Sequence[Saved], model: Model) -> Sequence[Saved]:
    """Records of steps, those of another job in the unknowns that the supports of ``model`` leave. Raises InputError where
    supports hold points elsewhere than they were."""
    if not any(saved.taken for saved in resume):
        return resume
    constraints = supports(model)
    return [_taken(saved, model, constraints) for saved in resume]


def require_fit(resume: Sequence[Saved], model: Model) -> None:
    """Raise InputError unless the steps of another job can be those of ``model``, but for the balance of forces, which only
    the run knows."""
    constraints = supports(model)
    found = [_taken(saved, model, constraints) for saved in resume]
    check_order(found, int(constraints.free.shape[1]), sum(map(len, pairs(model, constraints))))


def _taken(saved: Saved, model: Model, constraints: Constraints) -> Saved:
    parts = tuple(
        replace(part, state=_found(part.state, part.displacement, saved.number, model, constraints))
        for part in saved.parts
    )
    state = _found(saved.state, saved.displacement, saved.number, model, constraints)
    return replace(saved, state=state, parts=parts)


def _found(
    state: State, displacement: NDArray[np.float64] | None, number: int, model: Model, constraints: Constraints
) -> State:
    """The state with the free displacements that give ``displacement`` (dim n_points,); None: files written without, whose
    supports must be the same."""
    if displacement is None:
        return state
    if len(displacement) != constraints.free.shape[0]:
        raise InputError(
            f"start: step {number} of the job before has no displacements of this mesh; run that job again"
        )
    given = constraints.prescribed @ weights(model.histories, state.time)
    free = constraints.coordinates((displacement - given)[:, None])[:, 0]
    off = np.abs(constraints.free @ free + given - displacement).reshape(-1, model.dim).max(axis=1)
    if off.max(initial=0.0) > TAKEN * np.abs(displacement).max(initial=0.0):
        raise InputError(
            f"start: supports of this job put points up to {off.max():.3g} from where step {number} of the job before has "
            f"them: {_named(off, model)}; a support acts from the start, at zero where its amplitude is: give it "
            "values that pass through these displacements, or make it a hold that acts since the end of the job before"
        )
    return replace(state, unknowns=free)


def _named(off: NDArray[np.float64], model: Model) -> str:
    """The supports that are off, by what they are on; off: (n_points,)."""
    far = off > 0.5 * off.max()
    names = dict.fromkeys(s.on for s in model.supports if far[model.mesh.nodes_of(s.on)].any())
    return ", ".join(f"'{name}'" for name in names) or "points on the axis"

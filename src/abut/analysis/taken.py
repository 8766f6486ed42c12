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
from abut.problem.assembly import prescribed
from abut.problem.constraints import Constraints
from abut.problem.contact_pairs import pairs
from abut.problem.finite_pairs import finite_pairs
from abut.problem.rigid_bodies import rigid_bodies
from abut.solution import Saved
from abut.solution.state import State


def taken_up(resume: Sequence[Saved], model: Model) -> Sequence[Saved]:
    """Records of steps, those of another job in the unknowns that the supports of ``model`` leave. Raises InputError where
    supports hold points elsewhere than they were."""
    if not any(saved.taken for saved in resume):
        return resume
    constraints, _ = prescribed(model)
    return [_taken(saved, model, constraints) for saved in resume]


def require_fit(resume: Sequence[Saved], model: Model) -> None:
    """Raise InputError unless the steps of another job can be those of ``model``, but for the balance of forces, which only
    the run knows."""
    constraints, _ = prescribed(model)
    found = [_taken(saved, model, constraints) for saved in resume]
    made = finite_pairs(model, constraints) if model.finite else pairs(model, constraints)
    check_order(found, int(constraints.free.shape[1]), sum(map(len, made)))


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
    """The state with the free displacements that give ``displacement`` (dim n_points,), as in ``Saved``."""
    if displacement is None or len(displacement) != constraints.free.shape[0]:
        raise InputError(
            f"start: step {number} of the job before has no displacements of this mesh; run that job again"
        )
    given = constraints.prescribed @ weights(model.histories, state.time)
    free = constraints.coordinates((displacement - given)[:, None])[:, 0]
    if constraints.others is not None:  # forces of connectors, as they are
        count = constraints.others.free.nnz
        free[len(free) - count :] = state.unknowns[len(state.unknowns) - count :]
    off = np.abs(constraints.free @ free + given - displacement).reshape(-1, model.dim).max(axis=1)
    if off.max(initial=0.0) > TAKEN * np.abs(displacement).max(initial=0.0):
        raise InputError(
            f"start: supports of this job put points up to {off.max():.3g} from where step {number} of the job before has "
            f"them: {_named(off, model)}; a support acts from the start, at zero where its amplitude is: give it "
            "values that pass through these displacements, or make it a hold that acts since the end of the job before"
        )
    drag = state.history.drag
    if drag is not None and len(drag) != len(free):
        raise InputError(
            f"start: step {number} of the job before was reached under a drag, and this job has other supports; give it "
            "the same ones, or that job more load steps"
        )
    return replace(state, unknowns=free)


def _named(off: NDArray[np.float64], model: Model) -> str:
    """The supports that are off, by what they are on, rigid bodies and couplings; off: (n_points,)."""
    far = off > 0.5 * off.max()
    names = dict.fromkeys(s.on for s in model.supports if far[model.mesh.nodes_of(s.on)].any())
    bodies = rigid_bodies(model)
    names |= dict.fromkeys(body.name for body in bodies if far[body.nodes].any())
    return ", ".join(f"'{name}'" for name in names) or "points on the axis"

"""Loads that no equilibrium carries, or hardly one: what to say of steps that fail, or shrink, while metal flows."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from abut.analysis.flow import flow
from abut.materials.material import history_fields
from abut.materials.plastic import EQUIVALENT
from abut.model import Model
from abut.model.conditions import weights
from abut.nonlinear.attempt import Attempt
from abut.problem.assembly import Assembled
from abut.solution import Step
from abut.solution.flow import Flow, LimitLoad

SUM = 1e-9  # of forces over the sum of their sizes that is none
GROWN = 2.0  # how many times the plastic strain so far a step flows that has no limit, theory (Y13)
SHRUNK = 0.25  # of a step, which was not found in longer parts


def yields(model: Model) -> bool:
    """Whether metal of a model may flow."""
    return any(EQUIVALENT in history_fields(solid.material) for solid in model.solids)


def limit_load(assembled: Assembled, steps: Sequence[Step], failed: Attempt) -> LimitLoad | None:
    """What to say of an attempt that failed, the shortest one, after converged steps, theory (Y13): where metal flows more
    in it than in all of these. Nothing where it does not, or where nothing is loaded.

    Raises Inverted for a state in which cells are inside out."""
    model, time = assembled.problem.model, steps[-1].factor if steps else 0.0
    forces = np.asarray(assembled.loaded.forces @ weights(model.histories, time)).reshape(model.mesh.points.shape)
    if not yields(model) or not model.loads:
        return None
    before, now = steps[-1].flow if steps else None, _flow(assembled, failed)
    if now is None or not now.largest > GROWN * (0.0 if before is None else before.largest):
        return None
    where = (
        f"{_place(model.solve.time(time), forces, now)}, and no load step from there to "
        f"{model.solve.time(failed.time):.5g} or beyond finds an equilibrium"
    )
    return LimitLoad(1.0 - time / model.ends[-1], where)


def near_limit(assembled: Assembled, steps: Sequence[Step], times: Sequence[float]) -> LimitLoad | None:
    """The same of a run whose last step was found, but in parts that had to shrink: where more has flowed in it than in all
    before. steps: all of them; times: ends of the parts of the last one."""
    model = assembled.problem.model
    if len(steps) < 2 or not yields(model) or not model.loads:
        return None
    before, now, begun = steps[-2].flow, steps[-1].flow, steps[-2].factor
    if before is None or now is None or not now.largest > GROWN * before.largest > 0.0:
        return None
    shortest = float(np.diff([begun, *times]).min())
    if shortest > SHRUNK * (times[-1] - begun):
        return None
    forces = np.asarray(assembled.loaded.forces @ weights(model.histories, times[-1])).reshape(model.mesh.points.shape)
    parts = f"in steps down to {model.solve.time(shortest):.2g}"
    so_far = f"{now.largest:.3g} after {before.largest:.3g} at time {steps[-2].time:.5g}, {parts}"
    return LimitLoad(0.0, f"{_place(model.solve.time(times[-1]), forces, now)}, {so_far}")


def _place(time: float, forces: NDArray[np.float64], now: Flow) -> str:
    at, sums = (", ".join(f"{value:.5g}" for value in x) for x in (now.place, forces.sum(axis=0)))
    of_all = f" (sum of nodal forces ({sums}))" if np.abs(forces.sum(axis=0)).max() > SUM * np.abs(forces).sum() else ""
    return f"limit load near time {time:.5g}{of_all}: metal flows, most in '{now.body}' at ({at})"


def _flow(assembled: Assembled, attempt: Attempt) -> Flow | None:
    """In the last state of an attempt that failed, whose own history is still the one before."""
    problem, bodies, state = assembled.problem, assembled.bodies, attempt.reached or attempt.state
    motion = problem.motion(state.time, problem.values(state))
    motion = replace(motion, history=state.history.of(bodies.name), displacement=problem.displacement(state))
    return flow(problem.model.deformable, bodies.evaluate(motion, motion).history)

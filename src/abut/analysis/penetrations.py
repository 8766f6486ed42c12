"""Results of pressure penetration at the end of a step."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from abut.bodies.loads import area_weights
from abut.problem.discretised import Discretised
from abut.problem.fluid_frames import fluids
from abut.problem.wetting import TERM
from abut.solution.penetrations import PenetrationResult
from abut.solution.state import State
from abut.types import Array

FLUID = "fluid_pressure"  # name of the field at nodes


def penetration_results(problem: Discretised, state: State, displacement: Array) -> dict[str, PenetrationResult]:
    """Of all fluids by name; displacement: (dim n_points,)."""
    term, points = fluids(problem), problem.model.mesh.points
    if term is None:
        return {}
    points = points + displacement.reshape(points.shape) if problem.model.finite else points
    found = {}
    for i, (wetting, wet) in enumerate(zip(term.wettings, term.begun(state.history.of(TERM)))):
        area = area_weights(replace(term.pairs[i].contactor, points=points))
        forces = [force.reshape(points.shape).sum(axis=0) for force, _ in term.on_sides(i, wet, state.time, points)]
        wetted = float(area @ wet.shares[:, 0])
        pressure = wetting.penetration.pressure(state.time)
        found[wetting.penetration.name] = PenetrationResult(pressure, wetted, wetted / float(area.sum()), *forces)
    return found


def fluid_fields(problem: Discretised, state: State) -> dict[str, Array]:
    """The pressure of fluids at nodes, (n_points,), without what carrying it to the target overshoots; empty without any."""
    term = fluids(problem)
    if term is None:
        return {}
    wets = term.begun(state.history.of(TERM))
    every = [
        w.penetration.pressure(state.time) * np.clip(wet.shares.max(axis=1), 0.0, 1.0)
        for w, wet in zip(term.wettings, wets)
    ]
    return {FLUID: np.max(every, axis=0)}

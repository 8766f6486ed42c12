"""Fields at nodes beside displacements and stresses."""

from __future__ import annotations

from abut.analysis.penetrations import fluid_fields
from abut.dofs import DISPLACEMENT
from abut.problem.discretised import Discretised
from abut.problem.terms import Motion
from abut.solution.state import State
from abut.types import Array


def node_fields(problem: Discretised, motion: Motion, state: State) -> dict[str, Array]:
    """By name, (n_points,) or (n_points, components): those of other physics, and the pressure of fluids in
    contacts; velocities and accelerations of points."""
    at_nodes = [field.name for field in problem.model.dofs.fields if field.at == "nodes"]
    others = {k: v[:, 0] if v.shape[1] == 1 else v for k, v in motion.fields.items() if k in at_nodes}
    return {**others, **_rates(problem, state), **fluid_fields(problem, state)}


def _rates(problem: Discretised, state: State) -> dict[str, Array]:
    if state.rates is None:
        return {}
    rates = {"velocity": state.rates.velocities, "acceleration": state.rates.accelerations}
    return {name: problem.model.dofs.named(values)[DISPLACEMENT] for name, values in rates.items()}

"""Fields at nodes beside displacements and stresses."""

from __future__ import annotations

from abut.analysis.penetrations import fluid_fields
from abut.problem.discretised import Discretised
from abut.problem.terms import Motion
from abut.solution.state import State
from abut.types import Array


def node_fields(problem: Discretised, motion: Motion, state: State) -> dict[str, Array]:
    """By name, (n_points,) or (n_points, components): those of other physics, and the pressure of fluids in contacts."""
    at_nodes = [field.name for field in problem.model.dofs.fields if field.at == "nodes"]
    others = {k: v[:, 0] if v.shape[1] == 1 else v for k, v in motion.fields.items() if k in at_nodes}
    return {**others, **fluid_fields(problem, state)}

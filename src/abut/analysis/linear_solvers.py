"""The bodies and the linear solver of a run, on one process or many."""

from __future__ import annotations

from collections.abc import Callable
from typing import TYPE_CHECKING

from abut.errors import InputError
from abut.linear.choice import Direct, choose
from abut.linear.cost_model import of_stiffness, preparing
from abut.linear.iterative import Multigrid
from abut.linear.solver import Count, LinearSolver
from abut.model import Model
from abut.problem.backend import Backend, serial
from abut.problem.clock import Clock
from abut.problem.problem import ContactProblem
from abut.solution import Observer, Phase

if TYPE_CHECKING:
    from abut.parallel.team import Team


def assembled_bodies(
    model: Model, observe: Observer, note: Callable[[str], None], clock: Clock, team: Team | None
) -> Backend:
    """The stiffness of a model's bodies, assembled here or by a team. Raises InputError for bodies that go and come, which a
    team does not know."""
    if team is not None and model.removals:
        raise InputError("removals: bodies that go and come are solved on one process; start one only")
    if team is None:
        observe(Phase("assembling the stiffness"))
        return serial(model)
    from abut.parallel.backend import deal_out

    observe(Phase(f"partitioning the mesh over {team.size} processes"))
    parts = deal_out(model, team)
    note(parts.summary)
    clock.mark("partition")
    observe(Phase("assembling the stiffness"))
    return parts.assembled()


def solver_kind(problem: ContactProblem, team: Team | None) -> str:
    """ "direct" or "amg": what the user asked for, or what size and abilities of the solvers suggest. Raises InputError."""
    if problem.model.physics or problem.model.connectors or problem.model.removals:
        return "direct"
    if team is None:
        return choose(problem.model.solve.linear, problem)
    from abut.parallel.linear import choose as choose_petsc

    return choose_petsc(problem)


def linear_solver(kind: str, problem: ContactProblem, team: Team | None) -> LinearSolver:
    """kind: as from ``solver_kind``."""
    if team is None:
        return Direct() if kind == "direct" else Multigrid(problem, Count())
    from abut.parallel.linear import PetscDirect, PetscIterations

    return PetscDirect() if kind == "direct" else PetscIterations(problem, Count())


def setting_up(solver: LinearSolver, problem: ContactProblem) -> tuple[str, float]:
    """What setting a solver up is, and about how many seconds it takes."""
    kind, model = "direct" if solver.count is None else "amg", problem.model
    what = "factorising" if kind == "direct" else "setting up multigrid for"
    size = f"{problem.n_free:,}".replace(",", " ")
    return f"{what} {size} displacements", preparing(
        of_stiffness(model.mesh, problem.n_free, model.integrations.wide), kind
    )

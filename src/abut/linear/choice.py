"""Which linear solver serves a problem: static condensation, direct solution of the saddle point, or multigrid with Krylov
iterations."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from importlib.util import find_spec

import numpy as np

from abut.cells import CELLS
from abut.errors import InputError
from abut.linear.cost_model import LARGE, LARGE_FINITE
from abut.linear.dense import Dense, dense
from abut.linear.direct import solver_name
from abut.linear.foresight import foresight
from abut.linear.multigrid import wide
from abut.linear.repeated import Repeated
from abut.linear.saddle_point import SaddlePoint
from abut.linear.schur_preconditioner import half_spaces, interfaces
from abut.linear.solver import Prepared
from abut.linear.static_condensation import condense
from abut.mesh.mesh import Mesh
from abut.mesh.one_layer import one_layer
from abut.problem.linearised import Linearised
from abut.problem.pair import Pair
from abut.problem.problem import ContactProblem, Problem

MANY = 200  # displacements that move many points each, from which on multigrid no longer pays


def choose(linear: str, problem: ContactProblem) -> str:
    """ "direct" or "amg" for what the user asked for; "auto" goes by size, and by what multigrid can do. In plates and
    shells, one cell thick, factors stay small, and thin cells are not for multigrid; continuous pressures make it
    converge slowly, if at all. Raises InputError where "amg" cannot serve the problem."""
    sizes = LARGE_FINITE if problem.model.finite else LARGE
    constraints, mesh = problem.constraints, problem.model.mesh
    many = constraints.coupled and int(wide(constraints.free, mesh.dim).sum()) > MANY
    solids = problem.model.deformable
    unfit = many or one_layer(mesh, solids.body_of >= 0) or solids.pressures is not None
    return chosen(linear, problem.n_free, problem.pairs, mesh, unfit, sizes)


def chosen(
    linear: str, n_free: int, pairs: Sequence[Pair], mesh: Mesh, unfit: bool, sizes: Mapping[int, int] = LARGE
) -> str:
    """The same from the number of free displacements and the contact pairs; unfit: for multigrid, as in ``choose``; sizes:
    from where on multigrid wins."""
    smooth = [pair.contact.name for pair in pairs if pair.smooth and pair.frictional]
    if linear == "amg" and smooth:
        raise InputError(
            f"solve.linear: \"amg\" knows friction by Coulomb's law alone, and contact '{smooth[0]}' has the constraint "
            'function for it; choose "direct" or "auto", or law "complementarity"'
        )
    if linear != "auto":
        return linear
    degree = max(CELLS[block.kind].degree for block in mesh.blocks)
    large = mesh.dim == 3 and n_free >= sizes[degree]
    able = not (unfit or smooth) and find_spec("pyamg") is not None and not any(pair.redundant for pair in pairs)
    return "amg" if large and able else "direct"


@dataclass(frozen=True)
class Direct:
    """As ``abut.linear.solver.LinearSolver``: static condensation where the interface is small enough, else the saddle
    point. repeated: the factors that a finite deformation keeps from one iteration to the next."""

    count: None = None
    repeated: Repeated = field(default_factory=Repeated, compare=False)

    @property
    def name(self) -> str:
        return f"direct ({solver_name()})"

    def condensed(self, problem: Problem) -> Problem:
        """The problem with displacements eliminated, where that is of use, as in ``LinearSolver``."""
        return (condense(problem) if isinstance(problem, ContactProblem) else None) or problem

    def prepare(self, system: Linearised, previous: Prepared | None) -> Prepared:
        """Set up for a linearised problem, as in ``LinearSolver``."""
        if isinstance(previous, Dense | SaddlePoint) and previous.system.same_matrices(system):
            return replace(previous, system=system)
        if system.compliance is not None:
            return dense(system)
        pairs = system.pairs
        moved = np.asarray(system.operator @ system.motions)
        return SaddlePoint(system, foresight(lambda: half_spaces(interfaces(pairs)), moved), repeated=self.repeated)

    def note(self, prepared: Prepared) -> str:
        """What is told of it, as in ``LinearSolver``."""
        if prepared.system.compliance is None:
            return f"direct solver {solver_name()}"
        kept = len(prepared.system.load)
        return f"direct solver {solver_name()}; displacements condensed ({kept} retained), dense interface system"

    @property
    def effort(self) -> str:
        """What is told of its work, as in ``LinearSolver``."""
        done = self.repeated
        if not done.factorisations:
            return ""
        analyses = "one symbolic analysis" if done.analyses == 1 else f"{done.analyses} symbolic analyses"
        return f"{done.factorisations} factorisations in all, with {analyses}"

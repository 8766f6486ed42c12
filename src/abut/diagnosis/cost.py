"""Cost of a run, estimated before it is solved: solver, memory and time."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from importlib.util import find_spec

from abut.bodies.factor_memory import MEMORY, MEMORY_LAYER, with_wide
from abut.cells import CELLS
from abut.diagnosis.finding import Finding
from abut.linear.choice import chosen
from abut.linear.cost_model import (
    LARGE,
    LARGE_FINITE,
    LARGE_ON_MANY,
    effort,
    seconds,
    share_of,
    typical_steps,
)
from abut.linear.direct import available_memory
from abut.mesh.one_layer import one_layer
from abut.model import Model
from abut.problem.constraints import Constraints
from abut.problem.pair import Pair


@dataclass(frozen=True)
class Foreseen:
    """solver: "direct" or "amg"; stages: seconds of each on one core; megabytes."""

    solver: str
    stages: dict[str, float]
    megabytes: float

    @property
    def seconds(self) -> float:
        return sum(self.stages.values())


def foresee(model: Model, constraints: Constraints, pairs: Sequence[Pair]) -> Foreseen:
    """What a run will need: seconds mostly within a factor of two, of a typical number of load steps where these are found
    on the way; memory of two or three."""
    n = int(constraints.free.shape[1])
    petsc = model.solve.linear == "petsc"
    sizes = LARGE_ON_MANY if petsc else LARGE_FINITE if model.finite else LARGE
    thin = one_layer(model.mesh, model.deformable.body_of >= 0)
    shared = model.deformable.pressures is not None
    unfit = (constraints.coupled if petsc else thin) or shared
    solver = chosen("auto" if petsc else model.solve.linear, n, pairs, model.mesh, unfit, sizes)
    degree = max(CELLS[block.kind].degree for block in model.mesh.blocks)
    memory = MEMORY[model.dim, "direct" if model.dim == 2 else solver, degree]
    if thin and solver == "direct":
        memory = MEMORY_LAYER
    share = share_of(model.mesh, model.integrations.wide) if solver == "direct" else 0.0
    return Foreseen(solver, seconds(effort(model, n, pairs), solver), with_wide(memory, n, share))


def cost(model: Model, constraints: Constraints, pairs: Sequence[Pair]) -> list[Finding]:
    """The linear solver that will be taken, and what it needs; a warning where that is more than the machine has."""
    n, petsc = int(constraints.free.shape[1]), model.solve.linear == "petsc"
    foreseen = foresee(model, constraints, pairs)
    solver, megabytes = foreseen.solver, foreseen.megabytes
    multipliers = sum(map(len, pairs))
    name, alone = (f"petsc ({solver})", "on one process ") if petsc else (solver, "")
    findings = [
        Finding(
            "info",
            "solve",
            f"{n} free displacements, {multipliers} multipliers; linear solver {name}: about "
            f"{_time(foreseen.seconds)} {alone}({_known(model)}) and {_memory(megabytes)}",
        )
    ]
    if petsc and find_spec("petsc4py") is None:
        findings.append(
            Finding(
                "warning",
                "solve",
                'linear = "petsc" needs petsc4py, which is not installed for this Python',
                "install it (docs/mpi.md), or take the line out",
            )
        )
    available = available_memory()
    if available is not None and 1e6 * megabytes > available:
        cure = 'choose linear = "amg"' if solver == "direct" and model.dim == 3 else "make the mesh coarser"
        findings.append(
            Finding(
                "warning",
                "solve",
                f"about {_memory(megabytes)} needed, {_memory(1e-6 * available)} free",
                f"{cure}, or take a larger machine",
            )
        )
    return findings


def _known(model: Model) -> str:
    steps = typical_steps(model)
    if steps != len(model.ends):
        easy = "where it is easy" if model.finite else "where contact does not slip"
        return f"for {steps} load steps; a run finds them, {easy} fewer"
    return "to a factor of two"


def _time(seconds: float) -> str:
    if seconds < 1.0:
        return "a second"
    return (
        f"{seconds:.2g} s" if seconds < 10.0 else f"{seconds:.0f} s" if seconds < 120.0 else f"{seconds / 60.0:.0f} min"
    )


def _memory(megabytes: float) -> str:
    return f"{megabytes:.0f} MB" if megabytes < 1000.0 else f"{megabytes / 1000.0:.1f} GB"

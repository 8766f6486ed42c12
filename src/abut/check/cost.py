"""What a run will take: solver, memory and time, from the number of unknowns.

Fitted to docs/performance.md (3D) and to measurements in docs/check.md (2D, quadratic cells): one core, one load step of
about five iterations. Good to a factor of two or three: enough to see whether a model fits.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from importlib.util import find_spec

from abut.cells import CELLS
from abut.check.finding import Finding
from abut.discretization.pairs import Pair
from abut.discretization.supports import Supports
from abut.model import Model
from abut.parallel.volume import LARGE as PETSC_LARGE
from abut.solvers.direct import available_memory
from abut.solvers.linear import LARGE, chosen


@dataclass(frozen=True)
class Law:
    """seconds = time n^time_power, megabytes = base + memory n^memory_power, for n free displacements."""

    time: float
    time_power: float
    memory: float
    memory_power: float
    base: float = 100.0


LAWS = {  # by dimension, solver and degree of the cells
    (2, "direct", 1): Law(3.3e-5, 1.0, 2.3e-3, 1.0),
    (2, "direct", 2): Law(4.2e-5, 1.0, 3.1e-3, 1.0),
    (3, "direct", 1): Law(6.8e-7, 1.4, 2.7e-4, 4 / 3),
    (3, "direct", 2): Law(3.3e-6, 1.4, 4.5e-4, 4 / 3),
    (3, "amg", 1): Law(6.7e-6, 1.12, 4.4e-3, 1.0, 60.0),
    (3, "amg", 2): Law(1.5e-5, 1.12, 1.0e-2, 1.0, 60.0),
}


def cost(model: Model, held: Supports, pairs: Sequence[Pair]) -> list[Finding]:
    """The linear solver that will be taken, and what it needs; a warning where that is more than the machine has."""
    n = int(held.free.shape[1])
    petsc = model.solve.linear == "petsc"
    sizes = PETSC_LARGE if petsc else LARGE
    solver = chosen("auto" if petsc else model.solve.linear, n, pairs, model.mesh, held.coupled, sizes)
    degree = max(CELLS[block.kind].degree for block in model.mesh.blocks)
    law = LAWS[model.dim, "direct" if model.dim == 2 else solver, degree]
    seconds, megabytes = law.time * n**law.time_power, law.base + law.memory * n**law.memory_power
    if model.solve.steps > 1 and solver == "amg":
        seconds *= model.solve.steps
    multipliers = sum(map(len, pairs))
    name, alone = (f"petsc ({solver})", "on one process ") if petsc else (solver, "")
    findings = [
        Finding(
            "info",
            "solve",
            f"{n} free displacements, {multipliers} multipliers; linear solver {name}: about "
            f"{_time(seconds)} and {_memory(megabytes)} {alone}(to a factor of two or three)",
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


def _time(seconds: float) -> str:
    if seconds < 1.0:
        return "a second"
    return f"{seconds:.0f} s" if seconds < 120.0 else f"{seconds / 60.0:.0f} min"


def _memory(megabytes: float) -> str:
    return f"{megabytes:.0f} MB" if megabytes < 1000.0 else f"{megabytes / 1000.0:.1f} GB"

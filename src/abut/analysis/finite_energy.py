"""Energy over a load step with finite kinematics, theory (G13): what forces do on the way between two converged states."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from abut.analysis.energy import NOTHING
from abut.analysis.jumps import has_potential, unexplained
from abut.problem.problem import ContactProblem
from abut.solution import ContactResult
from abut.solution.energy import ENERGY, Energy
from abut.types import Sparse

Vector = NDArray[np.float64]


@dataclass(frozen=True)
class FiniteActing:
    """A converged state with the forces in it, each (dim n_points,). displacement; internal: of stresses; loads; reaction:
    of what holds the points; pressing, rubbing: of pressures and ties, and of tractions; stored: strain energy;
    free: (n_free,) displacements; follows: (dim n_points, n_free) how the points go with them there; residual: largest
    force left on these; drag: (n_free,) that of a step which it leads, None without; flowed: work of plastic
    flow so far; time: when that is. stored is not a number where a material does not tell its energy."""

    displacement: Vector
    internal: Vector
    loads: Vector
    reaction: Vector
    pressing: Vector
    rubbing: Vector
    stored: float
    free: Vector
    follows: Sparse
    residual: float = 0.0
    drag: Vector | None = None
    flowed: float = 0.0
    time: float = 0.0

    @classmethod
    def none(cls, follows: Sparse) -> FiniteActing:
        """Before the first step: nothing has moved, and nothing acts."""
        nothing, free = np.zeros(follows.shape[0]), np.zeros(follows.shape[1])
        return cls(nothing, nothing, nothing, nothing, nothing, nothing, 0.0, free, follows)


def finite_energy(
    problem: ContactProblem, before: FiniteActing, now: FiniteActing, stiffness: Vector, contacts: Sequence[ContactResult],
    earlier: float = 0.0,
) -> Energy:  # fmt: skip
    """Of the step of a problem between two states. stiffness: (n_free,) diagonal of the tangent; contacts: their results;
    earlier: the largest size of the steps before, beside which what is left after unloading is rounding."""
    moved, step = now.displacement - before.displacement, now.free - before.free

    def work(name: str) -> float:
        return float(0.5 * (getattr(before, name) + getattr(now, name)) @ moved)

    supports = sum(0.5 * float(side.reaction @ (moved - side.follows @ step)) for side in (before, now))
    friction, plastic = sum(c.friction.work for c in contacts if c.friction is not None), now.flowed - before.flowed
    dragged = sum(0.5 * float(side.drag @ step) for side in (before, now) if side.drag is not None)
    internal, way = work("internal"), np.abs(step)
    stored = now.stored - before.stored if np.isfinite(now.stored) else internal - plastic
    rounding = np.finfo(float).eps * (np.abs(stiffness) * np.abs(now.free)) @ way
    size = 0.5 * float(np.abs(before.internal + now.internal) @ np.abs(moved))
    pushed = now.drag is not None or (before.drag is not None and bool(before.drag.any()))
    at_rest = not pushed and abs(friction) <= ENERGY * size and np.isfinite(now.stored)
    at_rest = at_rest and has_potential(problem, before.time, now.time)
    return Energy(
        loads=work("loads"),
        supports=supports,
        contact=work("pressing"),
        stored=stored,
        friction=friction,
        stepping=(internal - stored - plastic) - (work("rubbing") + friction),
        size=max(size, NOTHING * earlier, 1e-300),
        left=float(rounding + max(before.residual, now.residual) * way.sum()),
        earlier=earlier,
        elastic=now.stored,
        stabilisation=dragged,
        plastic=plastic,
        flowed=now.flowed,
        unexplained=unexplained(before.loads, now.loads, moved, stored + plastic) if at_rest else None,
    )

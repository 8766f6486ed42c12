"""Energy over a load step, theory (R10), (G13): what forces do on the way from one converged state to the next."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from abut.analysis.jumps import has_potential, unexplained
from abut.problem.balance import Balance
from abut.problem.pair import Pair
from abut.problem.problem import ContactProblem
from abut.solution import ContactResult
from abut.solution.energy import ENERGY, Energy
from abut.types import Sparse

NOTHING = 1e-12  # energy over the largest so far that is taken for none: a millionth of forces and of motions
Vector = NDArray[np.float64]


@dataclass(frozen=True)
class Acting:
    """A converged state with the forces in it, each (dim n_points,). displacement; internal: of stresses; loads; reaction:
    of what holds the points; pressing, rubbing: of pressures and ties, and of tractions; stored: strain energy; free:
    (n_free,) displacements; follows: (dim n_points, n_free) how the points go with them there; residual: largest force left
    on these; drag: (n_free,) that of a step which it leads, None without; flowed: work of plastic flow so far; time: when
    that is; resisting: forces of dashpots, no part of the loads, which have dissipated damped so far; tractions:
    (n_tangential,) of each pair, where these are the same at all states, so not at large displacements.
    stored is not a number where the work of stresses is what is stored: where a material does not tell its energy, and at
    small displacements."""

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
    tractions: Sequence[Vector] = ()
    resisting: Vector | None = None
    damped: float = 0.0

    @classmethod
    def none(cls, displacement: Vector, follows: Sparse) -> Acting:
        """Before the first step: nothing acts."""
        nothing, free = np.zeros(follows.shape[0]), np.zeros(follows.shape[1])
        return cls(displacement, nothing, nothing, nothing, nothing, nothing, 0.0, free, follows)


def pressing(pairs: Sequence[Pair], multipliers: Sequence[Vector], size: int) -> Vector:
    """Nodal forces of all pressures and ties, without friction, (size,); of gaps that close: theory (R11)."""
    force = np.zeros(size)
    for pair, values in zip(pairs, multipliers):
        part = pair.normal if pair.frictional else slice(None)
        force += pair.rows[part].T @ values[part]
    return force


def tractions(pairs: Sequence[Pair], multipliers: Sequence[Vector]) -> list[Vector]:
    """Multipliers of friction of each pair, none without."""
    return [part[pair.tangential] if pair.frictional else part[:0] for pair, part in zip(pairs, multipliers)]


def energy(
    problem: ContactProblem,
    balance: Balance,
    before: Acting,
    now: Acting,
    slips: Sequence[Vector | None],
    contacts: Sequence[ContactResult],
    earlier: float = 0.0,
) -> Energy:
    """Of the step of a problem between two states. slips: (n, 4) of each pair's multipliers, as in ``ContactHistory``;
    contacts: their results; earlier: the largest size of the steps before, beside which what is left after unloading is
    rounding.

    At small displacements slips are jumps of the displacements, so that tractions and slips say themselves what tractions
    that grow over the step do otherwise: the balance is a check of both. At large ones that is what is left of the work."""
    large, moved, step = problem.model.finite, now.displacement - before.displacement, now.free - before.free

    def work(name: str) -> float:
        return float(0.5 * (getattr(before, name) + getattr(now, name)) @ moved)

    supports = sum(0.5 * float(side.reaction @ (moved - side.follows @ step)) for side in (before, now))
    friction, plastic = sum(c.friction.work for c in contacts if c.friction is not None), now.flowed - before.flowed
    internal, way = work("internal"), np.abs(step)
    told = large and bool(np.isfinite(now.stored))
    stored = now.stored - before.stored if told else internal - plastic
    growing, closing = (0.0, 0.0) if large else _of_slips(balance.pairs, before, now, slips)
    stepping = (internal - stored - plastic) - (work("rubbing") + friction) if large else growing
    rounding = (np.abs(balance.diagonal) * np.abs(now.free)) @ way
    mean = 0.5 * np.abs(before.internal + now.internal)
    rounding += mean @ np.abs(now.displacement)  # where hardly anything has moved
    resisted = sum(-0.5 * float(side.resisting @ moved) for side in (before, now) if side.resisting is not None)
    dashpots = now.damped - before.damped
    size, drags = float(mean @ np.abs(moved)), [side.drag for side in (before, now) if side.drag is not None]
    at_rest = told and now.drag is None and not any(drag.any() for drag in drags) and abs(friction) <= ENERGY * size
    at_rest = at_rest and has_potential(problem, before.time, now.time)
    return Energy(
        loads=work("loads"),
        supports=supports,
        contact=work("pressing") + closing,
        stored=stored,
        friction=friction,
        stepping=stepping + resisted - dashpots,
        size=max(size, NOTHING * earlier, 1e-300),
        left=float(np.finfo(float).eps * rounding + max(before.residual, now.residual) * way.sum()),
        earlier=earlier if large or now.flowed else 0.0,
        elastic=now.stored if large else None,
        stabilisation=sum(0.5 * float(drag @ step) for drag in drags),
        plastic=plastic,
        flowed=now.flowed,
        unexplained=unexplained(before.loads, now.loads, moved, stored + plastic) if at_rest else None,
        dashpots=dashpots,
    )


def _of_slips(
    pairs: Sequence[Pair], before: Acting, now: Acting, slips: Sequence[Vector | None]
) -> tuple[float, float]:
    """What tractions do on slips beyond those at the end of the step, and on what only comes closer; nothing acts before the
    first step."""
    growing = closing = 0.0
    for i, (pair, slip, late) in enumerate(zip(pairs, slips, now.tractions)):
        if pair.frictional and slip is not None:
            early = before.tractions[i] if before.tractions else np.zeros_like(late)
            step, _, came, _ = (pair.weight[:, None] * slip)[pair.tangential].T
            growing += 0.5 * float(step @ (late - early))
            closing += 0.5 * float(came @ (late + early))
    return growing, closing

"""Energy over a load step with friction, theory (R10): what forces do on the way from one converged state to the next."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from abut.problem.balance import Balance
from abut.problem.pair import Pair
from abut.solution import ContactResult
from abut.solution.energy import Energy

NOTHING = 1e-12  # energy over the largest so far that is taken for none: a millionth of forces and of motions
Vector = NDArray[np.float64]


@dataclass(frozen=True)
class Acting:
    """A converged state with the forces in it, each (dim n_points,). displacement; prescribed: the part of it that is given;
    internal: of stresses; loads; reaction: of what holds the points; pressing: of pressures and ties; tractions: (n,) of
    each pair's multipliers of friction; free: (n_free,) displacements; residual: largest force left on these;
    flowed: work of plastic flow so far."""

    displacement: Vector
    prescribed: Vector
    internal: Vector
    loads: Vector
    reaction: Vector
    pressing: Vector
    tractions: Sequence[Vector]
    free: Vector
    residual: float = 0.0
    flowed: float = 0.0

    @classmethod
    def none(cls, prescribed: Vector, balance: Balance) -> Acting:
        """Before the first step: nothing acts. prescribed: displacement (dim n_points,) at the outset."""
        nothing = np.zeros_like(prescribed)
        tractions = [
            np.zeros(len(pair) - len(pair.space)) if pair.frictional else np.zeros(0) for pair in balance.pairs
        ]
        free = np.zeros(len(balance.diagonal))
        return cls(prescribed, prescribed, nothing, nothing, nothing, nothing, tractions, free)


def pressing(pairs: Sequence[Pair], multipliers: Sequence[Vector]) -> Vector:
    """Nodal forces of all pressures and ties, without friction, (dim n_points,); of gaps that close: theory (R11)."""
    force = np.zeros(pairs[0].rows.shape[1])
    for pair, values in zip(pairs, multipliers):
        part = pair.normal if pair.frictional else slice(None)
        force += pair.rows[part].T @ values[part]
    return force


def tractions(pairs: Sequence[Pair], multipliers: Sequence[Vector]) -> list[Vector]:
    """Multipliers of friction of each pair, none without."""
    return [part[pair.tangential] if pair.frictional else part[:0] for pair, part in zip(pairs, multipliers)]


def energy(
    balance: Balance,
    before: Acting,
    now: Acting,
    slips: Sequence[Vector | None],
    contacts: Sequence[ContactResult],
    earlier: float = 0.0,
) -> Energy:
    """Of the step between two states. slips: (n, 4) of each pair's multipliers, in the step, in all, and what came closer
    without slip, None without friction; contacts: their results; earlier: the largest size of the steps before, beside
    which what is left after unloading is rounding."""
    moved = now.displacement - before.displacement
    given = now.prescribed - before.prescribed

    def mean(name: str) -> Vector:
        return np.asarray(0.5 * (getattr(before, name) + getattr(now, name)))

    stepping = closing = 0.0
    for pair, slip, early, late in zip(balance.pairs, slips, before.tractions, now.tractions):
        if pair.frictional and slip is not None:
            step, _, came, _ = (pair.weight[:, None] * slip)[pair.tangential].T
            stepping += 0.5 * float(step @ (late - early))
            closing += 0.5 * float(came @ (late + early))
    internal, step = mean("internal"), np.abs(now.free - before.free)
    rounding = np.finfo(float).eps * (balance.diagonal * np.abs(now.free)) @ step
    rounding += np.finfo(float).eps * np.abs(internal) @ np.abs(now.displacement)  # where hardly anything has moved
    unbalanced = max(before.residual, now.residual) * step.sum()
    return Energy(
        loads=float(mean("loads") @ moved),
        supports=float(mean("reaction") @ given),
        contact=float(mean("pressing") @ moved) + closing,
        stored=float(internal @ moved) - (now.flowed - before.flowed),
        plastic=now.flowed - before.flowed,
        friction=sum(c.friction.work for c in contacts if c.friction is not None),
        stepping=stepping,
        size=max(float(np.abs(internal) @ np.abs(moved)), NOTHING * earlier, 1e-300),
        left=float(rounding + unbalanced),
        earlier=earlier if now.flowed else 0.0,
        flowed=now.flowed,
    )

"""What holds each body: supports, ties, contact; and what to do where an active set lets one go."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.optimize import nnls

from abut.discretization.pairs import Pair
from abut.discretization.rigid import (
    RigidModes,
    describe,
    free_motions,
    resistance_of_rows,
    resistance_of_supports,
    rigid_modes,
)
from abut.discretization.supports import Supports
from abut.mesh.mesh import Mesh

UNBALANCED = 1e-9  # force that no contact balances, over the sum of all, from which on it moves a body


@dataclass(frozen=True)
class Holding:
    """Resistance against rigid motions: of the supports (with what holds loose motions), of each pair's rows."""

    rigid: RigidModes
    supports: NDArray[np.float64]
    pairs: Sequence[Pair]
    by_supports: bool  # supports and ties alone hold every body
    free: NDArray[np.float64]  # (dim n_points, m) rigid motions that the supports alone leave free

    @property
    def everything(self) -> list[NDArray[np.float64]]:
        """Resistance of supports and of every pair, closed."""
        return [self.supports, *(resistance_of_rows(self.rigid, p.rows) for p in self.pairs)]

    def helped_by(self, gram: NDArray[np.float64]) -> Holding:
        """The same with something else that resists."""
        return _holding(self.rigid, self.supports + gram, self.pairs) if gram.any() else self

    def complete(
        self,
        held: Supports,
        load: NDArray[np.float64],
        active: NDArray[np.bool_],
        gap: NDArray[np.float64],
        weights: NDArray[np.float64],
    ) -> NDArray[np.bool_]:
        """The active set, with the closest multipliers added where it would let a body go that the loads move, theory (V8).

        load: (n_free, n_histories), weights: (n_histories,) as in ``abut.solvers.newton.System``."""
        if self.by_supports or self._holds(active) or self._moved(held, load @ weights, active) is None:
            return active
        result = active.copy()
        splits = np.cumsum([len(p) for p in self.pairs])[:-1]
        for p, g, own in zip(self.pairs, np.split(gap, splits), np.split(result, splits)):
            if p.tied or not len(p):
                continue
            clearance = g / (p.scale * p.stiffness * p.size)  # over the facet size
            own |= clearance <= clearance.min() + 0.01
        return result if self._holds(result) else np.ones_like(active)

    def pulled_off(self, held: Supports, load: NDArray[np.float64], weights: NDArray[np.float64]) -> str:
        """The motion, in words, that loads cause though contact pushes wherever it can; empty where there is none.

        load, weights: as for ``complete``."""
        motion = self._moved(held, load @ weights)
        return "" if motion is None else describe(self.rigid, motion[:, None])

    def _moved(
        self, held: Supports, force: NDArray[np.float64], active: NDArray[np.bool_] | None = None
    ) -> NDArray[np.float64] | None:
        """The motion (n_modes,) that forces (n_free,) cause though contact, or that of the multipliers ``active`` alone,
        pushes where it can; None where there is none."""
        free = free_motions([self.supports])
        moves = held.coordinates(self.rigid.modes @ free)
        motion = unbalanced(self.pairs, moves, moves.T @ force, float(np.abs(force).sum()), active)
        return None if motion is None else free @ motion

    def _rows(self, active: NDArray[np.bool_]) -> list[NDArray[np.float64]]:
        splits = np.cumsum([len(p) for p in self.pairs])[:-1]
        return [resistance_of_rows(self.rigid, p.rows[own]) for p, own in zip(self.pairs, np.split(active, splits))]

    def _holds(self, active: NDArray[np.bool_]) -> bool:
        return free_motions([self.supports, *self._rows(active)]).shape[1] == 0


def unbalanced(
    pairs: Sequence[Pair],
    moves: NDArray[np.float64],
    work: NDArray[np.float64],
    size: float,
    active: NDArray[np.bool_] | None = None,
) -> NDArray[np.float64] | None:
    """The motion (m,) that is left where no pressures that push (ties: nor pull) balance the loads, theory (V15); None
    where some do.

    moves: (n_free, m) rigid motions that supports leave free; work: (m,) of the loads on them; size: sum of all forces,
    of which a work of ``UNBALANCED`` is none; active: (n,) multipliers that may press, all where left out."""
    if not len(work) or not np.abs(work).max() > UNBALANCED * size:
        return None
    chosen = [None] * len(pairs) if active is None else np.split(active, np.cumsum([len(p) for p in pairs])[:-1])
    push = [np.zeros((0, len(work)))]
    for pair, own in zip(pairs, chosen):  # with points the pressure is positive there, its coefficients need not be
        points = own is None and pair.points is not None
        operator = pair.points.operator if points and pair.points is not None else pair.operator
        moved = np.asarray((operator if own is None else operator[own]) @ moves)
        push += [moved, -moved] if pair.tied else [moved]
    forces = np.concatenate(push)
    length = np.linalg.norm(forces, axis=1)
    forces = forces[length > 0.0] / length[length > 0.0, None]
    if not len(forces):
        return work
    pressure, missing = nnls(forces.T, -work)
    return work + forces.T @ pressure if missing > UNBALANCED * size else None


def holding(mesh: Mesh, held: Supports, pairs: Sequence[Pair]) -> Holding:
    """Work out what holds the bodies of a mesh."""
    rigid = rigid_modes(mesh)
    return _holding(rigid, resistance_of_supports(rigid, held), pairs)


def _holding(rigid: RigidModes, support: NDArray[np.float64], pairs: Sequence[Pair]) -> Holding:
    ties = [resistance_of_rows(rigid, p.rows) for p in pairs if p.tied]
    return Holding(
        rigid, support, pairs, free_motions([support, *ties]).shape[1] == 0, rigid.modes @ free_motions([support])
    )

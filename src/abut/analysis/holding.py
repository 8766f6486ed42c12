"""What holds each body: supports, ties, contact; and what to do where an active set lets one go."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

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
from abut.errors import SingularModelError
from abut.mesh.mesh import Mesh


@dataclass(frozen=True)
class Holding:
    """Resistance against rigid motions: of the supports, of each pair's rows."""

    rigid: RigidModes
    supports: NDArray[np.float64]
    pairs: Sequence[Pair]
    by_supports: bool  # supports and ties alone hold every body
    free: NDArray[np.float64]  # (dim n_points, m) rigid motions that the supports alone leave free

    def check(self) -> None:
        """Raise SingularModelError where a body can move even with all contact closed."""
        grams = [self.supports, *(resistance_of_rows(self.rigid, p.rows) for p in self.pairs)]
        motions = free_motions(grams)
        if motions.shape[1]:
            others = f" (and {motions.shape[1] - 1} more motions)" if motions.shape[1] > 1 else ""
            raise SingularModelError(
                f"{describe(self.rigid, motions)} without resistance{others}: neither supports nor contact hold it; "
                "add a support, or a symmetry plane (normal = 0)"
            )

    def complete(self, active: NDArray[np.bool_], gap: NDArray[np.float64]) -> NDArray[np.bool_]:
        """The active set, with the closest multipliers added where it would let a body go, theory (V8)."""
        if self.by_supports or self._holds(active):
            return active
        result = active.copy()
        splits = np.cumsum([len(p) for p in self.pairs])[:-1]
        for p, g, own in zip(self.pairs, np.split(gap, splits), np.split(result, splits)):
            if p.tied or not len(p):
                continue
            clearance = g / (p.scale * p.stiffness * p.size)  # over the facet size
            own |= clearance <= clearance.min() + 0.01
        return result if self._holds(result) else np.ones_like(active)

    def freed(self, active: NDArray[np.bool_]) -> str:
        """Which body an active set lets go, in words."""
        motions = free_motions([self.supports, *self._rows(active)])
        return describe(self.rigid, motions) if motions.shape[1] else "no body is let go"

    def _rows(self, active: NDArray[np.bool_]) -> list[NDArray[np.float64]]:
        splits = np.cumsum([len(p) for p in self.pairs])[:-1]
        return [resistance_of_rows(self.rigid, p.rows[own]) for p, own in zip(self.pairs, np.split(active, splits))]

    def _holds(self, active: NDArray[np.bool_]) -> bool:
        return free_motions([self.supports, *self._rows(active)]).shape[1] == 0


def holding(mesh: Mesh, held: Supports, pairs: Sequence[Pair]) -> Holding:
    """Work out what holds the bodies of a mesh."""
    rigid = rigid_modes(mesh)
    support = resistance_of_supports(rigid, held)
    ties = [resistance_of_rows(rigid, p.rows) for p in pairs if p.tied]
    return Holding(
        rigid, support, pairs, free_motions([support, *ties]).shape[1] == 0, rigid.modes @ free_motions([support])
    )

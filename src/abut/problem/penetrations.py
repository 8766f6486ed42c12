"""Pressure penetration, as a term of the balance of forces: a fluid's pressure on what it wets; theory (F19)."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np
import scipy.sparse as sp

from abut.bodies.follower import follower_pressure
from abut.model import Model
from abut.problem.pair import Pair
from abut.problem.terms import MatrixTangent, Motion, Share
from abut.problem.wet import Wet
from abut.problem.wetting import TERM, Wetting, at_corners
from abut.types import Array, Sparse


@dataclass(frozen=True)
class Penetrations:
    """All fluids of a model. wettings, pairs: of each, its contact's as at the outset."""

    model: Model
    wettings: Sequence[Wetting]
    pairs: Sequence[Pair]
    name: str = TERM
    constant: bool = False

    @classmethod
    def of(cls, model: Model, pairs: Sequence[Pair]) -> Penetrations | None:
        """None where there are none. Raises InputError for sources that touch neither side."""
        if not model.penetrations:
            return None
        wettings = [Wetting.of(model, item, pairs) for item in model.penetrations]
        return cls(model, wettings, [pairs[wetting.pair] for wetting in wettings])

    def evaluate(self, before: Motion, now: Motion) -> Share:
        """Force, tangent and history at a state, as in ``Term``: on what is wet in the step's frame; its history is that."""
        mesh = self.model.mesh
        points = mesh.points + now.displacement.reshape(mesh.points.shape) if self.model.finite else mesh.points
        force, slope = np.zeros(points.size), sp.csr_matrix((points.size,) * 2)
        history = {}
        for i, wet in enumerate(now.wet):
            for pushed, by in self.on_sides(i, wet, now.time, points):
                force, slope = force + pushed, slope + by
            history[f"wet{i}"] = wet.parts()
        tangent = MatrixTangent(-slope) if self.model.finite else None
        return Share(-force, tangent, history, symmetric=not (self.model.finite and slope.nnz))

    def on_sides(self, i: int, wet: Wet, time: float, points: Array) -> list[tuple[Array, Sparse]]:
        """Nodal forces (dim n_points,) of one fluid on contactor and target, and their derivatives; points: (n_points, dim)
        where they are."""
        pressure, pair = self.wettings[i].penetration.pressure(time), self.pairs[i]
        shares = (
            at_corners(pair.contactor, wet.shares[:, 0], not pair.space.ordinary),
            at_corners(pair.target, wet.shares[:, 1]),
        )
        return [
            follower_pressure(replace(side, points=points), pressure, share=share)
            for side, share in zip((pair.contactor, pair.target), shares)
        ]

    def begun(self, history: Mapping[str, Array]) -> tuple[Wet, ...]:
        """How far fluids have got in a converged state with such a history."""
        count = len(self.model.mesh.points)
        return tuple(
            Wet.remembered(history[f"wet{i}"]) if f"wet{i}" in history else Wet.none(count)
            for i in range(len(self.wettings))
        )

"""Dashpots as a term of the balance of forces; theory (F16)."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np
import scipy.sparse as sp

from abut.model import Model
from abut.problem.springs import SpringRows, parts_of
from abut.problem.terms import MatrixTangent, Motion, Share
from abut.types import Array

FORCE, WORK = 0, 1  # columns of a history: force that each has last, and what it has dissipated so far


@dataclass(frozen=True)
class Dashpots:
    """All dashpots of a model: springs whose laws are of the speed, which over a load step is taken for constant
    (backward Euler). At the end of a step, with no time since, they have the force that they had over it."""

    model: Model
    parts: Sequence[SpringRows]
    constant: bool = False  # the tangent is one over the time elapsed
    name: str = "dashpots"

    @classmethod
    def of(cls, model: Model) -> Dashpots | None:
        """None where there are none. Raises InputError for those between points that coincide."""
        parts = [part for spring in model.springs if spring.dashpot for part in parts_of(model, spring)]
        return cls(model, parts) if parts else None

    def evaluate(self, before: Motion, now: Motion) -> Share:
        """Force, tangent and history at a state, as in ``Term``."""
        elapsed = (now.time - before.time) * self.model.solve.end
        total, tangent = np.zeros(len(now.displacement)), sp.csr_matrix((len(now.displacement),) * 2)
        history: dict[str, Array] = {}
        for i, part in enumerate(self.parts):
            force, work = _kept(part, i, before.history).T
            if elapsed > 0.0:
                way = part.lengthening(now.displacement) - part.lengthening(before.displacement)
                force, slope = part.forces(way / elapsed)
                work = work + force * way
                tangent = tangent + part.stiffness(force, slope / elapsed, now.displacement)
            total += part.nodal(force, now.displacement)
            history[_key(part, i)] = np.column_stack([force, work])
        return Share(total, MatrixTangent(tangent.tocsr()), history)

    def resistance(self, motions: Array) -> Array:
        """Gram matrix of motions (dim n_points, m) by what dashpots take of them, of the size of one."""
        return np.asarray(sum(part.resistance(motions) for part in self.parts))

    def force_on(self, displacement: Array, history: Mapping[str, Array]) -> dict[str, Array]:
        """By dashpot the nodal forces (n_points, dim) on what it is on, at the end of a step that left a history."""
        found: dict[str, Array] = {}
        for i, part in enumerate(self.parts):
            nodal = -part.nodal(_kept(part, i, history)[:, FORCE], displacement).reshape(-1, self.model.dim)
            found[part.spring.name] = found.get(part.spring.name, np.zeros_like(nodal)) + nodal
        return found


def dissipated(history: Mapping[str, Array]) -> float:
    """Energy that all dashpots have taken so far, by their history."""
    return float(sum(values[:, WORK].sum() for values in history.values()))


def _key(part: SpringRows, number: int) -> str:
    return f"{part.spring.name}.{number}"


def _kept(part: SpringRows, number: int, history: Mapping[str, Array]) -> Array:
    """(n, 2) by the columns ``FORCE`` and ``WORK``; none at the start."""
    return history.get(_key(part, number), np.zeros((len(part.share), 2)))

"""Preloads that are locked, as a term of the balance of forces; theory (F15)."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
import scipy.sparse as sp

from abut.mesh.facets import bodies_at
from abut.model import Model
from abut.model.preload import Section, sections
from abut.model.step_ends import SAME
from abut.problem.follower_loads import Slopes
from abut.problem.sections import given_force, shortening_row
from abut.problem.terms import MatrixTangent, Motion, Share

HELD = 1e6  # stiffness of what is locked or held over Young's modulus times the size of its place: it gives a millionth


@dataclass(frozen=True)
class LockedPreloads:
    """Preloads that are locked: up to that time a force draws the sides together, from then on their shortening stays, by a
    spring that is ``HELD`` times as stiff as the section and begins with that force."""

    model: Model
    sections: Sequence[Section]
    name: str = "preloads"
    constant: bool = False

    @classmethod
    def of(cls, model: Model) -> LockedPreloads | None:
        """None where nothing is locked."""
        locked = [s for s in sections(model.mesh, model.preloads) if s.preload.lock is not None]
        return cls(model, locked) if locked else None

    def evaluate(self, before: Motion, now: Motion) -> Share:
        """Force, tangent and history at a state, as in ``Term``; its history is the shortening of each section up to
        where it is locked."""
        size = len(now.displacement)
        total = np.zeros(size)
        parts, history = [], {}
        for section in self.sections:
            row = shortening_row(section, self.model.dim, size)
            preload, short = section.preload, float(row @ now.displacement)
            assert preload.lock is not None
            if now.time <= preload.lock + SAME:
                total += given_force(preload, now.time) * row
                history[preload.name] = np.array([[short]])
                continue
            kept = before.history[preload.name]
            stiffness = self._stiffness(section)
            total += (given_force(preload, preload.lock) + stiffness * (float(kept[0, 0]) - short)) * row
            parts.append((sp.csr_matrix(-stiffness * row[:, None]), sp.csr_matrix(row[None])))
            history[preload.name] = kept
        return Share(-total, Slopes(MatrixTangent(sp.csr_matrix((size, size))), parts), history)

    def _stiffness(self, section: Section) -> float:
        mesh = self.model.mesh
        cells = [first + np.flatnonzero(np.isin(block.nodes, section.before).any(axis=1))
                 for block, first in zip(mesh.blocks, mesh.starts)]  # fmt: skip
        names = bodies_at(mesh, np.concatenate(cells))
        modulus = max(solid.material.modulus for solid in self.model.solids if solid.body in names)
        extent = float(np.linalg.norm(np.ptp(mesh.points[section.before], axis=0))) if self.model.dim == 3 else 1.0
        around = 2.0 * np.pi * float(mesh.points[section.before, 0].max()) if mesh.axisymmetric else 1.0
        return HELD * modulus * (extent or 1.0) * around

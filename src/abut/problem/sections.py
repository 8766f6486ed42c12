"""Sections of preloads: what they add to constraints and to loads; theory (F15)."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
import scipy.sparse as sp

from abut.dofs import dofs_at, n_dofs
from abut.errors import InputError
from abut.model import Model
from abut.model.preload import Preload, Section, sections
from abut.types import Array, Sparse


@dataclass(frozen=True)
class Shortenings:
    """at_points @ u + by_shortenings @ d = values for n shortenings d of ``preloads``: at the points of all sections, and
    d alone where it is prescribed. at_points: (m, dim n_points), by_shortenings: (m, n) sparse; values: (m, n_histories);
    names: of all m, for errors."""

    preloads: Sequence[Preload]
    at_points: Sparse
    by_shortenings: Sparse
    values: Array
    names: list[str]

    def __len__(self) -> int:
        return len(self.preloads)

    def require_closing(self, by_free: Sparse) -> None:
        """Raise InputError for a force on a section that supports hold open. by_free: (n, n_free) shortenings by the free
        displacements."""
        moves = np.diff(by_free.tocsr().indptr) > 0
        for preload, free in zip(self.preloads, moves):
            if preload.force is not None and not free:
                raise InputError(
                    f"{_name(preload)}: supports hold both sides of its section along its normal, so that nothing is drawn "
                    "together; move the section, or the supports"
                )


def shortenings_of(model: Model) -> Shortenings:
    """Of the preloads of a model."""
    cut, dim, size = sections(model.mesh, model.preloads), model.dim, model.mesh.points.size
    points, turned = [sp.csr_matrix((0, size))], [np.zeros((0, len(cut)))]
    values, names = [np.zeros((0, len(model.histories)))], []
    for number, section in enumerate(cut):
        preload, count = section.preload, n_dofs(len(section.before), dim)
        row, parts = np.arange(count), []
        for sign, nodes in ((1.0, section.beyond), (-1.0, section.before)):
            at = dofs_at(nodes, dim).ravel()
            parts.append(sp.csr_matrix((np.full(count, sign), (row, at)), (count, size)))
        given = np.zeros((int(preload.shortening is not None), len(model.histories)))
        if preload.shortening is not None:
            given[0, model.histories.index(preload.amplitude)] = preload.shortening
        points += [parts[0] + parts[1], sp.csr_matrix((len(given), size))]
        unit = np.eye(len(cut))[number]
        turned += [np.outer(np.tile(section.normal, len(section.before)), unit), np.tile(unit, (len(given), 1))]
        values += [np.zeros((count, len(model.histories))), given]
        names += [_name(preload)] * (count + len(given))
    by_shortenings = sp.csr_matrix(np.concatenate(turned))
    return Shortenings(model.preloads, sp.vstack(points, format="csr"), by_shortenings, np.concatenate(values), names)


def shortening_row(section: Section, dim: int, size: int) -> Array:
    """How much the sides are drawn together by the displacements of all points, (dim n_points,)."""
    row = np.zeros(size)
    share = section.normal / len(section.before)
    for sign, nodes in ((-1.0, section.beyond), (1.0, section.before)):
        row[dofs_at(nodes, dim)] = sign * share
    return row


def preload_forces(model: Model) -> Array:
    """Nodal forces (dim n_points, n_histories) of preloads by force that are not locked."""
    total = np.zeros((model.mesh.points.size, len(model.histories)))
    for section in sections(model.mesh, model.preloads):
        preload = section.preload
        if preload.force is not None and preload.lock is None:
            row = shortening_row(section, model.dim, len(total))
            total[:, model.histories.index(preload.amplitude)] += preload.force * row
    return total


def given_force(preload: Preload, time: float) -> float:
    """Of a preload by force at a time."""
    assert preload.force is not None
    return preload.force * (time if preload.amplitude is None else preload.amplitude(time))


def _name(preload: Preload) -> str:
    return f"preload '{preload.name}'"

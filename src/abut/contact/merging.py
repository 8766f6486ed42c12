"""Merging of couplings: that of a whole interface from those of its parts."""

from __future__ import annotations

from collections.abc import Sequence
from functools import reduce
from operator import add

import numpy as np
import scipy.sparse as sp

from abut.contact.coupling import Coupling, GapSamples, IntegrationPoints
from abut.types import Sparse


def added(parts: Sequence[Coupling]) -> Coupling:
    """The coupling of all facets from those of disjoint ones."""
    points = [part.points for part in parts if part.points is not None]
    samples = [part.gap_samples for part in parts if part.gap_samples is not None]
    return Coupling(
        degree=parts[0].degree,
        operator=_sum([part.operator for part in parts]),
        contactor_part=_sum([part.contactor_part for part in parts]),
        target_part=_sum([part.target_part for part in parts]),
        gap=np.sum([part.gap for part in parts], axis=0),
        weight=np.sum([part.weight for part in parts], axis=0),
        mass=np.sum([part.mass for part in parts], axis=0),
        covered=np.sum([part.covered for part in parts], axis=0),
        segments=np.sum([part.segments for part in parts], axis=0, dtype=np.int32),
        points=_points(points) if points else None,
        gap_samples=_gap_samples(samples) if samples else None,
    )


def _sum(matrices: Sequence[Sparse]) -> Sparse:
    return reduce(add, matrices).tocsr()


def _points(parts: Sequence[IntegrationPoints]) -> IntegrationPoints:
    """All points, in the order of their facets."""
    facet = np.concatenate([part.facet for part in parts])
    order = np.argsort(facet, kind="stable")
    return IntegrationPoints(
        facet=facet[order],
        target_facet=np.concatenate([part.target_facet for part in parts])[order],
        weight=np.concatenate([part.weight for part in parts])[order],
        gap=np.concatenate([part.gap for part in parts])[order],
        normal=np.concatenate([part.normal for part in parts])[order],
        pressure=sp.vstack([part.pressure for part in parts]).tocsr()[order],
        gap_operator=sp.vstack([part.gap_operator for part in parts]).tocsr()[order],
    )


def _gap_samples(parts: Sequence[GapSamples]) -> GapSamples:
    """The same of corners and middles."""
    order = np.argsort(np.concatenate([part.facet for part in parts]), kind="stable")
    names = ("facet", "target_facet", "gap", "normal", "contactor_shapes", "target_shapes")
    return GapSamples(*(np.concatenate([getattr(part, name) for part in parts])[order] for name in names))

"""The interface on many processes: its surfaces, one dimension lower than the volume, are whole on each; every facet of the
contactor is cut and integrated by the process that has its cell."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import scipy.sparse as sp
from numpy.typing import NDArray

from abut.contact.coupling import Coupling, CouplingOptions, default_reach, no_gap
from abut.contact.coupling import couple as couple_here
from abut.contact.merging import added
from abut.mesh.surface import Surface
from abut.parallel.team import Store, Team
from abut.types import Sparse


def couple(
    team: Team, owner: NDArray[np.int64], contactor: Surface, target: Surface, degree: int, options: CouplingOptions
) -> Coupling:
    """As ``abut.contact.coupling.couple``; owner: (n_facets,) process of each facet of the
    contactor. Surfaces lie over one array of points."""
    points = np.union1d(contactor.node_ids, target.node_ids)
    shared = contactor.points[points]
    small = [_over(surface, points, shared) for surface in (contactor, target)]
    options = replace(
        options,
        reach=default_reach(contactor, target) if options.reach is None else options.reach,
        adjust=no_gap(contactor, target, options.adjust),  # rounding of all coordinates counts
    )
    arguments = [(owner == rank,) for rank in range(team.size)]
    whole = added(team.each(_couple, *small, degree, options, per_rank=arguments))
    n, at = len(contactor.points), whole.points
    width = 1 if options.componentwise else contactor.dim
    operator, contactor_part, target_part = (
        _among_all(matrix, points, width, n) for matrix in (whole.operator, whole.contactor_part, whole.target_part)
    )
    if at is not None:
        at = replace(at, gap_operator=_among_all(at.gap_operator, points, contactor.dim, n))
    return replace(whole, operator=operator, contactor_part=contactor_part, target_part=target_part, points=at)


def _over(surface: Surface, points: NDArray[np.int64], coordinates: NDArray[np.float64]) -> Surface:
    """The surface over some of its points alone, whose array it shares with others."""
    place = np.full(len(surface.points), -1, dtype=np.int32)
    place[points] = np.arange(len(points))
    nodes = np.where(surface.nodes >= 0, place[surface.nodes], -1).astype(np.int32)
    return replace(surface, points=coordinates, nodes=nodes)


def _among_all(matrix: Sparse, points: NDArray[np.int64], width: int, n_points: int) -> Sparse:
    """A matrix with ``width`` columns for each of some points, as one with columns for all points."""
    place = (width * points[:, None] + np.arange(width)).ravel()
    rows = matrix.tocsr()
    return sp.csr_matrix((rows.data, place[rows.indices], rows.indptr), shape=(rows.shape[0], width * n_points))


def _couple(
    store: Store, contactor: Surface, target: Surface, degree: int, options: CouplingOptions, chosen: NDArray[np.bool_]
) -> Coupling:
    return couple_here(contactor, target, degree, options, chosen)

"""The interface on many processes: its surfaces, one dimension lower than the volume, are whole on each; every facet of the
contactor is cut and integrated by one of them."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import scipy.sparse as sp
from numpy.typing import NDArray

from abut.contact.block_rows import CompressedRows
from abut.contact.coupling import Coupling, CouplingOptions, default_reach, no_gap
from abut.contact.coupling import couple as couple_here
from abut.contact.coupling_tangent import ContactLoad, CouplingTangent, assembled, of_facets
from abut.contact.merging import added
from abut.contact.moving_normals import MovingNormals
from abut.dofs import component_of, dofs_at, n_dofs, place_of
from abut.errors import AbutError
from abut.mesh.surface import Surface
from abut.parallel.team import Store, Team
from abut.types import Json, Sparse


def couple(
    team: Team, owner: NDArray[np.int64], contactor: Surface, target: Surface, degree: int, options: CouplingOptions
) -> Coupling:
    """As ``abut.contact.coupling.couple``; owner: (n_facets,) process of each facet of the
    contactor. Surfaces lie over one array of points."""
    points, small = _reduced(contactor, target)
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


def differentiate(
    team: Team, contactor: Surface, target: Surface, degree: int, options: CouplingOptions, load: ContactLoad,
    normals: MovingNormals,
) -> CouplingTangent:  # fmt: skip
    """As ``abut.contact.coupling_tangent.differentiated``, for options with a reach. Facets of the contactor are dealt out
    in turn: neighbours, which meet the target or do not, go to different processes."""
    points, small = _reduced(contactor, target)
    options = replace(options, adjust=no_gap(contactor, target, options.adjust))
    turn = np.arange(len(contactor)) % team.size
    dealt = [(turn == rank,) for rank in range(team.size)]
    parts = team.each(_differentiate, *small, degree, options, load, _without_blocks(normals), per_rank=dealt)
    for part in parts:
        if isinstance(part, AbutError):
            raise part
    value, column, start = normals.blocks
    place = np.zeros(len(contactor.points), dtype=column.dtype)
    place[points] = np.arange(len(points))
    few = replace(normals, blocks=(value, place[column], start)).turning(len(points))
    n, dim = len(contactor.points), contactor.dim
    made = assembled(parts, few)
    tangent = made.force_tangent.tocoo()
    row, along = (
        dofs_at(points, dim)[place_of(index, dim), component_of(index, dim)] for index in (tangent.row, tangent.col)
    )
    force = np.zeros((n, dim))
    force[points] = made.force.reshape(-1, dim)
    return replace(
        made, force=force.ravel(), turning=normals.turning(n),
        force_tangent=sp.csr_matrix((tangent.data, (row, along)), shape=(n_dofs(n, dim),) * 2),
        operators=_columns(made.operators, points), by_points=_columns(made.by_points, points),
    )  # fmt: skip


def _reduced(contactor: Surface, target: Surface) -> tuple[NDArray[np.int64], list[Surface]]:
    """The points of both, and both over these alone."""
    points = np.union1d(contactor.node_ids, target.node_ids)
    shared = contactor.points[points]
    return points, [_over(surface, points, shared) for surface in (contactor, target)]


def _columns(rows: CompressedRows, points: NDArray[np.int64]) -> CompressedRows:
    value, column, start = rows
    return value, points[column].astype(column.dtype), start


def _without_blocks(normals: MovingNormals) -> MovingNormals:
    """Their values only, to travel."""
    none = np.zeros(0, dtype=np.int32)
    return replace(normals, blocks=(np.zeros((0, 1, 1)), none, none))


def _over(surface: Surface, points: NDArray[np.int64], coordinates: NDArray[np.float64]) -> Surface:
    """The surface over some of its points alone, whose array it shares with others."""
    place = np.full(len(surface.points), -1, dtype=np.int32)
    place[points] = np.arange(len(points))
    nodes = np.where(surface.nodes >= 0, place[surface.nodes], -1).astype(np.int32)
    return replace(surface, points=coordinates, nodes=nodes)


def _among_all(matrix: Sparse, points: NDArray[np.int64], width: int, n_points: int) -> Sparse:
    """A matrix with ``width`` columns for each of some points, as one with columns for all points."""
    place = dofs_at(points, width).ravel()
    rows = matrix.tocsr()
    return sp.csr_matrix((rows.data, place[rows.indices], rows.indptr), shape=(rows.shape[0], n_dofs(n_points, width)))


def _couple(
    store: Store, contactor: Surface, target: Surface, degree: int, options: CouplingOptions, chosen: NDArray[np.bool_]
) -> Coupling:
    return couple_here(contactor, target, degree, options, chosen)


def _differentiate(
    store: Store, contactor: Surface, target: Surface, degree: int, options: CouplingOptions, load: ContactLoad,
    normals: MovingNormals, chosen: NDArray[np.bool_],
) -> Json | AbutError:  # fmt: skip
    """As ``of_facets``; errors are returned, as the others would wait for a process that has left."""
    try:
        return of_facets(contactor, target, degree, options, load, normals, chosen)
    except AbutError as error:
        return error

"""Friction of a pair at current positions: rows of the tractions' forces, slips and derivatives, theory (G4) to (G6)."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import scipy.sparse as sp
from numpy.typing import NDArray

from abut.contact.block_rows import CompressedRows, added_up, block_rows, in_place, row_numbers
from abut.contact.coupling_tangent import CouplingTangent
from abut.contact.slip_points import SlipNow
from abut.dofs import n_places
from abut.mesh.surface import Surface
from abut.problem.tangent_frames import Frames, FramesNow
from abut.types import Sparse

Array = NDArray[np.float64]


@dataclass(frozen=True)
class Rubbing:
    """What friction adds, m rows. rows: (m, dim n_points) of the forces; slip: (m,) weighted; by_position: (m, dim n_points)
    its derivative; bending: (dim n_points, dim n_points) derivative of the forces by the tangents' turning."""

    rows: Sparse
    slip: Array
    by_position: Sparse
    bending: Sparse | None = None


def rub_in_plane(part: Sparse, by: CouplingTangent, operators: CompressedRows, slip: SlipNow) -> Rubbing:
    """2D: one component along the normals turned by a right angle. part: (m, 9 n_facets); operators: as in
    ``CouplingTangent``, functions added up."""
    normals, points = (n_places(n, 2) for n in by.turning.shape)
    by_normals = block_rows(added_up(part, slip.by_normals, normals), normals)
    by_points = block_rows(added_up(part, slip.by_points, points), points)
    return Rubbing(
        block_rows(in_place(operators[0][..., 2:], operators), points).tocsr(),
        np.asarray(part @ slip.value[:, 0]),
        (by_points + by_normals @ by.turning).tocsr(),
    )


@dataclass(frozen=True)
class Tangents:
    """Of n functions in 3D. frames, now: as they turn; along: (n, 2) tractions along them; kept: (m,) which of the 2 n, two
    a function, have multipliers."""

    frames: Frames
    now: FramesNow
    along: Array
    kept: NDArray[np.int64]

    @property
    def traction(self) -> Array:
        """(n, 3)."""
        return np.asarray(np.einsum("nb,nbd->nd", self.along, self.now.tangents))


def rub_in_space(
    down: Sparse, by: CouplingTangent, operators: CompressedRows, slip: SlipNow, tangents: Tangents, contactor: Surface
) -> Rubbing:
    """3D: two components along tangents that turn with the surface. down: (n, 9 n_facets); operators: blocks (n, 3, 3)
    of tractions along the axes, functions added up."""
    at, kept = tangents.now, tangents.kept
    normals, points = (n_places(n, 3) for n in by.turning.shape)
    value = down @ slip.value
    rows = block_rows(_along(at.tangents, operators), points)
    by_points = block_rows(_along(at.tangents, added_up(down, slip.by_points, points)), points)
    by_normals = block_rows(_along(at.tangents, added_up(down, slip.by_normals, normals)), normals)
    # of the tangents: v . dT_b, and t_b dT_b
    slopes = tangents.frames.spread(contactor, np.einsum("na,nbac->nbc", value, at.by_along))
    turns = _at_normals(np.einsum("na,nbac->nbc", value, at.by_normal), at.number, normals)
    pulled = tangents.frames.spread(contactor, np.einsum("nb,nbac->nac", tangents.along, at.by_along))
    turned = _at_normals(np.einsum("nb,nbac->nac", tangents.along, at.by_normal), at.number, normals)
    return Rubbing(
        rows.tocsr()[kept],
        np.einsum("nd,nbd->nb", value, at.tangents).ravel()[kept],
        (by_points + slopes + (by_normals + turns) @ by.turning).tocsr()[kept],
        block_rows(operators, points).T @ (pulled + turned @ by.turning),
    )


def _along(tangents: Array, parts: CompressedRows) -> CompressedRows:
    """Components (n, 2, 3) along the tangents (n_functions, 2, 3) of blocks (n, 3, 3)."""
    value, column, start = parts
    return tangents[row_numbers(start)] @ value, column, start


def _at_normals(values: Array, number: NDArray[np.int32], normals: int) -> Sparse:
    """A block (n, r, 3) a row, in the columns of the nodal normals."""
    return sp.bsr_matrix(
        (values, number, np.arange(len(values) + 1)), shape=(values.shape[1] * len(values), 3 * normals)
    )

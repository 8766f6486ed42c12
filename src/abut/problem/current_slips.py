"""A pair at current positions: its forces, and the slips of its points."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
import scipy.sparse as sp
from numpy.typing import NDArray

from abut.contact.block_rows import CompressedRows, added_up, in_place, weights_of_rows
from abut.contact.coupling_tangent import ContactLoad, CouplingTangent
from abut.contact.moving_normals import MovingNormals
from abut.contact.slip_points import SlipPoints, slip_now
from abut.mesh.surface import Surface
from abut.problem.current_friction import Rubbing, Tangents, rub_in_plane, rub_in_space
from abut.problem.dual_functions import Mixed
from abut.problem.kinematics import ContactNow
from abut.problem.pair import Pair
from abut.types import Sparse

Array = NDArray[np.float64]


@dataclass(frozen=True)
class Seen:
    """A pair where it is, with its functions as they are mixed there. down: (n_functions, 9 n_facets) of the functions;
    operators: those of ``by``, added up with it; tangents: None in 2D; mixed: None where no function is a dual one."""

    pair: Pair
    contactor: Surface
    target: Surface
    normals: MovingNormals
    tangents: Tangents | None
    by: CouplingTangent
    down: Sparse
    operators: CompressedRows
    mixed: Mixed | None

    def rubbed(self, points: SlipPoints, multipliers: Array) -> Rubbing:
        """With the slip of points, tractions being those of multipliers (n,)."""
        slip, n_points = slip_now(points, self.contactor, self.target, self.normals), len(self.contactor.points)
        if self.tangents is None:
            part = weights_of_rows(self.pair.components[1].transfer.T)
            made = rub_in_plane(part, self.by, added_up(part, self.by.operators, n_points), slip)
            along = multipliers[self.pair.tangential]
            return made if self.mixed is None else self.mixed.rubbed_in_plane(made, slip, along)
        square = in_place(self.operators[0][..., 3:].reshape(-1, 3, 3), self.operators)
        made = rub_in_space(self.down, self.by, square, slip, self.tangents, self.contactor)
        return made if self.mixed is None else self.mixed.rubbed_in_space(made, slip, self.tangents)


def either(one: Rubbing, other: Rubbing, those: NDArray[np.bool_]) -> Rubbing:
    """With the slips of the other in ``those`` rows (m,); forces are the same."""
    keep, take = (sp.diags(mask.astype(float)) for mask in (~those, those))
    by_position = keep @ one.by_position + take @ other.by_position
    return replace(one, slip=np.where(those, other.slip, one.slip), by_position=by_position.tocsr())


def contact_load(pair: Pair, multipliers: Array, tangents: Tangents | None) -> ContactLoad:
    pressure = pair.space.transfer @ multipliers[pair.normal]
    if tangents is not None:
        return ContactLoad(pressure, traction=pair.space.transfer @ tangents.traction)
    if pair.frictional:
        return ContactLoad(pressure, turned=pair.components[1].transfer @ multipliers[pair.tangential])
    return ContactLoad(pressure)


def with_friction(now: ContactNow, made: Rubbing, tangents: Array, without_history: NDArray[np.bool_]) -> ContactNow:
    """The same with friction; tangents: (n_functions, dim - 1, dim)."""
    assert now.pair.slip is not None
    assert now.bending is not None
    return ContactNow(
        replace(
            now.pair,
            rows=sp.vstack([now.pair.rows, made.rows], format="csr"),
            slip=replace(now.pair.slip, tangents=tangents),
        ),
        np.concatenate([now.gap, made.slip]),
        sp.vstack([now.by_position, made.by_position], format="csr"),
        now.bending if made.bending is None else (now.bending + made.bending.tocsr()),
        without_history,
    )

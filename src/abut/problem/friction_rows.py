"""The multipliers of a contact with friction: pressure, and traction along the tangents of the contactor."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import scipy.sparse as sp
from numpy.typing import NDArray

from abut.contact.function_places import places
from abut.contact.pressure_space import PressureSpace, only
from abut.contact.tangential import SlipOperators, frames
from abut.mesh.surface import Surface
from abut.problem.constraints import Supports
from abut.problem.held_multipliers import NO_EFFECT, row_norms
from abut.types import Sparse


@dataclass(frozen=True)
class Slip:
    """What makes tangential rows. operators: by facets; tangents: (n_functions, dim - 1, dim) unit, at the place of each
    function of the pressure, ``points`` (n_functions, dim)."""

    operators: SlipOperators
    tangents: NDArray[np.float64]
    points: NDArray[np.float64]


@dataclass(frozen=True)
class FrictionRows:
    """Multipliers component by component, the pressure first. components: the space of each; index: (n_functions, dim) the
    multiplier of each function and component, -1 where there is none; rows: (n, dim n_points) on all displacements."""

    components: tuple[PressureSpace, ...]
    index: NDArray[np.int64]
    rows: Sparse
    slip: Slip


def friction_rows(
    contactor: Surface, space: PressureSpace, normal: Sparse, operators: SlipOperators, held: Supports
) -> FrictionRows:
    """Rows of the gap (``normal``) and of the slip, theory (R1). Where supports hold the contactor's node along a tangent,
    as at a plane of symmetry, there is no traction along it."""
    dim, n = contactor.dim, len(space)
    points, outward = places(contactor, space)
    axes = [held.can_move(space.node, np.broadcast_to(np.eye(dim)[a], (n, dim))) for a in range(dim)]
    moves = np.where(space.node[:, None, None] >= 0, np.stack(axes, axis=1), np.eye(dim))  # facets are held by no node
    tangents, free = frames(-outward, moves)
    fields = [(space.transfer.T @ own).tocsr() for own in operators.along]
    index, first = np.full((n, dim), -1), n
    index[:, 0] = np.arange(n)
    rows, components = [normal], [space]
    for b in range(dim - 1):
        parts = fields if dim == 2 else [sp.diags(tangents[:, b, a]) @ fields[a] for a in range(dim)]
        own = sum(parts[1:], parts[0]).tocsr()
        keep = free[:, b] & (row_norms(own @ held.free) > NO_EFFECT * space.weight)
        rows.append(own[keep])
        components.append(only(space, keep))
        index[keep, 1 + b] = first + np.arange(int(keep.sum()))
        first += int(keep.sum())
    return FrictionRows(tuple(components), index, sp.vstack(rows).tocsr(), Slip(operators, tangents, points))

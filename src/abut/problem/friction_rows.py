"""The multipliers of a contact with friction: pressure, and traction along the tangents of the contactor."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import scipy.sparse as sp
from numpy.typing import NDArray

from abut.contact.function_places import places
from abut.contact.pressure_space import PressureSpace, only
from abut.contact.tangential import SlipOperators, frames
from abut.contact.turned_functions import by_turn
from abut.mesh.surface import Surface
from abut.problem.constraints import Constraints
from abut.problem.held_multipliers import NO_EFFECT, row_norms
from abut.problem.pair import Slip
from abut.problem.relative_motion import passing
from abut.types import Array, Sparse


@dataclass(frozen=True)
class Sides:
    """Contactor and target within ``reach`` of each other, and the normals of the contactor for friction, (n_facets, 9,
    dim). move: rows are looked at where bodies are, so that what nothing moves at the outset may be moved later."""

    contactor: Surface
    target: Surface
    at_facets: NDArray[np.float64]
    reach: float
    move: bool = False


@dataclass(frozen=True)
class FrictionRows:
    """Multipliers component by component, the pressure first. components: the space of each; index: (n_functions, dim) the
    multiplier of each function and component, -1 where there is none; rows: (n, dim n_points) on all displacements; carried:
    (n_tangential,) that the target alone sees, as supports hold the contactor's point."""

    components: tuple[PressureSpace, ...]
    index: NDArray[np.int64]
    rows: Sparse
    slip: Slip
    carried: NDArray[np.bool_]


def friction_rows(
    pair: Sides, space: PressureSpace, normal: Sparse, operators: SlipOperators, constraints: Constraints
) -> FrictionRows:
    """Rows of the gap (``normal``) and of the slip, theory (R1). Where supports hold both sides along a tangent, as at a
    plane of symmetry, there is no traction along it; where they hold the contactor's node alone, the target carries it."""
    dim, n = pair.contactor.dim, len(space)
    points, outward = places(pair.contactor, space, pair.at_facets)
    normals = -outward
    past = passing(pair.contactor, pair.target, space.node, normals, pair.reach, constraints)
    tangents, free = frames(normals, past.moves)
    fields = _fields(pair.contactor, space, operators, tangents)
    index, first = np.full((n, dim), -1), n
    index[:, 0] = np.arange(n)
    rows, components, carried = [normal], [space], list[NDArray[np.bool_]]()
    for b in range(dim - 1):
        part = fields[b]
        keep = free[:, b] if pair.move else free[:, b] & _seen(part, space.weight, constraints)
        rows.append(part[keep])
        components.append(only(space, keep))
        carried.append(past.carried(tangents[:, b])[keep])
        index[keep, 1 + b] = first + np.arange(int(keep.sum()))
        first += int(keep.sum())
    slip = Slip(operators, tangents, points, normals, pair.at_facets)
    return FrictionRows(tuple(components), index, sp.vstack(rows).tocsr(), slip, np.concatenate(carried))


def _fields(contactor: Surface, space: PressureSpace, operators: SlipOperators, tangents: Array) -> list[Sparse]:
    """Rows (n, dim n_points) of the slip along each of the functions' tangents (n, dim - 1, dim), which beyond the side of a
    sector are turned."""
    if contactor.dim == 2:  # along the surface, whichever way it goes
        return [(space.transfer.T @ part).tocsr() for part in operators.along]
    turned = [
        (tangents @ turn.T, [(part.T @ along).tocsr() for along in operators.along])
        for turn, part in by_turn(contactor, space.node, space.transfer)
    ]
    result = []
    for b in range(2):
        parts = [sp.diags(way[:, b, a]) @ fields[a] for way, fields in turned for a in range(3)]
        result.append(sum(parts[1:], parts[0]).tocsr())
    return result


def _seen(rows: Sparse, weight: NDArray[np.float64], constraints: Constraints) -> NDArray[np.bool_]:
    """Rows (n, dim n_points) of slip that free displacements or prescribed ones change, (n,)."""
    size = max(float(np.abs(constraints.prescribed).max(initial=0.0)), 1e-300)
    told = np.linalg.norm(rows @ constraints.prescribed, axis=1) / size
    return np.maximum(row_norms((rows @ constraints.free).tocsr()), told) > NO_EFFECT * weight

"""The multipliers of a contact with friction: pressure, and traction along the tangents of the contactor."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import scipy.sparse as sp
from numpy.typing import NDArray
from scipy.linalg import qr

from abut.cells import MAX_FACET_NODES
from abut.contact.function_places import places
from abut.contact.node_to_segment import feet
from abut.contact.pressure_space import PressureSpace, only
from abut.contact.tangential import SlipOperators, frames
from abut.mesh.surface import Surface
from abut.problem.constraints import Constraints
from abut.problem.held_multipliers import NO_EFFECT, row_norms
from abut.types import Sparse

MOVES = 1e-6  # of a point of the target along a tangent, by unit free displacements, below which it is held
INDEPENDENT = 1e-3  # of a row's part that others do not have, over the largest
FEW = 1000  # held nodes up to which a look at them costs little


@dataclass(frozen=True)
class Sides:
    """Contactor and target within ``reach`` of each other, and the normals of the contactor for friction, (n_facets, 9,
    dim)."""

    contactor: Surface
    target: Surface
    at_facets: NDArray[np.float64]
    reach: float


@dataclass(frozen=True)
class Slip:
    """What makes tangential rows. operators: by facets; tangents: (n_functions, dim - 1, dim), normals: (n_functions, dim)
    from target to contactor, unit, at the place of each function of the pressure, ``points`` (n_functions, dim);
    at_facets: (n_facets, 9, dim) normals of the contactor, None for large sliding; area: (n_functions,) by which weighted
    slips are divided, None for int H_k as it is."""

    operators: SlipOperators
    tangents: NDArray[np.float64]
    points: NDArray[np.float64]
    normals: NDArray[np.float64]
    at_facets: NDArray[np.float64] | None = None
    area: NDArray[np.float64] | None = None


@dataclass(frozen=True)
class FrictionRows:
    """Multipliers component by component, the pressure first. components: the space of each; index: (n_functions, dim) the
    multiplier of each function and component, -1 where there is none; rows: (n, dim n_points) on all displacements."""

    components: tuple[PressureSpace, ...]
    index: NDArray[np.int64]
    rows: Sparse
    slip: Slip


def friction_rows(
    pair: Sides, space: PressureSpace, normal: Sparse, operators: SlipOperators, constraints: Constraints
) -> FrictionRows:
    """Rows of the gap (``normal``) and of the slip, theory (R1). Where supports hold both sides along a tangent, as at a
    plane of symmetry, there is no traction along it; where they hold the contactor's node alone, the target carries it."""
    dim, n = pair.contactor.dim, len(space)
    points, outward = places(pair.contactor, space, pair.at_facets)
    normals = -outward
    axes = [constraints.can_move(space.node, np.broadcast_to(np.eye(dim)[a], (n, dim))) for a in range(dim)]
    moves = np.where(space.node[:, None, None] >= 0, np.stack(axes, axis=1), np.eye(dim))  # facets are held by no node
    tangents, free = frames(normals, moves)
    fields = [(space.transfer.T @ part).tocsr() for part in operators.along]
    index, first = np.full((n, dim), -1), n
    index[:, 0] = np.arange(n)
    rows, components = [normal], [space]
    for b in range(dim - 1):
        parts = fields if dim == 2 else [sp.diags(tangents[:, b, a]) @ fields[a] for a in range(dim)]
        part = sum(parts[1:], parts[0]).tocsr()
        reduced = (part @ constraints.free).tocsr()
        keep = free[:, b] & (row_norms(reduced) > NO_EFFECT * space.weight)
        keep |= carried_by_target(pair, space, normals, tangents[:, b], keep, reduced, constraints)
        rows.append(part[keep])
        components.append(only(space, keep))
        index[keep, 1 + b] = first + np.arange(int(keep.sum()))
        first += int(keep.sum())
    slip = Slip(operators, tangents, points, normals, pair.at_facets)
    return FrictionRows(tuple(components), index, sp.vstack(rows).tocsr(), slip)


def carried_by_target(
    pair: Sides, space: PressureSpace, normals: NDArray[np.float64], along: NDArray[np.float64],
    keep: NDArray[np.bool_], rows: Sparse, constraints: Constraints,
) -> NDArray[np.bool_]:  # fmt: skip
    """Functions (n,) other than ``keep`` whose contactor's node is held along a tangent, (n, dim), while the target opposite
    can move, as at a clamped edge; beside others that are kept, and as many as do not repeat each other: the contactor has
    no displacement of its own there, which would tell them apart. rows: (n, n_free) of the slip."""
    result = np.zeros(len(space), dtype=bool)
    uses = abs(space.plain)
    of_facets = [
        (uses @ chosen.astype(float)).reshape(-1, MAX_FACET_NODES).sum(axis=1) > 0.0 for chosen in (keep, ~keep)
    ]
    alone = uses.T @ np.repeat(of_facets[1] & ~of_facets[0], MAX_FACET_NODES).astype(float) > 0.0
    asked = np.flatnonzero(~keep & ~alone & (space.node >= 0) & (row_norms(rows) > NO_EFFECT * space.weight))
    if not 0 < len(asked) <= FEW:
        return result
    points = pair.contactor.points[space.node[asked]]
    facet, weights, _ = feet(points, -normals[asked], pair.target, pair.reach)
    nodes = pair.target.nodes[facet]
    dim = pair.contactor.dim
    function, local = np.nonzero((nodes >= 0) & (facet >= 0)[:, None])
    moved = sp.csr_matrix((len(asked), constraints.free.shape[0]))
    for a in range(dim):
        value = weights[function, local] * along[asked[function], a]
        column = dim * nodes[function, local].astype(np.int64) + a
        moved = moved + sp.csr_matrix((value, (function, column)), shape=moved.shape)
    asked = asked[row_norms(moved @ constraints.free) > MOVES]
    if len(asked):
        gram = (rows[asked] @ rows[asked].T).toarray() / np.multiply.outer(space.weight[asked], space.weight[asked])
        _, left, order = qr(gram, pivoting=True)
        size = np.abs(np.diag(left))
        result[asked[order[size > INDEPENDENT * size[0]]]] = True
    return result

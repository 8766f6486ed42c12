"""Multipliers of a contact that supports leave nothing to do."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from abut.contact.coupling import Coupling
from abut.contact.geometry import CREASE, side_normals
from abut.contact.pressure_space import PressureSpace, beside, reduce
from abut.mesh.surface import Surface
from abut.problem.constraints import Constraints
from abut.types import Sparse

HELD = 1.0 - 1e-9  # share of the normal direction held by supports above which a contactor node cannot move along it
SAME_DIRECTION = 0.3  # sine of the angle between normals at a crease below which their sides have one pressure
NO_EFFECT = 1e-10  # size of an operator row on the free displacements, relative to its weight, that counts as zero


def without_held(
    space: PressureSpace, contactor: Surface, coupling: Coupling, constraints: Constraints
) -> PressureSpace:
    """Take out multipliers at contactor nodes that supports hold along the normal, beside others that they do not: with them
    the constant of theory (P7) falls from 0.8 to 0.03. Those with none beside them stay: the target alone sees what they
    press. Those of the sides of a crease whose normals supports leave one direction for become one."""
    keep = ~held(space, contactor, constraints)
    sits = np.flatnonzero(space.node >= 0)
    if not (len(sits) and keep.any()):
        return space
    keep |= ~beside(space, keep)
    _, at = side_normals(contactor)
    nodes, count = np.unique(space.node[sits[keep[sits]]], return_counts=True)
    several = sits[np.isin(space.node[sits], nodes[count > 1]) & keep[sits]]
    onto = np.full(len(space), -1)
    if len(several):
        at_node = at[space.side[several]]
        first = _repeated(space.node[several], at_node, constraints.can_move(space.node[several], at_node))
        onto[several[first >= 0]] = several[first[first >= 0]]
    return reduce(space, coupling, keep & (onto < 0), onto=onto)


def held(space: PressureSpace, contactor: Surface, constraints: Constraints) -> NDArray[np.bool_]:
    """Functions (n,) at nodes that supports hold along the contactor's normal."""
    sits = np.flatnonzero(space.node >= 0)
    result = np.zeros(len(space), dtype=bool)
    if len(sits):
        normals = side_normals(contactor)[1][space.side[sits]]
        result[sits] = constraints.held_share(space.node[sits], normals) >= HELD
    return result


def _repeated(
    nodes: NDArray[np.int64], normals: NDArray[np.float64], directions: NDArray[np.float64]
) -> NDArray[np.int64]:
    """Of directions (n, dim) at nodes (n,), the first one at the same node where they add nothing to those before them,
    else -1. Those with one of the normals (n, dim) before them are no crease's, but of another part: -1."""
    result = np.full(len(nodes), -1)
    before: dict[int, list[NDArray[np.float64]]] = {}
    first: dict[int, int] = {}
    seen: dict[int, list[NDArray[np.float64]]] = {}
    for i, (node, normal, direction) in enumerate(zip(nodes.tolist(), normals, directions)):
        others = seen.setdefault(node, [])
        if any(normal @ other > CREASE for other in others):
            continue
        others.append(normal)
        basis = before.setdefault(node, [])
        rest = direction - sum(((direction @ other) * other for other in basis), np.zeros(len(direction)))
        size = float(np.linalg.norm(rest))
        if basis and size < SAME_DIRECTION:
            result[i] = first[node]
            continue
        first.setdefault(node, i)
        basis.append(rest / max(size, 1e-300))
    return result


def row_norms(matrix: Sparse) -> NDArray[np.float64]:
    """Euclidean norms of the rows of a sparse matrix, (n,)."""
    return np.sqrt(np.asarray(matrix.multiply(matrix).sum(axis=1)).ravel())

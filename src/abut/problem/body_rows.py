"""What is prescribed of rigid bodies and couplings, as rows in the unknowns of ``problem/constraints``."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
import scipy.sparse as sp
from numpy.typing import NDArray

from abut.model.conditions import History, Rigid
from abut.problem.rigid_bodies import RigidBody
from abut.types import Array, Sparse


@dataclass(frozen=True)
class Rows:
    """matrix @ unknowns = values: matrix (m, n) sparse, values (m, n_histories)."""

    matrix: Sparse
    values: Array


def body_rows(
    body: RigidBody, histories: Sequence[History], free: Sparse, prescribed: Array, columns: NDArray[np.int64]
) -> Rows:
    """What is prescribed of a body, then what holds its points to it, theory (F13). free: (dim n_points, n) displacements by
    the unknowns, of which ``columns`` are the body's own; prescribed: (dim n_points, n_histories) the rest of them."""
    given, values = body.prescribed(histories)
    dim = body.points.shape[1]
    dofs = (dim * body.nodes[:, None] + np.arange(dim)).ravel()
    if body.mean:
        by_points = sp.csr_matrix(given @ body.spreading().T)
        return Rows((by_points @ free[dofs]).tocsr(), values - by_points @ prescribed[dofs])
    loose = np.zeros((0, given.shape[1])) if isinstance(body.rigid, Rigid) else body.loose(given)
    shift = sp.csr_matrix(
        (np.ones(len(columns)), (np.arange(len(columns)), columns)), shape=(len(columns), free.shape[1])
    )
    matrix = sp.csr_matrix(np.concatenate([given, loose])) @ shift
    values = np.concatenate([values, np.zeros((len(loose), values.shape[1]))])
    if body.whole:
        return Rows(matrix, values)
    kept = dofs.reshape(body.points.shape)[:, body.follow].ravel()
    moved = body.moved(body.points)[:, body.follow].reshape(len(kept), -1)
    following = (free[kept] - sp.csr_matrix(moved) @ shift).tocsr()
    return Rows(sp.vstack([matrix, following], format="csr"), np.concatenate([values, -prescribed[kept]]))

"""How far thin parts give way, beside which an overlap between nodes is large or small: theory (L10)."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from abut.mesh.record import MeshRecord
from abut.model import Model
from abut.problem.pair import Pair

SHARE = 0.1  # of it that surfaces may overlap: (L10) says why forces between them are then right to a twentieth

Array = NDArray[np.float64]


def bends(model: Model, pair: Pair, displacement: Array, internal: Array) -> float | None:
    """As ``thin_give`` of the bodies made of shells that a side of a pair is on; None where there are none.

    displacement: (n_points, dim); internal: (dim n_points,) nodal forces of stresses."""
    mesh = model.mesh
    sides = [side.node_ids for side in (pair.contactor, pair.target)]
    thin = [body for body in mesh.shells if any(np.isin(side, mesh.nodes_of(body)).mean() > 0.5 for side in sides)]
    if not thin:
        return None
    return thin_give(mesh, thin, displacement, internal.reshape(-1, mesh.dim), not model.small_strains)


def thin_give(mesh: MeshRecord, bodies: list[str], displacement: Array, internal: Array, finite: bool) -> float:
    """The least, over bodies, of how far the forces on a thin body move in the mean, a length: twice its elastic energy over
    the sum of the sizes of the nodal forces of its stresses. 0 where there is none.

    displacement, internal: (n_points, 3); what others that share nodes have of the forces there counts as well. finite:
    whether turns may be large; else the forces, which balance, do no work on them."""
    found = []
    for body in bodies:
        nodes = mesh.nodes_of(body)
        forces, bent = internal[nodes], displacement[nodes]
        if finite:
            bent = _bent(mesh.points[nodes], bent)
        size = float(np.linalg.norm(forces, axis=1).sum())
        if size > 0.0:
            found.append(abs(float((forces * bent).sum())) / size)
    return min(found, default=0.0)


def _bent(points: Array, displacement: Array) -> Array:
    """Displacements (n, 3) beyond the rigid motion nearest to them (Kabsch 1976)."""
    x = points - points.mean(axis=0)
    now = points + displacement
    now = now - now.mean(axis=0)
    left, _, right = np.linalg.svd(x.T @ now)
    proper = np.diag([1.0, 1.0, np.linalg.det(left @ right)])
    return np.asarray(now - x @ (left @ proper @ right))

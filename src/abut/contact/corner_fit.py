"""Values at the corners of facets of what is fitted in the mean by functions of second order."""

from __future__ import annotations

import numpy as np
import scipy.sparse as sp
from numpy.typing import NDArray

from abut.cells import CELLS
from abut.contact.bases import sound_facets
from abut.contact.bulge import middle_functions
from abut.contact.geometry import corner_functions

Array = NDArray[np.float64]


def fit_functions(kind: str, shapes: Array) -> tuple[Array, Array]:
    """Functions of second order, (q, m), of a facet whose own have the values ``shapes`` (q, 9), and the corners' functions
    as combinations of them, (m, corners). The first ones are 1 at one corner each, the others 0 at all; on facets of
    first order the others are those of the bulge, theory (S13)."""
    if CELLS[kind].degree == 2:
        corners = corner_functions(kind, 2)
        return shapes[:, : len(corners)], corners
    n = CELLS[kind].corners
    functions = np.hstack([shapes[:, :n], middle_functions(kind, shapes)])
    return functions, np.eye(functions.shape[1], n)


def fitted(
    functions: Array, corners: Array, weight: Array, values: Array, group: NDArray[np.int64], count: int
) -> tuple[NDArray[np.bool_], Array, Array, Array]:
    """Fits on ``count`` facets to values (q,) at points, those with weights (q,) on the facets ``group`` (q,): which of
    the facets have enough points, (count,), and of these (s of them) the values at the corners (s, corners), int N_k N_l
    and int N_k v of the corners' functions, (s, corners, corners) and (s, corners).

    functions, corners: as from ``fit_functions``."""
    m, n = corners.shape
    total = sp.csr_matrix((weight, (group, np.arange(len(group)))), shape=(count, len(group)))
    mass = (total @ (functions[:, :, None] * functions[:, None, :]).reshape(-1, m * m)).reshape(-1, m, m)
    moment = total @ (functions * values[:, None])
    sound = sound_facets(mass)
    mass, moment = mass[sound], moment[sound]
    fit = np.linalg.solve(mass, moment[..., None])[:, :n, 0]
    return sound, fit, corners.T @ mass @ corners, moment @ corners

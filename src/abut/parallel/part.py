"""Operations of each process on its part of the cells: stiffness, internal forces, stresses."""

from __future__ import annotations

import numpy as np
import scipy.sparse as sp
from numpy.typing import NDArray

from abut.bodies.assemble import internal_force, stiffness
from abut.bodies.solids import Solids, TemperatureChange
from abut.bodies.stress import stress_sums
from abut.parallel.team import Store


def assemble(store: Store, part: Solids) -> None:
    """Keep the part and the stiffness of its cells over its points."""
    n = part.mesh.points.size
    store["part"] = part
    store["stiffness"] = stiffness(part) if part.mesh.n_cells else sp.csr_matrix((n, n))


def internal(store: Store, displacement: NDArray[np.float64]) -> NDArray[np.float64]:
    """Nodal forces of this part's stresses, (dim n_points, ...). Where the stiffness has made room for the matrix of all
    parts, it is integrated anew."""
    if "stiffness" in store:
        return np.asarray(store["stiffness"] @ displacement)
    part: Solids = store["part"]
    force = np.empty_like(displacement)
    for column in np.ndindex(displacement.shape[1:]):
        place = (slice(None), *column)
        force[place] = internal_force(part, displacement[place].reshape(part.mesh.points.shape))
    return force


def stresses(
    store: Store, temperatures: dict[str, float], displacement: NDArray[np.float64], nodal: NDArray[np.float64]
) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Sums of stresses (n_points, 6) over this part's cells at its points, and how many take part (n_points,)."""
    return stress_sums(store["part"], displacement, TemperatureChange(temperatures, nodal))

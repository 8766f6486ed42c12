"""Operations of each process on its part of the cells: stiffness, internal forces, stresses.

Cells that turn inside out are returned, not raised: the others would wait for a process that has left."""

from __future__ import annotations

import numpy as np
import scipy.sparse as sp
from numpy.typing import NDArray

from abut.bodies.assemble import internal_force, stiffness
from abut.bodies.finite import respond_finite
from abut.bodies.inverted import Inverted
from abut.bodies.solids import Solids, TemperatureChange
from abut.bodies.stress import PointStress, point_stress
from abut.parallel.team import Store

InsideOut = tuple[int, str, float]  # number of a cell of the part, body, determinant of the deformation gradient


def assemble(store: Store, part: Solids, again: bool = False) -> None:
    """Keep the part and the stiffness of its cells over its points; again: also when it has been reduced."""
    n = part.mesh.points.size
    store["part"], store["again"] = part, again
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
    store: Store,
    temperatures: dict[str, float],
    displacement: NDArray[np.float64],
    nodal: NDArray[np.float64] | None,
) -> tuple[PointStress, list[NDArray[np.int64]]] | InsideOut:
    """Stresses at the integration points of this part's groups of cells, and the numbers of these cells in the part."""
    part: Solids = store["part"]
    try:
        stress = point_stress(part, displacement, TemperatureChange(temperatures, nodal))
    except Inverted as error:
        return error.cell, error.body, error.determinant
    return stress, [group.cells for group in part.groups()]


def deform(
    store: Store,
    number: int | None,
    temperatures: dict[str, float],
    displacement: NDArray[np.float64],
    nodal: NDArray[np.float64],
) -> tuple[NDArray[np.float64], float] | InsideOut:
    """Nodal forces (dim n_points,) and elastic energy of this part under finite strains; its tangent is kept under
    ``number``, None for none."""
    part: Solids = store["part"]
    n = part.mesh.points.size
    if not part.mesh.n_cells:
        if number is not None:
            store[number] = sp.csr_matrix((n, n))
        return np.zeros(n), 0.0
    try:
        response = respond_finite(part, displacement, TemperatureChange(temperatures, nodal), number is not None)
    except Inverted as error:
        return error.cell, error.body, error.determinant
    if number is not None:
        store[number] = response.tangent
    return response.force, float(response.energy.sum())


def product(store: Store, number: int, values: NDArray[np.float64]) -> NDArray[np.float64]:
    """Of the tangent kept under ``number`` with values at this part's points."""
    return np.asarray(store[number] @ values)

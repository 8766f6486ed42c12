"""Operations of each process on its part of the cells: stiffness, internal forces, stresses.

Cells that turn inside out are returned, not raised: the others would wait for a process that has left."""

from __future__ import annotations

from collections.abc import Mapping
from typing import NamedTuple

import numpy as np
import scipy.sparse as sp
from numpy.typing import NDArray

from abut.bodies.assemble import internal_force, respond, stiffness
from abut.bodies.evaluation import History
from abut.bodies.inverted import Inverted
from abut.bodies.mass import mass
from abut.bodies.solids import Solids, TemperatureChange
from abut.bodies.stress import PointStress, point_stress
from abut.bodies.stress_stiffness import stress_stiffness
from abut.materials.kernel import Since
from abut.parallel.team import Store
from abut.types import Array


class InsideOut(NamedTuple):
    """Number of a cell of the part, body, determinant of the deformation gradient."""

    cell: int
    body: str
    determinant: float


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
    history: History,
) -> tuple[PointStress, list[NDArray[np.int64]]] | InsideOut:
    """Stresses at the integration points of this part's groups of cells, and the numbers of these cells in the part."""
    part: Solids = store["part"]
    try:
        stress = point_stress(part, displacement, TemperatureChange(temperatures, nodal), history)
    except Inverted as error:
        return InsideOut(error.cell, error.body, error.determinant)
    return stress, [group.cells for group in part.groups()]


def deform(
    store: Store,
    number: int | None,
    temperatures: dict[str, float],
    displacement: NDArray[np.float64],
    nodal: NDArray[np.float64],
    history: History,
    since: Since | None = None,
    elapsed: float = 0.0,
) -> tuple[NDArray[np.float64], float, History] | InsideOut:
    """Nodal forces (dim n_points,), elastic energy and new history of this part; since: as in ``respond``, elapsed: as
    in ``TemperatureChange``; its tangent is kept under ``number``, None for none."""
    part: Solids = store["part"]
    n = part.mesh.points.size
    if not part.mesh.n_cells:
        if number is not None:
            store[number] = sp.csr_matrix((n, n))
        return np.zeros(n), 0.0, {}
    try:
        change = TemperatureChange(temperatures, nodal, elapsed)
        response = respond(part, displacement, change, history, number is not None, since)
    except Inverted as error:
        return InsideOut(error.cell, error.body, error.determinant)
    if number is not None:
        store[number] = response.tangent
    return response.force, float(response.energy.sum()), response.history


def keep_mass(store: Store, number: int, densities: Mapping[str, float], along: Array | None) -> None:
    """Keep the mass of this part, as of ``abut.bodies.mass.mass``, under a number."""
    part: Solids = store["part"]
    n = part.mesh.points.size
    store[number] = mass(part.mesh, densities, along) if part.mesh.n_cells else sp.csr_matrix((n, n))


def keep_stress_stiffness(store: Store, number: int, stress: PointStress) -> None:
    """Keep what stresses at its integration points add to this part's stiffness under a number."""
    part: Solids = store["part"]
    n = part.mesh.points.size
    store[number] = stress_stiffness(part, stress) if part.mesh.n_cells else sp.csr_matrix((n, n))


def product(store: Store, number: int, values: NDArray[np.float64]) -> NDArray[np.float64]:
    """Of the tangent kept under ``number`` with values at this part's points."""
    return np.asarray(store[number] @ values)

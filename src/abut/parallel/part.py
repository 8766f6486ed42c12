"""Operations of each process on its part of the cells: stiffness, internal forces, stresses."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
import scipy.sparse as sp
from numpy.typing import NDArray

from abut.bodies.elements import stiffness, stress_sums
from abut.materials.elastic import LinearElastic
from abut.mesh.mesh import Mesh
from abut.parallel.partition import pieces
from abut.parallel.team import Store

PORTION = 8192  # cells assembled at once where the matrix is not kept


@dataclass(frozen=True)
class Part:
    """The cells of one process and what they are made of."""

    mesh: Mesh
    materials: Mapping[str, LinearElastic]
    plane: str | None
    integration: Mapping[str, str]

    @property
    def empty(self) -> bool:
        """Whether it has no cell."""
        return self.mesh.n_cells == 0


def assemble(store: Store, part: Part) -> None:
    """Keep the part and the stiffness of its cells over its points."""
    store["part"] = part
    store["stiffness"] = _stiffness(part)


def internal(store: Store, displacement: NDArray[np.float64]) -> NDArray[np.float64]:
    """Nodal forces of this part's stresses, (dim n_points, ...). Where the stiffness has made room for the matrix of all
    parts, it is assembled anew, some cells at a time."""
    if "stiffness" in store:
        return np.asarray(store["stiffness"] @ displacement)
    part: Part = store["part"]
    nodal = displacement.reshape(-1, part.mesh.dim, *displacement.shape[1:])
    total = np.zeros_like(nodal)
    portion = np.arange(part.mesh.n_cells) // PORTION
    for piece in pieces(part.mesh, portion, portion.max(initial=-1) + 1):
        own = nodal[piece.points]
        force = _stiffness(replace(part, mesh=piece.mesh)) @ own.reshape(-1, *own.shape[2:])
        total[piece.points] += force.reshape(own.shape)
    return total.reshape(displacement.shape)


def _stiffness(part: Part) -> Any:
    n = part.mesh.points.size
    if part.empty:
        return sp.csr_matrix((n, n))
    return stiffness(part.mesh, part.materials, part.plane, part.integration)


def stresses(
    store: Store, temperatures: Mapping[str, float], displacement: NDArray[np.float64], nodal: NDArray[np.float64]
) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Sums of stresses (n_points, 6) over this part's cells at its points, and how many take part (n_points,)."""
    part: Part = store["part"]
    if part.empty:
        return np.zeros((0, 6)), np.zeros(0)
    return stress_sums(
        part.mesh, part.materials, temperatures, displacement, part.plane, nodal, part.integration
    )  # fmt: skip

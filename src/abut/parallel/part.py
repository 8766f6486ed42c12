"""What each process does with its part of the cells: stiffness, internal forces, stresses."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np
import scipy.sparse as sp
from numpy.typing import NDArray

from abut.mesh.mesh import Mesh
from abut.parallel.team import Store
from abut.solids.elements import stiffness, stress_sums
from abut.solids.materials import LinearElastic


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
    n = part.mesh.points.size
    store["stiffness"] = (
        sp.csr_matrix((n, n)) if part.empty else stiffness(part.mesh, part.materials, part.plane, part.integration)
    )


def internal(store: Store, displacement: NDArray[np.float64]) -> NDArray[np.float64]:
    """Nodal forces of this part's stresses, (dim n_points, ...)."""
    return np.asarray(store["stiffness"] @ displacement)


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



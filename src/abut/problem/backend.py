"""What a solution asks of the volume of the bodies: everything whose work grows with the cells. One process does it here;
``abut.parallel`` has many do it."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, Protocol

import numpy as np
from numpy.typing import NDArray

from abut.bodies.elements import nodal_stress, stiffness
from abut.contact.coupling import Coupling, couple
from abut.linear.choice import Prepared, choose, prepare
from abut.mesh.surface import Surface
from abut.model import Model
from abut.problem.constraints import Supports
from abut.problem.system import System


class Volume(Protocol):
    """The bodies of a model, assembled."""

    def couple(self, contactor: Surface, target: Surface, degree: int, **options: Any) -> Coupling:
        """Cut and integrate the interface of a contact pair, as ``abut.contact.coupling.couple``."""
        ...

    def internal(self, displacement: NDArray[np.float64]) -> NDArray[np.float64]:
        """Nodal forces of stresses under displacements of all points, both (dim n_points,) or (dim n_points, k)."""
        ...

    def reduce(self, held: Supports) -> Any:
        """The stiffness on the free displacements, (n_free, n_free): its shape, diagonal, sums and products."""
        ...

    def stress(
        self, displacement: NDArray[np.float64], time: float, temperature: NDArray[np.float64]
    ) -> NDArray[np.float64]:
        """Nodal averages (n_points, 6) under displacements (n_points, dim) and nodal changes of temperature (n_points,);
        whole solids are heated by their share at ``time``."""
        ...

    def choose(self, system: System, held: Supports) -> str:
        """ "direct" or "amg", by what the user asked for, by size, and by what the solvers can do. Raises InputError."""
        ...

    def prepare(
        self, kind: str, system: System, held: Supports, motions: NDArray[np.float64], loose: NDArray[np.float64]
    ) -> Prepared:
        """Set the linear solver up. motions: (dim n_points, m) that strain bodies least; loose: (n_free, k) those that
        supports leave free. Raises InputError where the solver is not installed or cannot serve the system."""
        ...


@dataclass(frozen=True)
class Whole:
    """All of it in this process. matrix: stiffness over all points, (dim n_points, dim n_points) CSR."""

    model: Model
    matrix: Any

    def couple(self, contactor: Surface, target: Surface, degree: int, **options: Any) -> Coupling:
        """As in ``Volume``."""
        return couple(contactor, target, degree, **options)

    def internal(self, displacement: NDArray[np.float64]) -> NDArray[np.float64]:
        """As in ``Volume``."""
        return np.asarray(self.matrix @ displacement)

    def reduce(self, held: Supports) -> Any:
        """As in ``Volume``, CSR."""
        return held.reduce(self.matrix)

    def stress(
        self, displacement: NDArray[np.float64], time: float, temperature: NDArray[np.float64]
    ) -> NDArray[np.float64]:
        """As in ``Volume``."""
        m = self.model
        return nodal_stress(
            m.mesh, m.materials, m.temperatures(time), displacement, m.plane, temperature, m.integration
        )

    def choose(self, system: System, held: Supports) -> str:
        """As in ``Volume``."""
        return choose(self.model.solve.linear, system, self.model.mesh, held.coupled)

    def prepare(
        self, kind: str, system: System, held: Supports, motions: NDArray[np.float64], loose: NDArray[np.float64]
    ) -> Prepared:
        """As in ``Volume``."""
        return prepare(kind, system, held.free, motions, loose, self.model.mesh.points)


def whole(model: Model) -> Whole:
    """Assemble a model in this process."""
    return Whole(model, stiffness(model.mesh, model.materials, model.plane, model.integration))

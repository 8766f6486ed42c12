"""The bodies of a model, assembled: operations whose cost grows with the number of cells. One process does them here;
``abut.parallel`` has many do them."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Protocol

import numpy as np
from numpy.typing import NDArray

from abut.bodies.assemble import respond, stiffness_at_rest
from abut.bodies.evaluation import History
from abut.bodies.mass import mass
from abut.bodies.solids import TemperatureChange
from abut.bodies.stress import PointStress, point_stress
from abut.bodies.stress_stiffness import stress_stiffness
from abut.contact.coupling import Coupling, CouplingOptions, couple
from abut.contact.coupling_tangent import ContactLoad, CouplingTangent, differentiated
from abut.contact.moving_normals import MovingNormals
from abut.materials.kernel import Since
from abut.mesh.surface import Surface
from abut.model import Model
from abut.problem.constraints import Constraints
from abut.problem.terms import MatrixTangent, Tangent
from abut.types import Array, Operator


@dataclass(frozen=True)
class Deformed:
    """Bodies at a displacement. force: (dim n_points,) of the stresses; tangent: its derivative, where it was asked for;
    energy: elastic, of all bodies (per unit thickness in 2D), as in ``abut.bodies.assemble.Response``; history: the new
    one."""

    force: NDArray[np.float64]
    tangent: Tangent | None
    energy: float
    history: History


class Backend(Tangent, Protocol):
    """The bodies of a model, assembled; as a tangent, at rest."""

    def couple(self, contactor: Surface, target: Surface, degree: int, options: CouplingOptions) -> Coupling:
        """Cut and integrate the interface of a contact pair, as ``abut.contact.coupling.couple``."""
        ...

    def differentiate(
        self, contactor: Surface, target: Surface, degree: int, options: CouplingOptions, load: ContactLoad,
        normals: MovingNormals,
    ) -> CouplingTangent:  # fmt: skip
        """The same at current positions with its derivatives, as ``abut.contact.coupling_tangent.differentiated``."""
        ...

    def stress(
        self, displacement: NDArray[np.float64], change: TemperatureChange, history: History | None = None
    ) -> PointStress:
        """At the integration points under displacements (n_points, dim), as ``abut.bodies.stress.point_stress``."""
        ...

    def deform(
        self,
        displacement: NDArray[np.float64],
        change: TemperatureChange,
        history: History | None = None,
        tangent: bool = True,
        since: Since | None = None,
    ) -> Deformed:
        """At displacements (n_points, dim), after a history; since: as in ``abut.bodies.assemble.respond``.
        Raises ``abut.bodies.inverted.Inverted``."""
        ...

    def mass(self, densities: Mapping[str, float], along: Array | None = None) -> Tangent:
        """Of bodies, as ``abut.bodies.mass.mass``."""
        ...

    def stress_stiffness(self, stress: PointStress) -> Tangent:
        """Of stresses as from ``stress``, as ``abut.bodies.stress_stiffness.stress_stiffness``."""
        ...


@dataclass(frozen=True)
class Serial:
    """All of it in this process. matrix: stiffness over all points, (dim n_points, dim n_points), with its border."""

    model: Model
    matrix: Operator

    def couple(self, contactor: Surface, target: Surface, degree: int, options: CouplingOptions) -> Coupling:
        """Coupling integrals of two surfaces, as in ``Backend``."""
        return couple(contactor, target, degree, options)

    def differentiate(
        self, contactor: Surface, target: Surface, degree: int, options: CouplingOptions, load: ContactLoad,
        normals: MovingNormals,
    ) -> CouplingTangent:  # fmt: skip
        """Coupling integrals and their derivatives, as in ``Backend``."""
        return differentiated(contactor, target, degree, options, load, normals)

    def internal(self, displacement: NDArray[np.float64]) -> NDArray[np.float64]:
        """Nodal forces of stresses, as in ``Backend``."""
        return np.asarray(self.matrix @ displacement)

    def reduce(self, constraints: Constraints) -> Operator:
        """The stiffness on the free displacements, as in ``Backend``, CSR or ``Bordered``."""
        return constraints.reduced(self.matrix)

    def stress(
        self, displacement: NDArray[np.float64], change: TemperatureChange, history: History | None = None
    ) -> PointStress:
        """Stresses at integration points, as in ``Backend``."""
        return point_stress(self.model.deformable, displacement, change, history)

    def deform(
        self,
        displacement: NDArray[np.float64],
        change: TemperatureChange,
        history: History | None = None,
        tangent: bool = True,
        since: Since | None = None,
    ) -> Deformed:
        """Forces, tangent and histories of deformed bodies, as in ``Backend``."""
        response = respond(self.model.deformable, displacement, change, history, tangent, since)
        slope = Serial(self.model, response.tangent) if tangent else None
        return Deformed(response.force, slope, float(response.energy.sum()), response.history)

    def mass(self, densities: Mapping[str, float], along: Array | None = None) -> Tangent:
        """The mass matrix, as in ``Backend``."""
        return MatrixTangent(mass(self.model.mesh, densities, along))

    def stress_stiffness(self, stress: PointStress) -> Tangent:
        """The stiffness that stresses add, as in ``Backend``."""
        return MatrixTangent(stress_stiffness(self.model.deformable, stress))


def serial(model: Model) -> Serial:
    """Assemble a model in this process."""
    return Serial(model, stiffness_at_rest(model.deformable))

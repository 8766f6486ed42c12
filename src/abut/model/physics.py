"""What else a model may have beside displacements: fields with terms of their own in the balance."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any, Protocol

import numpy as np
from numpy.typing import NDArray

from abut.dofs import DISPLACEMENT, Dofs, Field
from abut.errors import InputError
from abut.mesh.mesh import Mesh
from abut.model.conditions import History

TEMPERATURE = "temperature"  # field at nodes whose values bodies take as a change of temperature


@dataclass(frozen=True)
class Held:
    """Values of a field that are prescribed. dofs: (n,) as from ``Dofs.of``; values: (n,); amplitude: their history, the
    ramp without."""

    dofs: NDArray[np.int64]
    values: NDArray[np.float64]
    amplitude: History = None


class Physics(Protocol):
    """Fields beside displacements, what is prescribed of them, and terms that know them.

    Terms are as ``abut.problem.terms.Term``: forces over all values (``Dofs.size``,), those of a field being what balances
    in it (heat flows, say), and a ``MatrixTangent`` of that size. Bodies expand with a field at nodes named
    "temperature"."""

    def fields(self, mesh: Mesh) -> Sequence[Field]:
        """What it adds, with names of their own."""
        ...

    def held(self, model: Any, dofs: Dofs) -> Sequence[Held]:
        """What is prescribed in a model (``abut.Model``)."""
        ...

    def terms(self, model: Any, dofs: Dofs) -> Sequence[Any]:
        """Its part in the balance of a model (``abut.Model``); their names are their own."""
        ...

    @property
    def amplitudes(self) -> Sequence[History]:
        """Histories of all that is prescribed."""
        ...


class HasFields(Protocol):
    """What adds fields."""

    def fields(self, mesh: Mesh) -> Sequence[Field]:
        """What it adds, with names of their own."""
        ...


def dofs_of(mesh: Mesh, physics: Sequence[HasFields]) -> Dofs:
    """Displacements, then all other fields. Raises InputError for a name that is there twice."""
    every = [Field(DISPLACEMENT, *mesh.points.shape)]
    for i, item in enumerate(physics):
        for field in item.fields(mesh):
            if field.name in [other.name for other in every]:
                raise InputError(f"physics[{i}]: there is another field '{field.name}'; give it another name")
            every.append(field)
    return Dofs(tuple(every))

"""Terms of the balance of forces: bodies and loads, each as force and tangent at a displacement."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from typing import Protocol

import numpy as np
from numpy.typing import NDArray

from abut.materials.kernel import Since
from abut.model.rates import Rates
from abut.problem.constraints import Constraints
from abut.problem.wet import Wet
from abut.types import Operator

Vector = NDArray[np.float64]


class Tangent(Protocol):
    """A tangent stiffness over all points."""

    def internal(self, displacement: NDArray[np.float64]) -> NDArray[np.float64]:
        """Nodal forces under displacements of all points, both (dim n_points,) or (dim n_points, k)."""
        ...

    def reduce(self, constraints: Constraints) -> Operator:
        """The same on the free displacements, (n_free, n_free): its shape, diagonal, sums and products."""
        ...


@dataclass(frozen=True)
class MatrixTangent:
    """A tangent that is a matrix, sparse or ``Bordered``: over all values (n_values, n_values), or over displacements
    alone."""

    matrix: Operator

    def internal(self, displacement: NDArray[np.float64]) -> NDArray[np.float64]:
        """Forces by a change of displacements, as in ``Tangent``."""
        return np.asarray(self.matrix @ displacement)

    def reduce(self, constraints: Constraints) -> Operator:
        """The tangent on the free displacements, as in ``Tangent``."""
        return constraints.reduced(self.matrix)


@dataclass(frozen=True)
class Motion:
    """What a term sees of a state. displacement: (dim n_points,) of all points; history: the term's, by part, empty at the
    start; fields: others by name, (places, components); rates: of all values (n_values,), None without a time integration;
    wet: how far fluids have got into contacts, in turn; since: from where Newton's method came, None: from nowhere."""

    time: float
    displacement: Vector
    history: Mapping[str, Vector] = field(default_factory=dict)
    fields: Mapping[str, Vector] = field(default_factory=dict)
    rates: Rates | None = None
    wet: Sequence[Wet] = ()
    since: Since | None = None


@dataclass(frozen=True)
class Share:
    """A term's share of the balance of forces. force: (dim n_points,) on the left-hand side (loads are negative there), or
    (n_values,) of all fields; tangent: what reduces to the unknowns, over values as the force has them, None for none;
    history: as in ``Motion``, new; symmetric: the tangent; energy: elastic, of a term that knows it, not a number where a
    material does not tell it; sizes: as the force, what residuals of
    other fields are judged against, None for the force itself."""

    force: Vector
    tangent: Tangent | None = None
    history: Mapping[str, Vector] = field(default_factory=dict)
    symmetric: bool = True
    energy: float | None = None
    sizes: Vector | None = None


class Term(Protocol):
    """Part of the balance of forces. name: of its history; constant: its tangent never changes (the same object comes back)
    and its force is affine in the displacement."""

    @property
    def name(self) -> str: ...

    @property
    def constant(self) -> bool: ...

    def evaluate(self, before: Motion, now: Motion) -> Share:
        """Force and tangent at ``now``, which follows the converged ``before``, whose history both carry."""
        ...


def added_up(forces: Sequence[Vector], size: int) -> Vector:
    """The sum of forces, (size,); those that are shorter are of the first values alone."""
    if all(len(force) == size for force in forces):
        return np.asarray(np.sum(forces, axis=0))
    total = np.zeros(size)
    for force in forces:
        total[: len(force)] += force
    return total

"""Terms of the balance of forces: bodies and loads, each as force and tangent at a displacement."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Protocol

import numpy as np
from numpy.typing import NDArray

from abut.problem.constraints import Constraints
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
class Motion:
    """What a term sees of a state. displacement: (dim n_points,) of all points; history: the term's, by part, empty at the
    start."""

    time: float
    displacement: Vector
    history: Mapping[str, Vector] = field(default_factory=dict)


@dataclass(frozen=True)
class Share:
    """A term's share of the balance of forces. force: (dim n_points,) on the left-hand side (loads are negative there);
    tangent: what reduces to the free displacements, None for none; history: as in ``Motion``, new; symmetric:
    the tangent; energy: elastic, of a term that knows it, not a number where a material does not tell it."""

    force: Vector
    tangent: Tangent | None = None
    history: Mapping[str, Vector] = field(default_factory=dict)
    symmetric: bool = True
    energy: float | None = None


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

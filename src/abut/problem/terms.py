"""Terms of the balance of forces: bodies and loads, each as force and tangent at a displacement."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, Protocol

import numpy as np
from numpy.typing import NDArray

from abut.model.conditions import History as Amplitudes
from abut.model.conditions import weights
from abut.problem.backend import Backend
from abut.problem.loads import Loads

Vector = NDArray[np.float64]


@dataclass(frozen=True)
class Motion:
    """What a term sees of a state. displacement: (dim n_points,) of all points; history: (n_integration_points, k) of the
    term, None at the start."""

    time: float
    displacement: Vector
    history: Vector | None = None


@dataclass(frozen=True)
class Share:
    """A term's share of the balance of forces. force: (dim n_points,) on the left-hand side (loads are negative there);
    tangent: (dim n_points, dim n_points) sparse, or the backend's own; None for none; history: as in ``Motion``, new."""

    force: Vector
    tangent: Any = None
    history: Vector | None = None


class Term(Protocol):
    """Part of the balance of forces. name: of its history; constant: its tangent never changes (the same object comes back)
    and its force is affine in the displacement."""

    @property
    def name(self) -> str: ...

    @property
    def constant(self) -> bool: ...

    def evaluate(self, before: Motion, now: Motion) -> Share:
        """Force and tangent at ``now``, which follows the converged ``before``."""
        ...


@dataclass(frozen=True)
class LinearBodies:
    """Linear elastic bodies under small strains: force = K u."""

    backend: Backend
    name: str = "bodies"
    constant: bool = True

    def evaluate(self, before: Motion, now: Motion) -> Share:
        """As in ``Term``; the tangent is the backend."""
        return Share(self.backend.internal(now.displacement), self.backend)


@dataclass(frozen=True)
class DeadLoads:
    """Loads that keep their direction and place, and thermal strains of linear elastic bodies; histories: of the columns of
    ``loads``."""

    loads: Loads
    histories: tuple[Amplitudes, ...]
    name: str = "loads"
    constant: bool = True

    def evaluate(self, before: Motion, now: Motion) -> Share:
        """As in ``Term``."""
        return Share(-(self.loads.forces @ weights(self.histories, now.time)))

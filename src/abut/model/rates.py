"""Velocities and accelerations of all values, and how they follow from these over a load step."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Any, Protocol, runtime_checkable

import numpy as np

from abut.dofs import Dofs, Field
from abut.errors import InputError
from abut.mesh.mesh import Mesh
from abut.model.conditions import History
from abut.types import Array


@dataclass(frozen=True)
class Rates:
    """Velocities and accelerations of the values of all fields, as in ``Dofs``, (n_values,) each.

    slopes: derivatives of a velocity and of an acceleration by its own value at the end of a step [1/time, 1/time^2]; zero
    in a converged state."""

    velocities: Array
    accelerations: Array
    slopes: tuple[float, float] = (0.0, 0.0)

    @property
    def converged(self) -> Rates:
        """Those that a state keeps."""
        return replace(self, slopes=(0.0, 0.0))


@runtime_checkable
class TimeIntegration(Protocol):
    """How rates follow from values; one of the ``physics`` of a model may have it."""

    def begins(self, n_values: int) -> Rates:
        """At the start."""
        ...

    def after(self, before: Rates, moved: Array, step: float) -> Rates:
        """At the end of a part ``step`` of the run, from ``before`` on, over which values have changed by ``moved``
        (n_values,); with none, as before."""
        ...


@dataclass(frozen=True)
class OneStep:
    """A method that looks back at the last step's end only, as one of the ``physics`` of a model.

    Parameters
    ----------
    duration : float
        Of a run, whose time in abut goes from 0 to 1 [time].
    velocities, accelerations : (n,) arrays, optional
        At the start, of all values; zero without. Newmark's method needs the accelerations that loads cause then.

    Raises
    ------
    InputError
        For a duration that is not positive, and for arrays of another size.
    """

    duration: float
    velocities: Array | None = None
    accelerations: Array | None = None

    def __post_init__(self) -> None:
        if not self.duration > 0.0:
            raise InputError(f"{type(self).__name__}: duration = {self.duration}: it has to be positive")

    @property
    def amplitudes(self) -> Sequence[History]:
        """Histories that terms go by, as in ``Physics``, as all that follows: it adds nothing else."""
        return ()

    def fields(self, mesh: Mesh) -> Sequence[Field]:
        """None."""
        return ()

    def held(self, model: Any, dofs: Dofs) -> Sequence[Any]:
        """None."""
        return ()

    def terms(self, model: Any, dofs: Dofs) -> Sequence[Any]:
        """None."""
        return ()

    def begins(self, n_values: int) -> Rates:
        """Rates at the outset, as in ``TimeIntegration``."""
        given = {"velocities": self.velocities, "accelerations": self.accelerations}
        for name, values in given.items():
            if values is not None and np.shape(values) != (n_values,):
                shape = f"{name} of shape {np.shape(values)}; there are {n_values} values"
                raise InputError(f"{type(self).__name__}: {shape}")
        velocities, accelerations = (np.zeros(n_values) if v is None else np.array(v, float) for v in given.values())
        return Rates(velocities, accelerations)

    def after(self, before: Rates, moved: Array, step: float) -> Rates:
        """Rates at the end of a step, as in ``TimeIntegration``."""
        h = step * self.duration
        return before if h == 0.0 else self._after(before, moved, h)

    def _after(self, before: Rates, moved: Array, h: float) -> Rates:
        """With the duration of the step."""
        raise NotImplementedError


@dataclass(frozen=True)
class Newmark(OneStep):
    """Newmark's method: u1 = u0 + h v0 + h^2 (a0 + a1) / 4, v1 = v0 + h (a0 + a1) / 2 by default.

    In general u1 = u0 + h v0 + h^2 ((1/2 - beta) a0 + beta a1), v1 = v0 + h ((1 - gamma) a0 + gamma a1). By default it is
    the trapezoidal rule (average acceleration), which takes no energy. Raises InputError for a beta that is not positive.

    References
    ----------
    N. M. Newmark, A method of computation for structural dynamics, J. Eng. Mech. Div. ASCE 85 (1959).
    """

    gamma: float = 0.5
    beta: float = 0.25

    def __post_init__(self) -> None:
        super().__post_init__()
        if not self.beta > 0.0:
            raise InputError(f"Newmark: beta = {self.beta}: it has to be positive")

    def _after(self, before: Rates, moved: Array, h: float) -> Rates:
        v, a = before.velocities, before.accelerations
        new = (moved - h * v - h**2 * (0.5 - self.beta) * a) / (self.beta * h**2)
        slopes = self.gamma / (self.beta * h), 1.0 / (self.beta * h**2)
        return Rates(v + h * ((1.0 - self.gamma) * a + self.gamma * new), new, slopes)


@dataclass(frozen=True)
class BackwardEuler(OneStep):
    """u1 = u0 + h v1, v1 = v0 + h a1: of first order, and it damps what oscillates."""

    def _after(self, before: Rates, moved: Array, h: float) -> Rates:
        velocities = moved / h
        return Rates(velocities, (velocities - before.velocities) / h, (1.0 / h, 1.0 / h**2))


def integration_of(physics: Sequence[object]) -> TimeIntegration | None:
    """That of a model. Raises InputError for two."""
    found = [item for item in physics if isinstance(item, TimeIntegration)]
    if len(found) > 1:
        raise InputError("physics: there are two time integrations; take one of them out")
    return found[0] if found else None

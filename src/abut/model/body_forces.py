"""Forces on the volume of bodies: gravity, centrifugal forces, any others; and all kinds of loads."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

from abut import checks
from abut.errors import InputError
from abut.fields import Field
from abut.model.conditions import History, check_amplitude, vector
from abut.model.loads import Force, Moment, NodalForce, Pressure, Temperature, Traction


@dataclass(frozen=True)
class Gravity:
    """Acceleration that acts on the density of every body, or of one.

    Parameters
    ----------
    value : (dim,) of float
        Acceleration [length/time^2].
    on : str, optional
        The body; every one where left out.
    amplitude : Amplitude, optional
        Factor over time; the ramp where left out.

    Raises
    ------
    InputError
        For values that are no such things, or do not go together.
    """

    value: tuple[float, ...]
    on: str | None = None
    amplitude: History = None

    def __post_init__(self) -> None:
        object.__setattr__(self, "value", vector(self.value, "gravity: value"))
        check_amplitude(self.amplitude, "gravity")


@dataclass(frozen=True)
class BodyForce:
    """Force per volume in every body, or in one.

    Parameters
    ----------
    value : (dim,) of float, or function
        Force per volume (2D: per area and unit thickness), or a function of position, points (n, dim) -> (n, dim).
    on : str, optional
        The body; every one where left out.
    amplitude : Amplitude, optional
        Factor over time; the ramp where left out.

    Raises
    ------
    InputError
        For values that are no such things, or do not go together.
    """

    value: tuple[float, ...] | Field
    on: str | None = None
    amplitude: History = None

    def __post_init__(self) -> None:
        if not callable(self.value):
            object.__setattr__(self, "value", vector(self.value, "body force: value"))
        check_amplitude(self.amplitude, "body force")


@dataclass(frozen=True)
class Centrifugal:
    """Force of a rotation on the density of every body, or of one.

    It is density times speed squared times the distance from the axis, outward, taken in the undeformed body. The
    amplitude is that of the force, which is the square of the speed's.

    Parameters
    ----------
    speed : float
        Angle per time [radian/time].
    axis : (3,) of float, optional
        Its direction; left out in 2D, where it is z, and where a model is axisymmetric, y.
    through : (dim,) of float, optional
        A point of the axis [length]; the origin where left out.
    on : str, optional
        The body; every one where left out.
    amplitude : Amplitude, optional
        Factor over time; the ramp where left out.

    Raises
    ------
    InputError
        For values that are no such things, or do not go together.

    Examples
    --------
    >>> import abut
    >>> abut.Centrifugal(speed=314.0, axis=(0, 0, 1)).at([[2.0, 0.0, 5.0]]).tolist()
    [[197192.0, 0.0, 0.0]]
    """

    speed: float
    axis: tuple[float, ...] | None = None
    through: tuple[float, ...] | None = None
    on: str | None = None
    amplitude: History = None

    def __post_init__(self) -> None:
        object.__setattr__(self, "speed", checks.finite(self.speed, "centrifugal: speed"))
        for name in ("axis", "through"):
            if getattr(self, name) is not None:
                object.__setattr__(self, name, vector(getattr(self, name), f"centrifugal: {name}"))
        if self.axis is not None and not any(self.axis):
            raise InputError("centrifugal: axis: expected a direction, got zero")
        check_amplitude(self.amplitude, "centrifugal")

    def at(self, points: ArrayLike, axisymmetric: bool = False) -> NDArray[np.float64]:
        """Acceleration (n, dim) at points (n, dim)."""
        points = np.asarray(points, dtype=float)
        apart = points - (0.0 if self.through is None else np.array(self.through))
        return np.asarray(apart @ self.slope(points.shape[-1], axisymmetric))

    def slope(self, dim: int, axisymmetric: bool = False) -> NDArray[np.float64]:
        """(dim, dim) change of the acceleration with the place."""
        axis = np.zeros(dim)
        if axisymmetric:
            axis[1] = 1.0
        elif self.axis is not None:
            axis = np.array(self.axis) / np.linalg.norm(self.axis)
        return np.asarray(self.speed**2 * (np.eye(dim) - np.outer(axis, axis)))

    def velocity(self, dim: int) -> NDArray[np.float64]:
        """(dim, dim) by which the velocity of what turns so follows from the place: speed a x r, about the axis a."""
        if dim == 2:
            return np.array([[0.0, -self.speed], [self.speed, 0.0]])
        axis = np.array((0.0, 0.0, 1.0) if self.axis is None else self.axis)
        return np.asarray(np.cross(self.speed * axis / np.linalg.norm(axis), np.eye(3)).T)


Load = Pressure | Traction | Force | Moment | NodalForce | Temperature | Gravity | Centrifugal | BodyForce

"""Local axes: directions in which supports, loads, results or materials are given, at each point."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from abut import checks
from abut.errors import InputError

KINDS = ("rectangular", "cylindrical", "spherical")
PARALLEL = 1e-9  # sine of the angle below which two directions are one
ON_AXIS = 1e-12  # distance over the points' own below which a point has no radial direction


@dataclass(frozen=True)
class Axes:
    """Three directions at right angles (two in 2D) at each point, right-handed.

    Parameters
    ----------
    kind : str
        "rectangular": the same everywhere. "cylindrical": radial, around the axis, along the axis; "spherical": radial,
        around the polar axis (east), toward its pole (north); in 2D both are radial and around the origin.
    origin : (dim,) of float, optional
        A point on the axis, or the sphere's centre [length]; zero where left out.
    axis : (3,) of float, optional
        Of "cylindrical" and "spherical" in 3D, any length; z where left out.
    x : (dim,) of float, optional
        Of "rectangular": the first direction, any length; the global x where left out.
    xy : (3,) of float, optional
        Of "rectangular" in 3D: a vector in the plane of the first and second direction, on the second's side; the global
        y where left out.

    Raises
    ------
    InputError
        For values that are no such things, or do not go together.

    Examples
    --------
    >>> import abut
    >>> bore = abut.Axes("cylindrical", origin=(0, 0, 5), axis=(0, 0, 1))
    >>> bore.frames([[0.0, 2.0, 7.0]])[0]  # radial, around, along
    array([[ 0.,  1.,  0.],
           [-1.,  0.,  0.],
           [ 0.,  0.,  1.]])
    """

    kind: str = KINDS[0]
    origin: tuple[float, ...] | None = None
    axis: tuple[float, ...] | None = None
    x: tuple[float, ...] | None = None
    xy: tuple[float, ...] | None = None

    def __post_init__(self) -> None:
        checks.choice(self.kind, "axes: kind", KINDS)
        for name in ("origin", "axis", "x", "xy"):
            value = getattr(self, name)
            if value is None:
                continue
            object.__setattr__(self, name, _numbers(value, f"axes: {name}"))
            if name != "origin" and not any(getattr(self, name)):
                raise InputError(f"axes: {name}: a direction needs a component other than zero")
        others = ("x", "xy") if self.kind != "rectangular" else ("origin", "axis")
        for name in others:
            if getattr(self, name) is not None:
                raise InputError(f'axes: {name} does not go with kind = "{self.kind}"; take it out')

    def check(self, dim: int, where: str) -> None:
        """Raise InputError, beginning with ``where``, for vectors that do not fit a mesh of ``dim`` dimensions, or that give
        no frame."""
        for name in ("origin", "axis", "x", "xy"):
            value = getattr(self, name)
            if value is not None and dim == 2 and name in ("axis", "xy"):
                raise InputError(f"{where}: axes: {name}: the model is 2D; leave {name} out")
            if value is not None and len(value) != dim:
                raise InputError(f"{where}: axes: {name}: expected {dim} numbers, got {len(value)}")
        if self.kind == "rectangular" and dim == 3:
            first, second = _unit(np.array(self.x or (1.0, 0, 0))), _unit(np.array(self.xy or (0.0, 1, 0)))
            if np.linalg.norm(np.cross(first, second)) < PARALLEL:
                raise InputError(f"{where}: axes: x and xy are parallel; give xy (by default y) another direction")

    def frames(self, points: NDArray[np.float64] | list[list[float]]) -> NDArray[np.float64]:
        """Unit vectors at points (n, dim), (n, dim, dim): ``[i, k]`` is direction k at point i, in global components, so
        that local components of a vector v are ``frames[i] @ v``. A point on the axis takes a direction at right angles
        to it for the radial one."""
        at = np.asarray(points, dtype=float)
        dim = at.shape[1]
        if self.kind == "rectangular":
            return np.broadcast_to(self._fixed(dim), (len(at), dim, dim)).copy()
        arm = at - np.array(self.origin if self.origin is not None else (0.0,) * dim)
        if dim == 2:
            radial = _units(arm, np.array([1.0, 0.0]))
            return np.stack([radial, np.column_stack([-radial[:, 1], radial[:, 0]])], axis=1)
        along = _unit(np.array(self.axis if self.axis is not None else (0.0, 0.0, 1.0)))
        outward = _units(arm - np.outer(arm @ along, along), _across(along), np.linalg.norm(arm, axis=1))
        around = np.cross(along, outward)
        if self.kind == "cylindrical":
            return np.stack([outward, around, np.broadcast_to(along, at.shape)], axis=1)
        radial = _units(arm, along)
        return np.stack([radial, around, np.cross(radial, around)], axis=1)

    def _fixed(self, dim: int) -> NDArray[np.float64]:
        first = _unit(np.array(self.x if self.x is not None else (1.0, 0.0, 0.0)[:dim]))
        if dim == 2:
            return np.array([first, [-first[1], first[0]]])
        third = _unit(np.cross(first, np.array(self.xy if self.xy is not None else (0.0, 1.0, 0.0))))
        return np.array([first, np.cross(third, first), third])


def _numbers(values: object, name: str) -> tuple[float, ...]:
    try:
        result = tuple(checks.finite(value, name) for value in values)  # type: ignore[attr-defined]
    except TypeError:
        raise InputError(f"{name}: expected 2 or 3 numbers, got {values!r}") from None
    if len(result) not in (2, 3):
        raise InputError(f"{name}: expected 2 or 3 numbers, got {len(result)}")
    return result


def _unit(vector: NDArray[np.float64]) -> NDArray[np.float64]:
    return np.asarray(vector / np.linalg.norm(vector))


def _units(
    vectors: NDArray[np.float64], instead: NDArray[np.float64], scale: NDArray[np.float64] | None = None
) -> NDArray[np.float64]:
    """Unit vectors (n, dim); ``instead`` of those that are nothing beside ``scale`` (n,)."""
    size = np.linalg.norm(vectors, axis=1)
    none = size <= (0.0 if scale is None else ON_AXIS * scale)
    return np.where(none[:, None], instead, vectors / np.where(none, 1.0, size)[:, None])


def _across(along: NDArray[np.float64]) -> NDArray[np.float64]:
    """A direction at right angles to one: of the global axis nearest to that, x before y before z."""
    chosen = np.eye(3)[int(np.argmin(np.round(np.abs(along), 9)))]
    return _unit(chosen - (chosen @ along) * along)

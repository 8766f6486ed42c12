"""Loads on surfaces, nodes and references, each with its history; records that check themselves."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from abut import checks
from abut.axes import Axes
from abut.errors import InputError
from abut.expression import Expression, Expressions
from abut.fields import Field, evaluate, number_or_field
from abut.model.conditions import History, check_amplitude, vector


@dataclass(frozen=True)
class Pressure:
    """Pressure on a surface.

    Parameters
    ----------
    on : str
        The surface.
    value : float, str or function
        Force per area, positive into the body; a number, an expression ("0.01*(50 - y)") or a function of position in
        the undeformed mesh, points (n, dim) -> (n,).
    amplitude : Amplitude, optional
        Factor over time; the ramp where left out.
    follows : bool
        With kinematics "finite" it acts along the normal of the deformed surface, on its deformed area; False: a dead
        load, along the normal and on the area of the undeformed one. Without effect with kinematics "small".

    Raises
    ------
    InputError
        For values that are no such things, or do not go together.

    Examples
    --------
    >>> import abut
    >>> oil = abut.Pressure("bore", 12.0, abut.Amplitude(((0.0, 1.0), (1.0, 1.0))))  # in full from the start
    """

    on: str
    value: float | str | Field
    amplitude: History = None
    follows: bool = True

    def __post_init__(self) -> None:
        if not isinstance(self.follows, bool):
            raise InputError(f"pressure on '{self.on}': follows: expected true or false, got {self.follows!r}")
        object.__setattr__(self, "value", number_or_field(self.value, f"pressure on '{self.on}': value"))
        check_amplitude(self.amplitude, f"pressure on '{self.on}'")


def _components(values: Any, name: str) -> tuple[float, ...] | Field:
    """A vector; as expressions where one component is."""
    if isinstance(values, str) or not isinstance(values, Iterable):
        raise InputError(f"{name}: expected 2 or 3 numbers or expressions, got {values!r}")
    given = [number_or_field(value, name) for value in values]
    if not any(isinstance(value, Expression) for value in given):
        return vector(given, name)
    return Expressions(tuple(v if isinstance(v, Expression) else Expression(repr(v)) for v in given))


@dataclass(frozen=True)
class Traction:
    """Traction on a surface.

    Parameters
    ----------
    on : str
        The surface.
    value : (dim,) of float or str, or function
        Force per area: numbers and expressions of position, or a function, points (n, dim) -> (n, dim).
    amplitude : Amplitude, optional
        Factor over time; the ramp where left out.
    axes : Axes, optional
        Local axes at undeformed points, along which the components are; the global ones where left out.

    Raises
    ------
    InputError
        For values that are no such things, or do not go together.
    """

    on: str
    value: tuple[float | str, ...] | Field
    amplitude: History = None
    axes: Axes | None = None

    def __post_init__(self) -> None:
        if not callable(self.value):
            object.__setattr__(self, "value", _components(self.value, f"traction on '{self.on}': value"))
        check_amplitude(self.amplitude, f"traction on '{self.on}'")
        if self.axes is not None:
            checks.instance(self.axes, Axes, f"traction on '{self.on}': axes", "axes (abut.Axes)")

    @property
    def along(self) -> tuple[float | str, ...] | Field:
        """The value along the global axes."""
        return self.value if self.axes is None else self._turned

    def _turned(self, points: NDArray[np.float64]) -> NDArray[np.float64]:
        assert self.axes is not None
        shape = points.shape[1:]
        local = evaluate(self.value, points, f"traction on '{self.on}': value", shape)
        return np.asarray(np.einsum("nki,nk->ni", self.axes.frames(points), local))


@dataclass(frozen=True)
class Force:
    """Total force, spread evenly over a surface, or at the reference of a rigid body or coupling.

    Parameters
    ----------
    on : str
        The surface, body or coupling.
    value : (dim,) of float
        Force (2D: per unit thickness).
    amplitude : Amplitude, optional
        Factor over time; the ramp where left out.
    bearing : bool
        Of a surface such as a bore: not evenly, but as a pin brings it, a pressure where the force presses against the
        surface, which falls off with the cosine of the angle from its middle, theory (F17).

    Raises
    ------
    InputError
        For values that are no such things, or do not go together.

    Examples
    --------
    >>> import abut
    >>> abut.Force("lug.end", [1000, 0, 0]).value
    (1000.0, 0.0, 0.0)
    """

    on: str
    value: tuple[float, ...]
    amplitude: History = None
    bearing: bool = False

    def __post_init__(self) -> None:
        if not isinstance(self.bearing, bool):
            raise InputError(f"force on '{self.on}': bearing: expected true or false, got {self.bearing!r}")
        object.__setattr__(self, "value", vector(self.value, f"force on '{self.on}': value"))
        check_amplitude(self.amplitude, f"force on '{self.on}'")


@dataclass(frozen=True)
class Moment:
    """Moment on a rigid body or coupling.

    It keeps its direction however far the body turns, theory (D15).

    Parameters
    ----------
    on : str
        The rigid body or coupling.
    value : (3,) of float, or float
        Force times length: about axes fixed in space; in the plane one number (per unit thickness).
    amplitude : Amplitude, optional
        Factor over time; the ramp where left out.

    Raises
    ------
    InputError
        For values that are no such things, or do not go together.

    Examples
    --------
    >>> import abut
    >>> abut.Moment("flange", 500).value
    (500.0,)
    """

    on: str
    value: tuple[float, ...]
    amplitude: History = None

    def __post_init__(self) -> None:
        where = f"moment on '{self.on}': value"
        given: Any = self.value
        numbers = tuple(checks.finite(value, where) for value in (given if np.ndim(given) else [given]))
        if len(numbers) not in (1, 3):
            raise InputError(f"{where}: expected 3 numbers, in the plane 1, got {len(numbers)}")
        object.__setattr__(self, "value", numbers)
        check_amplitude(self.amplitude, f"moment on '{self.on}'")


@dataclass(frozen=True)
class NodalForce:
    """Force at each node of a node set or surface.

    Parameters
    ----------
    on : str
        The node set or surface.
    value : (dim,) of float
        Force at each (2D: per unit thickness; axisymmetric: of the full circumference).
    amplitude : Amplitude, optional
        Factor over time; the ramp where left out.
    axes : Axes, optional
        Local axes at undeformed points, along which the components are; the global ones where left out.

    Raises
    ------
    InputError
        For values that are no such things, or do not go together.
    """

    on: str
    value: tuple[float, ...]
    amplitude: History = None
    axes: Axes | None = None

    def __post_init__(self) -> None:
        object.__setattr__(self, "value", vector(self.value, f"nodal force on '{self.on}': value"))
        check_amplitude(self.amplitude, f"nodal force on '{self.on}'")
        if self.axes is not None:
            checks.instance(self.axes, Axes, f"nodal force on '{self.on}': axes", "axes (abut.Axes)")

    def at(self, points: NDArray[np.float64]) -> NDArray[np.float64]:
        """The forces (n, dim) at points (n, dim), along the global axes."""
        if self.axes is None:
            return np.broadcast_to(np.array(self.value), points.shape)
        return np.asarray(np.einsum("nki,k->ni", self.axes.frames(points), np.array(self.value)))


@dataclass(frozen=True)
class Temperature:
    """Change of temperature at the nodes of a node set or body.

    It strains bodies by their expansion; between nodes the shape functions interpolate, zero at nodes without one, so
    that neighbours glued to a heated body are warm in their first row of cells. Several add up, also with
    ``Solid.temperature``.

    Parameters
    ----------
    on : str
        The node set or body.
    value : float, str or function
        A number, an expression ("20 + 3*x") or a function of position, points (n, dim) -> (n,) [temperature].
    amplitude : Amplitude, optional
        Factor over time; the ramp where left out.

    Raises
    ------
    InputError
        For values that are no such things, or do not go together.
    """

    on: str
    value: float | str | Field
    amplitude: History = None

    def __post_init__(self) -> None:
        object.__setattr__(self, "value", number_or_field(self.value, f"temperature on '{self.on}': value"))
        check_amplitude(self.amplitude, f"temperature on '{self.on}'")

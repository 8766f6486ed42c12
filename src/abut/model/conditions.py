"""Histories, supports, equations and rigid bodies; records that check themselves."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from itertools import pairwise
from typing import Any

import numpy as np
from numpy.typing import NDArray

from abut import checks
from abut.axes import Axes
from abut.errors import InputError
from abut.fields import Field, number_or_field
from abut.types import Json

COMPONENTS = ("x", "y", "z")
TURNS = ("rx", "ry", "rz")


SLIGHTLY = 1e-9  # beyond the end is rounding


@dataclass(frozen=True)
class Amplitude:
    """A history: a factor over time, linear between points and constant outside.

    Calling it with a time gives the factor there.

    Parameters
    ----------
    points : sequence of (float, float)
        Pairs (time, factor), times increasing, from 0 to the end of the run: ``SolveOptions.end``, 1 by default.

    Raises
    ------
    InputError
        For points that are no such list.

    Examples
    --------
    >>> import abut
    >>> pulse = abut.Amplitude(((0.0, 0.0), (0.5, 1.0), (1.0, 0.0)))
    >>> pulse(0.25)
    0.5
    """

    points: tuple[tuple[float, float], ...]

    def __post_init__(self) -> None:
        try:
            points = tuple((float(time), float(factor)) for time, factor in self.points)
        except (TypeError, ValueError):
            raise InputError(f"amplitude: expected pairs of time and factor, got {self.points!r}") from None
        for number in (value for point in points for value in point):
            checks.finite(number, "amplitude")
        if not points:
            raise InputError("amplitude: expected at least one pair of time and factor")
        for (before, _), (after, _) in pairwise(points):
            if not before < after:
                raise InputError(f"amplitude: times must increase, but {after:g} follows {before:g}")
        if points[0][0] < -SLIGHTLY:
            raise InputError(f"amplitude: time runs from 0 on, but there is a point at {points[0][0]:g}; begin with 0")
        object.__setattr__(self, "points", points)

    def __call__(self, time: float) -> float:
        """The factor at a time."""
        times, factors = np.array(self.points).T
        return float(np.interp(time, times, factors))

    @property
    def largest(self) -> float:
        """Largest factor at any time, regardless of sign."""
        return max(abs(factor) for _, factor in self.points)


History = Amplitude | None  # None: the ramp, a factor equal to time


def weights(histories: Sequence[History], time: float) -> NDArray[np.float64]:
    """Factor of each history at a time, (n_histories,)."""
    return np.array([time if history is None else history(time) for history in histories])


def check_amplitude(value: object, where: str) -> None:
    """Raise InputError for what is neither an amplitude nor None."""
    if value is not None and not isinstance(value, Amplitude):
        raise InputError(f"{where}: amplitude: expected an Amplitude, got {type(value).__name__}")


def drives(condition: Any) -> bool:
    """Whether a support, load, equation or rigid body prescribes anything but zero; a function of position is taken to."""
    names = ("value", "speed", "normal", "force", "shortening", "motion", "load", *COMPONENTS, *TURNS)
    values = [getattr(condition, name, None) for name in names]
    given = any(value is not None and (callable(value) or bool(np.any(value))) for value in values)
    histories = [condition.amplitude, *getattr(condition, "amplitudes", {}).values()]
    return given and any(history is None or history.largest > 0.0 for history in histories)


@dataclass(frozen=True)
class Support:
    """Prescribed displacement of a surface or node set.

    Parameters
    ----------
    on : str
        The surface or node set.
    x, y, z : float, str or function, optional
        Components [length]: numbers, expressions ("0.01*y") or functions of position, points (n, dim) -> (n,), taken at
        the nodes; free where left out.
    normal : float, optional
        Along the surface's own outward normal [length], in place of these.
    amplitude : Amplitude, optional
        Factor over time; the ramp where left out.
    axes : Axes, optional
        Local axes, whose first, second and third direction x, y and z then are (radial, around and along of cylindrical
        ones), at each node where it was at the outset.

    Raises
    ------
    InputError
        For values that are no such things.

    Examples
    --------
    >>> import abut
    >>> clamp = abut.Support("block.bottom", x=0, y=0)
    >>> bend = abut.Support("block.top", y=lambda points: -0.01 * points[:, 0] ** 2)  # x stays free
    >>> bore = abut.Support("hub.bore", x=0, axes=abut.Axes("cylindrical"))  # no radial displacement
    """

    on: str
    x: float | str | Field | None = None
    y: float | str | Field | None = None
    z: float | str | Field | None = None
    normal: float | None = None
    amplitude: History = None
    axes: Axes | None = None

    def __post_init__(self) -> None:
        given = {name: getattr(self, name) for name in ("x", "y", "z", "normal") if getattr(self, name) is not None}
        for name, value in given.items():
            where = f"support on '{self.on}': {name}"
            if name == "normal":
                checks.finite(value, where)
            else:
                object.__setattr__(self, name, number_or_field(value, where))
        if not given:
            raise InputError(f"support on '{self.on}': no component is prescribed; give x, y, z or normal")
        if "normal" in given and len(given) > 1:
            raise InputError(f"support on '{self.on}': give either normal or components, not both")
        if self.axes is not None:
            checks.instance(self.axes, Axes, f"support on '{self.on}': axes", "axes (abut.Axes)")
        if self.axes is not None and "normal" in given:
            raise InputError(f"support on '{self.on}': axes go with x, y, z; normal has its own direction")
        check_amplitude(self.amplitude, f"support on '{self.on}'")

    def directions(self, points: NDArray[np.float64]) -> NDArray[np.float64]:
        """Of x, y, z at points (n, dim), (n, dim, dim)."""
        dim = points.shape[1]
        return np.broadcast_to(np.eye(dim), (len(points), dim, dim)) if self.axes is None else self.axes.frames(points)


def support_along(on: str, component: str, value: float) -> Support:
    """A support of one component by its name."""
    given: Json = {component: value}
    return Support(on, **given)


@dataclass(frozen=True)
class Term:
    """A displacement component of one point in an ``Equation``.

    Parameters
    ----------
    on : str or int
        A node set of one node, or a point's number.
    component : str
        "x", "y" or "z".
    coefficient : float
        What the component is multiplied by.

    Raises
    ------
    InputError
        For values that are no such things, or do not go together.
    """

    on: str | int
    component: str
    coefficient: float

    def __post_init__(self) -> None:
        if isinstance(self.on, bool) or not isinstance(self.on, (str, int, np.integer)):
            raise InputError(f"term.on: expected a node set or a point's index, got {self.on!r}")
        checks.choice(self.component, f"term on {self.on!r}: component", COMPONENTS)
        checks.finite(self.coefficient, f"term on {self.on!r}: coefficient")


@dataclass(frozen=True)
class Equation:
    """A linear constraint: the sum of all terms is ``value``, times ``amplitude``.

    Parameters
    ----------
    terms : sequence of Term
        What is added up.
    value : float
        The sum [length, if coefficients are numbers].
    amplitude : Amplitude, optional
        Factor over time; the ramp where left out.
    supports : sequence of str
        Node sets, surfaces or bodies that it supports: its forces on their points count among the reactions by these names,
        not among those of what joins points.

    Raises
    ------
    InputError
        For values that are no such things, or do not go together.

    Examples
    --------
    >>> import abut
    >>> tips = abut.Term("left tip", "y", 1.0), abut.Term("right tip", "y", -1.0)
    >>> alike = abut.Equation(tips)  # both tips sink by the same amount
    """

    terms: tuple[Term, ...]
    value: float = 0.0
    amplitude: History = None
    supports: tuple[str, ...] = ()

    def __post_init__(self) -> None:
        object.__setattr__(self, "supports", checks.names(self.supports, "equation: supports"))
        object.__setattr__(self, "terms", checks.listed(self.terms, "equation: terms", "terms"))
        for i, term in enumerate(self.terms):
            checks.instance(term, Term, f"equation: terms[{i}]", "a term (abut.Term)")
        checks.finite(self.value, "equation: value")
        if not any(term.coefficient for term in self.terms):
            raise InputError("equation: no term with a coefficient other than zero; give at least one")
        check_amplitude(self.amplitude, "equation")


def vector(values: Any, name: str) -> tuple[float, ...]:
    """Two or three numbers. Raises InputError, beginning with ``name``, for anything else."""
    try:
        result = tuple(checks.finite(value, name) for value in values)
    except TypeError:
        raise InputError(f"{name}: expected 2 or 3 numbers, got {values!r}") from None
    if len(result) not in (2, 3):
        raise InputError(f"{name}: expected 2 or 3 numbers, got {len(result)}")
    return result


def check_motion(body: Any, where: str) -> None:
    """Raise InputError, beginning with ``where``, for a motion of a rigid body or coupling that is none."""
    for name, amplitude in checks.mapping(body.amplitudes, f"{where}: amplitudes", "an Amplitude").items():
        if name not in (*COMPONENTS, *TURNS) or getattr(body, name) is None:
            known = ", ".join(key for key in (*COMPONENTS, *TURNS) if getattr(body, key) is not None)
            raise InputError(f"{where}: amplitudes: {name!r} is none of the components that are given: {known}")
        check_amplitude(amplitude, f"{where}: amplitudes.{name}")
    for name in (*COMPONENTS, *TURNS):
        if getattr(body, name) is not None:
            checks.finite(getattr(body, name), f"{where}: {name}")
    if body.reference is not None:
        object.__setattr__(body, "reference", vector(body.reference, f"{where}: reference"))
    check_amplitude(body.amplitude, where)


@dataclass(frozen=True)
class Rigid:
    """A body that moves as a whole, by small rotations, or by any with ``kinematics="finite"``.

    The body needs no material, and in contact it is the target.

    Parameters
    ----------
    body : str
        The body.
    reference : (dim,) of float, optional
        The point that moves and about which the body turns [length]; the mean of the body's points where left out.
    x, y, z : float, optional
        Prescribed translation of the reference [length]; free where left out.
    rx, ry, rz : float, optional
        Prescribed rotation about axes through it [radian]; 2D: only rz; axisymmetric: none, and only y; free where left
        out.
    amplitude : Amplitude, optional
        Of all these over time.
    amplitudes : mapping of str to Amplitude
        Of some of them, by name.
    density : float
        Of its cells, for frequencies and vibrations [mass/volume].

    Raises
    ------
    InputError
        For values that are no such things, or do not go together.

    Examples
    --------
    >>> import abut
    >>> punch = abut.Rigid("punch", y=-0.01, rz=0.0)  # pressed down, kept upright, free to move sideways
    """

    body: str
    reference: tuple[float, ...] | None = None
    x: float | None = None
    y: float | None = None
    z: float | None = None
    rx: float | None = None
    ry: float | None = None
    rz: float | None = None
    amplitude: History = None
    amplitudes: Mapping[str, Amplitude] = field(default_factory=dict)
    density: float = 0.0

    def __post_init__(self) -> None:
        check_motion(self, f"rigid '{self.body}'")
        if checks.finite(self.density, f"rigid '{self.body}': density") < 0.0:
            raise InputError(f"rigid '{self.body}': density: expected a number >= 0, got {self.density!r}")

    @property
    def name(self) -> str:
        """That of the body."""
        return self.body

    def history(self, name: str) -> History:
        """Of the component ``name``."""
        return self.amplitudes.get(name, self.amplitude)

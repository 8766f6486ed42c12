"""Connectors: joints between two reference points, or between one and the ground."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from abut import checks
from abut.dofs import Field
from abut.errors import InputError
from abut.mesh.mesh import Mesh
from abut.model.conditions import History, Rigid, check_amplitude, vector
from abut.model.coupling import Coupling

FIELD = "connectors"  # name of the field of multipliers
MOTIONS: dict[
    str, tuple[str, ...]
] = {  # free motions that are reported, the one of limits, motion, load and stiffness first
    "hinge": ("turn",),
    "slider": ("travel",),
    "cylindrical": ("travel", "turn"),
    "universal": ("turn", "turn2"),
    "ball": (),
    "slot": ("travel",),
    "distance": ("travel",),
    "straight": (),
    "plane": (),
    "mean-turn": ("turn",),
}
KINDS = tuple(MOTIONS)
PLANE = ("hinge", "slider", "slot", "distance", "straight", "mean-turn")  # those of plane models
LEAST = {"distance": 2, "straight": 3, "plane": 4, "mean-turn": 2}  # points of those that are between points of a set
HELD = {"hinge": 5, "slider": 5, "cylindrical": 4, "universal": 4, "ball": 3, "slot": 2}  # motions that each takes
HELD_IN_PLANE = {"hinge": 2, "slider": 2, "slot": 1}
NO_AXIS = ("ball", "straight", "plane", "distance")
ABOUT = ("hinge", "mean-turn")  # in plane models about the normal
SQUARE = 1e-6  # cosine of the angle between two axes that are perpendicular


@dataclass(frozen=True)
class Connector:
    """A joint between two reference points, those of rigid bodies or couplings, or between one and the ground.

    Between points of a surface or node set, with no ``to``, are "straight", "plane", "distance" and "mean-turn". Of joints
    ``axis`` belongs to what the joint is on the side of ``to``: with finite kinematics it turns with that body, and the
    ground's stays. Motions and forces are those of ``on`` relative to ``to``.

    =============  ======================================================  ====================  =======================
    kind           holds                                                   leaves                with ``limits`` and so on
    =============  ======================================================  ====================  =======================
    "hinge"        the point, and all turns but that about the axis        turn                  turn
    "slider"       all turns, and the point on the axis                    travel                travel
    "cylindrical"  the point on the axis, all turns but that about it      travel, turn          travel
    "universal"    the point, and the axes perpendicular to each other     turn, turn2           turn
    "ball"         the point                                               all turns
    "slot"         the point on the axis                                   travel, all turns     travel
    "straight"     points on a line
    "plane"        points in a plane
    "distance"     nothing by itself: two points                           travel apart          travel
    "mean-turn"    nothing by itself: points around an axis                their mean turn       turn
    =============  ======================================================  ====================  =======================

    Parameters
    ----------
    name : str
        Of the connector.
    kind : str
        As above; in plane models "hinge", "slider", "slot", "straight", "distance" and "mean-turn".
    on : str
        A rigid body or coupling; of connectors between points a surface or node set.
    to : str, optional
        Another one; left out: the ground.
    at : (dim,) of float, optional
        Where the joint is, undeformed [length]; the reference of ``on`` where left out.
    axis : (dim,) of float, optional
        Of any length; of joints but "ball", of "mean-turn", whose axis keeps its direction and goes through the middle of
        the points; in plane models of "slider" and "slot" alone.
    axis2 : (3,) of float, optional
        Of "universal": that on the side of ``on``, perpendicular to ``axis``.
    limits : (float, float), optional
        Between which the free motion stays, the lower one first [radian, or length]; a stop there pushes, and does not pull.
        Either may be infinite.
    motion : float, optional
        Prescribed free motion [radian, or length].
    load : float, optional
        Moment or force along the free motion [force length, or force].
    stiffness : float, optional
        Of a spring along the free motion, without force at the outset [force length / radian, or force/length].
    amplitude : Amplitude, optional
        Of motion or load over time.
    limits2 : (float, float), optional
        As limits, of the second free motion: the turn of "cylindrical", ``turn2`` of "universal".

    Raises
    ------
    InputError
        For values that are no such things, or do not go together.

    Examples
    --------
    >>> import abut
    >>> hinge = abut.Connector("hinge", "hinge", on="lever", at=(0, 0, 0), axis=(0, 0, 1), limits=(-0.1, 0.3))
    """

    name: str
    kind: str
    on: str
    to: str = ""
    at: tuple[float, ...] | None = None
    axis: tuple[float, ...] | None = None
    axis2: tuple[float, ...] | None = None
    limits: tuple[float, float] | None = None
    motion: float | None = None
    load: float | None = None
    stiffness: float | None = None
    amplitude: History = None
    limits2: tuple[float, float] | None = None

    def __post_init__(self) -> None:
        where = f"connector '{self.name}'"
        checks.text(self.name, f"{where}: name")
        checks.choice(self.kind, f"{where}: kind", KINDS)
        checks.text(self.on, f"{where}: on")
        if self.to == self.on:
            raise InputError(
                f"{where}: to: '{self.to}' is on both sides; name another body, or leave to out for the ground"
            )
        for key in ("at", "axis", "axis2"):
            if getattr(self, key) is not None:
                object.__setattr__(self, key, vector(getattr(self, key), f"{where}: {key}"))
                if key != "at" and not any(getattr(self, key)):
                    raise InputError(f"{where}: {key}: it has no length; give a direction")
        for key in ("motion", "load"):
            if getattr(self, key) is not None:
                object.__setattr__(self, key, checks.finite(getattr(self, key), f"{where}: {key}"))
        if self.stiffness is not None:
            object.__setattr__(self, "stiffness", checks.positive(self.stiffness, f"{where}: stiffness"))
        self._check_axes(where)
        self._check_motion(where)
        check_amplitude(self.amplitude, where)

    def _check_axes(self, where: str) -> None:
        if self.kind in NO_AXIS and self.axis is not None:
            raise InputError(f'{where}: axis: kind = "{self.kind}" has none; leave axis out')
        if self.of_points and (self.to or self.at is not None):
            key = "to" if self.to else "at"
            raise InputError(f'{where}: {key}: kind = "{self.kind}" is between the points of on; leave {key} out')
        if (self.axis2 is not None) != (self.kind == "universal"):
            what = "give the axis on the side of on" if self.kind == "universal" else "leave axis2 out"
            raise InputError(f'{where}: axis2 goes with kind = "universal"; {what}')
        if self.axis2 is None:
            return
        if self.axis is None or len(self.axis) != 3 or len(self.axis2) != 3:
            raise InputError(f"{where}: axis, axis2: expected 3 numbers each")
        one, other = np.array(self.axis), np.array(self.axis2)
        if abs(one @ other) > SQUARE * np.linalg.norm(one) * np.linalg.norm(other):
            raise InputError(f"{where}: axis2: expected a direction perpendicular to axis, as those of a cross are")

    def _check_motion(self, where: str) -> None:
        given = [key for key in ("limits", "motion", "load", "stiffness") if getattr(self, key) is not None]
        if given and not self.motions:
            raise InputError(
                f'{where}: {given[0]}: kind = "{self.kind}" has no single free motion; leave {given[0]} out'
            )
        if self.motion is not None and len(given) > 1:
            other = next(key for key in given if key != "motion")
            raise InputError(f"{where}: {other}: the free motion is prescribed by motion; give one of them")
        if self.limits2 is not None and len(self.motions) < 2:
            raise InputError(f'{where}: limits2: kind = "{self.kind}" has no second free motion; leave limits2 out')
        for key in ("limits", "limits2"):
            if getattr(self, key) is not None:
                object.__setattr__(self, key, _limits(getattr(self, key), f"{where}: {key}"))

    @property
    def limited(self) -> tuple[tuple[int, tuple[float, float]], ...]:
        """Numbers of the free motions that have limits, with these."""
        return tuple((k, given) for k, given in enumerate((self.limits, self.limits2)) if given is not None)

    @property
    def motions(self) -> tuple[str, ...]:
        """Names of the free motions that are reported, "turn" (radian) or "travel" (length); the first is that of limits,
        motion, load and stiffness, the second that of limits2."""
        return MOTIONS[self.kind]

    @property
    def of_points(self) -> bool:
        """Whether it is between points of a set."""
        return self.kind in LEAST

    def held(self, mesh: Mesh) -> int:
        """How many relative motions it takes, without limits and what is prescribed."""
        if self.of_points:
            more = len(mesh.nodes_of(self.on)) - LEAST[self.kind] + 1
            return {"straight": more * (mesh.dim - 1), "plane": more}.get(self.kind, 0)
        return HELD[self.kind] if mesh.dim == 3 else HELD_IN_PLANE[self.kind]

    def multipliers(self, mesh: Mesh) -> int:
        """How many there are: one for each motion that it takes, for each that has limits, and for what is prescribed."""
        return self.held(mesh) + len(self.limited) + (self.motion is not None)


def _limits(given: object, where: str) -> tuple[float, float]:
    try:
        lower, upper = (float(value) for value in checks.listed(given, where, "numbers"))
    except (TypeError, ValueError):
        raise InputError(f"{where}: expected [lower, upper], got {given!r}") from None
    if not lower <= 0.0 <= upper or lower == upper:
        raise InputError(
            f"{where}: expected lower <= 0 <= upper, as the motion begins at 0, and one of them other than 0, "
            f"got [{lower:g}, {upper:g}]"
        )
    return lower, upper


@dataclass(frozen=True)
class Multipliers:
    """The multipliers of connectors as a field, as in ``Physics``."""

    connectors: Sequence[Connector]

    def fields(self, mesh: Mesh) -> Sequence[Field]:
        """One, where there are connectors."""
        if not self.connectors:
            return []
        return [Field(FIELD, sum(c.multipliers(mesh) for c in self.connectors), 1, FIELD)]


def check_connectors(
    mesh: Mesh, connectors: Sequence[Connector], referenced: Sequence[Rigid | Coupling], finite: bool
) -> None:
    """Raise InputError for names that do not exist, kinds and directions that a model lacks, and bodies that connectors
    cannot take hold of."""
    by_name = {body.name: body for body in referenced}
    taken: set[str] = set()
    for i, connector in enumerate(connectors):
        where = f"connectors[{i}]"
        if connector.name in taken:
            raise InputError(f"{where}.name: '{connector.name}' is used twice; give each connector its own name")
        taken.add(connector.name)
        if mesh.axisymmetric:
            raise InputError(f"{where}: axisymmetric models have no connectors; prescribe y of the body or coupling")
        if connector.of_points:
            checks.known(connector.on, [*mesh.surfaces, *mesh.node_sets], f"{where}.on", "surface or node set")
            _check_count(len(mesh.nodes_of(connector.on)), connector, where)
        for key, name in (("on", connector.on), ("to", connector.to)):
            if name and not connector.of_points:
                checks.known(name, by_name, f"{where}.{key}", "rigid body or coupling")
                _check_body(mesh, by_name[name], connector, finite, f"{where}.{key}")
        if mesh.dim == 2 and connector.kind not in PLANE:
            raise InputError(
                f'{where}.kind: the model is 2D, where {", ".join(PLANE)} are known, got "{connector.kind}"'
            )
        _check_directions(mesh.dim, connector, where)


def _check_count(count: int, connector: Connector, where: str) -> None:
    least = LEAST[connector.kind]
    if count < least or (connector.kind == "distance" and count > least):
        more = "" if connector.kind == "distance" else " or more"
        raise InputError(f"{where}.on: '{connector.on}' has {count} points; a {connector.kind} has {least}{more}")


def _check_directions(dim: int, connector: Connector, where: str) -> None:
    for key in ("at", "axis", "axis2"):
        value: Any = getattr(connector, key)
        if value is not None and len(value) != dim:
            if key == "axis" and dim == 2 and connector.kind in ABOUT:
                break
            raise InputError(f"{where}.{key}: expected {dim} numbers, got {len(value)}")
    flat = dim == 2 and connector.kind in ABOUT
    if flat and connector.axis is not None:
        raise InputError(f"{where}.axis: the model is 2D, where a {connector.kind} is about its normal; leave axis out")
    if connector.axis is None and connector.kind not in NO_AXIS and not flat:
        raise InputError(f"{where}.axis: it is missing; give the direction of the {connector.kind}'s axis")


def _check_body(mesh: Mesh, body: Rigid | Coupling, connector: Connector, finite: bool, where: str) -> None:
    if isinstance(body, Rigid):
        return
    if body.partial(mesh):
        raise InputError(f"{where}: coupling '{body.name}' follows in some displacements only; let it follow in all")
    if body.mirrors:
        raise InputError(f"{where}: coupling '{body.name}' has mirrors; connectors need the whole model")
    if body.distributing and finite:
        raise InputError(
            f"{where}: coupling '{body.name}' is distributing, whose mean turn connectors can hold at small displacements "
            'only; use kind = "kinematic", or model.kinematics = "small"'
        )

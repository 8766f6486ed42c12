"""Prescribed rotation about an axis."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from abut import checks
from abut.errors import InputError
from abut.mesh.mesh import Mesh
from abut.model.conditions import Amplitude, History, Support, vector


@dataclass(frozen=True)
class Rotation:
    """All points of a surface, node set or body turn about an axis, exactly on their arcs; for kinematics "finite".

    Parameters
    ----------
    on : str
        The surface, node set or body.
    angle : float
        Times ``amplitude``, counterclockwise seen against ``axis`` [radian].
    centre : (dim,) of float
        A point of the axis [length].
    axis : (3,) of float, optional
        Its direction in 3D, of any length; left out in 2D.
    amplitude : Amplitude, optional
        Factor over time; the ramp where left out.

    Raises
    ------
    InputError
        For values that are no such things, or do not go together.

    Examples
    --------
    >>> import abut
    >>> rolled = abut.Rotation("beam.end", angle=6.28, centre=(10.0, 0.0))
    """

    on: str
    angle: float
    centre: tuple[float, ...]
    axis: tuple[float, ...] | None = None
    amplitude: History = None

    def __post_init__(self) -> None:
        where = f"rotation of '{self.on}'"
        checks.finite(self.angle, f"{where}: angle")
        for name in ("centre", "axis"):
            given = getattr(self, name)
            if given is not None:
                object.__setattr__(self, name, vector(given, f"{where}: {name}"))
        if self.axis is not None and not any(self.axis):
            raise InputError(f"{where}: axis: expected a direction, got zeros")
        if self.amplitude is not None and not isinstance(self.amplitude, Amplitude):
            raise InputError(f"{where}: amplitude: expected an Amplitude, got {type(self.amplitude).__name__}")

    @property
    def direction(self) -> tuple[float, ...]:
        """The axis with length 1."""
        axis = np.array(self.axis or (0.0, 0.0, 1.0))
        return tuple((axis / np.linalg.norm(axis)).tolist())

    def nodes(self, mesh: Mesh) -> NDArray[np.int64]:
        """Sorted numbers of the points that turn."""
        if self.on in mesh.surfaces or self.on in mesh.node_sets:
            return np.unique(mesh.nodes_of(self.on)).astype(np.int64)
        return np.unique(np.concatenate([cells.ravel() for _, cells, _ in mesh.cells_of(self.on)])).astype(np.int64)


def check_rotations(
    mesh: Mesh, rotations: Sequence[Rotation], supports: Sequence[Support], moving: Mapping[int, str], kinematics: str
) -> None:
    """Raise InputError for places that do not exist, axes of another dimension, and points that something else moves;
    moving: as from ``coupling.moving_points``."""
    taken: dict[int, str] = {}
    for support in supports if rotations else ():
        taken |= dict.fromkeys(mesh.nodes_of(support.on).tolist(), f"a support on '{support.on}'")
    taken |= moving
    for i, rotation in enumerate(rotations):
        where = f"rotations[{i}]"
        checks.known(
            rotation.on, [*mesh.surfaces, *mesh.node_sets, *mesh.bodies], f"{where}.on", "surface, node set or body"
        )
        if kinematics == "small":
            raise InputError(f'{where}: rotations are finite; use kinematics = "finite", or a rigid body')
        if mesh.axisymmetric:
            raise InputError(f"{where}: an axisymmetric model cannot turn; take the rotation out")
        if len(rotation.centre) != mesh.dim:
            raise InputError(f"{where}.centre: expected {mesh.dim} numbers, got {len(rotation.centre)}")
        if (rotation.axis is None) != (mesh.dim == 2) or (rotation.axis is not None and len(rotation.axis) != 3):
            raise InputError(f"{where}.axis: " + ("leave it out in 2D" if mesh.dim == 2 else "expected 3 numbers"))
        own_nodes = rotation.nodes(mesh).tolist()
        shared = next((n for n in own_nodes if n in taken), None)
        if shared is not None:
            raise InputError(
                f"{where}.on: point {shared} of '{rotation.on}' is moved by {taken[shared]} too; take it out of one of them"
            )
        taken |= dict.fromkeys(own_nodes, f"the rotation of '{rotation.on}'")

"""Stops: rigid planes that surfaces run against, made for them and met by contact as any other body."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from abut import checks
from abut.errors import InputError
from abut.mesh.facets import bodies_at
from abut.mesh.make import box, rectangle
from abut.mesh.mesh import CellBlock, Mesh
from abut.mesh.record import MeshRecord
from abut.model.conditions import Rigid, vector
from abut.model.contact import Contact
from abut.types import Array

FACE = "left"  # of a made box: where its first coordinate is least
ALONG = 1e-9  # component of a unit vector across an axis that is rounding


@dataclass(frozen=True)
class Stop:
    """A surface moves along a direction up to a stop: a rigid plane across it, without friction, that stays where it is.

    Where the surface is a plane across the direction, no point of it is displaced along it by more than the distance.

    Parameters
    ----------
    on : str
        A surface.
    direction : (dim,) of float
        Of the motion that is stopped, of any length; axisymmetric: along the axis.
    distance : float
        From where the surface reaches farthest to the plane [length].
    name : str
        Of the stop: of its contact and its body; "stop ON" where left out.

    Raises
    ------
    InputError
        For values that are no such things.

    Examples
    --------
    >>> import abut
    >>> stop = abut.Stop("arm.tip", direction=(0.0, -1.0), distance=0.2)  # no farther down than 0.2
    """

    on: str
    direction: tuple[float, ...]
    distance: float = 0.0
    name: str = ""

    def __post_init__(self) -> None:
        checks.text(self.on, "stop: on")
        where = f"stop on '{self.on}'"
        object.__setattr__(self, "direction", vector(self.direction, f"{where}: direction"))
        if not any(self.direction):
            raise InputError(f"{where}: direction: it has no length; give the one of the motion that is stopped")
        if checks.finite(self.distance, f"{where}: distance") < 0.0:
            raise InputError(
                f"{where}: distance: expected 0 or more, got {self.distance:g}; turn direction round instead"
            )
        if not self.name:
            object.__setattr__(self, "name", f"stop {self.on}")
        checks.text(self.name, f"{where}: name")


@dataclass(frozen=True)
class Stopped:
    """What stops add to a model.

    Parameters
    ----------
    mesh : Mesh
        With a body for each stop.
    rigid : tuple of Rigid
        These bodies, held.
    contacts : tuple of Contact
        Of each stop with its surface.
    """

    mesh: Mesh
    rigid: tuple[Rigid, ...]
    contacts: tuple[Contact, ...]


def add_stops(mesh: Mesh, stops: Sequence[Stop], plane: str | None = None) -> Stopped:
    """The mesh with a rigid plane for each stop, and the contacts with them, for ``Model``.

    Each plane reaches beyond its surface by the size of the surface, and by the distance.

    Parameters
    ----------
    mesh : Mesh
        Of the model so far.
    stops : sequence of Stop
        What is added.
    plane : str, optional
        That of the model.

    Returns
    -------
    Stopped
        Mesh, rigid bodies and contacts.

    Raises
    ------
    InputError
        For surfaces that do not exist, names that are taken, directions of another dimension, and planes that the body of
        the surface reaches through where the surface faces the other way.

    Examples
    --------
    >>> import abut
    >>> from abut.mesh import make
    >>> mesh = make.join({"bar": make.rectangle([0, 10], [0, 1], cells=[5, 1])})
    >>> added = abut.add_stops(mesh, [abut.Stop("bar.right", (1.0, 0.0), 0.02)])
    >>> added.contacts[0].name, sorted(added.mesh.bodies)
    ('stop bar.right', ['bar', 'stop bar.right'])
    """
    checks.instance(mesh, MeshRecord, "add_stops: mesh", "a mesh (abut.Mesh)")
    rigid, contacts = [], []
    for i, stop in enumerate(checks.records(stops, "stops", (Stop,))):
        where = f"stops[{i}]"
        checks.known(stop.on, mesh.surfaces, f"{where}.on", "surface")
        if len(stop.direction) != mesh.dim:
            raise InputError(f"{where}.direction: expected {mesh.dim} numbers, got {len(stop.direction)}")
        if stop.name in mesh.bodies:
            raise InputError(f"{where}.name: there is a body '{stop.name}'; give the stop another name")
        _check_side(mesh, stop, where)
        body = _plane(mesh.points[mesh.nodes_of(stop.on)], stop, plane == "axisymmetric", where)
        mesh = _with(mesh, body, stop.name)
        rigid.append(_held(stop.name, mesh.dim, plane == "axisymmetric"))
        contacts.append(Contact(stop.on, f"{stop.name}.face", stop.name))
    return Stopped(mesh, tuple(rigid), tuple(contacts))


def _held(name: str, dim: int, axisymmetric: bool) -> Rigid:
    """The body of a stop, which does not move."""
    if axisymmetric:
        return Rigid(name, y=0.0)
    if dim == 2:
        return Rigid(name, x=0.0, y=0.0, rz=0.0)
    return Rigid(name, x=0.0, y=0.0, z=0.0, rx=0.0, ry=0.0, rz=0.0)


def _plane(points: Array, stop: Stop, axisymmetric: bool, where: str) -> Mesh:
    """A box of one cell whose face is the plane; points: (n, dim) of the surface."""
    along = np.array(stop.direction) / np.linalg.norm(stop.direction)
    if axisymmetric and abs(along[0]) > ALONG:
        raise InputError(f"{where}.direction: the model is axisymmetric; expected (0, 1) or (0, -1), along the axis")
    frame = _frame(along)
    inside = points @ frame.T
    low, high = inside.min(axis=0), inside.max(axis=0)
    size = float(np.max(high - low)) + stop.distance
    face = high[0] + stop.distance
    ranges = [(face, face + size), *zip(low[1:] - size, high[1:] + size)]
    flat = len(frame) == 2
    made = rectangle(ranges[0], ranges[1], (1, 1), "quad4") if flat else box(ranges[0], ranges[1], ranges[2], (1, 1, 1))
    placed = made.points @ frame
    if axisymmetric:
        placed[:, 0] = np.maximum(placed[:, 0], 0.0)
    return replace(made, points=placed)


def _check_side(mesh: Mesh, stop: Stop, where: str) -> None:
    """Raise InputError where all of a surface faces against the direction, and its body reaches through the plane."""
    surface = mesh.surface(stop.on)
    edges = np.diff(mesh.points[surface.nodes[:, : mesh.dim]], axis=1)  # between corners, counterclockwise from outside
    normal = np.cross(edges[:, 0], edges[:, 1]) if mesh.dim == 3 else edges[:, 0] @ np.array([[0.0, -1.0], [1.0, 0.0]])
    along = np.array(stop.direction) / np.linalg.norm(stop.direction)
    if (normal @ along > -ALONG * np.linalg.norm(normal, axis=1)).any():
        return
    bodies = bodies_at(mesh, surface.cells)
    own = np.concatenate([mesh.nodes_of(body) for body in bodies])
    behind = float((mesh.points[own] @ along).max() - (mesh.points[surface.node_ids] @ along).max())
    if behind > stop.distance:
        raise InputError(
            f"{where}.direction: {stop.direction} points from '{stop.on}' into its own body '{bodies[0]}', in which the "
            "plane would stand; turn the direction round, or name the surface that faces the stop"
        )


def _frame(along: Array) -> Array:
    """Rows: a unit vector (dim,), and directions across it, right-handed."""
    if len(along) == 2:
        return np.array([along, [-along[1], along[0]]])
    across = np.cross(along, np.eye(3)[np.argmin(np.abs(along))])
    across /= np.linalg.norm(across)
    return np.array([along, across, np.cross(along, across)])


def _with(mesh: Mesh, made: Mesh, name: str) -> Mesh:
    """The mesh with a body of a name, whose face is the surface NAME.face."""
    (block,) = made.blocks
    last = CellBlock(block.kind, (block.nodes + len(mesh.points)).astype(np.int32))
    return replace(
        mesh,
        points=np.concatenate([mesh.points, made.points]),
        blocks=(*mesh.blocks, last),
        bodies={**mesh.bodies, name: np.array([mesh.n_cells])},
        surfaces={**mesh.surfaces, f"{name}.face": made.surfaces[FACE] + np.array([mesh.n_cells, 0])},
    )

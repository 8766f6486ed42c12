"""What connectors hold and leave free, as functions of a few points of the bodies that they join; theory (F21)."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
import scipy.sparse as sp

from abut.dofs import dofs_at
from abut.errors import InputError
from abut.jets import Jet, angle, cross, dot, linear
from abut.model import Connector, Model
from abut.model.coupling import in_line
from abut.problem.gatherings import Gathering, far_apart, gathering
from abut.problem.rigid_bodies import RigidBody
from abut.types import Array, Sparse

NORMAL = np.array([0.0, 0.0, 1.0])  # of plane models


@dataclass(frozen=True)
class Side:
    """A body that a connector takes hold of, by points that move with it: three of them, two in the plane; the ground has
    none. rest: (k, 3) undeformed; rows: (k dim, dim n_points) their displacements by those of all points."""

    rest: Array
    rows: Sparse
    dim: int

    @property
    def size(self) -> float:
        """Distance between its points."""
        return float(np.linalg.norm(self.rest[-1] - self.rest[0])) if len(self.rest) else 0.0

    def carried(self, moved: Array, first: int, count: int) -> Carried:
        """With its points displaced by (k dim,), which are the variables from ``first`` on, of ``count``."""
        if not len(self.rest):
            fixed = [Jet.linear(axis, np.zeros((3, count))) for axis in np.eye(3)]
            return Carried(Jet.linear(np.zeros(3), np.zeros((3, count))), fixed, np.zeros(3), np.eye(3))
        points = []
        for k, rest in enumerate(self.rest):
            here, slope = rest.copy(), np.zeros((3, count))
            own = slice(k * self.dim, (k + 1) * self.dim)
            here[: self.dim] += moved[own]
            slope[np.arange(self.dim), first + np.arange(own.start, own.stop)] = 1.0
            points.append(Jet.linear(here, slope))
        a = points[1] - points[0]
        still = np.zeros((3, count))
        normal = Jet.linear(NORMAL, still)
        b = cross(normal, a) if self.dim == 2 else points[2] - points[0]
        c = normal if self.dim == 2 else cross(a, b).times(1.0 / self.size)
        edges = self.rest[1:] - self.rest[0]
        if self.dim == 2:
            basis = np.column_stack([edges[0], np.cross(NORMAL, edges[0]), NORMAL])
        else:
            basis = np.column_stack([*edges, np.cross(*edges) / self.size])
        return Carried(points[0], [a, b, c], self.rest[0], np.linalg.inv(basis))


@dataclass(frozen=True)
class Carried:
    """What moves with a body: its origin, at ``rest`` undeformed, and vectors that span all others by ``shares``
    (3, 3)."""

    origin: Jet
    basis: Sequence[Jet]
    rest: Array
    shares: Array

    def vector(self, undeformed: Array) -> Jet:
        """A vector (3,) that moves with the body."""
        parts = [one.times(float(share)) for one, share in zip(self.basis, self.shares @ undeformed)]
        return parts[0] + parts[1] + parts[2]

    def point(self, undeformed: Array) -> Jet:
        """A point (3,) that does."""
        return self.origin + self.vector(undeformed - self.rest)


@dataclass(frozen=True)
class Joint:
    """A connector in a mesh. at: (3,) the joint; axes: (3, 3) of ``to``, the connector's first, undeformed; size: length by
    which turns are weighed beside displacements; finite: whether turns are."""

    connector: Connector
    on: Side
    to: Side
    at: Array
    axes: Array
    size: float
    finite: bool

    @property
    def rows(self) -> Sparse:
        """(n_variables, dim n_points): displacements of the points of both sides by those of all."""
        return sp.vstack([self.on.rows, self.to.rows], format="csr")

    def functions(self, moved: Array) -> tuple[list[Jet], list[Jet]]:
        """What is zero, each a length, and the free motions, at displacements (n_variables,) of the points of both sides."""
        if self.finite:
            return self._functions(moved)
        held, free = self._functions(np.zeros_like(moved))
        return [linear(jet, moved) for jet in held], [linear(jet, moved) for jet in free]

    def _functions(self, moved: Array) -> tuple[list[Jet], list[Jet]]:
        count, split = len(moved), self.on.rows.shape[0]
        on, to = self.on.carried(moved[:split], 0, count), self.to.carried(moved[split:], split, count)
        apart = on.point(self.at) - to.point(self.at)
        e, f = [to.vector(axis) for axis in self.axes], [on.vector(axis) for axis in self.axes]
        dim, kind = self.on.dim, self.connector.kind
        point = [apart[a] for a in range(dim)]
        beside = [dot(apart, e[k]) for k in range(1, dim)]
        travel = dot(apart, e[0])
        if dim == 2:
            square = dot(e[0], f[1]).times(self.size)
            turn = angle(dot(f[0], e[1]), dot(f[0], e[0]))
            return {"hinge": (point, [turn]), "slider": ([*beside, square], [travel]), "slot": (beside, [travel])}[kind]
        tilts = [dot(e[0], f[1]).times(self.size), dot(e[0], f[2]).times(self.size)]
        turn = angle(dot(f[1], e[2]), dot(f[1], e[1]))
        if kind == "universal":  # the second of the axes is that of ``on``
            return [*point, tilts[0]], [turn, angle(dot(f[0], cross(f[1], e[0])), dot(f[0], e[0]))]
        twist = dot(e[1], f[2]).times(self.size)
        return {
            "hinge": ([*point, *tilts], [turn]),
            "slider": ([*beside, *tilts, twist], [travel]),
            "cylindrical": ([*beside, *tilts], [travel, turn]),
            "ball": (point, []),
            "slot": (beside, [travel]),
        }[kind]

    def resultant(self, forces: Array, moved: Array) -> tuple[Array, Array]:
        """Force (dim,) and moment (1,) or (3,) about the joint where it is, of forces (n_variables,) on the points of
        ``on``."""
        dim, split = self.on.dim, self.on.rows.shape[0]
        here = np.zeros_like(moved) if not self.finite else moved
        own = self.on.carried(here[:split], 0, split)
        at, force = own.point(self.at).value, np.zeros((len(self.on.rest), 3))
        force[:, :dim] = forces[:split].reshape(-1, dim)
        place = self.on.rest.copy()
        place[:, :dim] += here[:split].reshape(-1, dim)
        moment = np.cross(place - at, force).sum(axis=0)
        return force.sum(axis=0)[:dim], moment if dim == 3 else moment[2:]


AnyJoint = Joint | Gathering


def joints(model: Model, bodies: Sequence[RigidBody]) -> list[AnyJoint]:
    """The connectors of a model. Raises InputError for bodies whose points do not say how they turn."""
    by_name = {body.name: body for body in bodies}
    return [gathering(model, each) if each.of_points else _joint(model, each, by_name) for each in model.connectors]


def joint_loads(model: Model, bodies: Sequence[RigidBody]) -> Array:
    """Nodal forces (dim n_points, n_histories) of the loads of connectors, on undeformed bodies."""
    histories = model.histories
    total = np.zeros((model.mesh.points.size, len(histories)))
    for joint in joints(model, bodies):
        if joint.connector.load is not None:
            _, free = joint.functions(np.zeros(joint.rows.shape[0]))
            along = joint.rows.T @ free[0].slope
            total[:, histories.index(joint.connector.amplitude)] += joint.connector.load * along
    return total


def _joint(model: Model, connector: Connector, bodies: dict[str, RigidBody]) -> Joint:
    dim = model.dim
    sides = [_side(model, bodies.get(name), connector) for name in (connector.on, connector.to)]
    at, axis = np.zeros(3), np.zeros(3)
    at[:dim] = bodies[connector.on].reference if connector.at is None else connector.at
    axis[:dim] = np.eye(dim)[0] if connector.axis is None else np.array(connector.axis)
    second = connector.axis2 if connector.axis2 is not None else _across(axis, dim)
    size = max(side.size for side in sides)
    return Joint(connector, sides[0], sides[1], at, _triad(axis, np.array(second)), size, model.finite)


def _across(axis: Array, dim: int) -> Array:
    return np.cross(NORMAL, axis) if dim == 2 else np.cross(axis, np.eye(3)[np.abs(axis).argmin()])


def _triad(first: Array, second: Array) -> Array:
    """Rows: both directions as unit vectors, and the one across."""
    one = first / np.linalg.norm(first)
    two = second - (second @ one) * one
    two /= np.linalg.norm(two)
    return np.array([one, two, np.cross(one, two)])


def _side(model: Model, body: RigidBody | None, connector: Connector) -> Side:
    dim, size = model.dim, model.mesh.points.size
    if body is None:
        return Side(np.zeros((0, 3)), sp.csr_matrix((0, size)), dim)
    if (dim == 3 and in_line(body.points)) or len(body.points) < 2:
        raise InputError(
            f"connector '{connector.name}': the points of {body.words} lie on one line, which leaves a turn open; couple "
            "points beside the line"
        )
    chosen = far_apart(body.points)
    rest = np.zeros((len(chosen), 3))
    rest[:, :dim] = body.points[chosen]
    picked = dofs_at(body.nodes[chosen], dim).ravel()
    if body.whole:
        rows = sp.csr_matrix((np.ones(len(picked)), (np.arange(len(picked)), picked)), shape=(len(picked), size))
        return Side(rest, rows, dim)
    moved = body.moved(body.points[chosen]).reshape(len(picked), -1) @ body.spreading().T
    every = dofs_at(body.nodes, dim).ravel()
    place = sp.csr_matrix((np.ones(len(every)), (np.arange(len(every)), every)), shape=(len(every), size))
    return Side(rest, (sp.csr_matrix(moved) @ place).tocsr(), dim)

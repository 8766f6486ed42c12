"""Connectors between the points of a set: on a line, in a plane, at a distance, with a mean turn; theory (F23)."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
import scipy.sparse as sp
from numpy.typing import NDArray

from abut.dofs import dofs_at, n_components, n_dofs
from abut.errors import InputError
from abut.jets import Jet, angle, cross, dot, linear
from abut.model import Connector, Model
from abut.types import Array, Sparse

OFF = 1e-6  # of the points' extent: how far one may lie off the line or plane, or off the axis and still be on it
NORMAL = np.array([0.0, 0.0, 1.0])  # of plane models


@dataclass(frozen=True)
class Gathering:
    """A connector between points. rest: (k, 3) undeformed; rows: (k dim, dim n_points) their displacements by those of all
    points; axis: (3,) unit vector of a mean turn; size: extent of the points; finite: whether turns are."""

    connector: Connector
    rest: Array
    rows: Sparse
    axis: Array
    size: float
    finite: bool

    def functions(self, moved: Array) -> tuple[list[Jet], list[Jet]]:
        """What the joint holds, as in ``Joint``."""
        if self.finite:
            return self._functions(moved)
        held, free = self._functions(np.zeros_like(moved))
        return [linear(jet, moved) for jet in held], [linear(jet, moved) for jet in free]

    def resultant(self, forces: Array, moved: Array) -> tuple[Array, Array]:
        """Force and moment that the joint carries, as in ``Joint``: points of one set hold each other."""
        return (np.zeros(2), np.zeros(1)) if self._flat else (np.zeros(3), np.zeros(3))

    def _functions(self, moved: Array) -> tuple[list[Jet], list[Jet]]:
        kind = self.connector.kind
        if kind == "distance":
            return [], [self._distance(moved)]
        if kind == "mean-turn":
            return [], [self._mean_turn(moved)]
        base = far_apart(self.rest) if kind == "plane" else far_apart(self.rest[:, :2] if self._flat else self.rest)
        if kind == "straight":
            base = [base[0], base[-1]]
        others = [k for k in range(len(self.rest)) if k not in base]
        held = [jet for k in others for jet in self._off(moved, [*base, k])]
        return held, []

    @property
    def _flat(self) -> bool:
        return n_components(self.rows.shape[0], len(self.rest)) == 2

    def _off(self, moved: Array, chosen: list[int]) -> list[Jet]:
        """How far the last of some points is off the line or plane through the others."""
        first, *ends, last = self._points(moved, chosen)
        edges = [end - first for end in ends]
        if len(edges) == 2:
            across = np.cross(*(self.rest[k] - self.rest[chosen[0]] for k in chosen[1:3]))
            return [self._placed(dot(cross(*edges), last - first).times(1.0 / float(np.linalg.norm(across))), chosen)]
        along = self.rest[chosen[1]] - self.rest[chosen[0]]
        beside = cross(edges[0], last - first).times(1.0 / float(np.linalg.norm(along)))
        two = np.cross(along, np.eye(3)[np.abs(along).argmin()])
        directions = [NORMAL] if self._flat else [two, np.cross(along, two)]
        none = np.zeros_like(first.slope)
        return [self._placed(dot(beside, Jet.linear(each / np.linalg.norm(each), none)), chosen) for each in directions]

    def _distance(self, moved: Array) -> Jet:
        """The root of a square, less what it is at the outset."""
        one, other = self._points(moved, [0, 1])
        apart = other - one
        square, rest = dot(apart, apart), float(np.linalg.norm(self.rest[1] - self.rest[0]))
        root = float(np.sqrt(square.value))
        slope = square.slope / (2.0 * root)
        bend = square.bend / (2.0 * root) - np.outer(slope, slope) / root
        return self._placed(Jet(np.asarray(root - rest), slope, bend), [0, 1])

    def _mean_turn(self, moved: Array) -> Jet:
        """The mean of the angles by which the points turn about an axis of a fixed direction through their middle."""
        count = len(self.rest)
        every = list(range(count))
        points = self._points(moved, every)
        middle = points[0]
        for point in points[1:]:
            middle = middle + point
        none = np.zeros_like(middle.slope)
        axis = Jet.linear(self.axis, none)
        centre, total = self.rest.mean(axis=0), None
        for rest, point in zip(self.rest, points):
            arm = rest - centre
            arm = Jet.linear(arm - (arm @ self.axis) * self.axis, none)
            here = point - middle.times(1.0 / count)
            turn = angle(dot(cross(arm, here), axis), dot(arm, here)).times(1.0 / count)
            total = turn if total is None else total + turn
        assert total is not None
        return total

    def _points(self, moved: Array, chosen: Sequence[int]) -> list[Jet]:
        """Some of the points, as functions of their own displacements."""
        dim = 2 if self._flat else 3
        result = []
        for k, number in enumerate(chosen):
            here, slope = self.rest[number].copy(), np.zeros((3, n_dofs(len(chosen), dim)))
            here[:dim] += moved[dofs_at(number, dim)]
            slope[np.arange(dim), dofs_at(k, dim)] = 1.0
            result.append(Jet.linear(here, slope))
        return result

    def _placed(self, jet: Jet, chosen: Sequence[int]) -> Jet:
        """A function of some of the points as one of all."""
        dim, count = (2 if self._flat else 3), self.rows.shape[0]
        at = dofs_at(np.array(chosen), dim).ravel()
        slope, bend = np.zeros(count), np.zeros((count, count))
        slope[at] = jet.slope
        bend[np.ix_(at, at)] = jet.bend
        return Jet(jet.value, slope, bend)


def gathering(model: Model, connector: Connector) -> Gathering:
    """Raises InputError for points that are not where they are to stay, or on the axis."""
    mesh, dim = model.mesh, model.dim
    nodes = mesh.nodes_of(connector.on).astype(np.int64)
    rest = np.zeros((len(nodes), 3))
    rest[:, :dim] = mesh.points[nodes]
    picked = dofs_at(nodes, dim).ravel()
    rows = sp.csr_matrix(
        (np.ones(len(picked)), (np.arange(len(picked)), picked)), shape=(len(picked), mesh.points.size)
    )
    axis = NORMAL if connector.axis is None or dim == 2 else np.array(connector.axis)
    size = float(np.linalg.norm(np.ptp(rest, axis=0)))
    found = Gathering(connector, rest, rows, axis / np.linalg.norm(axis), size, model.finite)
    _check(found)
    return found


def _check(found: Gathering) -> None:
    connector, rest, where = found.connector, found.rest, f"connector '{found.connector.name}'"
    if found.size <= 0.0:
        raise InputError(f"{where}: the points of '{connector.on}' are at one place")
    if connector.kind == "mean-turn":
        arms = rest - rest.mean(axis=0)
        arms -= np.outer(arms @ found.axis, found.axis)
        if np.linalg.norm(arms, axis=1).min() <= OFF * found.size:
            raise InputError(f"{where}: a point of '{connector.on}' lies on the axis; leave it out of the set")
    if connector.kind == "plane" and _spread(rest)[1] <= OFF * _spread(rest)[0]:
        raise InputError(f"{where}: the points of '{connector.on}' lie on one line; use kind = \"straight\"")
    kept = {"straight": 1, "plane": 2}.get(connector.kind)
    if kept is not None and _spread(rest)[kept] > OFF * _spread(rest)[0]:
        raise InputError(
            f"{where}: the points of '{connector.on}' do not lie on one {'line' if kept == 1 else 'plane'} at the outset; "
            "choose points that do"
        )


def _spread(rest: Array) -> NDArray[np.float64]:
    """Extents along principal directions, the largest first."""
    return np.append(np.linalg.svd(rest - rest.mean(axis=0), compute_uv=False), np.zeros(3))[:3]


def far_apart(points: Array) -> list[int]:
    """Numbers of two points far from each other, and in 3D of a third far from their line."""
    one = int(np.linalg.norm(points - points.mean(axis=0), axis=1).argmax())
    other = int(np.linalg.norm(points - points[one], axis=1).argmax())
    if points.shape[1] == 2:
        return [one, other]
    along = points[other] - points[one]
    third = int(np.linalg.norm(np.cross(points - points[one], along), axis=1).argmax())
    return [one, third, other]

"""Supports, equations and rigid bodies as an exact change of variables: u = Z u_free + u_prescribed; theory (F8)."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
import scipy.sparse as sp
import scipy.sparse.linalg as spla
from numpy.typing import NDArray

from abut.bordered import Bordered
from abut.contact.geometry import nodal_normals
from abut.dofs import dofs_at, n_dofs, n_places, place_of, widened
from abut.fields import evaluate
from abut.mesh.mesh import Mesh
from abut.model import Model, Support
from abut.problem.elimination import Links, contradiction_at_node, eliminate, row_products
from abut.problem.other_fields import OtherFields
from abut.problem.projection import projected
from abut.problem.rigid_bodies import RigidBody, body_rows, rigid_bodies
from abut.problem.sections import shortenings_of
from abut.problem.turns import Turn, Turns, about
from abut.types import Array, Operator, Sparse

AXIS = -1  # origin of the condition that points on the axis of symmetry stay there
ON_AXIS = 1e-9  # radius over the model's size that counts as none
CANCELLED = 1e-12  # coefficients over the largest of their row that are what putting in supports left
AGREEING = 1e-12  # of the largest prescribed value: functions of position that agree may differ by this
STUCK = 1e-12  # square of a point's motion over its largest, by unit free displacements, that counts as none
ORTHONORMAL = 1e-12
SAME_DIRECTION = 1e-6  # sine of the angle below which two held directions count as one


@dataclass(frozen=True)
class Constraints:
    """free: (dim n_points, n_free) sparse, its columns ``orthonormal`` unless equations or rigid bodies take part;
    ``coupled``: a column moves several points; prescribed: (dim n_points, n_histories); largest: displacement prescribed
    at any time; bodies: the rigid ones; links: where there are equations; turns: finite ones, None without;
    others: fields, None without, whose unknowns come after the free displacements."""

    free: Sparse
    prescribed: NDArray[np.float64]
    largest: float = 0.0
    orthonormal: bool = True
    coupled: bool = False
    bodies: Sequence[RigidBody] = ()
    links: Links | None = None
    turns: Turns | None = None
    others: OtherFields | None = None

    @property
    def moving(self) -> Constraints:
        """Those of displacements alone."""
        if self.others is None:
            return self
        free = self.free[:, : self.free.shape[1] - self.others.free.nnz]
        return replace(self, free=free, others=None)  # turns are in the columns already, as from ``near``

    def with_others(self, others: OtherFields | None) -> Constraints:
        """With fields beside displacements."""
        if others is None:
            return self
        n = others.free.shape[1]
        turns = None if self.turns is None else self.turns.widened(n)
        return replace(self, free=widened(self.free, n), turns=turns, others=others)

    def forces(self, values: NDArray[np.float64]) -> NDArray[np.float64]:
        """On the unknowns, (n_free,), by forces (n_values,) on the values of all fields."""
        if self.others is None:
            return np.asarray(self.free.T @ values)
        n = self.free.shape[0]
        return np.asarray(self.free.T @ values[:n] + self.others.free.T @ values[n:])

    def displacement(self, free: NDArray[np.float64], factors: NDArray[np.float64]) -> NDArray[np.float64]:
        """Of all points, (dim n_points,), by the free displacements and the factors of the histories."""
        linear = self.linear(free, factors)
        return linear if self.turns is None else linear + self.turns.displacement(free, factors)

    def linear(self, free: NDArray[np.float64], factors: NDArray[np.float64]) -> NDArray[np.float64]:
        """The same without what finite turns add, so with small ones in their place."""
        return np.asarray(self.free @ free + self.prescribed @ factors)

    def turn_of(self, nodes: NDArray[np.int64]) -> Turn | None:
        """The finite turn of points (n,), those of a rigid body or coupling; None without."""
        turns = () if self.turns is None else self.turns.turns
        return next((turn for turn in turns if np.array_equal(turn.nodes, nodes)), None)

    def near(self, free: NDArray[np.float64], factors: NDArray[np.float64]) -> Constraints:
        """The same as a linear change of variables near a state: its columns are the derivatives there."""
        if self.turns is None:
            return self
        columns = (self.free + self.turns.columns(free, factors)).tocsr()
        return replace(self, free=columns, orthonormal=False)

    def together(self, points: NDArray[np.int64], dim: int) -> bool:
        """Whether a free displacement moves one of ``points`` (n,) and others with it."""
        if not self.coupled:
            return False
        columns = self.free[dofs_at(points, dim).ravel()].indices
        entries = self.free.tocsc()[:, np.unique(columns)].tocoo()
        moved = np.unique(np.column_stack([entries.col, place_of(entries.row, dim)]), axis=0)
        return bool(np.bincount(moved[:, 0]).max(initial=0) > 1)

    def coordinates(self, vectors: NDArray[np.float64]) -> NDArray[np.float64]:
        """Free displacements (n_free, k) nearest to displacements of all points (dim n_points, k)."""
        moved = self.free.T @ vectors
        if self.orthonormal or not moved.size:
            return np.asarray(moved)
        moves = np.diff(self.free.tocsc().indptr) > 0  # unknowns of other fields move nothing
        free = self.free[:, moves]
        moved[moves] = spla.splu((free.T @ free).tocsc()).solve(moved[moves])
        return np.asarray(moved)

    def taken(self, vectors: NDArray[np.float64]) -> NDArray[np.float64]:
        """What is left of displacements of all points (dim n_points, k) that no free ones can follow, where that may not be
        zero: most points move freely, and nothing need be computed for them."""
        alone = np.bincount(self.free.indices, minlength=self.free.shape[1]) == 1
        followed = np.zeros(self.free.shape[0], dtype=bool)
        single = np.flatnonzero(np.diff(self.free.indptr) == 1)
        followed[single] = alone[self.free.indices[self.free.indptr[single]]]
        rows = np.flatnonzero(~followed)
        free, here = self.free[rows], vectors[rows]
        near = replace(self, free=free[:, np.unique(free.indices)], others=None)
        return np.asarray(here - near.free @ near.coordinates(here))

    def reduce(self, matrix: Sparse) -> Sparse:
        """free^T matrix free, (n_free, n_free) CSR.

        matrix: over displacements, or over the values of all fields."""
        if self.others is not None and matrix.shape[0] > self.free.shape[0]:
            whole = self.others.whole(self.free)
            return projected(matrix.tocsr(), whole)
        return projected(matrix.tocsr(), self.free)

    def reduced(self, matrix: Operator) -> Operator:
        """The same of a matrix that may have a border, which stays."""
        if not isinstance(matrix, Bordered):
            return self.reduce(matrix)
        return matrix.within(self.free, self.reduce(matrix.matrix))

    def held_share(self, points: NDArray[np.int64], directions: NDArray[np.float64]) -> NDArray[np.float64]:
        """How much of a direction (n, dim unit vectors) is held at each of n points: 1 fully, 0 free."""
        return np.asarray(1.0 - (self.can_move(points, directions) ** 2).sum(axis=1))

    def can_move(self, points: NDArray[np.int64], directions: NDArray[np.float64]) -> NDArray[np.float64]:
        """The part of a direction (n, dim unit vectors) along which each of n points is free to move, (n, dim)."""
        dim = directions.shape[1]
        gram = row_products(self.free, dofs_at(points, dim))
        if self.orthonormal:
            return np.einsum("nab,nb->na", gram, directions)
        size, axes = np.linalg.eigh(gram)  # of the displacements that a point can take
        moves = (size > STUCK * np.maximum(size[:, -1:], 1e-300)) & (size[:, -1:] > 0.0)
        along = np.einsum("nda,nd->na", axes, directions)
        return np.einsum("nda,na->nd", axes, np.where(moves, along, 0.0))


def supports(model: Model) -> Constraints:
    """Collect all supports, equations and rigid bodies. Raises SingularModelError where they contradict each other,
    InputError for functions that do not return a finite number for each node."""
    conditions, bodies = _conditions(model), rigid_bodies(model)
    whole = [body for body in bodies if body.whole]
    on_bodies = np.isin(conditions[0], np.concatenate([np.empty(0, np.int64), *(body.nodes for body in whole)]))
    free, prescribed = _node_by_node(model, tuple(part[~on_bodies] for part in conditions), whole)
    orthonormal, coupled, links, turning = True, False, None, list[Turn]()
    holding = [body for body in bodies if body.holds]
    if holding or model.equations or model.preloads:
        free, prescribed, links, turning = _together(
            model, free, prescribed, tuple(part[on_bodies] for part in conditions), holding
        )
        gram = free.T @ free
        orthonormal = abs(gram - sp.identity(gram.shape[0])).max() < ORTHONORMAL if gram.shape[0] else True
        at, shape = free.tocoo(), (n_places(free.shape[0], model.dim), free.shape[1])
        point = sp.csr_matrix((np.ones(at.nnz), (place_of(at.row, model.dim), at.col)), shape=shape)
        point.sum_duplicates()
        coupled = bool(np.bincount(point.indices).max(initial=0) > 1)
    factors = [1.0 if history is None else history.largest for history in model.histories]
    largest = float((np.abs(prescribed) @ factors).max(initial=0.0))
    turning += _turned(model, free.shape[1])
    turns = Turns(turning, model.dim, len(model.mesh.points)) if model.finite and turning else None
    linked = links if model.equations or model.preloads else None
    return Constraints(free, prescribed, largest, orthonormal, coupled, bodies, linked, turns)


def _together(
    model: Model,
    free: Sparse,
    prescribed: NDArray[np.float64],
    conditions: tuple[Array, ...],
    bodies: Sequence[RigidBody],
) -> tuple[Sparse, NDArray[np.float64], Links, list[Turn]]:
    """Add the unknowns of rigid bodies, and eliminate what holds on several points at once: theory (F11), (F12). The turns
    are those of rigid bodies."""
    n_dofs, n_own = free.shape
    cut = shortenings_of(model)
    columns_of = [*(body.columns(n_dofs) for body in bodies), sp.csr_matrix((n_dofs, len(cut)))]
    free = sp.hstack([free, *columns_of], format="csr")
    rows, values, names = [], [], []
    first = n_own
    for body in bodies:
        columns = np.arange(first, first := first + body.unknowns)
        held = body_rows(body, model.histories, free, prescribed, columns)
        rows.append(held.matrix)
        values.append(held.values)
        names += [body.words] * len(held.values)
    node, direction, value, origin = conditions
    dim = model.dim
    entries = (np.repeat(np.arange(len(node)), dim), dofs_at(node, dim).ravel())
    rows_of = sp.csr_matrix((direction.ravel(), entries), shape=(len(node), n_dofs))
    linear, constants = equations(model)
    names += [_name(model, i) for i in origin] + [f"equations[{i}]" for i in range(len(model.equations))]
    names += cut.names
    points = sp.vstack([rows_of, linear, cut.at_points], format="csr")
    above = sp.csr_matrix((rows_of.shape[0] + linear.shape[0], len(cut)))
    by_unknowns = points @ free + sp.hstack(
        [sp.csr_matrix((points.shape[0], first)), sp.vstack([above, cut.by_shortenings])], format="csr"
    )
    rows.append(_without_rounding(by_unknowns, abs(points).max(axis=1).toarray().ravel()))
    given = np.concatenate([value, constants, cut.values])
    left, size = given - points @ prescribed, np.abs(given) + abs(points) @ np.abs(prescribed)
    values.append(np.where(np.abs(left) > CANCELLED * size, left, 0.0))
    every = sp.vstack(rows, format="csr")
    done = eliminate(every, np.concatenate(values), names)
    cut.require_closing(done.free[first:])
    joins = sp.diags([float(not equation.supports) for equation in model.equations], shape=2 * (linear.shape[0],))
    linear = sp.vstack([joins @ linear, cut.at_points], format="csr")
    others = sp.csr_matrix((every.shape[0] - linear.shape[0], n_dofs))
    of_equations = sp.vstack([others, linear], format="csr")
    links = Links(free, every[done.independent][:, done.pivots], done.pivots, of_equations[done.independent])
    turning, first = list[Turn](), n_own
    for body in bodies:
        count = body.unknowns
        given_rows = slice(first + model.dim, first + count)
        first += count
        if count > 1 and body.whole:
            by_free, given = done.free[given_rows] * (1.0 / body.size), done.prescribed[given_rows] / body.size
            turning.append(about(body.nodes, body.points, body.centre, by_free, given, small=True))
    return (free @ done.free).tocsr(), prescribed + free @ done.prescribed, links, turning


def equations(model: Model) -> tuple[Sparse, NDArray[np.float64]]:
    """Coefficients (n_equations, dim n_points) sparse and values (n_equations, n_histories) of a model's equations."""
    histories, dim = model.histories, model.dim
    values = np.zeros((len(model.equations), len(histories)))
    entries: list[tuple[int, int, float]] = []
    for i, equation in enumerate(model.equations):
        values[i, histories.index(equation.amplitude)] = equation.value
        for term in equation.terms:
            node = int(model.mesh.node_sets[term.on][0]) if isinstance(term.on, str) else int(term.on)
            entries.append((i, int(dofs_at(node, dim)["xyz".index(term.component)]), term.coefficient))
    row, column, coefficient = np.array(entries, dtype=float).reshape(-1, 3).T
    shape = (len(model.equations), model.mesh.points.size)
    return sp.csr_matrix((coefficient, (row.astype(np.int64), column.astype(np.int64))), shape=shape), values


def _without_rounding(rows: Sparse, size: NDArray[np.float64]) -> Sparse:
    """Without entries that are nothing beside the size of their row before supports were put in."""
    entries = rows.tocoo()
    keep = np.abs(entries.data) > CANCELLED * size[entries.row]
    return sp.csr_matrix((entries.data[keep], (entries.row[keep], entries.col[keep])), shape=rows.shape)


def _turned(model: Model, n_free: int) -> list[Turn]:
    """The turns of ``Model.rotations``."""
    turns = []
    for rotation in model.rotations:
        nodes = rotation.nodes(model.mesh)
        vector = np.array([rotation.angle]) if model.dim == 2 else rotation.angle * np.array(rotation.direction)
        given = np.multiply.outer(vector, np.eye(len(model.histories))[model.histories.index(rotation.amplitude)])
        none = sp.csr_matrix((len(vector), n_free))
        turns.append(about(nodes, model.mesh.points[nodes], np.array(rotation.centre), none, given, small=False))
    return turns


def _name(model: Model, origin: int) -> str:
    named = [*(support.on for support in model.supports), *(rotation.on for rotation in model.rotations)]
    return "the axis" if origin == AXIS else f"support on '{named[origin]}'"


def _node_by_node(
    model: Model, conditions: tuple[Array, ...], bodies: Sequence[RigidBody]
) -> tuple[Sparse, NDArray[np.float64]]:
    """Supports at the points that belong to no rigid body: columns left free, and prescribed displacements."""
    mesh, dim = model.mesh, model.dim
    node, direction, value, origin = conditions
    prescribed = np.zeros((len(mesh.points), dim, value.shape[1]))
    slack = max(AGREEING * np.abs(value).max(initial=0.0), 1e-39)
    order = np.lexsort((np.abs(direction).argmax(axis=1), node))
    node, direction, value, origin = node[order], direction[order], value[order], origin[order]
    plain = _plain(node, direction)
    picked = np.ones((len(mesh.points), dim), dtype=bool)
    axis = np.abs(direction[plain]).argmax(axis=1)
    picked[node[plain], axis] = False
    prescribed[node[plain], axis] = value[plain] * direction[plain, axis][:, None]
    node, direction, value, origin = node[~plain], direction[~plain], value[~plain], origin[~plain]
    picked[np.concatenate([node, *(body.nodes for body in bodies)])] = False
    rows = np.flatnonzero(picked)
    free_rows, free_columns, free_values = [rows], [np.arange(len(rows))], [np.ones(len(rows))]
    column = len(rows)
    nodes_of, start = np.unique(node, return_index=True)
    for k, first, last in zip(nodes_of, start, np.append(start[1:], len(node))):
        matrix, target = direction[first:last], value[first:last]
        basis, x = _solve_node(matrix, target)
        if np.abs(matrix @ x - target).max() > max(slack, 1e-9 * np.abs(target).max()):
            names = [_name(model, i) for i in np.unique(origin[first:last])]
            raise contradiction_at_node(names, f"at node {k} (at {mesh.points[k].tolist()})")
        prescribed[k] = x
        count = basis.shape[1]
        free_rows.append(np.tile(dofs_at(k, dim), count))
        free_columns.append(np.repeat(column + np.arange(count), dim))
        free_values.append(basis.T.ravel())
        column += count
    rows, columns = np.concatenate(free_rows), np.concatenate(free_columns)
    point = np.empty(column, dtype=np.int64)
    point[columns] = place_of(rows, dim)
    place = np.empty(column, dtype=np.int64)
    place[np.argsort(point, kind="stable")] = np.arange(column)  # columns in the order of the points
    shape = n_dofs(len(mesh.points), dim), column
    free = sp.csr_matrix((np.concatenate(free_values), (rows, place[columns])), shape=shape)
    free.eliminate_zeros()
    return free, prescribed.reshape(free.shape[0], -1)


def _plain(node: NDArray[np.int64], direction: NDArray[np.float64]) -> NDArray[np.bool_]:
    """Conditions, sorted by node and axis, of nodes that are held along axes only, and once along each: nothing to solve."""
    axis = np.abs(direction).argmax(axis=1)
    twice = np.zeros(len(node), dtype=bool)
    twice[1:] = (node[1:] == node[:-1]) & (axis[1:] == axis[:-1])
    odd = twice | ~(np.abs(direction) == np.eye(direction.shape[1])[axis]).all(axis=1)
    return ~np.isin(node, node[odd])


def _solve_node(matrix: NDArray[np.float64], target: NDArray[np.float64]) -> tuple[Array, Array]:
    """Basis (dim, n_free) of the directions left free, and the displacement of the held ones (dim, n_histories)."""
    axis = np.abs(matrix).argmax(axis=1)
    if np.array_equal(np.abs(matrix), np.eye(matrix.shape[1])[axis]):  # along the axes: keep zeros and ones exact
        x = np.zeros((matrix.shape[1], target.shape[1]))
        x[axis] = target * matrix[np.arange(len(axis)), axis][:, None]
        return np.delete(np.eye(matrix.shape[1]), np.unique(axis), axis=1), x
    _, singular, vt = np.linalg.svd(matrix)
    rank = int((singular > SAME_DIRECTION * singular[0]).sum())
    return vt[rank:].T, np.linalg.lstsq(matrix, target, rcond=SAME_DIRECTION)[0]


def _conditions(model: Model) -> tuple[Array, ...]:
    """Every held direction: node, unit vector, value by history (n, n_histories), number of its support."""
    dim, histories = model.dim, model.histories
    nodes: list[Array] = [np.empty(0, np.int64)]
    directions: list[Array] = [np.empty((0, dim))]
    values: list[Array] = [np.empty((0, len(histories)))]
    origins: list[Array] = [np.empty(0, np.int64)]
    for i, support in enumerate(model.supports):
        for where, vector, value in _directions(model.mesh, support, dim):
            nodes.append(where)
            directions.append(np.broadcast_to(vector, (len(where), dim)))
            values.append(np.multiply.outer(value, np.eye(len(histories))[histories.index(support.amplitude)]))
            origins.append(np.full(len(where), i))
    for i, rotation in enumerate(model.rotations):
        where = rotation.nodes(model.mesh)
        for axis in np.eye(dim):
            nodes.append(where)
            directions.append(np.broadcast_to(axis, (len(where), dim)))
            values.append(np.zeros((len(where), len(histories))))
            origins.append(np.full(len(where), len(model.supports) + i))
    on_axis = points_on_axis(model.mesh)
    if len(on_axis):
        nodes.append(on_axis)
        directions.append(np.broadcast_to(np.eye(dim)[0], (len(on_axis), dim)))
        values.append(np.zeros((len(on_axis), len(histories))))
        origins.append(np.full(len(on_axis), AXIS))
    return tuple(np.concatenate(parts) for parts in (nodes, directions, values, origins))


def points_on_axis(mesh: Mesh) -> NDArray[np.int64]:
    """Points of an axisymmetric mesh that cannot leave the axis."""
    if not mesh.axisymmetric:
        return np.empty(0, np.int64)
    return np.flatnonzero(mesh.points[:, 0] <= ON_AXIS * np.ptp(mesh.points, axis=0).max())


def _directions(mesh: Mesh, support: Support, dim: int) -> list[tuple[Array, ...]]:
    """Nodes (n,), unit vectors (n, dim) or (dim,), values (n,)."""
    if support.normal is None:
        where = mesh.nodes_of(support.on)
        along = support.directions(mesh.points[where])
        return [
            (where, along[:, a], evaluate(value, mesh.points[where], f"support on '{support.on}': {name}"))
            for a, name in enumerate("xyz"[:dim])
            if (value := getattr(support, name)) is not None
        ]
    surface = mesh.surface(support.on)
    normals = nodal_normals(surface)
    facet, local = np.nonzero(surface.nodes >= 0)
    where = surface.nodes[facet, local].astype(np.int64)
    both = np.round(np.column_stack([where, normals[facet, local]]), 9)
    _, first = np.unique(both, axis=0, return_index=True)  # one condition for each normal at a node
    return [(where[first], normals[facet, local][first], np.full(len(first), float(support.normal)))]

"""Rigid bodies and couplings: points that follow a few unknowns, translation and small rotations about the centre, or whose
mean motion these are; theory (F12), (F13)."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
import scipy.sparse as sp
from numpy.typing import NDArray

from abut.bodies.mean_turn import mean_turn
from abut.bodies.rigid_modes import motions
from abut.dofs import dofs_at, n_dofs
from abut.errors import InputError
from abut.mesh.mesh import Mesh
from abut.model import Coupling, Model
from abut.model.conditions import COMPONENTS, TURNS, History, Rigid
from abut.model.coupling import symmetric
from abut.types import Array, Sparse

LOOSE = 1e-12  # square of what a unit unknown moves points by, over the largest, that counts as nothing
SLIGHT = 1e-6  # of loads: what rounding may lose


@dataclass(frozen=True)
class RigidBody:
    """nodes: (n,) of the body or coupling; reference, centre: (dim,); size: largest distance of a node from the centre;
    weights: (n,) of the nodes in their mean, sum 1; follow: (dim,) components in which they follow, along ``frames``
    (n, dim, dim) if there are any. The unknowns q are translations of the centre and turns times ``size``, so that none
    moves a point by more than its value."""

    rigid: Rigid | Coupling
    nodes: NDArray[np.int64]
    points: NDArray[np.float64]
    reference: NDArray[np.float64]
    centre: NDArray[np.float64]
    size: float
    axisymmetric: bool
    weights: NDArray[np.float64]
    follow: NDArray[np.bool_]
    frames: NDArray[np.float64] | None = None

    @property
    def name(self) -> str:
        """Of the body or coupling."""
        return self.rigid.name

    @property
    def words(self) -> str:
        """What it is and its name."""
        return f"{'coupling' if isinstance(self.rigid, Coupling) else 'rigid body'} '{self.name}'"

    @property
    def mean(self) -> bool:
        """Whether the points move freely, and the unknowns are their mean motion."""
        return isinstance(self.rigid, Coupling) and self.rigid.distributing

    @property
    def whole(self) -> bool:
        """Whether the points follow in all displacements."""
        return not self.mean and bool(self.follow.all())

    @property
    def holds(self) -> bool:
        """Whether forces hold the points together."""
        return not self.mean or any(getattr(self.rigid, name) is not None for name in self.components)

    @property
    def unknowns(self) -> int:
        """How many unknowns there are: none where the mean motion follows from the points."""
        return 0 if self.mean else len(self.components)

    @property
    def components(self) -> tuple[str, ...]:
        """Names of the unknowns."""
        if self.axisymmetric:
            return ("y",)
        return ("x", "y", "rz") if self.points.shape[1] == 2 else ("x", "y", "z", "rx", "ry", "rz")

    def moved(self, points: NDArray[np.float64]) -> NDArray[np.float64]:
        """Displacement of points (n, dim) by the unknowns, (n, dim, n_unknowns)."""
        return motions((points - self.centre) / self.size, self.axisymmetric)

    def along(self, values: NDArray[np.float64]) -> NDArray[np.float64]:
        """Components of vectors at the points, (n, dim, m), in which these follow: (n, n_followed, m)."""
        return np.asarray((values if self.frames is None else self.frames @ values)[:, self.follow])

    def followed(self, values: NDArray[np.float64]) -> NDArray[np.float64]:
        """The part of vectors at the points, (n, dim, m), that they follow: as large."""
        if self.frames is None:
            return values * self.follow[:, None]
        return np.asarray(self.frames[:, self.follow].transpose(0, 2, 1) @ self.along(values))

    def held(self, forces: NDArray[np.float64]) -> NDArray[np.float64]:
        """Of forces at all points, (n_points, dim), what the reference takes."""
        result = np.zeros_like(forces)
        if self.holds:
            result[self.nodes] = self.followed(forces[self.nodes][:, :, None])[:, :, 0]
        return result

    @property
    def mirrors(self) -> tuple[str, ...]:
        """Normals of the planes of symmetry of which the points are one side."""
        return (self.rigid.mirrors or ()) if isinstance(self.rigid, Coupling) else ()

    def _left(self, components: Sequence[str]) -> NDArray[np.bool_]:
        """Which components of a motion, force or moment the planes of symmetry leave."""
        return np.isin(components, symmetric(self.mirrors, components))

    def columns(self, size: int) -> Sparse:
        """Displacement of all points of the mesh by the unknowns, (dim n_points, n_unknowns) sparse; none where points
        follow by equations."""
        if not self.whole:
            return sp.csr_matrix((size, self.unknowns))
        values = self.moved(self.points)
        dim, count = values.shape[1:]
        rows = np.repeat(dofs_at(self.nodes, dim), count)
        columns = np.tile(np.arange(count), n_dofs(len(self.nodes), dim))
        matrix = sp.csr_matrix((values.ravel(), (rows, columns)), shape=(size, count))
        matrix.eliminate_zeros()
        return matrix

    def prescribed(self, histories: Sequence[History]) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
        """Rows (m, n_unknowns) and values (m, n_histories) of the components that are given, at the reference."""
        shift = self.moved(self.reference[None])[0]
        rows, values, columns = [np.zeros((0, len(self.components)))], [], []
        for k, name in enumerate(self.components):
            value = getattr(self.rigid, name)
            if value is None:
                continue
            columns.append(histories.index(self.rigid.history(name)))
            if name.startswith("r"):
                rows.append(np.eye(len(self.components))[k : k + 1])
                values.append(value * self.size)
            else:
                rows.append(shift["xyz".index(name)][None])
                values.append(value)
        given = np.zeros((len(values), len(histories)))
        given[np.arange(len(values)), columns] = values
        return np.concatenate(rows), given

    def loose(self, given: NDArray[np.float64]) -> NDArray[np.float64]:
        """Combinations (k, n_unknowns) of the unknowns that move no point and that rows ``given`` (m, n_unknowns) leave
        free: turns about the line that all points lie on, say."""
        moved = self.along(self.moved(self.points)).reshape(-1, len(self.components))
        gram = moved.T @ moved / max(len(self.points), 1) + given.T @ given
        sizes, basis = np.linalg.eigh(gram)
        return np.asarray(basis[:, sizes <= LOOSE * sizes[-1]].T)

    def spreading(self, among: NDArray[np.float64] | None = None) -> NDArray[np.float64]:
        """Forces at the points, (dim n, n_unknowns), that do the work of a unit force on each of the unknowns, or of the
        combinations ``among`` (n_unknowns, k) of them only: theory (F14); transposed, the mean motion by the displacements
        of the points."""
        moved = self.followed(self.moved(self.points))
        weighted = (self.weights[:, None, None] * moved).reshape(-1, len(self.components))
        basis = np.eye(len(self.components))[:, self._left(self.components)] if among is None else among
        inertia = basis.T @ (weighted.T @ moved.reshape(weighted.shape)) @ basis
        return np.asarray(weighted @ basis @ np.linalg.pinv(inertia, rcond=LOOSE, hermitian=True) @ basis.T)

    def spread(self, force: NDArray[np.float64], moment: NDArray[np.float64]) -> NDArray[np.float64]:
        """Forces at the points, (n, dim), that are equivalent to a force (dim,) at the reference and a moment (1,) or (3,);
        where the points do not follow all motions, equivalent in those that are not prescribed.

        Raises InputError where they do work on a motion that moves no point."""
        work = self.moved(self.reference[None])[0].T @ force
        work[len(force) :] += moment[: len(work) - len(force)] / self.size
        moved = self.followed(self.moved(self.points)).reshape(-1, len(work))
        for among in self._choices(force, moment):
            at_points = self.spreading(among) @ work
            lost = moved.T @ at_points - work if among is None else among.T @ (moved.T @ at_points - work)
            if np.abs(lost).max(initial=0.0) <= SLIGHT * np.abs(work).max(initial=0.0):
                return at_points.reshape(self.points.shape)
        raise InputError(
            f"loads on {self.words}: they act on a motion of the reference that moves none of its points; prescribe that "
            "motion, move the reference, or couple more points"
        )

    def _choices(
        self, force: NDArray[np.float64], moment: NDArray[np.float64]
    ) -> tuple[NDArray[np.float64] | None, ...]:
        """Combinations of the unknowns in which a load is to be equivalent, the first that can be; None: all. Raises
        InputError for a load across a plane of symmetry."""
        if not self.mirrors:
            return (None, self._open())
        turns = TURNS[2:] if len(force) == 2 else TURNS
        names = (*COMPONENTS[: len(force)], *turns)
        load = np.concatenate([force, moment[: len(turns)]])
        across = [name for name, value, left in zip(names, load, self._left(names), strict=True) if value and not left]
        if across:
            raise InputError(
                f"loads on {self.words}: {', '.join(across)} is not symmetric about the planes of mirrors, "
                f"{', '.join(self.mirrors)}; take it out, or model the whole"
            )
        return (np.eye(len(self.components))[:, self._left(self.components)],)

    def _open(self) -> NDArray[np.float64]:
        """Combinations (n_unknowns, k) of the unknowns that are not prescribed."""
        given = self.prescribed([self.rigid.history(name) for name in self.components])[0]
        _, sizes, basis = np.linalg.svd(given)
        return np.asarray(basis[int((sizes > SLIGHT).sum()) :].T)

    def motion(
        self, displacement: NDArray[np.float64], given: NDArray[np.float64] | None = None
    ) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
        """Translation of the reference (dim,) and turns (1,) or (3,) from the displacement of all points (n_points, dim),
        and from the prescribed components, given (m,) as ``prescribed`` has them, where the points do not say all."""
        moved = displacement[self.nodes].ravel()
        if self.whole:
            q = np.linalg.lstsq(self.moved(self.points).reshape(len(moved), -1), moved, rcond=None)[0]
        elif self.mean or given is None:
            q = self.spreading().T @ moved
        else:
            rows = self.prescribed([self.rigid.history(name) for name in self.components])[0]
            known, among = np.linalg.pinv(rows) @ given, self._open()
            q = known + self.spreading(among).T @ (moved - self.moved(self.points).reshape(len(moved), -1) @ known)
        turns = q[self.points.shape[1] :] / self.size if len(q) > 1 else np.zeros(1)
        return np.asarray(self.moved(self.reference[None])[0] @ q), np.asarray(turns)

    def turned(self, displacement: NDArray[np.float64]) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
        """As ``motion`` by a finite turn, of which the positions say at most half a turn."""
        if self.axisymmetric:
            return self.motion(displacement)
        from scipy.spatial.transform import Rotation  # slow to import

        dim = self.points.shape[1]
        middle = self.weights @ self.points
        turn = mean_turn(self.points - middle, self.points + displacement[self.nodes], self.weights)
        arm = np.zeros(3)
        arm[:dim] = self.reference - middle
        vector = Rotation.from_matrix(turn).as_rotvec()
        there = self.weights @ displacement[self.nodes] + (turn @ arm - arm)[:dim]
        return there, np.asarray(vector if dim == 3 else vector[2:])

    def resultant(
        self, forces: NDArray[np.float64], displacement: NDArray[np.float64] | None = None
    ) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
        """Force (dim,) and moment about the reference (1,) or (3,) of forces at all points (n_points, dim); displacement:
        (n_points, dim) under finite deformation, None for arms in the undeformed body."""
        at_nodes, arm = forces[self.nodes], self.points - self.reference
        if displacement is not None:
            arm = arm + displacement[self.nodes] - self.turned(displacement)[0]
        if self.axisymmetric:
            return at_nodes.sum(axis=0), np.zeros(1)
        if self.mirrors:  # the other side takes the rest
            force, moment = at_nodes.sum(axis=0), np.cross(arm, at_nodes).reshape(len(arm), -1).sum(axis=0)
            turns = TURNS[2:] if len(force) == 2 else TURNS
            return force * self._left(COMPONENTS[: len(force)]), moment * self._left(turns)
        if at_nodes.shape[1] == 2:
            return at_nodes.sum(axis=0), np.array([(arm[:, 0] * at_nodes[:, 1] - arm[:, 1] * at_nodes[:, 0]).sum()])
        return at_nodes.sum(axis=0), np.cross(arm, at_nodes).sum(axis=0)


def rigid_bodies(model: Model) -> list[RigidBody]:
    """All rigid bodies and couplings of a model."""
    return [_body(model, rigid) for rigid in model.referenced]


def nodes_of_body(mesh: Mesh, body: str) -> NDArray[np.int64]:
    """Sorted point numbers of a body, also where a surface or node set has its name."""
    return np.unique(np.concatenate([nodes.ravel() for _, nodes, _ in mesh.cells_of(body)])).astype(np.int64)


def _body(model: Model, rigid: Rigid | Coupling) -> RigidBody:
    mesh, follow, frames = model.mesh, np.ones(model.dim, bool), None
    if isinstance(rigid, Coupling):
        nodes, weights = rigid.nodes(mesh), rigid.shares(mesh)
        if rigid.follow is not None:
            follow = np.array([axis in rigid.follow for axis in "xyz"[: model.dim]])
        if rigid.axes is not None:
            frames = rigid.axes.frames(mesh.points[nodes])
    else:
        nodes = nodes_of_body(mesh, rigid.body)
        weights = np.full(len(nodes), 1.0 / len(nodes))
    points = mesh.points[nodes]
    centre = weights @ points if isinstance(rigid, Coupling) else points.mean(axis=0)
    reference = centre if rigid.reference is None else np.array(rigid.reference)
    body = RigidBody(
        rigid=rigid,
        nodes=nodes,
        points=points,
        reference=reference,
        centre=centre,
        size=float(np.linalg.norm(points - centre, axis=1).max()) or 1.0,
        axisymmetric=mesh.axisymmetric,
        weights=weights,
        follow=follow,
        frames=frames,
    )
    if model.finite and not body.mean:  # so that translations do not depend on finite turns
        return replace(body, centre=reference)
    return body


@dataclass(frozen=True)
class Rows:
    """matrix @ unknowns = values: matrix (m, n) sparse, values (m, n_histories)."""

    matrix: Sparse
    values: Array


def body_rows(
    body: RigidBody, histories: Sequence[History], free: Sparse, prescribed: Array, columns: NDArray[np.int64]
) -> Rows:
    """What is prescribed of a body, then what holds its points to it, theory (F13). free: (dim n_points, n) displacements by
    the unknowns, of which ``columns`` are the body's own; prescribed: (dim n_points, n_histories) the rest of them."""
    given, values = body.prescribed(histories)
    dim = body.points.shape[1]
    dofs = dofs_at(body.nodes, dim).ravel()
    if body.mean:
        by_points = sp.csr_matrix(given @ body.spreading().T)
        return Rows((by_points @ free[dofs]).tocsr(), values - by_points @ prescribed[dofs])
    loose = np.zeros((0, given.shape[1])) if isinstance(body.rigid, Rigid) else body.loose(given)
    shift = sp.csr_matrix(
        (np.ones(len(columns)), (np.arange(len(columns)), columns)), shape=(len(columns), free.shape[1])
    )
    matrix = sp.csr_matrix(np.concatenate([given, loose])) @ shift
    values = np.concatenate([values, np.zeros((len(loose), values.shape[1]))])
    if body.whole:
        return Rows(matrix, values)
    chosen = _chosen(body)
    moved = body.along(body.moved(body.points)).reshape(chosen.shape[0], -1)
    following = (chosen @ free[dofs] - sp.csr_matrix(moved) @ shift).tocsr()
    return Rows(sp.vstack([matrix, following], format="csr"), np.concatenate([values, -(chosen @ prescribed[dofs])]))


def _chosen(body: RigidBody) -> Sparse:
    """The components in which points follow, by the displacements of the points: (n n_followed, n dim)."""
    count, dim = body.points.shape
    rows = np.broadcast_to(np.eye(dim), (count, dim, dim)) if body.frames is None else body.frames
    chosen = sp.block_diag(list(rows[:, body.follow]), format="csr")
    chosen.eliminate_zeros()
    return sp.csr_matrix(chosen)

"""Rigid bodies: all points follow a few unknowns, translation and small rotations about the centre; theory (F12)."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
import scipy.sparse as sp
from numpy.typing import NDArray

from abut.mesh.mesh import Mesh
from abut.model import Model
from abut.model.conditions import History, Rigid
from abut.problem.rigid_modes import motions
from abut.types import Sparse


@dataclass(frozen=True)
class RigidBody:
    """nodes: (n,) of the body; reference, centre: (dim,); size: largest distance of a node from the centre. The unknowns q
    are translations of the centre and turns times ``size``, so that none moves a point by more than its value."""

    rigid: Rigid
    nodes: NDArray[np.int64]
    points: NDArray[np.float64]
    reference: NDArray[np.float64]
    centre: NDArray[np.float64]
    size: float
    axisymmetric: bool

    @property
    def components(self) -> tuple[str, ...]:
        """Names of the unknowns."""
        if self.axisymmetric:
            return ("y",)
        return ("x", "y", "rz") if self.points.shape[1] == 2 else ("x", "y", "z", "rx", "ry", "rz")

    def moved(self, points: NDArray[np.float64]) -> NDArray[np.float64]:
        """Displacement of points (n, dim) by the unknowns, (n, dim, n_unknowns)."""
        return motions((points - self.centre) / self.size, self.axisymmetric)

    def columns(self, n_dofs: int) -> Sparse:
        """Displacement of all points of the mesh by the unknowns, (dim n_points, n_unknowns) sparse."""
        values = self.moved(self.points)
        dim, count = values.shape[1:]
        rows = np.repeat(dim * self.nodes[:, None] + np.arange(dim), count)
        columns = np.tile(np.arange(count), dim * len(self.nodes))
        matrix = sp.csr_matrix((values.ravel(), (rows, columns)), shape=(n_dofs, count))
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

    def motion(self, displacement: NDArray[np.float64]) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
        """Translation of the reference (dim,) and turns (1,) or (3,) from the displacement of all points (n_points, dim)."""
        matrix = self.moved(self.points).reshape(-1, len(self.components))
        q = np.linalg.lstsq(matrix, displacement[self.nodes].ravel(), rcond=None)[0]
        turns = q[self.points.shape[1] :] / self.size if len(q) > 1 else np.zeros(1)
        return np.asarray(self.moved(self.reference[None])[0] @ q), np.asarray(turns)

    def turned(self, displacement: NDArray[np.float64]) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
        """As ``motion`` by a finite turn, whose rotation vector is at most half a turn long."""
        if self.axisymmetric:
            return self.motion(displacement)
        from scipy.spatial.transform import Rotation  # slow to import

        dim = self.points.shape[1]
        before, moved = np.zeros((2, len(self.nodes), 3))
        before[:, :dim] = self.points - self.points.mean(axis=0)
        moved[:, :dim] = self.points + displacement[self.nodes]
        middle = moved.mean(axis=0)
        turn = Rotation.align_vectors(moved - middle, before)[0]
        arm = np.zeros(3)
        arm[:dim] = self.reference - self.points.mean(axis=0)
        vector = turn.as_rotvec()
        there = (middle + turn.apply(arm))[:dim] - self.reference
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
        if at_nodes.shape[1] == 2:
            return at_nodes.sum(axis=0), np.array([(arm[:, 0] * at_nodes[:, 1] - arm[:, 1] * at_nodes[:, 0]).sum()])
        return at_nodes.sum(axis=0), np.cross(arm, at_nodes).sum(axis=0)


def rigid_bodies(model: Model) -> list[RigidBody]:
    """All rigid bodies of a model."""
    return [_body(model, rigid) for rigid in model.rigid]


def nodes_of_body(mesh: Mesh, body: str) -> NDArray[np.int64]:
    """Sorted point numbers of a body, also where a surface or node set has its name."""
    return np.unique(np.concatenate([nodes.ravel() for _, nodes, _ in mesh.cells_of(body)])).astype(np.int64)


def _body(model: Model, rigid: Rigid) -> RigidBody:
    nodes = nodes_of_body(model.mesh, rigid.body)
    points = model.mesh.points[nodes]
    centre = points.mean(axis=0)
    if model.finite and rigid.reference is not None:
        centre = np.array(rigid.reference)  # so that translations do not depend on finite turns
    return RigidBody(
        rigid=rigid,
        nodes=nodes,
        points=points,
        reference=centre if rigid.reference is None else np.array(rigid.reference),
        centre=centre,
        size=float(np.linalg.norm(points - centre, axis=1).max()),
        axisymmetric=model.mesh.axisymmetric,
    )

"""Springs as a term of the balance of forces; theory (F16)."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
import scipy.sparse as sp

from abut.bodies.loads import facet_points
from abut.errors import InputError
from abut.mesh.surface import Surface
from abut.model import Model
from abut.model.spring import Spring, Table
from abut.problem.terms import MatrixTangent, Motion, Share, Tangent
from abut.types import Array, Sparse

ONE = 1e-12  # distance of both ends of a spring, over the model's size, that gives no direction


@dataclass(frozen=True)
class SpringRows:
    """Springs of one law, side by side. rows: (n, dim n_points) displacements by those of the points; share: (n,) of the
    law that each has; law: a stiffness or a table; turning: of springs that turn with their ends the way (n, dim) from
    one end to the other at rest, and what ends move apart by, (dim n, dim n_points) times displacements."""

    spring: Spring
    rows: Sparse
    share: Array
    law: float | Table
    turning: tuple[Array, Sparse] | None = None

    def forces(self, moved: Array) -> tuple[Array, Array]:
        """Of all n springs, against displacements (n,), and their slopes."""
        if isinstance(self.law, float):
            return self.share * self.law * moved, self.share * self.law
        u, f = np.array(self.law).T
        slopes = np.diff(f) / np.diff(u)
        piece = np.clip(np.searchsorted(u, moved, side="right") - 1, 0, len(slopes) - 1)
        return self.share * (f[piece] + slopes[piece] * (moved - u[piece])), self.share * slopes[piece]

    def lengthening(self, displacement: Array) -> Array:
        """What each of n springs is moved by, (n,), at displacements (dim n_points,)."""
        if self.turning is None:
            return np.asarray(self.rows @ displacement)
        return self._turned(*self.turning, displacement)[1] - np.linalg.norm(self.turning[0], axis=1)

    def nodal(self, force: Array, displacement: Array) -> Array:
        """Forces (dim n_points,) that hold displacements (dim n_points,) against those of springs, (n,)."""
        if self.turning is None:
            return np.asarray(self.rows.T @ force)
        along = self._turned(*self.turning, displacement)[0]
        return np.asarray(self.turning[1].T @ (force[:, None] * along).ravel())

    def pull(self, displacement: Array) -> Array:
        """Forces (dim n_points,) that hold displacements (dim n_points,)."""
        return self.nodal(self.forces(self.lengthening(displacement))[0], displacement)

    def stiffness(self, force: Array, slope: Array, displacement: Array) -> Sparse:
        """Derivative (dim n_points, dim n_points) of the forces of springs, (n,), of which each changes by a slope, (n,):
        of a spring that turns k d d^T + (f / l) (1 - d d^T)."""
        if self.turning is None:
            return self.rows.T @ sp.diags(slope) @ self.rows
        along, length = self._turned(*self.turning, displacement)
        both = along[:, :, None] * along[:, None, :]
        across = np.eye(along.shape[1]) - both
        blocks = slope[:, None, None] * both + (force / length)[:, None, None] * across
        n = len(blocks)
        apart = self.turning[1]
        return apart.T @ sp.bsr_matrix((blocks, np.arange(n), np.arange(n + 1))) @ apart

    def resistance(self, motions: Array) -> Array:
        """Gram matrix of motions (dim n_points, m) by what springs take of them, of the size of one."""
        moved, share = self.rows @ motions, np.abs(self.share) / np.abs(self.share).sum()
        return np.asarray(moved.T @ (share[:, None] * moved))

    def _turned(self, rest: Array, apart: Sparse, displacement: Array) -> tuple[Array, Array]:
        """Of n springs that turn: directions (n, dim) and lengths (n,)."""
        reach, size = rest + (apart @ displacement).reshape(rest.shape), np.linalg.norm(rest, axis=1)
        length = np.maximum(np.linalg.norm(reach, axis=1), ONE * size)
        return reach / length[:, None], length


@dataclass(frozen=True)
class Springs:
    """All springs of a model, without its dashpots; ``constant`` where they are linear."""

    model: Model
    parts: Sequence[SpringRows]
    constant: bool
    name: str = "springs"

    @classmethod
    def of(cls, model: Model) -> Springs | None:
        """None where there are none. Raises InputError for springs between points that coincide."""
        parts = [part for spring in model.springs if not spring.dashpot for part in parts_of(model, spring)]
        if not parts:
            return None
        return cls(model, parts, all(isinstance(part.law, float) and part.turning is None for part in parts))

    def evaluate(self, before: Motion, now: Motion) -> Share:
        """Force, tangent and history at a state, as in ``Term``."""
        total = np.zeros(len(now.displacement))
        for part in self.parts:
            total += part.pull(now.displacement)
        return Share(total, self.tangent(now.displacement))

    def tangent(self, displacement: Array) -> Tangent:
        """At displacements (dim n_points,)."""
        slope = sp.csr_matrix((len(displacement),) * 2)
        for part in self.parts:
            slope = slope + part.stiffness(*part.forces(part.lengthening(displacement)), displacement)
        return MatrixTangent(slope.tocsr())

    def resistance(self, motions: Array) -> Array:
        """Gram matrix of motions (dim n_points, m) by what springs take of them, of the size of one."""
        return np.asarray(sum(part.resistance(motions) for part in self.parts))

    def force_on(self, displacement: Array) -> dict[str, Array]:
        """By spring the nodal forces (n_points, dim) on what it is on."""
        found: dict[str, Array] = {}
        for part in self.parts:
            nodal = -part.pull(displacement).reshape(-1, self.model.dim)
            found[part.spring.name] = found.get(part.spring.name, np.zeros_like(nodal)) + nodal
        return found


def parts_of(model: Model, spring: Spring) -> list[SpringRows]:
    """Of each law of a spring. Raises InputError for springs between points that coincide."""
    mesh, dim = model.mesh, model.dim
    result = []
    for key, law in spring.laws.items():
        if spring.on in mesh.surfaces and not spring.to:
            surface = mesh.surface(spring.on)
            shapes, area, normals = _at_points(surface)
            directions = normals if key == "normal" else np.broadcast_to(np.eye(dim)["xyz".index(key)], normals.shape)
            share = area if spring.per_area else area / area.sum()
        else:
            nodes = mesh.nodes_of(spring.on)
            shapes = _picks(nodes, len(mesh.points))
            share = np.full(len(nodes), 1.0 / len(nodes))
            directions = np.zeros((len(nodes), dim))
            if spring.to:
                others = mesh.nodes_of(spring.to)
                shapes = _picks(others, len(mesh.points)) - shapes
            elif spring.point is not None:
                shapes = -shapes
            directions = _line(model, spring) if key == "along" else directions + np.eye(dim)["xyz".index(key)]
        rows = sum(sp.kron(sp.diags(directions[:, a]) @ shapes, np.eye(dim)[[a]], format="csr") for a in range(dim))
        turning = key == "along" and model.finite
        moving = (_reach(model, spring), sp.kron(shapes, np.eye(dim), format="csr")) if turning else None
        result.append(SpringRows(spring, rows.tocsr(), share, law, moving))
    return result


def _picks(nodes: Array, count: int) -> Sparse:
    return sp.csr_matrix((np.ones(len(nodes)), (np.arange(len(nodes)), nodes)), shape=(len(nodes), count))


def _reach(model: Model, spring: Spring) -> Array:
    """(n, dim) from where a spring is on to its other end."""
    mesh = model.mesh
    far = mesh.points[mesh.nodes_of(spring.to)] if spring.to else np.array(spring.point)
    return np.asarray(far - mesh.points[mesh.nodes_of(spring.on)])


def _line(model: Model, spring: Spring) -> Array:
    mesh, away = model.mesh, _reach(model, spring)
    length = np.linalg.norm(away, axis=1)
    if (length <= ONE * np.ptp(mesh.points, axis=0).max()).any():
        raise InputError(f"spring '{spring.name}': along: both ends are at one point; give x, y or z")
    return np.asarray(away / length[:, None])


def _at_points(surface: Surface) -> tuple[Sparse, Array, Array]:
    """At the n integration points of a surface: shape functions (n, n_points), areas (n,), unit normals (n, dim)."""
    shapes, areas, normals = [], [], []
    for nodes, values, weights, normal, at in facet_points(surface):
        size = np.linalg.norm(normal, axis=2)
        n = size.size
        column = np.repeat(nodes[:, None, :], len(weights), axis=1).reshape(n, -1)
        value = np.broadcast_to(values, (len(nodes), *values.shape)).reshape(n, -1)
        row = np.repeat(np.arange(n), nodes.shape[1])
        shapes.append(sp.csr_matrix((value.ravel(), (row, column.ravel())), shape=(n, len(surface.points))))
        areas.append((weights * size * surface.around(at)).ravel())
        normals.append((normal / size[..., None]).reshape(n, -1))
    return sp.vstack(shapes, format="csr"), np.concatenate(areas), np.concatenate(normals)

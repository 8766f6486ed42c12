"""Internal unknowns of cells as a field beside displacements: incompatible modes, all that they take, outside of abut."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
import scipy.sparse as sp

from abut import LinearElastic, Model
from abut._core import shape_functions
from abut.cells import CELLS
from abut.dofs import DISPLACEMENT, Dofs, Field
from abut.mesh.integrals import gradients
from abut.mesh.mesh import Mesh
from abut.mesh.quadrature import stiffness_rule
from abut.model.conditions import History
from abut.model.physics import Held
from abut.problem.terms import MatrixTangent, Motion, Share
from abut.types import Array

MODES = "modes"


@dataclass(frozen=True)
class IncompatibleModes:
    """Wilson's modes 1 - xi^2 and 1 - eta^2 in both directions in every cell of a mesh of quad4, one material, plane stress,
    their gradients by the Jacobian at the middle (Taylor, Beresford, Wilson 1976): four unknowns a cell, which no other cell
    shares. To be used with bodies under full integration."""

    material: LinearElastic

    @property
    def amplitudes(self) -> Sequence[History]:
        return []

    def fields(self, mesh: Mesh) -> Sequence[Field]:
        return [Field(MODES, sum(len(block.nodes) for block in mesh.blocks), 4, "cells")]

    def held(self, model: Model, dofs: Dofs) -> Sequence[Held]:
        return []

    def terms(self, model: Model, dofs: Dofs) -> Sequence[ModesTerm]:
        (block,) = model.mesh.blocks
        xi, weights = stiffness_rule("quad4")
        (at_points, det), (middle, det_0) = (
            gradients(model.mesh.points, block.nodes, shape_functions(CELLS["quad4"].code, np.ascontiguousarray(x))[1])
            for x in (xi, np.zeros((1, 2)))
        )
        corners = np.array([[-1.0, -1.0], [1.0, -1.0], [1.0, 1.0], [-1.0, 1.0]])
        # Linear functions reproduce xi and eta, so that these matrices have their gradients at the middle.
        of_reference = np.einsum("ia,cqib->cab", corners, middle)
        slopes = -2.0 * np.einsum("qm,cmb,cq->cqmb", xi, of_reference, det_0 / det)
        stress = _plane_stress(self.material)
        own, modes = _strains(at_points), _strains(slopes)
        volume = weights * det
        across = np.einsum("cq,cqrk,rs,cqsm->ckm", volume, own, stress, modes)
        along = np.einsum("cq,cqrk,rs,cqsm->ckm", volume, modes, stress, modes)
        moved = dofs.of(DISPLACEMENT, block.nodes).reshape(len(block.nodes), -1)
        inside = dofs.of(MODES).reshape(len(block.nodes), -1)
        entries = [_entries(moved, inside, across), _entries(inside, moved, np.swapaxes(across, 1, 2))]
        entries.append(_entries(inside, inside, along))
        row, column, value = (np.concatenate(parts) for parts in zip(*entries))
        return [ModesTerm(sp.csr_matrix((value, (row, column)), shape=(dofs.size, dofs.size)))]


@dataclass(frozen=True)
class ModesTerm:
    """What modes and displacements do to each other; matrix: (n_values, n_values)."""

    matrix: sp.csr_matrix
    name: str = "modes"
    constant: bool = True

    def evaluate(self, before: Motion, now: Motion) -> Share:
        values = np.concatenate([now.displacement, now.fields[MODES].ravel()])
        return Share(np.asarray(self.matrix @ values), MatrixTangent(self.matrix))


def _plane_stress(material: LinearElastic) -> Array:
    young, nu = material.young, material.poisson
    return young / (1.0 - nu**2) * np.array([[1.0, nu, 0.0], [nu, 1.0, 0.0], [0.0, 0.0, 0.5 * (1.0 - nu)]])


def _strains(gradient: Array) -> Array:
    """xx, yy, doubled xy by both components of each function: (cells, q, 3, 2 n) of gradients (cells, q, n, 2)."""
    none = np.zeros_like(gradient[..., 0])
    x, y = gradient[..., 0], gradient[..., 1]
    rows = [np.stack([x, none], -1), np.stack([none, y], -1), np.stack([y, x], -1)]
    return np.stack([row.reshape(*row.shape[:2], -1) for row in rows], axis=2)


def _entries(rows: Array, columns: Array, values: Array) -> tuple[Array, Array, Array]:
    shape = values.shape
    return (
        np.broadcast_to(rows[:, :, None], shape).ravel(),
        np.broadcast_to(columns[:, None], shape).ravel(),
        values.ravel(),
    )

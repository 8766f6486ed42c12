"""Conduction of heat as a field beside displacements: all that it takes, outside of abut."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
import scipy.sparse as sp

from abut import Model
from abut._core import shape_functions
from abut.bodies.assemble import internal_force
from abut.bodies.loads import pressure_load
from abut.bodies.solids import TemperatureChange
from abut.cells import CELLS
from abut.dofs import DISPLACEMENT, Dofs, Field
from abut.mesh.integrals import gradients
from abut.mesh.mesh import Mesh
from abut.mesh.quadrature import stiffness_rule
from abut.model.conditions import History
from abut.model.physics import TEMPERATURE, Held
from abut.problem.terms import MatrixTangent, Motion, Share
from abut.types import Array, Sparse


@dataclass(frozen=True)
class Heater:
    """Heat that flows into a straight end, per area; less by the square of the end's motion along x: none at ``stroke``."""

    on: str
    heat: float
    stroke: float = np.inf


@dataclass(frozen=True)
class Conduction:
    """Fourier's law, -k lap T = 0, with temperatures held on surfaces (changes against the reference) and heaters; coupled:
    with the derivative of bodies' forces by the temperature."""

    conductivity: float
    surfaces: tuple[tuple[str, float, History], ...] = ()
    heaters: tuple[Heater, ...] = ()
    coupled: bool = True

    @property
    def amplitudes(self) -> Sequence[History]:
        return [history for _, _, history in self.surfaces]

    def fields(self, mesh: Mesh) -> Sequence[Field]:
        return [Field(TEMPERATURE, len(mesh.points))]

    def held(self, model: Model, dofs: Dofs) -> Sequence[Held]:
        every = [(dofs.of(TEMPERATURE, model.mesh.surface(on).node_ids)[:, 0], *at) for on, *at in self.surfaces]
        return [Held(at, np.full(len(at), value), history) for at, value, history in every]

    def terms(self, model: Model, dofs: Dofs) -> Sequence[ConductionTerm]:
        return [ConductionTerm(self.conductivity, self.heaters, model, dofs, self.coupled)]


@dataclass(frozen=True)
class ConductionTerm:
    """Heat that flows out of every node, less what heaters put in."""

    conductivity: float
    heaters: Sequence[Heater]
    model: Model
    dofs: Dofs
    coupled: bool
    name: str = "conduction"
    constant: bool = True

    def evaluate(self, before: Motion, now: Motion) -> Share:
        size, at = self.dofs.size, self.dofs.of(TEMPERATURE)[:, 0]
        place = sp.csr_matrix((np.ones(len(at)), (np.arange(len(at)), at)), shape=(len(at), size))
        conductance = self.conductivity * _laplacian(self.model.mesh)
        force = place.T @ (conductance @ now.fields[TEMPERATURE][:, 0])
        tangent = place.T @ conductance @ place
        for heater in self.heaters:
            nodes, shares = _lumped(self.model.mesh, heater.on)
            heated, moved = self.dofs.of(TEMPERATURE, nodes)[:, 0], self.dofs.of(DISPLACEMENT, nodes)[:, 0]
            share = now.displacement[moved] / heater.stroke
            force[heated] -= heater.heat * shares * (1.0 - share**2)
            slope = 2.0 * heater.heat * shares * share / heater.stroke
            tangent = tangent + sp.csr_matrix((slope, (heated, moved)), shape=(size, size))
        if self.coupled:
            tangent = tangent + _expanding(self.model) @ place
        return Share(force, MatrixTangent(tangent.tocsr()), symmetric=False)


def _laplacian(mesh: Mesh) -> Sparse:
    """int grad N_i . grad N_j, (n_points, n_points)."""
    total = sp.csr_matrix((len(mesh.points),) * 2)
    for block in mesh.blocks:
        xi, weights = stiffness_rule(block.kind)
        slopes = shape_functions(CELLS[block.kind].code, np.ascontiguousarray(xi))[1]
        gradient, det = gradients(mesh.points, block.nodes, slopes)
        values = np.einsum("q,cq,cqia,cqja->cij", weights, det, gradient, gradient)
        rows, columns = (
            np.repeat(block.nodes, block.nodes.shape[1], axis=1),
            np.tile(block.nodes, block.nodes.shape[1]),
        )
        total = total + sp.csr_matrix((values.ravel(), (rows.ravel(), columns.ravel())), shape=total.shape)
    return total


def _lumped(mesh: Mesh, on: str) -> tuple[Array, Array]:
    """Nodes of a surface, and how much of its area each stands for."""
    surface = mesh.surface(on)
    areas = np.linalg.norm(pressure_load(surface, 1.0).reshape(mesh.points.shape), axis=1)
    return surface.node_ids, areas[surface.node_ids]


def _expanding(model: Model) -> Sparse:
    """Derivative of bodies' forces by the temperatures, over all values of displacements (first) and temperatures."""
    n = len(model.mesh.points)
    rest = np.zeros(model.mesh.points.shape)
    columns = [internal_force(model.deformable, rest, TemperatureChange({}, unit)) for unit in np.eye(n)]
    full = np.stack(columns, axis=1)
    return sp.vstack([sp.csr_matrix(full), sp.csr_matrix((n, n))], format="csr")

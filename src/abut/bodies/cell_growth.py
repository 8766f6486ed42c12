"""How cells change their volume, and how far they are strained, by the displacement of their nodes alone."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from abut._core import shape_functions
from abut.bodies.corner_pressures import linear_functions
from abut.bodies.solids import Array, Group, Solids
from abut.cells import CELLS
from abut.mesh.integrals import CHUNK, determinants, gradients
from abut.mesh.quadrature import Rule, cell_rule


@dataclass(frozen=True)
class CellGrowth:
    """Of cells, (n, k), the integrals with each of k weights that add up to one, as of ``keeping``. volume: undeformed, per
    unit thickness in 2D, all round if axisymmetric; growth: change of volume; hot: the one that temperature alone makes;
    strain: (n,) of the cell, the root of 2/3 e : e, of its mean strain e, logarithmic under finite strains; where the
    volume is kept, the equivalent strain."""

    volume: Array
    growth: Array
    hot: Array
    strain: Array


def keeping(rule: Rule, corners: bool) -> Array:
    """Weights (q, k) at the points of a rule with which the volume of cells is held in the mean: 1, or of ``corners`` the
    functions of the pressures there, theory (E8)."""
    return linear_functions(rule[0]) if corners else np.ones((len(rule[1]), 1))


def cell_growth(
    solids: Solids, group: Group, displacement: Array, corners: bool, thermal: Array | None = None
) -> CellGrowth:
    """Of a group's cells under displacements (n_points, dim), exact for what the shape functions make of them; corners:
    as in ``keeping``; thermal: strains (cells, n_nodes), as of ``TemperatureChange.strain``."""
    parts = [
        _growth(
            solids,
            replace(group, nodes=group.nodes[i : i + CHUNK], cells=group.cells[i : i + CHUNK]),
            displacement,
            corners,
            None if thermal is None else thermal[i : i + CHUNK],
        )
        for i in range(0, len(group.cells), CHUNK)
    ]
    columns = ([getattr(part, name) for part in parts] for name in ("volume", "growth", "hot", "strain"))
    return CellGrowth(*(np.concatenate(column) for column in columns))


def _growth(solids: Solids, group: Group, displacement: Array, corners: bool, thermal: Array | None) -> CellGrowth:
    rule = cell_rule(group.kind, "full")
    shapes, derivatives = shape_functions(CELLS[group.kind].code, np.ascontiguousarray(rule[0]))
    by_place, det = gradients(solids.points, group.nodes, derivatives)
    size, moved, weights = det * rule[1], displacement[group.nodes], keeping(rule, corners)
    dim, small = moved.shape[2], solids.kinematics == "small"
    slope = np.zeros((*size.shape, 3, 3))
    slope[..., :dim, :dim] = np.einsum("cna,cqnb->cqab", moved, by_place, optimize=True)
    if solids.mesh.axisymmetric:
        radius = solids.points[group.nodes, 0] @ shapes.T
        size = size * 2.0 * np.pi * radius
        slope[..., 2, 2] = (moved[..., 0] @ shapes.T) / radius
    mean = np.einsum("cq,cqab->cab", size / size.sum(axis=1, keepdims=True), slope)
    if small:
        local, strain = np.trace(slope, axis1=-2, axis2=-1), 0.5 * (mean + mean.transpose(0, 2, 1))
    else:
        local, strain = determinants(np.eye(3) + slope) - 1.0, _logarithmic(np.eye(3) + mean)
    hot = np.zeros_like(size)
    if thermal is not None:
        there = thermal @ shapes.T
        hot = 3.0 * there if small else (1.0 + there) ** 3 - 1.0
    largest = np.sqrt(2.0 / 3.0 * (strain**2).sum(axis=(1, 2)))
    return CellGrowth(size @ weights, (size * local) @ weights, (size * hot) @ weights, largest)


def _logarithmic(gradient: Array) -> Array:
    """Logarithmic strains (n, 3, 3) in the undeformed axes, of deformation gradients (n, 3, 3)."""
    squares, axes = np.linalg.eigh(gradient.transpose(0, 2, 1) @ gradient)
    logs = 0.5 * np.log(np.maximum(squares, np.finfo(float).tiny))
    return np.asarray((axes * logs[:, None, :]) @ axes.transpose(0, 2, 1))

"""The derivative of a coupling by central differences: the slow twin of ``abut.contact.coupling_tangent``."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import scipy.sparse as sp

from abut.contact.coupling import Coupling, CouplingOptions, couple
from abut.contact.coupling_tangent import CouplingTangent
from abut.contact.geometry import nodal_normals
from abut.mesh.surface import Surface
from abut.types import Array, Sparse

STEP = 1e-6  # of a difference, over the contactor's extent


def coupling_differences(
    contactor: Surface,
    target: Surface,
    degree: int,
    options: CouplingOptions,
    pressure: Array,
    traction: Array | None = None,
    only: Array | None = None,
) -> CouplingTangent:
    """As ``coupling_tangent``, without traction. Both surfaces lie over one array of points."""

    def at(points: Array) -> Coupling:
        return couple(replace(contactor, points=points), replace(target, points=points), degree, options, only)

    points = contactor.points
    here = at(points)
    nodes = np.union1d(contactor.node_ids, target.node_ids)
    step = STEP * float(np.ptp(points[nodes], axis=0).max())
    n, dim = points.shape
    gap, weight, force = (sp.lil_matrix((size, n * dim)) for size in (len(pressure), len(pressure), n * dim))
    for node in nodes:
        for a in range(dim):
            aside = np.zeros_like(points)
            aside[node, a] = step
            more, less = at(points + aside), at(points - aside)
            column = dim * node + a
            gap[:, column] = ((more.gap - less.gap) / (2.0 * step))[:, None]
            weight[:, column] = ((more.weight - less.weight) / (2.0 * step))[:, None]
            force[:, column] = ((more.operator - less.operator).T @ pressure / (2.0 * step))[:, None]
    return CouplingTangent(gap.tocsr(), weight.tocsr(), np.asarray(here.operator.T @ pressure), force.tocsr())


def normal_differences(contactor: Surface) -> Sparse:
    """As ``normal_derivative``."""
    points = contactor.points
    step = STEP * float(np.ptp(points[contactor.node_ids], axis=0).max())
    n, dim = points.shape
    result = sp.lil_matrix((9 * len(contactor) * dim, n * dim))
    for node in contactor.node_ids:
        for a in range(dim):
            aside = np.zeros_like(points)
            aside[node, a] = step
            more, less = (nodal_normals(replace(contactor, points=points + s * aside)) for s in (1.0, -1.0))
            result[:, dim * node + a] = ((more - less).ravel() / (2.0 * step))[:, None]
    return result.tocsr()

"""What each integration point of a cell stands for."""

from __future__ import annotations

import numpy as np

from abut._core import shape_functions
from abut.bodies.solids import Array, Group, Solids
from abut.cells import CELLS
from abut.mesh.integrals import gradients
from abut.mesh.quadrature import Rule


def point_volumes(solids: Solids, group: Group, rule: Rule) -> Array:
    """Undeformed, (cells, q), per unit thickness in 2D, all round if axisymmetric."""
    xi, weights = rule
    shapes, derivatives = shape_functions(CELLS[group.kind].code, np.ascontiguousarray(xi))
    _, det = gradients(solids.points, group.nodes, derivatives)
    size = det * weights
    return size * 2.0 * np.pi * (solids.points[group.nodes, 0] @ shapes.T) if solids.mesh.axisymmetric else size

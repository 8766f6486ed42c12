"""Contact of triangles and tetrahedra of first order, whose load steps are solved once more under the forces that their
straight displacements leave; theory (Z11)."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from abut.bodies.interpolation import SIMPLEX
from abut.mesh.mesh import Mesh
from abut.mesh.surface import Surface
from abut.model import Model
from abut.problem.pair import Pair

# By dimension. The second with the stresses that the first has found: it brings von Mises under a ball of triangles from 6.9
# to 3.6 %, of tetrahedra from 5.5 to 6.0 (bench/stress/table.py), for which it is too dear. A third changes .5 %.
ROUNDS = {2: 2, 3: 1}


def rounds(model: Model, pairs: Sequence[Pair]) -> int:
    """How often each step of a problem whose stiffness is constant is solved once more: contact of bodies with such cells,
    at small displacements, without friction; else 0."""
    beside = model.finite or model.physics or model.connectors or model.penetrations or model.removals
    if beside or any(pair.frictional for pair in pairs):
        return 0
    straight = any(of_simplices(model.mesh, side).any() for pair in pairs for side in (pair.contactor, pair.target))
    return ROUNDS[model.dim] if straight else 0


def of_simplices(mesh: Mesh, side: Surface) -> NDArray[np.bool_]:
    """(n_facets,) whose cells are triangles or tetrahedra of first order."""
    result = np.zeros(len(side), dtype=bool)
    for block, start, end in zip(mesh.blocks, mesh.starts, mesh.starts[1:]):
        if block.kind in SIMPLEX:
            result |= (side.cells >= start) & (side.cells < end)
    return result

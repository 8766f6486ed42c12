"""Tangents of the same bodies share their pattern."""

import numpy as np
import pytest

import abut
from abut.bodies.assemble import respond
from abut.bodies.solids import Solids
from abut.mesh.make import box, rectangle
from abut.mesh.mesh import Mesh


@pytest.mark.parametrize("mesh", [box(cells=(2, 3, 2)), rectangle(cells=(3, 2))], ids=["hex8", "quad4"])
def test_tangents_share_what_they_cannot_change(mesh: Mesh) -> None:
    """Two tangents have the same columns in memory, values of their own, and none may write to the columns."""
    plane = None if mesh.dim == 3 else "strain"
    solids = Solids(mesh, {"body": abut.NeoHooke(young=3.0, poisson=0.3)}, plane=plane, kinematics="finite")
    at_rest, moved = (respond(solids, factor * mesh.points**2).tangent for factor in (0.0, 0.1))
    assert np.shares_memory(at_rest.indices, moved.indices)
    assert not np.shares_memory(at_rest.data, moved.data)
    assert abs(at_rest - moved).max() > 0.1
    with pytest.raises(ValueError, match="read-only"):
        moved.indices[0] = 1
    assert (at_rest.has_sorted_indices, moved.has_sorted_indices) == (True, True)
    assert np.array_equal(at_rest.sorted_indices().indices, at_rest.indices)

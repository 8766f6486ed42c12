"""The normals of a contact with friction, where supports have a say."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from abut.contact.common_normals import common_normals
from abut.contact.coupling import Couple
from abut.mesh.surface import Surface
from abut.problem.constraints import Supports

NEAR = 0.95  # cosine between a normal and its part in a plane of symmetry: 18 degrees


def contact_normals(
    contactor: Surface, target: Surface, share: float, reach: float, couple: Couple, held: Supports
) -> NDArray[np.float64]:
    """As ``common_normals``; at nodes that supports hold beside them, as at a plane of symmetry, they lie in the directions
    that are left: facets on one side of the plane alone lean out of it."""
    normals = common_normals(contactor, target, share, reach, couple)
    used = contactor.nodes >= 0
    own = normals[used]
    moves = held.can_move(contactor.nodes[used].astype(np.int64), own)
    length = np.linalg.norm(moves, axis=1)
    inside = (length > NEAR) & (length < 1.0)
    own[inside] = moves[inside] / length[inside, None]
    normals[used] = own
    return normals

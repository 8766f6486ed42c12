"""The normals of a contact with friction, where supports have a say."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from abut.contact.common_normals import common_normals
from abut.contact.coupling import Couple
from abut.contact.geometry import turning_within
from abut.mesh.surface import Surface
from abut.problem.constraints import Supports

LEAN = 3.0  # of a normal out of a plane of symmetry, over the angle by which its facet turns: no more on round surfaces


def contact_normals(
    contactor: Surface, target: Surface, share: float, reach: float, couple: Couple, held: Supports
) -> NDArray[np.float64]:
    """As ``common_normals``; at nodes that supports hold beside them, as at a plane of symmetry, they lie in the directions
    that are left, where facets on one side of the plane alone lean out of it: by as much as a round surface turns."""
    normals = common_normals(contactor, target, share, reach, couple)
    used = contactor.nodes >= 0
    node, own = contactor.nodes[used].astype(np.int64), normals[used]
    moves = held.can_move(node, own)
    length = np.linalg.norm(moves, axis=1)
    lean = np.linalg.norm(own - moves, axis=1)
    turn = np.zeros(len(contactor.points))
    np.maximum.at(turn, node, turning_within(contactor, normals)[np.nonzero(used)[0]])
    leans = (lean > 0.0) & (lean <= LEAN * turn[node]) & (length > 0.5)
    own[leans] = moves[leans] / length[leans, None]
    normals[used] = own
    return normals

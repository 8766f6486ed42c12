"""Over-constraint: supports on the same nodes as contacts and ties."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from abut.contact.geometry import nodal_normals
from abut.contact.sides import words
from abut.diagnosis.finding import Finding
from abut.errors import SingularModelError
from abut.model import Model
from abut.problem.constraints import Constraints
from abut.problem.held_multipliers import HELD
from abut.problem.pair import Pair

MOST, ALL = 0.5, 1.0 - 1e-9  # share of the contactor's nodes: a symmetry plane across a contact holds fewer


def constraints(model: Model, pair: Pair, constraints: Constraints) -> list[Finding]:
    """Contacts and ties most of whose contactor nodes are constrained by supports already."""
    surface = pair.contactor
    facing = surface.nodes[pair.coupling.segments > 0]
    nodes = np.unique(facing[facing >= 0]).astype(np.int64)
    where = f"contact '{pair.contact.name}'"
    if pair.tied:
        shares = [constraints.held_share(nodes, np.tile(axis, (len(nodes), 1))) > HELD for axis in np.eye(surface.dim)]
        part = max(float(share.mean()) for share in shares)
        taken = np.any(shares, axis=0)
    else:
        taken = constraints.held_share(nodes, _normals(pair)[nodes]) > HELD
        part = float(taken.mean())
    if part <= MOST:
        return []
    names, does = _holding(model, nodes[taken]), "the tie" if pair.tied else "the contact"
    cure = f"remove {names}, or the tie" if pair.tied else f"remove {names}, or make the other side the contactor"
    return [
        Finding(
            "error" if pair.tied and part > ALL else "warning",
            where,
            f"over-constrained: {names} and {does} constrain the same nodes, {int(taken.sum())} of {len(nodes)} of "
            f"contactor {words(pair.contact.contactor)}, so that {does} acts on the target alone",
            cure,
            status=SingularModelError.exit_status,
        )
    ]


def _normals(pair: Pair) -> NDArray[np.float64]:
    """Normals at the contactor's points, (n_points, dim)."""
    normals = nodal_normals(pair.contactor)
    used = pair.contactor.nodes >= 0
    result = np.zeros_like(pair.contactor.points)
    result[pair.contactor.nodes[used]] = normals[used]
    return result


def _holding(model: Model, nodes: NDArray[np.int64]) -> str:
    """The supports that hold most of some nodes, in words."""
    names = [
        f"support on '{support.on}'"
        for support in model.supports
        if np.isin(nodes, model.mesh.nodes_of(support.on)).mean() > MOST
    ]
    names += [
        f"coupling '{coupling.name}'"
        for coupling in model.couplings
        if not coupling.distributing and np.isin(nodes, coupling.nodes(model.mesh)).mean() > MOST
    ]
    return " and ".join(dict.fromkeys(names)) or "supports"

"""The multipliers of a tie: all components of the displacement."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
import scipy.sparse as sp

from abut.contact.coupling import Coupling
from abut.contact.pressure_space import PressureSpace, reduce
from abut.mesh.surface import Surface
from abut.problem.constraints import Supports
from abut.problem.held_multipliers import HELD, NO_EFFECT, row_norms


@dataclass(frozen=True)
class TiedRows:
    """Multipliers of a tie: their space; rows: operator on all displacements, free: on the free ones."""

    space: PressureSpace
    rows: Any
    free: Any


def tied_rows(contactor: Surface, coupling: Coupling, space: PressureSpace, held: Supports) -> TiedRows:
    """All components of the displacement are tied, theory (L9). A multiplier component that supports hold at its node
    on the contactor follows its neighbour, direction by direction."""
    dim = contactor.dim
    rows, weights, spaces = [], [], []
    for a in range(dim):
        own = space
        sits = space.node >= 0
        if sits.any():
            share = np.zeros(len(space))
            direction = np.broadcast_to(np.eye(dim)[a], (int(sits.sum()), dim))
            share[sits] = held.held_share(space.node[sits], direction)
            if (share < HELD).any():
                own = reduce(space, coupling, share < HELD)
        scalar = (own.transfer.T @ coupling.operator).tocsr()
        spread = sp.csr_matrix(
            (np.ones(scalar.shape[1]), (np.arange(scalar.shape[1]), dim * np.arange(scalar.shape[1]) + a)),
            shape=(scalar.shape[1], dim * scalar.shape[1]),
        )
        component = (scalar @ spread).tocsr()
        keep = row_norms(component @ held.free) > NO_EFFECT * own.weight
        rows.append(component[keep])
        weights.append(own.weight[keep])
        spaces.append((own.transfer.tocsc()[:, keep], a))
    every = sp.vstack(rows).tocsr()
    weight = np.concatenate(weights)
    transfer = sp.hstack([t for t, _ in spaces]).tocsr()
    component_of = np.concatenate([np.full(t.shape[1], a) for t, a in spaces])
    vector_space = PressureSpace(
        space.name, space.degree, transfer, transfer, weight, component_of, component_of, space.removed
    )
    return TiedRows(vector_space, every, (every @ held.free).tocsr())

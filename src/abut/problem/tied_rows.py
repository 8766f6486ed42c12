"""The multipliers of a tie: all components of the displacement."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import scipy.sparse as sp
from numpy.typing import NDArray

from abut.contact.coupling import Coupling
from abut.contact.pressure_space import PressureSpace, only, reduce
from abut.dofs import dofs_at, n_dofs
from abut.mesh.surface import Surface
from abut.problem.constraints import Constraints
from abut.problem.held_multipliers import HELD, NO_EFFECT, row_norms
from abut.types import Sparse


@dataclass(frozen=True)
class TiedRows:
    """Multipliers of a tie, component by component. components: the space of each; index: (n_functions, dim) the multiplier
    of each function and component, -1 where there is none; rows: operator on all displacements, free: on the free ones;
    weight: (n,)."""

    components: tuple[PressureSpace, ...]
    index: NDArray[np.int64]
    rows: Sparse
    free: Sparse
    weight: NDArray[np.float64]


def tied_rows(contactor: Surface, coupling: Coupling, space: PressureSpace, constraints: Constraints) -> TiedRows:
    """All components of the displacement are tied, theory (L9). A multiplier component that supports hold at its node
    on the contactor follows its neighbour, direction by direction."""
    dim = contactor.dim
    rows, components = [], []
    index, first = np.full((len(space), dim), -1), 0
    for a in range(dim):
        free_here = _free(space, constraints, a, dim)
        free_space = reduce(space, coupling, free_here) if free_here.any() else space
        functions = np.flatnonzero(free_here) if free_here.any() else np.arange(len(space))
        scalar = (free_space.transfer.T @ coupling.operator).tocsr()
        spread = sp.csr_matrix(
            (np.ones(scalar.shape[1]), (np.arange(scalar.shape[1]), dofs_at(np.arange(scalar.shape[1]), dim)[:, a])),
            shape=(scalar.shape[1], n_dofs(scalar.shape[1], dim)),
        )
        component = (scalar @ spread).tocsr()
        keep = row_norms(component @ constraints.free) > NO_EFFECT * free_space.weight
        rows.append(component[keep])
        components.append(only(free_space, keep))
        index[functions[keep], a] = first + np.arange(int(keep.sum()))
        first += int(keep.sum())
    every = sp.vstack(rows).tocsr()
    weight = np.concatenate([free_space.weight for free_space in components])
    return TiedRows(tuple(components), index, every, (every @ constraints.free).tocsr(), weight)


def _free(space: PressureSpace, constraints: Constraints, axis: int, dim: int) -> NDArray[np.bool_]:
    """Functions (n,) whose point supports let move along an axis; those of a facet alone are taken to."""
    sits = space.node >= 0
    share = np.zeros(len(space))
    if sits.any():
        direction = np.broadcast_to(np.eye(dim)[axis], (int(sits.sum()), dim))
        share[sits] = constraints.held_share(space.node[sits], direction)
    return np.asarray(share < HELD)

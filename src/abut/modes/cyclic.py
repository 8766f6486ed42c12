"""Frequencies of a whole of alike sectors, of which one is modelled: vibrations with nodal diameters, theory (J7)."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
import scipy.sparse as sp
from numpy.typing import NDArray

from abut.bodies.mass import mass
from abut.dofs import dofs_at
from abut.errors import InputError
from abut.model import Frequencies, Model
from abut.modes.frequencies import densities, lowest
from abut.modes.held import Held
from abut.problem.constraints import Constraints, equations
from abut.problem.problem import ContactProblem
from abut.solution.modes import FREQUENCIES, ModesResult
from abut.solution.state import State
from abut.types import Sparse

Vector = NDArray[np.float64]


@dataclass(frozen=True)
class Sides:
    """Unknowns of which those of the nodes on one side of a sector are apart from the others. constraints: the change of
    variables to them; own, turned: (n, n_free) these unknowns by those of the sector alone, with whose phase the side
    moves, and with that of its neighbour."""

    constraints: Constraints
    own: Sparse
    turned: Sparse

    def state(self, state: State) -> State:
        """A state of the sector in these unknowns."""
        unknowns = np.asarray((self.own + self.turned) @ state.unknowns)
        return replace(state, unknowns=unknowns, history=replace(state.history, drag=None))

    def problem(self, problem: ContactProblem) -> ContactProblem:
        """A problem in these unknowns, without springs on motions that nothing else resists."""
        free = self.constraints.free
        pairs = [replace(pair, operator=(pair.rows @ free).tocsr()) for pair in problem.pairs]
        none = replace(
            problem.springs, motions=np.zeros((free.shape[0], 0)), columns=np.zeros(0, np.int64), stiffness=np.zeros(0)
        )
        motions = np.zeros((free.shape[1], 0))
        own = replace(problem, constraints=self.constraints, springs=none, stiffness=None, motions=motions)
        return own.with_pairs(pairs)


def sides(model: Model, constraints: Constraints, side: str) -> Sides:
    """Of the node set ``side``. Raises InputError for nodes that more than one sector's turn holds."""
    nodes = np.asarray(model.mesh.node_sets[side])
    rows = np.zeros(constraints.free.shape[0], dtype=bool)
    rows[dofs_at(nodes, model.dim).ravel()] = True
    _check(model, constraints, side, nodes, rows)
    free = constraints.free.tocsr()
    parts, chosen = [], []
    for here in (~rows, rows):
        part = (sp.diags(here.astype(float)) @ free).tocsc()
        part.eliminate_zeros()
        columns = np.flatnonzero(np.diff(part.indptr))
        parts.append(part[:, columns])
        chosen.append(columns)
    n, count = free.shape[1], len(chosen[0]) + len(chosen[1])
    maps = [
        sp.csr_matrix((np.ones(len(columns)), (first + np.arange(len(columns)), columns)), shape=(count, n))
        for first, columns in zip((0, len(chosen[0])), chosen)
    ]
    apart = replace(constraints, free=sp.hstack(parts).tocsr(), orthonormal=False, links=None)
    return Sides(apart, maps[0], maps[1])


def _check(
    model: Model, constraints: Constraints, side: str, nodes: NDArray[np.int64], rows: NDArray[np.bool_]
) -> None:
    linear = abs(equations(model)[0])
    touching, others = linear @ rows.astype(float) > 0.0, linear @ (~rows).astype(float) > 0.0
    if not (touching & others).any():
        raise InputError(
            f"frequencies: side: no equation joins nodes of '{side}' to others; write those between sectors"
        )
    if constraints.turns is not None or any(np.isin(body.nodes, nodes).any() for body in constraints.bodies):
        raise InputError(
            f"frequencies: side: rigid bodies or couplings hold nodes of '{side}' or turn by finite angles; with nodal "
            "diameters other than 0 they are not supported"
        )


def cyclic_frequencies(
    model: Model, apart: Sides, held: Held, wanted: Frequencies, diameters: Sequence[int]
) -> tuple[ModesResult, ...]:
    """For each of the nodal ``diameters`` the lowest frequencies. held: stiffness and contact in the unknowns of ``apart``.

    A vibration is the real part of exp(i omega t) x with complex x = own q + exp(i angle) turned q; real and imaginary
    parts of q are unknowns here, so that each frequency comes twice.
    Raises InputError where no body has a density, ConvergenceError, and SingularModelError."""
    reduced = apart.constraints.reduce(mass(model.mesh, densities(model)))
    return tuple(_one(model, apart, held, reduced, wanted, diameter) for diameter in diameters)


def _one(model: Model, apart: Sides, held: Held, reduced: Sparse, wanted: Frequencies, diameter: int) -> ModesResult:
    angle = 2.0 * np.pi * diameter / wanted.sectors
    real, imaginary = apart.own + np.cos(angle) * apart.turned, np.sin(angle) * apart.turned
    both = sp.bmat([[real, -imaginary], [imaginary, real]]).tocsr()  # real and imaginary parts of x by those of q
    doubled = Held(
        _hermitian(held.stiffness, both),
        (_twice(held.rows) @ both).tocsr(),
        np.tile(held.give, 2),
        True,
        held.kept,
        held.by,
    )
    found = lowest(doubled, _hermitian(reduced, both), wanted.count)
    moved = _twice(apart.constraints.free) @ (both @ found.vectors)
    shapes, others = (part.T.reshape(len(found.squares), -1, model.dim) for part in np.split(np.asarray(moved), 2))
    none = np.zeros((len(found.squares), 0))
    return ModesResult(
        FREQUENCIES, found.values, found.squares, shapes, none, none, np.zeros(0), found.residual, found.orthogonality,
        found.missing, imaginary=others, diameter=diameter,
    )  # fmt: skip


def _twice(matrix: Sparse) -> Sparse:
    return sp.block_diag([matrix, matrix], format="csr")


def _hermitian(matrix: Sparse, both: Sparse) -> Sparse:
    result = (both.T @ _twice(matrix) @ both).tocsr()
    return (0.5 * (result + result.T)).tocsr()

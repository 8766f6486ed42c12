"""Coefficients of friction up to which a discrete problem has one solution, and from which on it may have many."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
import scipy.linalg
import scipy.sparse as sp
from numpy.typing import NDArray

from abut.bodies.rigid_modes import free_motions, resistance_of_rows, rigid_modes
from abut.errors import SingularModelError
from abut.linear import direct
from abut.model import Model
from abut.problem.backend import serial
from abut.problem.constraints import Constraints
from abut.problem.pair import Pair
from abut.problem.restraint import resistance_of_supports

MOST = {2: 30_000, 3: 8_000}  # free displacements by dimension, and multipliers, up to which this costs a few seconds
MULTIPLIERS = 800
STIFF = 1e4  # of what holds ties, and gaps that stay closed, over the stiffness
DIRECTIONS = 8  # of slip in 3D, over half a turn
REAL = 1e-7  # imaginary part of an eigenvalue over its size below which it is real
REGULAR = 1e-10  # smallest over largest eigenvalue of a compliance that nothing is missing from
Array = NDArray[np.float64]


@dataclass(frozen=True)
class Uniqueness:
    """certain: below this coefficient there is one solution in each load step, whatever the loads, theory (R16), (R17); 0
    where contact alone holds a body; critical: the smallest coefficient at which there are infinitely many for some loads,
    while all contact is closed and slips one way, theory (R18); infinite where there is none."""

    certain: float
    critical: float


def uniqueness(model: Model, constraints: Constraints, pairs: Sequence[Pair]) -> Uniqueness | None:
    """For all pairs with friction together; None where the model is too large for it, has materials or contacts of other
    kinds (ties do), large sliding, a coefficient over pressure or none at all, or bodies that friction
    alone holds."""
    rubs = [pair for pair in pairs if pair.frictional]
    others = [pair for pair in pairs if not (pair.tied or _plain(pair))]
    small = constraints.free.shape[1] <= MOST[model.dim] and sum(map(len, pairs)) <= MULTIPLIERS
    if not rubs or others or not small or model.finite or not model.deformable.constant:
        return None
    rigid = rigid_modes(model.mesh)
    supports = [
        resistance_of_supports(rigid, constraints),
        *(resistance_of_rows(rigid, p.rows) for p in pairs if p.tied),
    ]
    normals = [resistance_of_rows(rigid, pair.rows[pair.normal]) for pair in rubs]
    if free_motions([*supports, *normals]).shape[1]:
        return None
    stiffness = serial(model).reduce(constraints)
    for pair in pairs:
        if pair.tied:
            stiffness = _held(stiffness, pair.operator)
    normal = sp.vstack([pair.operator[pair.normal] for pair in rubs]).tocsr()
    critical = _critical(_held(stiffness, normal), normal, _slips(rubs))
    return Uniqueness(0.0 if free_motions(supports).shape[1] else _certain(stiffness, normal, rubs), critical)


def _plain(pair: Pair) -> bool:
    """Whether there is friction, with a coefficient that does not depend on the pressure."""
    values = pair.values if pair.frictional else None
    return values is not None and values.curve is None and bool(np.isfinite(values.coefficient).all())


def _held(stiffness: sp.csr_matrix, rows: sp.csr_matrix) -> sp.csr_matrix:
    """The stiffness with springs on what rows (m, n_free) measure."""
    gram = (rows.T @ rows).tocsr()
    return (stiffness + STIFF * stiffness.diagonal().max() / max(gram.diagonal().max(), 1e-300) * gram).tocsr()


def _slips(pairs: Sequence[Pair]) -> list[sp.csr_matrix]:
    """Rows (n, n_free) of the slip along each direction, by the functions of the pressures; zero where supports hold it."""
    dim = pairs[0].contactor.dim
    angles = np.pi * np.arange(DIRECTIONS) / DIRECTIONS if dim == 3 else np.zeros(1)
    return [sp.vstack([_along(pair, angle) for pair in pairs]).tocsr() for angle in angles]


def _along(pair: Pair, angle: float) -> sp.csr_matrix:
    """Slip in one direction in space, turned by an angle about the mean normal; in 2D along the only tangent."""
    assert pair.slip is not None
    tangents = pair.slip.tangents
    if tangents.shape[1] == 1:
        shares = np.ones((len(tangents), 1))
    else:
        first, second = tangents[0]
        shares = tangents @ (np.cos(angle) * first + np.sin(angle) * second)
    n = len(pair.space)
    result = sp.csr_matrix((n, pair.operator.shape[1]))
    for b, numbers in enumerate(pair.index[:, 1:].T):
        there = np.flatnonzero(numbers >= 0)
        picks = sp.csr_matrix((shares[there, b], (there, numbers[there])), shape=(n, len(pair)))
        result = result + picks @ pair.operator
    return result


def _critical(stiffness: sp.csr_matrix, normal: sp.csr_matrix, slips: Sequence[sp.csr_matrix]) -> float:
    """The smallest mu for which (A_nn + mu A_nt) p = 0 for some p, of slip either way."""
    yields = direct.factorized(stiffness)(np.asarray(normal.T.todense()))
    coupling = np.asarray(normal @ yields)
    coupling = 0.5 * (coupling + coupling.T)
    values = np.linalg.eigvalsh(coupling)
    if not values[0] > REGULAR**2 * values[-1]:
        raise SingularModelError("contact cannot close")
    result = np.inf
    for slip in slips:
        found = scipy.linalg.eigvals(np.asarray(slip @ yields).T, coupling)
        real = np.abs(found[np.abs(found.imag) <= REAL * np.abs(found)].real)
        result = min(result, 1.0 / max(float(real.max(initial=0.0)), 1e-300))
    return result if result < 1e100 else np.inf


def _certain(stiffness: sp.csr_matrix, normal: sp.csr_matrix, pairs: Sequence[Pair]) -> float:
    """2 sqrt(smallest normal compliance with no slip / largest tangential compliance), per area."""
    slip = sp.vstack([pair.operator[pair.tangential] for pair in pairs]).tocsr()
    rows = sp.vstack([normal, slip]).tocsr()
    n, weight = normal.shape[0], np.concatenate([pair.space.weight for pair in pairs])
    more = np.concatenate([pair.weight[pair.tangential] for pair in pairs])
    scale = 1.0 / np.sqrt(np.concatenate([weight, more]))
    whole = np.asarray(rows @ direct.factorized(stiffness, definite=True)(np.asarray(rows.T.todense())))
    whole = scale[:, None] * 0.5 * (whole + whole.T) * scale
    along = np.linalg.eigvalsh(whole[n:, n:])
    if not len(along) or along[-1] <= 0.0:
        return np.inf
    stuck = whole[:n, :n] - whole[:n, n:] @ scipy.linalg.pinvh(whole[n:, n:]) @ whole[n:, :n]
    return 2.0 * float(np.sqrt(max(np.linalg.eigvalsh(stuck)[0], 0.0) / along[-1]))

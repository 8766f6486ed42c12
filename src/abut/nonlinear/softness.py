"""How far bodies give way beside their facets, theory (V16): what interior points begin with."""

from __future__ import annotations

import numpy as np
import scipy.linalg
from numpy.typing import NDArray

from abut.linear.solver import Prepared

Vector = NDArray[np.float64]


def softness(solver: Prepared) -> float:
    """How far the bodies give way under a uniform pressure, over how far their facets alone would, theory (V16). Rigid
    motions are held by springs at a few displacements, and their share is taken out. With one in its place
    ``test_counts_do_not_grow`` fails, at beams."""
    system = solver.system
    root = np.sqrt(system.scale)
    one = np.ones(len(root))
    moved = system.operator @ solver.respond(np.asarray(system.operator.T @ one), _springs(solver))
    if system.compliance is not None:
        moved = moved + system.compliance @ one
    if system.motions.shape[1]:
        rigid = np.asarray(system.operator @ system.motions) / root[:, None]
        moved = moved - root * (rigid @ np.linalg.lstsq(rigid, moved / root, rcond=None)[0])
    return max(1.0, float(np.linalg.norm(moved / root) / np.linalg.norm(root)))


def _springs(solver: Prepared) -> Vector:
    """Springs (n_free,) on as many displacements as hold the rigid motions, as stiff as the bodies there."""
    motions = solver.system.motions
    springs = np.zeros(len(motions))
    if motions.shape[1]:
        pivots = scipy.linalg.qr(motions.T, mode="r", pivoting=True)[1][: motions.shape[1]]
        springs[pivots] = solver.system.unit
    return springs

"""Rows of a contact pair that say the same twice."""

from __future__ import annotations

import numpy as np
import scipy.sparse as sp

from abut.types import Sparse

FEW = 1000  # multipliers of a pair up to which a look for repeated constraints costs little
DEPENDENT = 1e-13  # smallest eigenvalue of their Gram matrix over the largest below which they repeat each other


def repeats(operator: Sparse) -> bool:
    """Whether rows depend on each other. Not looked for where they are too many for a dense matrix."""
    if not 0 < operator.shape[0] <= FEW:
        return False
    size = sp.linalg.norm(operator, axis=1)
    rows = sp.diags(1.0 / np.where(size > 0.0, size, 1.0)) @ operator
    values = np.linalg.eigvalsh((rows @ rows.T).toarray())
    return bool(values[0] < DEPENDENT * values[-1])

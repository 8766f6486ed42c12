"""A drag on all motion, as of bodies in a thick fluid: forces against the way since a state, theory (G23)."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
import scipy.sparse as sp
from numpy.typing import NDArray

from abut.problem.linearised import Linearised

Vector = NDArray[np.float64]


@dataclass(frozen=True)
class Drag:
    """resistance: (n_free,) force by way; anchor: (n_free,) displacements from which the way counts."""

    resistance: Vector
    anchor: Vector

    def force(self, at: Vector) -> Vector:
        """(n_free,) that resists the way to displacements ``at``."""
        return np.asarray(self.resistance * (at - self.anchor))


def dragged(system: Linearised, drag: Drag | None) -> Linearised:
    """The problem near a state, with a drag."""
    if drag is None:
        return system
    assert system.about is not None
    about = replace(system.about, unbalanced=system.about.unbalanced + drag.force(system.about.at))
    return replace(system, stiffness=system.stiffness + sp.diags(drag.resistance, format="csr"), about=about)


def scale(system: Linearised) -> Vector:
    """(n_free,) the size of the stiffness of each displacement alone, which drags go with: soft bodies meet little, rigid
    ones as much as a hundredth of the median."""
    diagonal = np.abs(system.stiffness.diagonal())
    stiff = diagonal[diagonal > 0.0]
    return np.maximum(diagonal, 0.01 * float(np.median(stiff))) if len(stiff) else np.ones_like(diagonal)

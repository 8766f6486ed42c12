"""Derivatives of a user's own law or material against differences of its values."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray

from abut.contact.laws import Law, LawState
from abut.materials.material import Material

STEP = 1e-6  # of a difference, over the size of the values
Array = NDArray[np.float64]


def law_tangents(law: Law, jump: Array, traction: Array, state: LawState | None = None) -> float:
    """Largest error of a contact law's derivatives by jump and by traction, over the largest derivative.

    jump: (n, c) length and traction: (n, c) force per area, at which to look; away from kinks of the law, where there is no
    derivative. Central differences leave about 1e-9 of a sound law."""
    there = state or LawState(np.zeros(len(jump), dtype=bool))
    told = law.evaluate(jump, traction, there)
    by_jump = differences(lambda x: law.evaluate(x, traction, there).residual, jump)
    by_traction = differences(lambda x: law.evaluate(jump, x, there).residual, traction)
    return max(_error(told.by_jump, by_jump), _error(told.by_traction, by_traction))


def material_tangent(material: Material, strain: Array, history: Array | None = None) -> float:
    """Largest error of a material's tangent, over its largest entry.

    strain: (n, 6) at which to look; history: (n, h), that of a fresh material where left out."""
    before = material.initial(len(strain)) if history is None else history
    _, tangent, _ = material.evaluate(strain, before)
    return _error(tangent, differences(lambda x: material.evaluate(x, before)[0], strain))


def differences(function: Callable[[Array], Array], at: Array) -> Array:
    """Central differences of a function of points, (n, m) -> (n, k), by its m arguments: (n, k, m)."""
    columns = []
    for a in range(at.shape[1]):
        step = STEP * max(float(np.abs(at).max(initial=0.0)), 1e-300)
        aside = np.zeros_like(at)
        aside[:, a] = step
        columns.append((function(at + aside) - function(at - aside)) / (2.0 * step))
    return np.stack(columns, axis=-1)


def _error(told: Array, found: Array) -> float:
    return float(np.abs(told - found).max(initial=0.0) / max(float(np.abs(found).max(initial=0.0)), 1e-300))

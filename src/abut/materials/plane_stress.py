"""Plane stress of any material: the strains out of the plane are those that leave no stress there, theory (E5)."""

from __future__ import annotations

from collections.abc import Callable
from functools import partial

import numpy as np

from abut.errors import ConvergenceError
from abut.materials.material import Array, Evaluated

OUT = np.array([2, 4, 5])  # zz yz zx
LIMIT = 25  # iterations; Newton's method needs one for a linear material and about five for others
STRESS_LEFT = 1e-13  # stress left out of the plane, relative to tangent times strain and to stress

Evaluate = Callable[[Array, Array], Evaluated]
Strained = tuple[Array, Evaluated]  # strains (n, 6) that a material has seen, and what it said


def law(evaluate: Evaluate, plane: str | None) -> Callable[[Array, Array], Strained]:
    """A material's ``evaluate`` with the strains, in plane stress with those out of the plane found, beginning with those
    given."""
    if plane == "stress":
        return partial(in_plane_stress, evaluate)
    return lambda strain, history: (strain, evaluate(strain, history))


def in_plane_stress(evaluate: Evaluate, strain: Array, history: Array) -> Strained:
    """As ``Material.evaluate``, but strains zz yz zx are found from zero stresses there by Newton's method; the tangent is
    that of the components in the plane, with zeros elsewhere.

    Raises ConvergenceError where they are not found."""
    strain = strain.copy()
    for _ in range(LIMIT):
        stress, tangent, after = evaluate(strain, history)
        block = tangent[:, OUT[:, None], OUT]
        scale = np.abs(tangent).max(axis=(1, 2), initial=0.0) * np.abs(strain).max(axis=1, initial=0.0)
        scale += np.abs(stress).max(axis=1, initial=0.0)  # of bodies that have stresses before strains
        if (np.abs(stress[:, OUT]) <= STRESS_LEFT * scale[:, None]).all():
            return strain, _condensed(stress, tangent, block, after)
        strain[:, OUT] -= np.linalg.solve(block, stress[:, OUT, None])[..., 0]
    raise ConvergenceError(
        f"plane stress: no strain out of the plane without stress there was found in {LIMIT} iterations; smaller load "
        "steps, or a check of the material's tangent, may help"
    )


def _condensed(stress: Array, tangent: Array, block: Array, history: Array) -> Evaluated:
    stress, coupling = stress.copy(), tangent[:, :, OUT]
    stress[:, OUT] = 0.0
    reduced = tangent - coupling @ np.linalg.solve(block, tangent[:, OUT, :])
    reduced[:, OUT, :] = 0.0
    reduced[:, :, OUT] = 0.0
    return stress, reduced, history

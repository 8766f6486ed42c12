"""Local directions of materials: frames at points, and strains and stiffness from axes to axes, theory (A2)."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from abut.axes import Axes
from abut.materials.evaluated import Array

PAIRS = ((0, 0), (1, 1), (2, 2), (0, 1), (1, 2), (2, 0))  # xx yy zz xy yz zx
Directions = Axes | Callable[[Array], Array]  # or frames (n, dim, dim) of points (n, dim), as ``Axes.frames`` has them


def frames(directions: Directions, points: Array) -> Array:
    """Rows are the three unit vectors at points (n, dim), (n, 3, 3); of a plane model the third one is out of the plane."""
    dim = points.shape[1]
    given = directions.frames(points) if isinstance(directions, Axes) else np.asarray(directions(points), dtype=float)
    result = np.zeros((len(points), 3, 3))
    result[:, 2, 2] = 1.0
    result[:, :dim, :dim] = given
    return result


def uniform(directions: Directions | None) -> bool:
    """Whether they are the same everywhere."""
    return directions is None or (isinstance(directions, Axes) and directions.kind == "rectangular")


def turned(frame: Array) -> Array:
    """Local strains by global ones, shear doubled, (n, 6, 6) of frames (n, 3, 3); its transpose takes local stresses to
    global ones."""
    result = np.empty((len(frame), 6, 6))
    for row, (a, b) in enumerate(PAIRS):
        for column, (i, j) in enumerate(PAIRS):
            both = frame[:, a, i] * frame[:, b, j]
            if i != j:
                both = both + frame[:, a, j] * frame[:, b, i]
            if a == b and i != j:
                both = 0.5 * both
            result[:, row, column] = both if a == b else (2.0 if i == j else 1.0) * both
    return result

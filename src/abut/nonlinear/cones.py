"""Second-order cones x_0 >= |x_1|: many small ones at once, and what an interior point method needs of them.

Vectors are (n, d), the first component along the axis of the cone. Scaling after Nesterov and Todd (1997)."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]


@dataclass(frozen=True)
class Scaling:
    """matrix W (n, d, d), symmetric, and its inverse: W z = W^-1 u for the vectors of both cones; middle: that product."""

    matrix: Array
    inverse: Array
    middle: Array


def scaling(slack: Array, vector: Array) -> Scaling:
    """Of vectors u (``slack``) and z inside the cone."""
    size = np.sqrt(depth(slack)), np.sqrt(depth(vector))
    one, other = slack / size[0][:, None], mirrored(vector) / size[1][:, None]
    share = np.sqrt(0.5 * (1.0 + np.einsum("nd,nd->n", one, mirrored(other))))
    axis = (one + other) / (2.0 * share)[:, None]
    n, d = axis.shape
    matrix = np.empty((n, d, d))
    matrix[:, 0] = matrix[:, :, 0] = axis
    across = axis[:, 1:, None] * axis[:, None, 1:] / (1.0 + axis[:, 0])[:, None, None]
    matrix[:, 1:, 1:] = np.eye(d - 1) + across
    sign = np.outer(*2 * [np.r_[1.0, -np.ones(d - 1)]])
    stretch = np.sqrt(size[0] / size[1])[:, None, None]
    inverse = sign * matrix / stretch
    matrix = stretch * matrix
    return Scaling(matrix, inverse, times(matrix, vector))


def mirrored(x: Array) -> Array:
    """The same with the other sign across the axis."""
    return np.concatenate([x[:, :1], -x[:, 1:]], axis=1)


def depth(x: Array) -> Array:
    """x_0^2 - |x_1|^2: positive inside the cone and its mirror image, (n,)."""
    return (x[:, 0] - (size := np.linalg.norm(x[:, 1:], axis=1))) * (x[:, 0] + size)


def times(matrix: Array, x: Array) -> Array:
    return np.asarray(np.einsum("nij,nj->ni", matrix, x))


def product(x: Array, y: Array) -> Array:
    """x o y = (x . y, x_0 y_1 + y_0 x_1)."""
    return np.column_stack([np.einsum("nd,nd->n", x, y), x[:, :1] * y[:, 1:] + y[:, :1] * x[:, 1:]])


def quotient(x: Array, r: Array) -> Array:
    """The y with x o y = r."""
    first = (x[:, 0] * r[:, 0] - np.einsum("nd,nd->n", x[:, 1:], r[:, 1:])) / depth(x)
    return np.column_stack([first, (r[:, 1:] - first[:, None] * x[:, 1:]) / x[:, :1]])


def longest(x: Array, step: Array) -> float:
    """How many steps it takes from inside until the first of the vectors leaves its cone."""
    square, linear, constant = (
        depth(step),
        x[:, 0] * step[:, 0] - np.einsum("nd,nd->n", x[:, 1:], step[:, 1:]),
        depth(x),
    )
    root = np.sqrt(np.maximum(linear**2 - square * constant, 0.0))
    with np.errstate(divide="ignore", invalid="ignore"):
        larger = -linear - np.where(linear >= 0.0, root, -root)
        roots = np.stack([larger / square, constant / larger, -x[:, 0] / step[:, 0]])
    roots[:2, linear**2 < square * constant] = np.inf
    return float(np.where(np.isfinite(roots) & (roots > 0.0), roots, np.inf).min(initial=np.inf))

"""Closed forms of round fits: layered tubes and spheres with interferences, temperatures and pressures (Lame)."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np


@dataclass(frozen=True)
class Layer:
    """A tube in plane strain, or a spherical shell, of inner and outer radius; warmer by ``hot`` degrees."""

    inner: float
    outer: float
    young: float
    poisson: float = 0.3
    expansion: float = 0.0
    hot: float = 0.0


def interface_pressures(
    layers: Sequence[Layer],
    interferences: Sequence[float],
    inside: float = 0.0,
    outside: float = 0.0,
    sphere: bool = False,
) -> np.ndarray:
    """Pressures (n - 1,) between n layers: u_outer - u_inner is the interference at each interface. u = A r + B / r^n."""
    power = 2.0 if sphere else 1.0
    n = len(layers)
    rows, right = np.zeros((2 * n, 2 * n)), np.zeros(2 * n)

    def stress(layer: Layer, r: float) -> tuple[np.ndarray, float]:
        e, nu = layer.young, layer.poisson
        thermal = e * layer.expansion * layer.hot / (1 - 2 * nu)
        first = e / (1 - 2 * nu) if sphere else e / ((1 + nu) * (1 - 2 * nu))
        return np.array([first, -power * e / (1 + nu) / r ** (power + 1)]), -thermal

    def move(r: float) -> np.ndarray:
        return np.array([r, r**-power])

    row = 0
    for layer, r, pressure, at in (
        (layers[0], layers[0].inner, inside, 0),
        (layers[-1], layers[-1].outer, outside, n - 1),
    ):
        by, constant = stress(layer, r)
        rows[row, 2 * at : 2 * at + 2], right[row] = by, -pressure - constant
        row += 1
    for i, interference in enumerate(interferences):
        r = layers[i].outer
        (one, of_one), (two, of_two) = stress(layers[i], r), stress(layers[i + 1], r)
        rows[row, 2 * i : 2 * i + 4], right[row] = np.concatenate([one, -two]), of_two - of_one
        rows[row + 1, 2 * i : 2 * i + 4], right[row + 1] = np.concatenate([-move(r), move(r)]), interference
        row += 2
    scale = np.abs(rows).max(axis=1)
    solved = np.linalg.solve(rows / scale[:, None], right / scale)
    found = []
    for i in range(n - 1):
        by, constant = stress(layers[i], layers[i].outer)
        found.append(-(by @ solved[2 * i : 2 * i + 2] + constant))
    return np.array(found)

"""Bodies that fold until they touch themselves."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

import abut
from abut.mesh.make.block import grid

PERIOD, RISE, THICKNESS = 2.0, 1.5, 0.3
Array = NDArray[np.float64]


def wavy(points: Array) -> Array:
    """A strip (length, thickness) laid along a sine wave, its points as far apart along it as before."""
    fine = np.linspace(0.0, 2.0 * PERIOD, 4001)
    height = RISE * np.sin(2.0 * np.pi * fine / PERIOD)
    way = np.concatenate([[0.0], np.cumsum(np.hypot(np.diff(fine), np.diff(height)))])
    x = np.interp(points[:, 0] * way[-1], way, fine)
    slope = RISE * 2.0 * np.pi / PERIOD * np.cos(2.0 * np.pi * x / PERIOD)
    normal = np.stack([-slope, np.ones_like(slope)], axis=1) / np.hypot(1.0, slope)[:, None]
    centre = np.stack([x, RISE * np.sin(2.0 * np.pi * x / PERIOD)], axis=1)
    return np.asarray(centre + points[:, 1:2] * normal)


def accordion(shortening: float = 2.4, cells: int = 56, cell: str = "quad4", **contact: Any) -> abut.Model:
    """Two waves pushed together between their ends until the legs touch."""
    lines = [np.linspace(0.0, 1.0, cells + 1), np.linspace(-0.5, 0.5, 3) * THICKNESS]
    made = grid(lines, cell, wavy)
    mesh = replace(made, bodies={"strip": made.bodies["body"]})
    return abut.Model(
        mesh=mesh,
        solids=[abut.Solid("strip", abut.NeoHooke(young=100.0, poisson=0.3))],
        supports=[abut.Support("left", x=0.0, y=0.0), abut.Support("right", x=-shortening, y=0.0)],
        contacts=[abut.Contact("strip", "strip", name="folds", **contact)],
        plane="strain",
        kinematics="finite",
    )

"""Bodies that fold until they touch themselves."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

import abut
from abut.contact.sides import Names
from abut.mesh.make.block import grid

LEG, RADIUS, THICKNESS, TURNS, ENDS = 2.0, 0.4, 0.3, 2, 0.9
Array = NDArray[np.float64]


def folded(points: Array) -> Array:
    """A strip (share of the length, distance from its middle) laid in legs up and down with half circles between
    them, the outer legs longer."""
    arc = np.pi * RADIUS
    way = points[:, 0] * (TURNS * (LEG + arc) + LEG + 2.0 * ENDS) - ENDS
    number = np.clip(np.floor(way / (LEG + arc)), 0, TURNS)
    along = way - number * (LEG + arc)
    up = np.where(number % 2 == 0, 1.0, -1.0)
    angle = np.where(number < TURNS, np.maximum(along - LEG, 0.0), 0.0) / RADIUS
    x = 2.0 * RADIUS * number + RADIUS * (1.0 - np.cos(angle))
    y = up * (np.where(number < TURNS, np.minimum(along, LEG), along) - 0.5 * LEG + RADIUS * np.sin(angle))
    left = np.stack([-np.cos(angle), up * np.sin(angle)], axis=1) * up[:, None]
    return np.asarray(np.stack([x, y], axis=1) + points[:, 1:2] * left)


def accordion(
    shortening: float = 1.0, cells: int = 60, cell: str = "quad4", sides: Names = "strip", **contact: Any
) -> abut.Model:
    """Three legs, the outer ones held along their outer sides and pushed together until all touch."""
    lines = [np.linspace(0.0, 1.0, cells + 1), np.linspace(-0.5, 0.5, 3) * THICKNESS]
    made = grid(lines, cell, folded)
    held = {}
    for name, side, x in (
        ("first", "top", -0.5 * THICKNESS),
        ("last", "bottom", 2.0 * RADIUS * TURNS + 0.5 * THICKNESS),
    ):
        rows = made.surfaces[side]
        on = [np.abs(made.points[nodes[nodes >= 0], 0] - x).max() < 1e-9 for nodes in made.facets(rows).nodes]
        held[name] = rows[np.array(on)]
    mesh = replace(made, bodies={"strip": made.bodies["body"]}, surfaces={**made.surfaces, **held})
    return abut.Model(
        mesh=mesh,
        solids=[abut.Solid("strip", abut.NeoHooke(young=100.0, poisson=0.3))],
        supports=[abut.Support("first", x=0.0, y=0.0), abut.Support("last", x=-shortening, y=0.0)],
        contacts=[abut.Contact(contactor=sides, target=sides, name="folds", **contact)],
        plane="strain",
        kinematics="finite",
    )

"""Strips of surface cells that ``abut.thicken`` makes solid."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

import abut
from models.gmsh_files import write_msh

LENGTH, WIDTH, THICK, E = 100.0, 10.0, 1.0, 210e3
INERTIA = WIDTH * THICK**3 / 12
STEEL = abut.LinearElastic(E, 0.0)
CLAMPED = dict.fromkeys(("x", "y", "z", "rx", "ry", "rz"), 0.0)
Place = Callable[[NDArray[np.float64]], NDArray[np.float64]]


def strip(path: Path, count: int = 10, kind: str = "quad4", place: Place = lambda x: x) -> Path:
    """A strip along x, two cells wide, of groups "strip", "pad" (its outer half), "left", "right" and "corner"."""
    x, y = np.meshgrid(np.linspace(0, LENGTH, count + 1), np.linspace(0, WIDTH, 3), indexing="ij")
    points = np.stack([x.ravel(), y.ravel(), 0 * x.ravel()], axis=1)
    i, j = np.meshgrid(np.arange(count), np.arange(2), indexing="ij")
    first = (3 * i + j).ravel()
    quads = np.stack([first, first + 3, first + 4, first + 1], axis=1)
    cells = quads if kind == "quad4" else np.concatenate([quads[:, [0, 1, 2]], quads[:, [0, 2, 3]]])
    last = 3 * count
    groups = {
        "strip": {kind: cells},
        "pad": {kind: cells[points[cells].mean(axis=1)[:, 0] > LENGTH / 2]},
        "left": {"line2": [[0, 1], [1, 2]]},
        "right": {"line2": [[last, last + 1], [last + 1, last + 2]]},
        "corner": {"point": [[last]]},
    }
    return write_msh(path, np.array([place(p) for p in points]), groups)


def solved(thick: abut.Thick, body: str, how: str = "reduced", **more: object) -> abut.Solution:
    solid = abut.Solid(body, STEEL, integration=how)
    loads = [*thick.loads, *more.pop("loads", ())]  # type: ignore[call-overload]
    model = abut.Model(
        thick.mesh, [solid], thick.supports, loads, equations=thick.equations, couplings=thick.couplings, **more
    )
    return abut.solve(model)

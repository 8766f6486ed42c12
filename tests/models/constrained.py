"""What constraints are tested on, and how exactly."""

from __future__ import annotations

import numpy as np

import abut
from abut.mesh.mesh import Mesh

EXACT = 1e-9
SOFT = abut.LinearElastic(1000.0, 0.3)


def at(mesh: Mesh, body: str, *where: float) -> int:
    nodes = mesh.nodes_of(body)
    return int(nodes[np.abs(mesh.points[nodes] - where).sum(axis=1).argmin()])


def equal(a: tuple[int, str], b: tuple[int, str], value: float = 0.0) -> abut.Equation:
    """One displacement less another is ``value``."""
    return abut.Equation((abut.Term(a[0], a[1], 1.0), abut.Term(b[0], b[1], -1.0)), value)

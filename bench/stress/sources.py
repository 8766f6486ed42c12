"""What stresses at contact nodes of Hertz's ball owe to displacements, to the pressure, and to recovery: each in turn is
replaced by the exact one. Largest errors of the von Mises stress over the largest pressure, docs/verification/stresses.md.

OMP_NUM_THREADS=1 python bench/stress/sources.py [--cells quad4,hex8] [--n 6]
"""

from __future__ import annotations

import argparse
import sys
from pathlib import Path

import numpy as np
import scipy.sparse as sp

import abut
from abut.analysis.surface_slopes import SurfacePoints, surface_stress
from abut.bodies.solids import TemperatureChange
from abut.materials.invariants import von_mises
from abut.types import Array

sys.path.insert(0, str(Path(__file__).parents[2] / "tests"))
from models.stresses import BALL_PEAK, INSIDE, NU, RADIUS, ball_von_mises, hertz_ball

YOUNG, BALL = 1000.0, 8.0


def exact_displacement(x: Array) -> Array:
    """Of the surface of a half space, downwards negative as in the ball (Johnson, Contact Mechanics, 3.4), (n, dim)."""
    r = np.maximum(np.linalg.norm(x[:, :-1], axis=1), 1e-12)
    s, rest = np.minimum(RADIUS / r, 1.0), np.maximum(1.0 - (r / RADIUS) ** 2, 0.0)
    along = -(1 - 2 * NU) * (1 + NU) / (3 * YOUNG) * RADIUS**2 / r * BALL_PEAK * (1.0 - rest**1.5)
    inside = np.pi / 2 * (2 * RADIUS**2 - r**2)
    outside = (2 * RADIUS**2 - r**2) * np.arcsin(s) + r * RADIUS * np.sqrt(1.0 - s**2)
    deep = (1 - NU**2) * BALL_PEAK / (2 * YOUNG * RADIUS) * np.where(r < RADIUS, inside, outside)
    return np.column_stack([x[:, :-1] / r[:, None] * along[:, None], deep])


def largest(solution: abut.Solution, displacement: Array, pressure: Array, nodes: Array) -> float:
    """Error of the stresses that these give at nodes."""
    mesh = solution.model.mesh
    surface, x = mesh.surface("ball.round"), mesh.points
    facet, local = np.nonzero(surface.nodes >= 0)
    shape = (len(x), len(surface))
    has = sp.csr_matrix((np.ones(len(facet)), (surface.nodes[facet, local], facet)), shape=shape)[nodes].tocsr()
    centre = np.zeros(mesh.dim)
    centre[-1] = BALL
    normal = (x[nodes] - centre) / np.linalg.norm(x[nodes] - centre, axis=1, keepdims=True)
    mirrored = np.abs(x[nodes]) < 1e-9
    mirrored[:, -1] = False
    at = SurfacePoints(nodes, has, normal, mirrored, -pressure[:, None] * normal)
    stress, _ = surface_stress(solution.model.deformable, surface, displacement, TemperatureChange(), at)
    full = np.zeros((len(nodes), 6))
    full[:, : stress.shape[1]] = stress / BALL_PEAK
    r = np.linalg.norm(x[nodes, :-1], axis=1) / RADIUS
    return float(np.abs(von_mises(full) - ball_von_mises(r)).max())


def main() -> None:
    """Print a row for each cell."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--cells", default="quad4,tri3,hex8,tet4,quad8,tri6,hex20,tet10")
    parser.add_argument("--n", type=int, default=6)
    options = parser.parse_args()
    print("| cells | n | as solved | exact pressure | exact displacements | both |\n|---|---|---|---|---|---|")
    for kind in options.cells.split(","):
        solution = abut.solve(hertz_ball(kind, options.n))
        x, contact = solution.model.mesh.points, solution.contacts[0]
        own = np.zeros(len(x))
        own[contact.nodes] = contact.nodal_pressure
        nodes = solution.model.mesh.nodes_of("ball.round")
        nodes = nodes[np.linalg.norm(x[nodes, :-1], axis=1) < INSIDE * RADIUS]
        true = BALL_PEAK * np.sqrt(1.0 - (np.linalg.norm(x[nodes, :-1], axis=1) / RADIUS) ** 2)
        moves, pressures = (solution.displacement, exact_displacement(x)), (own[nodes], true)
        found = [100 * largest(solution, u, p, nodes) for u in moves for p in pressures]
        print(f"| {kind} | {options.n} | " + " | ".join(f"{value:.1f}" for value in found) + " |", flush=True)


if __name__ == "__main__":
    main()

"""PyAMG by hand on the stiffness that abut uses: python bench/contact/pyamg_child.py CASE DOFS

Smoothed aggregation with its defaults and the bodies' rigid motions, conjugate gradients to 1e-8; the bodies are not
coupled, each is held by its own supports. Prints one line of JSON: seconds of set-up and iterations together.
"""

from __future__ import annotations

import argparse
import json
import time

import cases
import numpy as np
import pyamg
import scipy.sparse as sp

from abut.bodies.assemble import stiffness
from abut.bodies.rigid_modes import rigid_modes
from abut.problem.constraints import supports

TOLERANCE = 1e-8


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("case")
    parser.add_argument("dofs", type=int)
    arguments = parser.parse_args()
    model = cases.model(arguments.case, arguments.dofs)
    held = supports(model)
    full = stiffness(model.deformable)
    matrix = held.reduce(full)
    near_null = held.free.T @ rigid_modes(model.mesh).together
    load = np.random.default_rng(0).standard_normal(matrix.shape[0])
    start = time.perf_counter()
    if matrix.shape[0] % 3 == 0 and _whole_points(held.free):
        matrix = matrix.tobsr((3, 3))
    levels = pyamg.smoothed_aggregation_solver(matrix, B=near_null)
    residuals: list[float] = []
    levels.solve(load, tol=TOLERANCE, accel="cg", maxiter=1000, residuals=residuals)
    seconds = time.perf_counter() - start
    done = residuals[-1] <= 1.01 * TOLERANCE * np.linalg.norm(load)
    print(
        json.dumps(
            {
                "status": "ok" if done else "not converged",
                "dofs": cases.dofs(model),
                "seconds": seconds,
                "iterations": len(residuals) - 1,
            }
        )
    )


def _whole_points(free: sp.csr_matrix) -> bool:
    """Whether every point has all its displacements or none, so that the matrix has blocks."""
    point = np.sort(free.tocsc().indices) // 3
    return bool((np.unique(point, return_counts=True)[1] == 3).all())


if __name__ == "__main__":
    main()

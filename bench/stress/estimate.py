"""The estimated stress error near contact (the certificate's line "stress error") beside the true one, by closed forms: a
cylinder on a block (McEwen) and a press fit (Lame). docs/verification/stresses.md.

OMP_NUM_THREADS=1 python bench/stress/estimate.py
"""

from __future__ import annotations

import sys
from collections.abc import Callable
from pathlib import Path

import numpy as np

import abut
from abut._core import shape_functions
from abut.analysis.stress_error import PRESSED, _around
from abut.bodies.recovery import carried
from abut.bodies.stress import point_stress
from abut.cells import CELLS
from abut.mesh.quadrature import error_rule
from abut.types import Array

sys.path.insert(0, str(Path(__file__).parents[2] / "tests"))
from models.stresses import FIT, HALF_WIDTH, LINE_PEAK, NU, hertz_line, press_fit

Field = Callable[[Array], tuple[Array, Array, Array]]  # xx, yy and xy at (..., 2)


def below(x: Array) -> tuple[Array, Array, Array]:
    """Of the half space under Hertz's pressure (McEwen 1949; Johnson, Contact Mechanics, 4.2)."""
    a, along, z = HALF_WIDTH, x[..., 0], -x[..., 1]
    b = a * a - along**2 + z * z
    root = np.sqrt(b * b + 4 * along**2 * z * z)
    m = np.sqrt(np.maximum(0.5 * (root + b), 0.0))
    n = np.sign(along) * np.sqrt(np.maximum(0.5 * (root - b), 0.0))
    size = np.maximum(m * m + n * n, 1e-12)
    share, scale = (z * z + n * n) / size, LINE_PEAK / a
    return -scale * (m * (1 + share) - 2 * z), -scale * m * (1 - share), scale * n * (m * m - z * z) / size


def pressed(inner: float, outer: float, outside: bool) -> Field:
    """Of a ring under a fit's pressure, from inside or from outside (Lame)."""

    def field(x: Array) -> tuple[Array, Array, Array]:
        own, free = (inner, outer) if outside else (outer, inner)
        level = FIT / ((free / own) ** 2 - 1.0)
        r = np.linalg.norm(x, axis=-1)
        radial, hoop = level * (1.0 - (free / r) ** 2), level * (1.0 + (free / r) ** 2)
        c, s = x[..., 0] / r, x[..., 1] / r
        return radial * c * c + hoop * s * s, radial * s * s + hoop * c * c, (radial - hoop) * c * s

    return field


FIELDS = {"block": below, "hub": pressed(2.0, 3.0, True), "shaft": pressed(1.0, 2.0, False)}


def true_error(solution: abut.Solution, body: str, cells: Array) -> float:
    """In the energy norm over some cells, relative."""
    solids, off, whole = solution.model.deformable, 0.0, 0.0
    young = solids.materials[body].modulus
    compliance = np.diag([1.0] * 3 + [2.0] * 3) * (1.0 + NU)
    compliance[:3, :3] -= NU
    for group, stress in zip(solids.groups(), point_stress(solids, solution.displacement)):
        rows = np.flatnonzero(np.isin(group.cells, cells))
        rule = error_rule(group.kind)
        shapes, slopes = shape_functions(CELLS[group.kind].code, np.ascontiguousarray(rule[0]))
        nodes = solids.points[group.nodes[rows]]
        volume = np.abs(np.linalg.det(np.einsum("qnd,cne->cqed", slopes, nodes))) * rule[1]
        exact = np.zeros((*volume.shape, 6))
        exact[..., 0], exact[..., 1], exact[..., 3] = FIELDS[body](shapes @ nodes)
        exact[..., 2] = NU * (exact[..., 0] + exact[..., 1])
        rest = exact - carried(group.kind, group.rule, rule[0]) @ stress[rows]
        for_both = [
            float((np.einsum("cqi,ij,cqj->cq", s, compliance, s) * volume).sum() / young) for s in (rest, exact)
        ]
        off, whole = off + for_both[0], whole + for_both[1]
    return float(np.sqrt(off / whole))


def main() -> None:
    """Print a row for each body, and the medians."""
    ratios: dict[int, list[float]] = {1: [], 2: []}
    print("| body | cells | n | estimate % | true % | ratio |\n|---|---|---|---|---|---|")
    for model, sizes in ((hertz_line, (4, 8, 16)), (press_fit, (3, 6, 12))):
        for kind in ("tri3", "quad4", "tri6", "quad8", "quad9"):
            for n in sizes:
                solution = abut.solve(model(kind, n))
                solids, contact = solution.model.deformable, solution.contacts[0]
                estimates = {e.body: e.error for e in solution.steps[-1].stress_error.near}
                for side, p in ((contact.contactor, contact.pressure), (contact.target, contact.target_pressure)):
                    number = int(solids.body_of[side.cells[0]])
                    body, largest = list(solids.materials)[number], np.nan_to_num(p).max(axis=1)
                    if body in FIELDS:
                        true = true_error(
                            solution, body, _around(solids, side, largest > PRESSED * largest.max(), number)
                        )
                        ratios[CELLS[kind].degree].append(estimates[body] / true)
                        row = f"{100 * estimates[body]:.2f} | {100 * true:.2f} | {estimates[body] / true:.2f}"
                        print(f"| {body} | {kind} | {n} | {row} |", flush=True)
    for degree, values in ratios.items():
        print(
            f"degree {degree}: median {np.median(values):.2f}, {min(values):.2f} to {max(values):.2f}, {len(values)} rows"
        )


if __name__ == "__main__":
    main()

"""The estimated stress error near contact (the certificate's line "stress error") beside the true one, by closed forms: a
cylinder on a block (McEwen), a press fit (Lame), a ball on a rigid plane (Huber), axisymmetric and an octant.
docs/verification/stresses.md.

OMP_NUM_THREADS=1 python bench/stress/estimate.py [line fit ball]
"""

from __future__ import annotations

import argparse
import sys
from collections.abc import Callable
from pathlib import Path

import numpy as np

import abut
from abut._core import shape_functions
from abut.analysis.stress_error import PRESSED, _around
from abut.bodies.patch_fits import carried
from abut.bodies.stress import point_stress
from abut.cells import CELLS
from abut.mesh.quadrature import error_rule
from abut.types import Array

sys.path.insert(0, str(Path(__file__).parents[2] / "tests"))
from models.stresses import (
    BALL_PEAK,
    FIT,
    HALF_WIDTH,
    LINE_PEAK,
    NU,
    RADIUS,
    hertz_ball,
    hertz_line,
    press_fit,
)

Field = Callable[[Array], Array]  # xx yy zz xy yz zx at (..., dim)
FLAT, SOLID = ("tri3", "quad4", "tri6", "quad8", "quad9"), ("tet4", "hex8", "tet10", "hex20", "hex27")


def strained(xx: Array, yy: Array, xy: Array) -> Array:
    """All components in plane strain."""
    none = np.zeros(xx.shape)
    return np.stack([xx, yy, NU * (xx + yy), xy, none, none], axis=-1)


def below(x: Array) -> Array:
    """Of the half space under Hertz's pressure (McEwen 1949; Johnson, Contact Mechanics, 4.2)."""
    a, along, z = HALF_WIDTH, x[..., 0], -x[..., 1]
    b = a * a - along**2 + z * z
    root = np.sqrt(b * b + 4 * along**2 * z * z)
    m = np.sqrt(np.maximum(0.5 * (root + b), 0.0))
    n = np.sign(along) * np.sqrt(np.maximum(0.5 * (root - b), 0.0))
    size = np.maximum(m * m + n * n, 1e-12)
    share, scale = (z * z + n * n) / size, LINE_PEAK / a
    xy = scale * n * (m * m - z * z) / size
    return strained(-scale * (m * (1 + share) - 2 * z), -scale * m * (1 - share), xy)


def pressed(inner: float, outer: float, outside: bool) -> Field:
    """Of a ring under a fit's pressure, from inside or from outside (Lame)."""

    def field(x: Array) -> Array:
        own, free = (inner, outer) if outside else (outer, inner)
        level = FIT / ((free / own) ** 2 - 1.0)
        r = np.linalg.norm(x, axis=-1)
        radial, hoop = level * (1.0 - (free / r) ** 2), level * (1.0 + (free / r) ** 2)
        c, s = x[..., 0] / r, x[..., 1] / r
        return strained(radial * c * c + hoop * s * s, radial * s * s + hoop * c * c, (radial - hoop) * c * s)

    return field


def under_ball(x: Array) -> Array:
    """Of the half space under Hertz's ball (Huber 1904; Johnson, Contact Mechanics, 3.4), the last coordinate its depth."""
    r, z, a = np.maximum(np.linalg.norm(x[..., :-1], axis=-1), 1e-4 * RADIUS), x[..., -1], RADIUS
    b = r * r + z * z - a * a
    size = np.sqrt(b * b + 4.0 * a * a * z * z)
    u = np.where(b > 0.0, 0.5 * (b + size), 2.0 * a * a * z * z / np.maximum(size - b, 1e-300))
    root = np.sqrt(np.maximum(u, 1e-300))
    down, turn, side = z / root, root / a * np.arctan2(a, root), (1 - NU) * u / (a * a + u)
    flat = (1 - 2 * NU) / 3.0 * (a / r) ** 2 * (1.0 - down**3)
    axial = -(down**3) * a * a * u / (u * u + a * a * z * z)
    radial = flat - axial + down * (side + (1 + NU) * turn - 2.0)
    hoop = -flat - down * (2 * NU + side - (1 + NU) * turn)
    shear = -r * z * z / (u * u + a * a * z * z) * a * a * root / (a * a + u)
    none = np.zeros(r.shape)
    if x.shape[-1] == 2:
        return BALL_PEAK * np.stack([radial, axial, hoop, shear, none, none], axis=-1)
    c, s = x[..., 0] / r, x[..., 1] / r
    plane = radial * c * c + hoop * s * s, radial * s * s + hoop * c * c, axial, (radial - hoop) * c * s
    return BALL_PEAK * np.stack([*plane, shear * s, shear * c], axis=-1)


FIELDS = {"ball": under_ball, "block": below, "hub": pressed(2.0, 3.0, True), "shaft": pressed(1.0, 2.0, False)}


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
        if solids.mesh.axisymmetric:
            volume *= 2.0 * np.pi * (shapes @ nodes)[..., 0]
        exact = FIELDS[body](shapes @ nodes)
        rest = exact - carried(group.kind, group.rule, rule[0]) @ stress[rows]
        for_both = [
            float((np.einsum("cqi,ij,cqj->cq", s, compliance, s) * volume).sum() / young) for s in (rest, exact)
        ]
        off, whole = off + for_both[0], whole + for_both[1]
    return float(np.sqrt(off / whole))


def main() -> None:
    """Print a row for each body, and the medians."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("cases", nargs="*", default=["line", "fit", "ball"])
    cases, ratios = parser.parse_args().cases, dict[tuple[str, int], list[float]]()
    print("| body | cells | n | estimate % | true % | ratio |\n|---|---|---|---|---|---|")
    for case, model, sizes, kinds in (
        ("line", hertz_line, (4, 8, 16), FLAT),
        ("fit", press_fit, (3, 6, 12), FLAT),
        ("ball", hertz_ball, (4, 6, 10), FLAT),
        ("ball", hertz_ball, (4, 6, 10), SOLID),
    ):
        for kind in kinds if case in cases else ():
            for n in sizes[: 2 if CELLS[kind].dim * CELLS[kind].degree == 6 else 3]:
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
                        group = f"{case}, {CELLS[kind].dim}D", CELLS[kind].degree
                        ratios.setdefault(group, []).append(estimates[body] / true)
                        row = f"{100 * estimates[body]:.2f} | {100 * true:.2f} | {estimates[body] / true:.2f}"
                        print(f"| {body} | {kind} | {n} | {row} |", flush=True)
    for (case, degree), values in ratios.items():
        spread = f"{min(values):.2f} to {max(values):.2f}, {len(values)} rows"
        print(f"{case}, degree {degree}: median {np.median(values):.2f}, {spread}")


if __name__ == "__main__":
    main()

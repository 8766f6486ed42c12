"""Local errors of the reported pressure, mid-nodes included: python bench/pressure/local_error.py [line | ball | rows].

Shares of the peak inside 0.9 of the contact's half width. References: Hertz's line (NAFEMS R0094) and Hertz's ball, whose
radius and peak follow from the force of the result (`tests/models/pressure.py` has the models).
rows: how errors fall with the size of facets at parts of the contact, and beside its edge.
"""

from __future__ import annotations

import sys
from pathlib import Path

import numpy as np

import abut

sys.path.insert(0, str(Path(__file__).parents[2] / "tests"))
from models import pressure as models

SIZES = (6, 10, 20)
BALLS = {"hex20": (4, 5, 7), "hex27": (7,), "tet10": (4, 5, 7), "wedge15": (7,), "hex8": (13,), "tet4": (13,)}
ROWS = (6, 10, 16, 26)


def line() -> None:
    print("cells, contactor, facets over 1.3 a: mean, largest in %")
    for cell in ("quad8", "quad9", "tri6", "quad4"):
        for contactor in ("block", "cylinder"):
            for n in SIZES:
                mean, most = models.everywhere(
                    abut.solve(models.line(cell, n, contactor)), models.LINE, models.LINE_PEAK
                )
                print(f"{cell:8s} {contactor:8s} {n:3d}: {100 * mean:5.2f} {100 * most:5.2f}", flush=True)


def ball() -> None:
    print("cells, contactor, facets of the ball over a: mean, largest in %")
    for cell, sizes in BALLS.items():
        for contactor in ("ball", "block"):
            for m in sizes:
                solution = abut.solve(models.quarter_ball(cell, m, contactor))
                radius, peak = models.quarter_ball_truth(solution)
                mean, most = models.everywhere(solution, radius, peak)
                fine = m * radius / models.FINE
                print(f"{cell:8s} {contactor:8s} {fine:4.1f}: {100 * mean:5.2f} {100 * most:5.2f}", flush=True)


def rows() -> None:
    """A cylinder ten times as flat, for which the formula is exact to 1e-3: largest errors inside parts of the half width,
    and farther inside than two facets, root mean squares over four places of the edge, with exponents of the size."""
    print("facets over a: error in % and its exponent inside 0.5 a, 0.7 a, 0.9 a, and two facets from the edge")
    before: tuple[int, list[float]] | None = None
    for n in ROWS:
        found = []
        for k in range(4):
            width = models.LINE * (1.0 + (k / 4.0 - 0.5) * 8.0 / models.LINE / n)
            contact = abut.solve(models.line("quad8", n, "block", 10.0, width)).contacts[0]
            used = contact.contactor.nodes >= 0
            x, p = contact.contactor.points[contact.contactor.nodes[used]], contact.pressure[used]
            peak = 0.1 * models.LINE_PEAK * width / models.LINE
            error = np.abs(p - models.ellipse(width, peak, 2)(x)) / peak
            limits = (0.5 * width, 0.7 * width, 0.9 * width, width - 16.0 / n)
            found.append([float(error[np.abs(x[:, 0]) < limit].max()) for limit in limits])
        value = np.sqrt(np.mean(np.square(found), axis=0)).tolist()
        rates = [""] * 4
        if before is not None:
            rates = [f"{np.log(old / new) / np.log(n / before[0]):.2f}" for old, new in zip(before[1], value)]
        row = "  ".join(f"{100 * v:6.3f} {rate:>5s}" for v, rate in zip(value, rates))
        print(f"{n * models.LINE / 8.0:5.1f}: {row}", flush=True)
        before = n, value


def main() -> None:
    parts = {"line": line, "ball": ball, "rows": rows}
    for name in sys.argv[1:] or parts:
        parts[name]()


if __name__ == "__main__":
    main()

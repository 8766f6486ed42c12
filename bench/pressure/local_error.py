"""Local errors of the reported pressure, mid-nodes included: python bench/pressure/local_error.py [line | ball | rows].

Shares of the peak inside 0.9 of the contact's half width. Theory's reference: Hertz's line (NAFEMS R0094) and Hertz's ball, whose
radius and peak follow from the force of the result (`tests/models/pressure.py` has the models).
rows: one more row of facets inside the contact, edges at eight places within a facet.
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
ROWS = (3, 4, 6, 8, 12, 16)


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
    """A cylinder ten times as flat, for which the formula is exact to 1e-3; largest error farther than one facet from the
    last one in contact, as the root mean square over eight places of the edge."""
    print("facets over a: error in %, its exponent")
    before = None
    for n in ROWS:
        found = []
        for k in range(8):
            width = models.LINE * (1.0 + (k / 8.0 - 0.5) / n)
            size = models.LINE / n
            model = models.line("quad8", round(8.0 / size), "block", 10.0, width)
            contact = abut.solve(model).contacts[0]
            used = contact.contactor.nodes >= 0
            x, p = contact.contactor.points[contact.contactor.nodes[used]], contact.pressure[used]
            peak = 0.1 * models.LINE_PEAK * width / models.LINE
            error = np.abs(p - models.ellipse(width, peak, 2)(x)) / peak
            found.append(error[np.abs(x[:, 0]) < width - 2.0 * 8.0 / round(8.0 / size)].max())
        value = float(np.sqrt(np.mean(np.square(found))))
        rate = "" if before is None else f"{np.log(before[1] / value) / np.log(n / before[0]):.2f}"
        print(f"{n:3d}: {100 * value:6.3f}  {rate}", flush=True)
        before = n, value


def main() -> None:
    parts = {"line": line, "ball": ball, "rows": rows}
    for name in sys.argv[1:] or parts:
        parts[name]()


if __name__ == "__main__":
    main()

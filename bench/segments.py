"""Segments cut and integrated a second on one core, flat interfaces with non-matching grids.

python bench/segments.py [--cells N]
"""

from __future__ import annotations

import argparse
import time

from abut.interface.coupling import couple, surface_degree
from abut.mesh.make import box, join


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--cells", type=int, default=70, help="contactor facets along each side")
    n = parser.parse_args().cells
    for cell in ("tet4", "hex8", "tet10", "hex20", "hex27"):
        lower = box(cells=(n, n, 1), cell=cell)
        upper = box(z=(1.0, 2.0), cells=(n + 11, n + 12, 1), cell=cell)
        mesh = join({"lower": lower, "upper": upper})
        contactor, target = mesh.surface("lower.top"), mesh.surface("upper.bottom")
        start = time.perf_counter()
        count = int(couple(contactor, target, surface_degree(contactor)).segments.sum())
        spent = time.perf_counter() - start
        print(f"{cell:6s} {count:7d} segments in {spent:6.2f} s: {count / spent:9.0f} a second")


if __name__ == "__main__":
    main()

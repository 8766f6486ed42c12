"""The inf-sup constant of an interface with many multipliers, by Lanczos: time and memory.

python bench/infsup.py [--multipliers N]
"""

from __future__ import annotations

import argparse
import os
import resource
import sys
import time

os.environ.setdefault("OMP_NUM_THREADS", "1")

import numpy as np

import abut
from abut.mesh.make import box, join
from abut.verify import inf_sup
from abut.verify.infsup import DENSE

COARSER = 119 / 141  # facets of the target along an edge, for each of the contactor: nodes never meet
LAYERS = (0.0, 1.0, 2.0, 4.0, 8.0)  # in facet sizes: fine where the interface's short waves decay, two layers deep


def slab(n: int, up: bool) -> abut.Mesh:
    """Unit square of n x n hex8 facets, eight facets thick; above or below z = 0."""
    heights = [layer / n for layer in LAYERS]
    z = heights if up else [-h for h in reversed(heights)]
    return box(z=z, cells=(n, n, len(z) - 1), cell="hex8")


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--multipliers", type=int, default=20_000, help=f"about how many (more than {DENSE})")
    wanted = parser.parse_args().multipliers
    if wanted <= DENSE:
        parser.error(f"--multipliers: expected more than {DENSE}, from where on Lanczos is used, got {wanted}")
    n = max(round(wanted**0.5) - 1, 1)  # n + 1 nodes along each edge
    target = round(COARSER * n)
    parts = {"lower": slab(n, False), "upper": slab(target, True)}
    model = abut.Model(
        join(parts),
        [abut.Solid(body, abut.LinearElastic(1.0, 0.3)) for body in parts],
        [abut.Support("lower.bottom", x=0, y=0, z=0), abut.Support("upper.top", x=0, y=0, z=0)],
        contacts=[abut.Contact(contactor="lower.top", target="upper.bottom")],
    )
    start = time.perf_counter()
    result = inf_sup(model)
    seconds = time.perf_counter() - start
    level = result.levels[0]
    peak = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / (2**20 if sys.platform != "darwin" else 2**30)
    print(f"{level.multipliers} multipliers, {3 * len(model.mesh.points)} displacements")
    print(f"beta (H^-1/2) {level.trace:.4f}, beta (h M) {level.mesh:.4f}: {result.verdict}")
    bound = sum(np.tanh(LAYERS[-1] / cells) for cells in (n, target)) ** 0.5
    print(f"beta (H^-1/2) of a constant pressure, which thin slabs feel the least: {bound:.4f} by theory")
    print(f"{seconds:.1f} s, {peak:.2f} GB at most")


if __name__ == "__main__":
    main()

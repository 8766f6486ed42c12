"""A model of time and memory on many processes: python bench/scaling/model.py

Constants were read off runs of bench/scaling/run.py (flat-hex8, one core of an x86-64 server each); network and latency
are those of a usual cluster. Everything is per displacement, per multiplier, or per Krylov iteration: docs/scaling.md says
what is what.
"""

from __future__ import annotations

from dataclasses import dataclass
from math import log2

BASE = 0.13  # GB: interpreter, libraries
PART = 3.7e-6  # GB a displacement: stiffness, multigrid, Krylov vectors
OWN = 0.55e-6  # GB a displacement on process 0: mesh, supports, loads, vectors, report
COUPLING = 2.7e-6  # GB a multiplier on process 0
SURFACES = 0.3e-6  # GB a multiplier on every process while surfaces are cut
ASSEMBLY = 7e-6  # s a displacement: stiffness, matrix of PETSc, internal forces, stresses, output
SETUP = 20e-6  # s a displacement: multigrid
ITERATION = 0.95e-6  # s a displacement and Krylov iteration
ALONE = 2.2e-6  # s a displacement: what process 0 does by itself
INTERFACE = 1.1e-6  # s a multiplier and iteration, on process 0
CUTTING = 50e-6  # s a multiplier: cutting, by the processes that have facets
TRAFFIC = 340.0  # bytes a displacement from or to process 0
PIPE = 1.5e9  # bytes a second through process 0: packing, sending, unpacking
MESSAGES, LATENCY = 60, 10e-6  # products and sums an iteration on all levels, s each time log2(P)


@dataclass(frozen=True)
class Estimate:
    """Seconds of a run, of it on process 0 alone, and GB of process 0 and of the others."""

    seconds: float
    alone: float
    first: float
    others: float


def estimate(n: float, processes: int, iterations: int = 45) -> Estimate:
    """Of a flat contact of two blocks with ``n`` displacements."""
    multipliers = 0.8 * (n / 3.0) ** (2.0 / 3.0)
    share = n / processes
    shared = share * (ASSEMBLY + SETUP + iterations * ITERATION) + multipliers * CUTTING / processes ** (2.0 / 3.0)
    exchanged = 0.0 if processes == 1 else n * TRAFFIC * (1.0 - 1.0 / processes) / PIPE
    waiting = iterations * MESSAGES * LATENCY * log2(processes) if processes > 1 else 0.0
    alone = n * ALONE + iterations * multipliers * INTERFACE + exchanged
    everyone = BASE + share * PART + multipliers * SURFACES
    return Estimate(shared + waiting + alone, alone, everyone + n * OWN + multipliers * COUPLING, everyone)


def main() -> None:
    print(
        "| displacements | processes | s | of it process 0 alone | GB, process 0 | GB, the others |\n"
        + "|---" * 6
        + "|"
    )
    for n in (391_287, 10_000_000, 100_000_000):
        for processes in (1, 2) if n < 1e6 else (10, 100, 1000):
            e = estimate(n, processes)
            spaced = f"{n:,}".replace(",", " ")
            print(f"| {spaced} | {processes} | {e.seconds:.3g} | {e.alone:.2g} | {e.first:.2g} | {e.others:.2g} |")


if __name__ == "__main__":
    main()

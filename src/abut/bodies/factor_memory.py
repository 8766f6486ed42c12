"""Memory of solvers for the stiffness of bodies, from the number of free displacements."""

from __future__ import annotations

from dataclasses import dataclass


@dataclass(frozen=True)
class Memory:
    """megabytes = base + factor n^power, for n free displacements."""

    factor: float
    power: float
    base: float = 100.0

    def megabytes(self, n: int) -> float:
        return self.base + self.factor * float(n) ** self.power


MEMORY = {  # by dimension, solver and degree of the cells: fitted to docs/performance.md (3D) and docs/check.md
    (2, "direct", 1): Memory(2.3e-3, 1.0),
    (2, "direct", 2): Memory(3.1e-3, 1.0),
    (3, "direct", 1): Memory(2.7e-4, 4 / 3),
    (3, "direct", 2): Memory(4.5e-4, 4 / 3),
    (3, "amg", 1): Memory(4.4e-3, 1.0, 60.0),
    (3, "amg", 2): Memory(1.0e-2, 1.0, 60.0),
}
MEMORY_LAYER = Memory(1.0e-2, 1.0)  # solver "direct", quadratic cells in one layer: 837 MB for 77409, 3127 for 306009
# Solver "direct", tet10 whose pressures are continuous: 1.23 times as much, 432 MB for 26460 (full 351), 900 for 56862 (734)
WIDE = Memory(5.6e-4, 4 / 3)


def with_wide(narrow: Memory, n: int, share: float) -> float:
    """Megabytes of the direct solver, where a share of the n displacements has pressures that are continuous; narrow: of
    none."""
    return (1.0 - share) * narrow.megabytes(n) + share * WIDE.megabytes(n)

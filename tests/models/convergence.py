"""How Newton's method ends."""

from __future__ import annotations

import abut

DONE = 1e-9  # tolerance of equilibrium
ORDER, FACTOR = 1.7, 10.0  # what is left is at most FACTOR times the ORDER-th power of what was left before


def quadratic_falls(
    solution: abut.Solution, factor: float = FACTOR, rounding: float = 1e-10
) -> tuple[int, list[tuple[int, float, float]]]:
    """How many pairs of what is left there are among the last three iterations of each load step, all statuses final, and
    those that do not fall quadratically, with the step's number. rounding: as much may be left by chance. What comes after
    nothing is left any more is the same step once again, with the functions and gaps that belong to its end."""
    falls, slow = 0, []
    for step in solution.steps:
        rows = step.iterations[-3:]
        left = [max(row.residual, row.contact_residual) for row in rows]
        pairs = [(step.number, a, b) for a, b, row in zip(left, left[1:], rows) if not row.changed and a > DONE]
        falls += len(pairs)
        slow += [(number, a, b) for number, a, b in pairs if b > max(rounding, factor * a**ORDER)]
    return falls, slow

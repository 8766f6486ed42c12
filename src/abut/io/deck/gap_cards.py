"""*GAP: elements GAPUNI as springs that push along a global axis once their gap is closed."""

from __future__ import annotations

import numpy as np

from abut.io.deck.cards import Card

TENSION = 1e-3  # where the card leaves it out, as CalculiX has it
WIDEST = 100.0  # of the table, over the width of its bend: beyond it the law is straight within 1e-4 of the tension
ROWS = 121
NARROW = 1e-9  # bends narrower than this, over the size of the gap or 1, are corners
Table = tuple[tuple[float, float], ...]


def gap_law(card: Card) -> tuple[int, Table, bool]:
    """Direction 1 to 3, the force over what the first node moves along it less what the second does, and whether the card
    has no spring constant: the force is per stiffness then, none when open.

    With the penetration p beyond the clearance the force is K p (1/2 + atan(p / e) / pi), e = pi T / K: K p once closed, and
    the tension T when open. As a table, within .002 T. Source: CalculiX's manual, contact by springs.

    Raises InputError for directions that are none of the global axes, and for stiffnesses that are not > 0."""
    line = card.first("clearance and direction")
    clearance = line.number(0, "clearance")
    normal = np.array([line.number(i, "direction", 0.0) for i in (1, 2, 3)])
    axes = np.flatnonzero(np.abs(normal) > 1e-6 * np.abs(normal).max())
    if len(axes) != 1:
        raise line.error("expected a direction along one global axis; use *CONTACT PAIR for gaps aslant")
    rigid = not line.text(5)
    stiffness, tension = line.number(5, "spring constant", 1.0), line.number(6, "tension", TENSION)
    if stiffness <= 0.0 or tension < 0.0:
        raise line.error(f"expected a spring constant > 0 and a tension >= 0, got {stiffness:g} and {tension:g}")
    sign = float(np.sign(normal[axes[0]]))
    tension = 0.0 if rigid else tension
    rows = [(clearance + p, f) for p, f in _pushing(stiffness, tension, max(abs(clearance), 1.0))]
    return int(axes[0]) + 1, tuple(sorted((sign * u, sign * f) for u, f in rows)), rigid


def _pushing(stiffness: float, tension: float, size: float) -> Table:
    """Penetration and force, on beyond the last two rows."""
    width = np.pi * tension / stiffness
    if width < NARROW * size:
        return (-size, 0.0), (0.0, 0.0), (size, stiffness * size)
    p = np.sinh(np.linspace(-1.0, 1.0, ROWS) * np.arcsinh(WIDEST))
    f = tension * p * (np.pi / 2.0 + np.arctan(p))
    open_, closed = (-2.0 * WIDEST, float(f[0])), (2.0 * WIDEST, float(f[-1] + np.pi * tension * WIDEST))
    every = [open_, *zip(p.tolist(), f.tolist()), closed]
    return tuple((width * a, b) for a, b in every)

"""Which of two surfaces should be the contactor: the one rule, which `auto = true` and `abut check` both go by.

1. A rigid side never: the pressure needs the displacements of its own side to be unique.
2. The softer side, which takes the shape of the other one: a stiff contactor that is finer than its target touches the
   target's corners one by one (``abut.benchmarks.contrast``).
3. But not a side that is mostly bare while the other is covered: its pressure would stand on facets of which a small part
   only lies opposite anything.
4. Among equals the finer side: its pressure has the better resolution, and gaps are closed in the mean over smaller facets.
   Unless it is several times finer than a curved target: its pressure would show every kink between the target's facets.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

ALIKE = 1.1  # ratio of moduli up to which neither side is the softer one
BARE = 0.55  # share of a side's facets that lies opposite: with less a pressure stands on facets that are mostly bare
BARER = 0.1  # difference of such shares that is worth a choice
FINER = 1.25  # ratio of facet sizes from which on the finer side is told apart where a line of the certificate fails
TWICE = 2.0  # ratio of facet sizes that is worth a word before the run
MUCH_FINER = 3.0  # ratio from which on a finer contactor would show the kinks of a curved target
FLAT = np.cos(np.deg2rad(1.0))  # facets all within that of one plane have no kinks to show
MARGIN = 1.1  # by which sizes and shares must pass their limits for the choice to be clear: both are measured

REASONS = {
    "softer": "softer",
    "covered": "the facets of the other side reach far beyond this one",
    "kinks": "the other side is much finer and would show the faceting of this one",
    "finer": "finer",
    "alike": "first of two alike",
}


@dataclass(frozen=True)
class Side:
    """What the choice looks at, of those facets of a surface that face the other one.

    modulus: E / (1 - nu^2), infinite for a rigid side; size: median of the facets, a length; covered: share of their area
    that lies opposite the other side; flat: whether they lie in one plane."""

    modulus: float
    size: float
    covered: float
    flat: bool


@dataclass(frozen=True)
class Choice:
    """contactor: 0 or 1, the number of the side; rule: a key of ``REASONS``; clear: it matters, and not by a trace."""

    contactor: int
    rule: str
    clear: bool

    @property
    def reason(self) -> str:
        """Why, in words."""
        return REASONS[self.rule]


def side(
    size: NDArray[np.float64],
    area: NDArray[np.float64],
    normal: NDArray[np.float64],
    opposite: float,
    modulus: float,
) -> Side:
    """Measure a side by those of its facets that face the other one: size, area (n,), mean unit normal (n, dim).

    opposite: how much of their area lies opposite the other side. Areas are those of the section where the surface is
    axisymmetric."""
    return Side(
        modulus=modulus,
        size=float(np.median(size)),
        covered=min(opposite / float(area.sum()), 1.0),
        flat=bool((normal @ normal[0]).min() > FLAT),
    )


def choose(one: Side, other: Side) -> Choice:
    """The side that should be the contactor."""
    sides = one, other
    soft = int(other.modulus < one.modulus)
    stiff = sides[1 - soft].modulus
    if np.isinf(stiff) and np.isfinite(sides[soft].modulus):
        return Choice(soft, "softer", True)
    unlike = stiff > ALIKE * sides[soft].modulus
    if unlike and not _bare(sides[soft], sides[1 - soft]):
        return Choice(soft, "softer", True)
    for number in (0, 1):
        if _bare(sides[1 - number], sides[number]):
            return Choice(number, "covered", sides[1 - number].covered * MARGIN < BARE)
    return _by_size(one, other)


def much_finer(contactor: Side, target: Side) -> bool:
    """Whether the contactor's pressure would show the kinks of the target."""
    return target.size > MUCH_FINER * contactor.size and not target.flat


def _bare(side: Side, other: Side) -> bool:
    return side.covered < BARE and side.covered < other.covered - BARER


def _by_size(one: Side, other: Side) -> Choice:
    sides = one, other
    fine = int(other.size < one.size * (1.0 - 1e-9))
    coarse = 1 - fine
    ratio = sides[coarse].size / sides[fine].size
    if much_finer(sides[fine], sides[coarse]):
        return Choice(coarse, "kinks", ratio > MARGIN * MUCH_FINER)
    kinks_near = not sides[coarse].flat and ratio * MARGIN > MUCH_FINER
    return Choice(fine, "finer" if ratio > 1.0 + 1e-9 else "alike", ratio > TWICE and not kinks_near)

"""Which of two surfaces should be the contactor: the one rule, by which abut chooses, and `abut check` and the advice judge
what the user has named.

1. A rigid side never, nor one whose points supports hold: the pressure needs the displacements of its own side. Nor one
   with a facet that has no normal somewhere: pressure is integrated along the contactor's normals.
2. The softer side, which takes the shape of the other one: a stiff contactor that is finer than its target touches the
   target's corners one by one (``abut.benchmarks.contrast``). Unless it is finer by half and softer by three times at most:
   what a target gives way, in facets that the contactor sees, is its share of what both sides do, a quarter then.
3. But not a side that is mostly bare while the other is covered: its pressure would stand on facets of which a small part
   only lies opposite anything.
4. Before these, at small displacements, unless one is softer by far, the side of which a sharp edge presses on a face of the
   other one, as a knife does: a node lies at the edge, and the gap there is that of the edge. A face averages it over facets
   on which it opens.
5. Among equals the coarser side: the other one follows what its pressure can show, where a finer contactor would show the
   corners of its target. Where sizes hardly differ, the one that is less bare.

``bench/sides`` has the study that this comes from, docs/verification/pressure.md its numbers.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

ALIKE = 1.1  # ratio of moduli up to which neither side is the softer one
BARE = 0.55  # share of a side's facets that lies opposite: with less a pressure stands on facets that are mostly bare
BARER = 0.1  # difference of such shares that is worth a choice
FINEST = 1.5  # ratio of facet sizes from which on they outweigh softness, up to STIFFER
FINER = 1.25  # ratio of facet sizes from which on one side counts as finer than the other
LEANS = 0.01  # sine between the sides at an edge: about what a facet gives way at strains of metals, over its size
MARGIN = 1.1  # by which shares must pass their limits for the choice to be clear: they are measured
SAME_SIZE = 1e-3  # relative difference of sizes that is none
STIFFER = 3.0  # ratio of moduli from which on one side is softer by far
TWICE = 2.0  # ratio of facet sizes that is worth a word
CLOSE = 0.05  # of the sum of two facets' sizes: gaps within that of the smallest one lie where contact begins
NEAR = 0.5  # of the sum of two facets' sizes: the distance within which they face each other

REASONS = {
    "rigid": "the other side is rigid, or held",
    "normals": "a facet of the other side has no normal at one of its points",
    "softer": "softer",
    "edge": "its edge presses on a face of the other side",
    "covered": "the facets of the other side reach far beyond this one",
    "coarser": "coarser",
    "alike": "first of two alike",
}


@dataclass(frozen=True)
class Side:
    """What the choice looks at, of those facets of a surface that face the other one.

    modulus: E / (1 - nu^2), infinite for a rigid side; size: median of the facets where contact begins, a length; covered:
    share of the area of all of them that lies opposite the other side; normals: whether each facet has one everywhere;
    tetrahedra: whether its cells are such of first order, which give way at their corners alone; edge: whether contact
    begins where a sharp edge of it presses on a face of the other side."""

    modulus: float
    size: float
    covered: float
    normals: bool = True
    tetrahedra: bool = False
    edge: bool = False


@dataclass(frozen=True)
class Choice:
    """contactor: 0 or 1, the number of the side; rule: a key of ``REASONS``; clear: it matters, and not by a trace."""

    contactor: int
    rule: str
    clear: bool

    @property
    def reason(self) -> str:
        """Why, in a few words."""
        return REASONS[self.rule]

    def why(self, one: Side, other: Side) -> str:
        """Why, with the numbers of both sides."""
        chosen, left = (one, other)[:: 1 - 2 * self.contactor]
        if self.rule == "softer":
            return f"softer, E/(1-nu^2) {chosen.modulus:.3g} against {left.modulus:.3g}"
        if self.rule == "coarser":
            return f"coarser, facets of {chosen.size:.3g} against {left.size:.3g}"
        return self.reason


def side(
    size: NDArray[np.float64], area: NDArray[np.float64], opposite: float, modulus: float, normals: bool = True
) -> Side:
    """Measure a side. size: (n,) of its facets where contact begins; area: (m,) of all that face the other side, as if plane
    where the surface is axisymmetric; opposite: how much of that area lies opposite the other side."""
    return Side(modulus, float(np.median(size)), min(opposite / float(area.sum()), 1.0), normals)


def where_contact_begins(gap: NDArray[np.float64], sizes: NDArray[np.float64]) -> NDArray[np.bool_]:
    """Which points are hardly further apart than the nearest ones. gap, sizes: (n,) sum of both facets' sizes, lengths."""
    return np.asarray(gap - gap.min() <= CLOSE * sizes)


def choose(one: Side, other: Side) -> Choice:
    """The side that should be the contactor."""
    sides = one, other
    soft = int(other.modulus < one.modulus)
    stiff = sides[1 - soft].modulus
    if np.isinf(stiff) and np.isfinite(sides[soft].modulus):
        return Choice(soft, "rigid", True)
    if one.normals != other.normals:
        return Choice(int(other.normals), "normals", True)
    presses = [number for number in (0, 1) if sides[number].edge and not sides[1 - number].edge]
    if presses and stiff <= STIFFER * sides[soft].modulus:
        return Choice(presses[0], "edge", True)
    by_far = stiff > ALIKE * sides[soft].modulus and not _outweighed(sides[soft], sides[1 - soft])
    if by_far and not _bare(sides[soft], sides[1 - soft]):
        return Choice(soft, "softer", True)
    for number in (0, 1):
        if _bare(sides[1 - number], sides[number]):
            return Choice(number, "covered", sides[1 - number].covered * MARGIN < BARE)
    coarse = int(other.size > one.size * (1.0 + SAME_SIZE))
    ratio = sides[coarse].size / sides[1 - coarse].size
    if ratio < FINER and sides[coarse].covered < sides[1 - coarse].covered - BARER:
        return Choice(1 - coarse, "covered", False)
    return Choice(coarse, "coarser" if ratio > 1.0 + SAME_SIZE else "alike", ratio > TWICE)


def shows_facets(contactor: Side, target: Side) -> bool:
    """Whether a contactor may touch the facets of its target one by one: the rule takes the other side, and it is finer, by
    a little if it is also stiffer, or lies on tetrahedra of first order, else by far: less does no harm that would show."""
    choice = choose(contactor, target)
    finer = target.size / contactor.size
    clearly = contactor.modulus > STIFFER * target.modulus or target.tetrahedra
    return choice.contactor == 1 and choice.rule in ("softer", "coarser") and finer > (FINER if clearly else TWICE)


def shows_nodes(contactor: Side, target: Side) -> bool:
    """Whether a contactor may show what single nodes of its target take: the rule takes the other side as the softer one by
    far, and it is of tetrahedra of first order, whose shares at planes of symmetry are put right on the contactor only."""
    choice = choose(contactor, target)
    stiffer = contactor.modulus > STIFFER * target.modulus
    return choice.contactor == 1 and choice.rule == "softer" and stiffer and target.tetrahedra


def _outweighed(soft: Side, stiff: Side) -> bool:
    """Whether facets say more than softness: the stiffer side is coarser by far, not stiffer by far, nor mostly bare."""
    alike = stiff.modulus <= STIFFER * (1.0 + SAME_SIZE) * soft.modulus
    return alike and stiff.size > FINEST * soft.size and not _bare(stiff, soft)


def _bare(side: Side, other: Side) -> bool:
    return side.covered < BARE and side.covered < other.covered - BARER

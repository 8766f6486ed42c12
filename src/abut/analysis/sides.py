"""Whether a contactor that the user has named shows the facets of its target, or what single nodes of it take: the
certificate's line "sides"."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np
from numpy.typing import NDArray

from abut.analysis.pressure_error import hollow
from abut.contact.contactor_choice import Side, choose, shows_facets, shows_nodes
from abut.contact.geometry import split_at_creases
from abut.contact.nodal_recovery import at_points
from abut.problem.pair import Pair
from abut.solution import Check

LIMIT = 0.045  # seen where contact is five facets wide to each side: above it the pressure is off by 4 % or more
Array = NDArray[np.float64]


def sides_check(
    pair: Pair, sides: tuple[Side, Side] | None, nodal: Array, carried: Array, none: float = 0.0
) -> Iterator[Check]:
    """A line where the rule would take the other side because this one is finer and not softer, or lies on much softer
    tetrahedra of first order; theory (P17).

    sides: contactor and target as the choice sees them; nodal: (n_facets, 9) reported pressure; carried:
    (n_target_facets, 9) the same at the target's nodes; none: pressure that is taken for none."""
    if sides is None:
        return
    largest = float(np.nanmax(np.abs(nodal), initial=0.0))
    pressed, found = largest > none, []
    if shows_facets(*sides):
        value = unresolved(pair, nodal, carried) if pressed else 0.0
        found.append((value, f"share of the pressure that the target's facets cannot follow, where {against(*sides)}"))
    if shows_nodes(*sides):
        points = at_points(split_at_creases(pair.contactor)[0], nodal)
        stiffer = sides[0].modulus / sides[1].modulus
        meaning = (
            "how far the pressure on planes of symmetry lies below that around, over the largest, where the contactor is "
            f"{stiffer:.2g} times stiffer than tetrahedra of first order, whose nodes take unequal shares there"
        )
        found.append((hollow(pair, points, largest) if pressed else 0.0, meaning))
    if found:
        value, meaning = max(found)
        yield Check(pair.contact.name, "sides", value, LIMIT, meaning)


def unresolved(pair: Pair, nodal: Array, carried: Array) -> float:
    """Integral of the size of p less its interpolation between the target's nodes, over the integral of p."""
    at = pair.coupling.gap_samples
    if at is None or not len(at.gap):
        return 0.0
    own = (at.contactor_shapes * np.nan_to_num(nodal)[at.facet]).sum(axis=1)
    other = (at.target_shapes * np.nan_to_num(carried)[at.target_facet]).sum(axis=1)
    area = pair.coupling.covered / np.maximum(np.bincount(at.facet, minlength=len(pair.contactor)), 1)
    whole = float((area[at.facet] * np.abs(own)).sum())
    return float((area[at.facet] * np.abs(own - other)).sum()) / whole if whole > 0.0 else 0.0


def against(contactor: Side, target: Side) -> str:
    """What speaks against the contactor."""
    finer = f"the contactor is {target.size / contactor.size:.2g} times finer than its target"
    if choose(contactor, target).rule == "softer":
        return f"{finer} and {contactor.modulus / target.modulus:.2g} times stiffer"
    return finer

"""The two sides of a sector of cyclic symmetry: which nodes belong together."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from abut.io.deck.faces import connectivity
from abut.io.deck.groups import Groups
from abut.io.deck.reasons import DeckError
from abut.io.deck.record import CyclicSymmetry, Deck, Numbers
from abut.sectors import matched

TINY = 1e-12  # of the largest coefficient: a term that is none
Vector = NDArray[np.float64]


@dataclass(frozen=True)
class Partners:
    """Slave nodes (n,) and the master nodes (n,) one sector on, in turn; turn: (3, 3) from master to slave, by a positive
    angle about the axis where ``forward``."""

    slaves: Numbers
    masters: Numbers
    turn: Vector
    forward: bool


def partners(deck: Deck, groups: Groups, symmetry: CyclicSymmetry) -> Partners:
    """The nodes of both sides. Raises DeckError where one has no partner."""
    nodes = {}
    for side in (symmetry.slave, symmetry.master):
        surface = deck.surfaces[side]
        side_nodes = surface.nodes
        if side_nodes is None:
            side_nodes = np.concatenate([n.ravel() for n in connectivity(deck, groups.rows(side)).values()])
        nodes[side] = np.intersect1d(side_nodes, groups.used)
    a, axis = np.array(symmetry.a), np.array(symmetry.b) - np.array(symmetry.a)
    x, y = (deck.points[np.searchsorted(deck.nodes, nodes[side])] for side in (symmetry.slave, symmetry.master))
    found = matched(x, y, symmetry.sectors, a, axis)
    if not found.fits:
        worst = int(nodes[symmetry.slave][int(found.distance.argmax())])
        raise DeckError(
            symmetry.place,
            f"*CYCLIC SYMMETRY MODEL: node {worst} of '{symmetry.slave}' has no partner on "
            f"'{symmetry.master}' one sector on; mesh both sides alike",
        )
    turn = np.where(np.abs(found.turn) < TINY, 0.0, found.turn)
    return Partners(nodes[symmetry.slave], nodes[symmetry.master][found.match], turn, found.forward)


def turned_side(deck: Deck, groups: Groups) -> Numbers:
    """The slave nodes of cyclic symmetry. Raises DeckError where vibrations that differ between sectors would need more than
    a phase between these nodes and their partners."""
    found = [partners(deck, groups, symmetry) for symmetry in deck.cyclic]
    slaves = np.unique(np.concatenate([part.slaves for part in found]))
    masters = np.unique(np.concatenate([part.masters for part in found]))
    place, what = deck.cyclic[0].place, ""
    linked = {node for equation in deck.equations for node, *_ in equation.terms}
    if len({part.forward for part in found}) > 1 or len({symmetry.sectors for symmetry in deck.cyclic}) > 1:
        what = "the slaves lie on different sides of the sector, or the numbers of sectors differ: give all alike"
    elif len(on_both := np.intersect1d(slaves, masters)):
        what = f"node {int(on_both[0])} is on both sides, as on the axis: leave a hole there"
    elif linked & set(slaves.tolist()):
        what = f"node {min(linked & set(slaves.tolist()))} of the slave stands in an equation, too: give its nodes none"
    if what:
        raise DeckError(place, f"*CYCLIC SYMMETRY MODEL: nodal diameters other than 0 are not found where {what}")
    return slaves

"""Shells, membranes, beams and trusses of a deck as solids, and plane elements beside others."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from abut.decks.beams import with_thick_beams
from abut.decks.in_plane import with_planes_held
from abut.decks.membranes import with_thick_membranes
from abut.decks.plane_solids import with_solid_planes
from abut.decks.shell_edges import quadratic
from abut.decks.thin import with_thick_shells
from abut.decks.trusses import with_thick_trusses
from abut.io.deck.record import Deck, Equation, Numbers


def expanded(deck: Deck, finite: bool) -> Deck:
    """The deck with solids in place of shells, membranes, beams and trusses. ``finite``: at large displacements.

    Raises InputError for what has no section or no size, and for what cannot be said of solids."""
    made, middles, ends = quadratic(with_planes_held(deck))
    return with_solid_planes(thickened(made, middles, ends, finite, rigid=True))


def thickened(deck: Deck, middles: Numbers, ends: Numbers, finite: bool, rigid: bool) -> Deck:
    """The same of one with quadratic shells. middles: (m,) nodes that were added in the middle of edges, whose ``ends`` are
    (m, 2): on linear solids they go with both ends, as the edge of the solid does; not in a knot, which is rigid. rigid:
    shells keep their thickness where their nodes are held or loaded, as in CalculiX."""
    new = with_thick_trusses(with_thick_beams(with_thick_shells(deck, finite, rigid), finite))
    new = with_thick_membranes(new)
    rows = [block.nodes.ravel() for block in deck.blocks if not block.type.thin]
    on = np.isin(ends, np.unique(np.concatenate(rows))).all(axis=1) if rows else np.zeros(len(ends), bool)
    on &= np.isin(middles, list(new.thin))
    return replace(new, equations=(*new.equations, *_straight(deck, middles[on], ends[on])))


def _straight(deck: Deck, middles: Numbers, ends: Numbers) -> Sequence[Equation]:
    place = deck.blocks[0].place
    return [
        Equation(((m, k, 2.0), (a, k, -1.0), (b, k, -1.0)), place)
        for m, (a, b) in zip(middles.tolist(), ends.tolist())
        for k in (1, 2, 3)
    ]

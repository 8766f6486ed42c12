"""Nodes that a deck binds by products of displacements."""

from __future__ import annotations

from dataclasses import dataclass

from abut.io.deck.reasons import Place


@dataclass(frozen=True)
class Gathered:
    """kind: STRAIGHT, PLANE, MEANROT, BEAM or DIST of *MPC; nodes; axis and pilot: of MEANROT, the node whose direction 1 is
    the turn; pilot and limit: of DIST, the node whose direction 1 is held, and how much farther apart nodes may get."""

    kind: str
    nodes: tuple[int, ...]
    place: Place
    axis: tuple[float, ...] = ()
    pilot: int = 0
    limit: float = 0.0

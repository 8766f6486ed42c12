"""Ties of surfaces that look the same way, as bodies that lie in each other have them: node by node, in equations."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from abut.bodies.loads import stress_load, surface_area
from abut.dofs import n_places
from abut.io.deck.faces import nodes_of_rows
from abut.io.deck.groups import Groups, pieces
from abut.io.deck.reasons import DeckError
from abut.io.deck.record import Deck, Equation, Pair
from abut.io.deck.ties import near
from abut.mesh.mesh import Mesh
from abut.mesh.read import build
from abut.mesh.surface import Surface
from abut.probing.closest_points import feet

SAME_WAY = 0.9  # of two surfaces that cannot touch: product of their mean normals (short where a surface bends round)
FADED = 1e-12  # a shape function at a node that is none


def looks(surface: Surface) -> NDArray[np.float64]:
    """The mean of a surface's normals, shorter than 1 where it is not plane."""
    push = stress_load(surface, np.eye(surface.dim)).reshape(-1, surface.dim).sum(axis=0)
    return np.asarray(push / max(surface_area(surface), 1e-300))


def with_ties_by_node(deck: Deck, notes: list[str]) -> Deck:
    """The deck with every *TIE of surfaces that look the same way as equations: a slave node within the position tolerance
    moves as the point of the master that is nearest to it. ``notes`` gets them. Raises InputError for slaves of which no
    node has such a point."""
    ties = [pair for pair in deck.pairs if pair.is_tie and pair.slave != pair.master]
    if not ties:
        return deck
    groups = Groups(deck)
    for piece in pieces(deck):
        groups.body(piece.name, piece.elements)
    sides = {name: groups.surface(name) for pair in ties for name in (pair.slave, pair.master)}
    mesh = build(Mesh, groups.raw(), deck.path)
    found = {name: mesh.surface(side) for name, side in sides.items()}
    bound: set[int] = set()
    more: list[Equation] = []
    gone: list[Pair] = []
    for pair in ties:
        if looks(found[pair.slave]) @ looks(found[pair.master]) <= SAME_WAY:
            continue
        equations = _equations(deck, groups, pair, found[pair.master], mesh, bound)
        notes.append(
            f"{pair.place}: *TIE '{pair.name}': the surfaces look the same way, as bodies that lie in each other: its "
            f"{n_places(len(equations), mesh.dim)} slave nodes are tied one by one, to the nearest points of the master"
        )
        more += equations
        gone.append(pair)
    left = tuple(pair for pair in deck.pairs if not any(pair is other for other in gone))
    return replace(deck, pairs=left, equations=(*deck.equations, *more))


def _equations(deck: Deck, groups: Groups, pair: Pair, master: Surface, mesh: Mesh, bound: set[int]) -> list[Equation]:
    """Of one tie; ``bound`` has the nodes that follow others already, and gets these."""
    nodes = nodes_of_rows(deck, near(deck, groups, pair).rows)
    slaves = np.array([n for n in np.unique(nodes[nodes >= 0]).tolist() if n not in bound], np.int64)
    foot = feet(master, mesh.points[np.searchsorted(groups.used, slaves)])
    if not len(foot.point):
        raise DeckError(pair.place, f"*TIE: no node of '{pair.slave}' lies over '{pair.master}'; choose other faces")
    first = np.unique(foot.point, return_index=True)[1]
    result = []
    for i in first.tolist():
        slave, local = int(slaves[foot.point[i]]), master.nodes[foot.facet[i]]
        shares = [(int(groups.used[local[a]]), w) for a, w in enumerate(foot.weights[i]) if abs(w) > FADED]
        for direction in range(1, mesh.dim + 1):
            terms = ((slave, direction, 1.0), *((node, direction, -float(w)) for node, w in shares))
            result.append(Equation(terms, pair.place))
        bound.add(slave)
    return result

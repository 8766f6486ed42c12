"""Surfaces of a deck as rows (element number, local facet of ``abut.cells``)."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from abut.cells import CELLS, MAX_FACET_NODES
from abut.io.deck.elements import FACES
from abut.io.deck.reasons import DeckError
from abut.io.deck.record import Block, Deck, Faces, Numbers

Rows = NDArray[np.int64]  # (n, 2)


@dataclass(frozen=True)
class FreeFaces:
    """Facets with an element on one side only: rows (n, 2), nodes (n, 9) padded with -1, corners (n,) how many of the
    nodes are corners."""

    rows: Rows
    nodes: Numbers
    corners: Numbers


def free_faces(deck: Deck) -> FreeFaces:
    """The boundary of all elements."""
    rows, nodes, corners, keys = [], [], [], []
    for block in deck.blocks:
        for local, (kind, local_nodes) in enumerate(CELLS[block.type.kind].facets):
            count = CELLS[kind].corners
            padded = np.full((len(block.ids), MAX_FACET_NODES), -1, np.int64)
            padded[:, : len(local_nodes)] = block.nodes[:, local_nodes]
            key = np.full((len(block.ids), 4), -1, np.int64)
            key[:, :count] = np.sort(padded[:, :count], axis=1)
            rows.append(np.stack([block.ids, np.full(len(block.ids), local)], axis=1))
            nodes.append(padded)
            corners.append(np.full(len(block.ids), count))
            keys.append(key)
    _, inverse, times = np.unique(np.concatenate(keys), axis=0, return_inverse=True, return_counts=True)
    free = times[inverse.ravel()] == 1
    return FreeFaces(np.concatenate(rows)[free], np.concatenate(nodes)[free], np.concatenate(corners)[free])


def surface_rows(deck: Deck, surface: Faces, free: FreeFaces) -> Rows:
    """Rows of a surface, each once. A surface of nodes becomes the free faces that its nodes make up.

    Raises InputError for nodes that make up no face."""
    if surface.empty:
        raise DeckError(surface.place, f"*SURFACE: surface '{surface.name}' is empty; give it faces, or nodes")
    if surface.nodes is not None:
        return _of_nodes(deck, surface, surface.nodes, free)
    parts = [np.empty((0, 2), np.int64)]
    for elements, face in surface.faces:
        if face == 0:
            parts.append(free.rows[np.isin(free.rows[:, 0], elements)])
            continue
        for block in deck.blocks:
            here = np.intersect1d(elements, block.ids)
            if not len(here):
                continue
            parts.append(np.stack([here, np.full(len(here), FACES[block.type.kind][face - 1])], axis=1))
    rows = np.unique(np.concatenate(parts), axis=0)
    if not len(rows):
        raise DeckError(surface.place, f"*SURFACE: surface '{surface.name}' has no faces; check its elements")
    return rows


def _of_nodes(deck: Deck, surface: Faces, nodes: Numbers, free: FreeFaces) -> Rows:
    every = bound_nodes(deck, nodes)
    inside = np.isin(free.nodes, every)
    hit = (inside | (free.nodes < 0)).all(axis=1)
    if not hit.any():  # a quadratic mesh whose set holds corners only
        slots = np.arange(free.nodes.shape[1])[None, :]
        hit = (inside | (slots >= free.corners[:, None])).all(axis=1)
    left = np.setdiff1d(nodes, free.nodes[hit])
    if len(left):  # faces that a set ends within: most of their nodes are in it
        most = 2 * (inside & (free.nodes >= 0)).sum(axis=1) > (free.nodes >= 0).sum(axis=1)
        hit |= most & np.isin(free.nodes, left).any(axis=1)
        left = np.setdiff1d(nodes, free.nodes[hit])
    if len(left):
        raise DeckError(
            surface.place,
            f"*SURFACE: node {left[0]}{f' and {len(left) - 1} more' if len(left) > 1 else ''} of surface "
            f"'{surface.name}' make up no face of an element, and abut needs faces; list faces (TYPE=ELEMENT)",
        )
    return free.rows[hit]


def bound_nodes(deck: Deck, nodes: Numbers) -> Numbers:
    """The nodes, and those that an equation of two terms makes move as they do."""
    more = [nodes]
    wanted = set(nodes.tolist())
    for equation in deck.equations:
        if len(equation.terms) == 2 and equation.terms[0][2] == -equation.terms[1][2]:
            (a, node, _), (b, other, _) = equation.terms
            if node == other and (a in wanted) != (b in wanted):
                more.append(np.array([a, b], np.int64))
    return np.unique(np.concatenate(more))


def connectivity(deck: Deck, rows: Rows) -> dict[str, Numbers]:
    """Facet type -> node numbers (n, k) of the facets in ``rows``."""
    parts: dict[str, list[Numbers]] = {}
    for block in deck.blocks:
        here = rows[np.isin(rows[:, 0], block.ids)]
        if not len(here):
            continue
        nodes = element_nodes(block, here[:, 0])
        for local in np.unique(here[:, 1]).tolist():
            kind, pick = CELLS[block.type.kind].facets[local]
            parts.setdefault(kind, []).append(nodes[here[:, 1] == local][:, pick])
    return {kind: np.concatenate(here) for kind, here in parts.items()}


def nodes_of_rows(deck: Deck, rows: Rows) -> Numbers:
    """Nodes (n, 9) of the facets in ``rows``, padded with -1."""
    result = np.full((len(rows), MAX_FACET_NODES), -1, np.int64)
    for block in deck.blocks:
        here = np.isin(rows[:, 0], block.ids)
        for local in np.unique(rows[here, 1]).tolist():
            own = here & (rows[:, 1] == local)
            pick = CELLS[block.type.kind].facets[local][1]
            result[own, : len(pick)] = element_nodes(block, rows[own, 0])[:, pick]
    return result


def element_nodes(block: Block, elements: Numbers) -> Numbers:
    """Nodes (n, k) of elements of a block by number."""
    order = np.argsort(block.ids)
    return block.nodes[order[np.searchsorted(block.ids[order], elements)]]

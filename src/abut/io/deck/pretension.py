"""Pre-tension sections: the mesh cut open inside a bolt, and equations that let the cut only close along its normal."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from abut.cells import CELLS
from abut.io.deck.faces import connectivity, free_faces, surface_rows
from abut.io.deck.pretension_record import PreTension
from abut.io.deck.reasons import DeckError
from abut.io.deck.record import Block, Deck, Equation, Numbers


def cut(deck: Deck) -> Deck:
    """The deck with every pre-tension section worked in. Direction 1 of the section's node is how much the two sides
    overlap, and a force there the tension of the bolt, if its normal points out of the elements that the surface names; a
    note says where it points into them, so that a force presses. Raises InputError for sections that do not cut through."""
    for section in deck.pretension:
        deck = _cut(deck, section)
    return replace(deck, pretension=())


def _cut(deck: Deck, section: PreTension) -> Deck:
    surface = deck.surfaces[section.surface]
    if surface.nodes is not None:
        raise DeckError(
            section.place,
            f"*PRE-TENSION SECTION: surface '{section.surface}' must list faces of elements (TYPE=ELEMENT)",
        )
    rows = surface_rows(deck, surface, free_faces(deck))
    facets = connectivity(deck, rows)
    nodes = np.unique(np.concatenate([n.ravel() for n in facets.values()]))
    side = _side(deck, rows, nodes, section)
    first = int(max(deck.nodes.max(), section.node)) + 1
    double = first + np.arange(len(nodes))
    blocks = tuple(_moved(block, side, nodes, double) for block in deck.blocks)
    at = np.searchsorted(deck.nodes, nodes)
    normal = _normal(deck, facets)
    notes = list(deck.notes)
    if section.normal is not None:
        outward, normal = normal, np.array(section.normal) / np.linalg.norm(section.normal)
        if outward @ normal < 0.0:
            notes.append(
                f"{section.place}: *PRE-TENSION SECTION: the normal points into the elements of '{section.surface}': forces "
                f"> 0 on node {section.node} press and forces < 0 pull, as in CalculiX; turn it round for the opposite"
            )
    across = np.linalg.svd(normal[None, :])[2][1:]
    equations = []
    for old, new in zip(nodes.tolist(), double.tolist()):
        for vector, opening in ((normal, True), (across[0], False), (across[1], False)):
            terms = [
                (node, k + 1, sign * float(vector[k]))
                for node, sign in ((new, 1.0), (old, -1.0))
                for k in range(3)
                if abs(vector[k]) > 1e-12
            ]
            equations.append(Equation((*terms, (section.node, 1, -1.0)) if opening else tuple(terms), section.place))
    return replace(
        deck,
        nodes=np.concatenate([deck.nodes, double]),
        points=np.concatenate([deck.points, deck.points[at]]),
        blocks=blocks,
        equations=(*deck.equations, *equations),
        notes=tuple(notes),
    )


def _normal(deck: Deck, facets: dict[str, Numbers]) -> NDArray[np.float64]:
    """Mean unit normal out of the elements whose faces the surface lists."""
    total = np.zeros(3)
    for kind, nodes in facets.items():
        x = deck.points[np.searchsorted(deck.nodes, nodes[:, : CELLS[kind].corners])]
        if CELLS[kind].dim == 1:
            along = (x[:, 1] - x[:, 0]).sum(axis=0)
            total += np.array([along[1], -along[0], 0.0])
        else:
            centre = x.mean(axis=1, keepdims=True)
            total += np.cross(x - centre, np.roll(x, -1, axis=1) - centre).sum(axis=(0, 1))
    return np.asarray(total / np.linalg.norm(total))


def _side(deck: Deck, rows: Numbers, nodes: Numbers, section: PreTension) -> set[int]:
    """Elements at the cut on the side of the surface's own elements: those reached from them without crossing it."""
    touching: dict[tuple[int, ...], list[tuple[int, int]]] = {}
    for block in deck.blocks:
        for local, (kind, pick) in enumerate(CELLS[block.type.kind].facets):
            corners = block.nodes[:, pick[: CELLS[kind].corners]]
            for i in np.flatnonzero(np.isin(corners, nodes).any(axis=1)).tolist():
                key = tuple(sorted(corners[i].tolist()))
                touching.setdefault(key, []).append((int(block.ids[i]), local))
    wall = {(int(e), int(f)) for e, f in rows}
    neighbours: dict[int, set[int]] = {}
    beyond: set[int] = set()
    for faces in touching.values():
        if any(face in wall for face in faces):
            if len(faces) == 1:
                raise DeckError(
                    section.place,
                    f"*PRE-TENSION SECTION: element {faces[0][0]} of its surface has no neighbour beyond the cut",
                )
            beyond |= {element for element, local in faces if (element, local) not in wall}
            continue
        for element, _ in faces:
            neighbours.setdefault(element, set()).update(other for other, _ in faces)
    reached = {element for element, _ in wall}
    todo = list(reached)
    while todo:
        for other in neighbours.get(todo.pop(), set()) - reached:
            reached.add(other)
            todo.append(other)
    if reached & beyond:
        raise DeckError(
            section.place,
            "*PRE-TENSION SECTION: its surface does not cut the body in two; it must go right through, with faces on one "
            "side only",
        )
    return reached


def _moved(block: Block, side: set[int], nodes: Numbers, double: Numbers) -> Block:
    """The block with the doubled nodes in elements of one side."""
    inside = np.isin(block.ids, np.array(sorted(side), np.int64))
    new = block.nodes.copy()
    hit = inside[:, None] & np.isin(new, nodes)
    new[hit] = double[np.searchsorted(nodes, new[hit])]
    return replace(block, nodes=new)

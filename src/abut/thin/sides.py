"""Faces of solids made of shells and beams, by name: (element, local facet)."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np
from numpy.typing import NDArray

from abut.cells import CELLS
from abut.decks.layers import stacked
from abut.io.deck.elements import FACES
from abut.io.deck.record import Block
from abut.mesh.facets import row_codes
from abut.thin.quadratic import Sorted
from abut.thin.records import Shell, Thin

Numbers = NDArray[np.int64]
ROUND = (0, 1, 2, 4)  # of the faces S1, S2, ... of a solid that a beam becomes: all but its ends
OUTSIDE, INSIDE = 0, 1  # of those of a solid of a hollow beam
SNEG, SPOS = 0, 1  # of the faces S1, S2, ... of a solid that a shell becomes; then those at its edges
NONE = np.empty((0, 2), np.int64)


def sides(
    parts: Sorted, sections: Mapping[str, Thin], blocks: Mapping[str, Block], ids: Mapping[str, Numbers],
    stacks: Mapping[int, tuple[int, ...]],
) -> dict[str, Numbers]:  # fmt: skip
    """Rows (n, 2) of each surface. blocks: of the solids, of layers the lowest ones, as ``as_deck`` calls them; stacks: all
    solids of those with layers, by the lowest one."""
    result: dict[str, Numbers] = {}
    shells = [
        (f"{name}:{kind}", kind, cells)
        for name, section in sections.items()
        if isinstance(section, Shell)
        for kind, cells in parts.bodies[name].items()
    ]
    ends, rows = _edges(shells, blocks, len(parts.points))
    _, inverse, count = np.unique(ends, return_inverse=True, return_counts=True)
    free = count[inverse] == 1
    for name, section in sections.items():
        if isinstance(section, Shell):
            for kind in parts.bodies[name]:
                block = blocks[f"{name}:{kind}"]
                for word, face in (("spos", SPOS), ("sneg", SNEG)):
                    _add(result, f"{name}.{word}", _face(block, block.ids, face))
            _add(result, f"{name}.edge", rows[free & np.isin(rows[:, 0], ids[name])])
        else:
            block = blocks[f"{name}:line3"]
            for face in ROUND if section.wall is None else (OUTSIDE,):
                _add(result, f"{name}.side", _face(block, block.ids, face))
            if section.wall is not None:
                _add(result, f"{name}.inside", _face(block, block.ids, INSIDE))
    for name, on in parts.on.items():
        for kind, cells in on.items():
            if kind == "line3":
                _add(result, f"{name}.edge", rows[free & np.isin(ends, _codes(cells[:, :2], len(parts.points)))])
            elif kind != "point":
                for word, face in (("spos", SPOS), ("sneg", SNEG)):
                    _add(result, f"{name}.{word}", _of_cells(shells, blocks, cells, kind, face))
    return {name: _outer(rows, blocks, stacks) for name, rows in result.items()}


def _outer(rows: Numbers, blocks: Mapping[str, Block], stacks: Mapping[int, tuple[int, ...]]) -> Numbers:
    """The same of all layers: of faces at edges, and of the last one for those of the positive side."""
    if not stacks:
        return rows
    kinds = {number: block.type.kind for block in blocks.values() for number in block.ids.tolist()}
    found = [
        (n, facet)
        for number, facet in rows.tolist()
        for n in stacked(np.array([number]), FACES[kinds[number]].index(facet) + 1, stacks).tolist()
    ]
    return np.array(found, np.int64)


def _add(result: dict[str, Numbers], name: str, rows: Numbers) -> None:
    if len(rows):
        result[name] = np.concatenate([result.get(name, NONE), rows])


def _face(block: Block, ids: Numbers, face: int) -> Numbers:
    return np.stack([ids, np.full(len(ids), FACES[block.type.kind][face])], axis=1)


def _codes(ends: Numbers, n_points: int) -> Numbers:
    low, high = np.sort(ends, axis=1).T
    return np.asarray(low * n_points + high)


def _edges(
    shells: list[tuple[str, str, Numbers]], blocks: Mapping[str, Block], n_points: int
) -> tuple[Numbers, Numbers]:
    """Of each edge of each cell of shells a number made of its ends, and the face across the thickness there."""
    codes, rows = [np.empty(0, np.int64)], [NONE]
    for name, kind, cells in shells:
        corners = cells[:, : CELLS[kind].corners]
        for k in range(corners.shape[1]):
            codes.append(_codes(corners[:, [k, (k + 1) % corners.shape[1]]], n_points))
            rows.append(_face(blocks[name], blocks[name].ids, 2 + k))
    return np.concatenate(codes), np.concatenate(rows)


def _of_cells(
    shells: list[tuple[str, str, Numbers]], blocks: Mapping[str, Block], cells: Numbers, kind: str, face: int
) -> Numbers:
    """Faces of those cells of shells that are ``cells``."""
    found = [NONE]
    wanted = np.sort(cells[:, : CELLS[kind].corners], axis=1)
    for name, other, own in shells:
        if other == kind:
            codes = row_codes(np.concatenate([wanted, np.sort(own[:, : CELLS[kind].corners], axis=1)]))
            here = np.isin(codes[len(wanted) :], codes[: len(wanted)])
            found.append(_face(blocks[name], blocks[name].ids[here], face))
    return np.concatenate(found)

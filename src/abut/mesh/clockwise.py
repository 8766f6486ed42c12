"""Cells of plane meshes with clockwise node numbering, reversed."""

from __future__ import annotations

from dataclasses import replace
from typing import TypeVar

import numpy as np
from numpy.typing import NDArray

from abut.cells import CELLS
from abut.mesh.record import MeshRecord

Kind = TypeVar("Kind", bound=MeshRecord)


def order(kind: str) -> NDArray[np.int64]:
    """Nodes of a plane cell the other way round from the same first corner: mid nodes follow their edges, a middle stays.
    Facet i becomes facet corners - 1 - i."""
    k, n = CELLS[kind].corners, CELLS[kind].nodes
    corners = [0, *range(k - 1, 0, -1)]
    middles = list(range(2 * k - 1, k - 1, -1)) if n >= 2 * k else []
    return np.array([*corners, *middles, *range(len(corners) + len(middles), n)])


def clockwise(mesh: MeshRecord) -> NDArray[np.bool_]:
    """Of each cell of a plane mesh, whether its corners run clockwise. Cells without area do not."""
    result = np.zeros(mesh.n_cells, dtype=bool)
    for block, first in zip(mesh.blocks, mesh.starts):
        corners = mesh.points[block.nodes[:, : CELLS[block.kind].corners]]
        x, y = np.moveaxis(corners - corners[:, :1], -1, 0)
        area = (x * np.roll(y, -1, axis=1) - np.roll(x, -1, axis=1) * y).sum(axis=1)
        result[first : first + len(area)] = area < 0.0
    return result


def turn_bodies(mesh: Kind) -> Kind:
    """A plane mesh with the cells of those bodies turned round that have clockwise cells only, and a note of each; facet
    numbers of surfaces follow. Bodies of which some cells run clockwise are left for ``check_mesh`` to refuse."""
    if mesh.dim != 2:
        return mesh
    wrong = clockwise(mesh)
    bodies = [name for name, cells in mesh.bodies.items() if len(cells) and wrong[cells].all()]
    if not bodies:
        return mesh
    turned = np.zeros(mesh.n_cells, dtype=bool)
    for name in bodies:
        turned[mesh.bodies[name]] = True
    blocks, corners = [], np.zeros(mesh.n_cells, dtype=np.int64)
    for block, first in zip(mesh.blocks, mesh.starts):
        here = turned[first : first + len(block.nodes)]
        corners[first : first + len(here)] = CELLS[block.kind].corners
        nodes = block.nodes.copy()
        nodes[here] = nodes[here][:, order(block.kind)]
        blocks.append(replace(block, nodes=nodes))
    surfaces = {name: _mapped(rows, turned, corners) for name, rows in mesh.surfaces.items()}
    notes = [f"body '{name}': its cells were numbered clockwise; their numbering was reversed" for name in bodies]
    return replace(mesh, blocks=tuple(blocks), surfaces=surfaces, notes=(*mesh.notes, *notes))


def _mapped(rows: NDArray[np.int64], turned: NDArray[np.bool_], corners: NDArray[np.int64]) -> NDArray[np.int64]:
    cells, local = rows.T
    return np.stack([cells, np.where(turned[cells], corners[cells] - 1 - local, local)], axis=1)

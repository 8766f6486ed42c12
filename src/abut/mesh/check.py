"""Is a mesh sound? Every finding names cells or facets and the cure."""

from __future__ import annotations

import numpy as np

from abut._core import shape_functions
from abut.cells import CELLS
from abut.errors import InputError
from abut.mesh.mesh import Mesh
from abut.mesh.quadrature import stiffness_rule

DEGENERATE = 1e-10  # smallest Jacobian determinant over the largest extent to the power of the dimension


def check_mesh(mesh: Mesh) -> None:
    """Raise InputError for points that are not numbers, inverted or flat cells, doubled cells, surfaces that are empty,
    doubled or not on the boundary."""
    if not np.isfinite(mesh.points).all():
        bad = np.flatnonzero(~np.isfinite(mesh.points).all(axis=1))
        raise InputError(f"mesh: points {_some(bad)} have coordinates that are not numbers; write the mesh again")
    for name, cells in mesh.bodies.items():
        if len(cells) == 0:
            raise InputError(f"mesh: body '{name}' has no cells")
    _check_cells(mesh)
    _check_doubles(mesh)
    for name, rows in mesh.surfaces.items():
        if len(rows) == 0:
            raise InputError(f"mesh: surface '{name}' has no facets")


def _check_cells(mesh: Mesh) -> None:
    for block, first in zip(mesh.blocks, mesh.starts):
        if not len(block.nodes):
            continue
        xi, _ = stiffness_rule(block.kind)
        _, derivatives = shape_functions(CELLS[block.kind].code, np.ascontiguousarray(xi))
        x = mesh.points[block.nodes]
        size = np.ptp(x, axis=1).max(axis=1) ** mesh.dim
        smallest = np.full(len(x), np.inf)
        for own in derivatives:  # a point at a time keeps memory low
            smallest = np.minimum(smallest, np.linalg.det(np.einsum("cnd,na->cda", x, own)))
        bad = np.flatnonzero(~(smallest > DEGENERATE * size))
        if len(bad):
            inverted = bool((smallest[bad] < -DEGENERATE * size[bad]).all())
            names = [n for n, cells in mesh.bodies.items() if np.isin(first + bad, cells).any()]
            cure = (
                "their nodes run the wrong way round: reverse them"
                if inverted and len(bad) == len(x)
                else "improve the mesh there (finer, or straight-sided near curved boundaries)"
            )
            raise InputError(
                f"mesh: {len(bad)} {block.kind} cells of {', '.join(map(repr, names))} are "
                f"{'inverted' if inverted else 'inverted or degenerate'}: cells {_some(first + bad)}; {cure}"
            )


def _check_doubles(mesh: Mesh) -> None:
    for block, first in zip(mesh.blocks, mesh.starts):
        _, where, count = np.unique(np.sort(block.nodes, axis=1), axis=0, return_index=True, return_counts=True)
        if (count > 1).any():
            raise InputError(
                f"mesh: cells {_some(first + where[count > 1])} stand in the mesh twice; save each body in one group only"
            )


def _some(numbers: object) -> str:
    values = np.asarray(numbers).tolist()
    return ", ".join(map(str, values[:5])) + (f", ... ({len(values)} in all)" if len(values) > 5 else "")

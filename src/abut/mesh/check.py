"""Checks of a mesh. Every finding names cells or facets and how to correct them."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from abut._core import shape_functions, smallest_determinants
from abut.cells import CELLS
from abut.errors import InputError
from abut.mesh.clockwise import clockwise
from abut.mesh.facets import bodies_at, facet_keys, number_keys, row_codes, single
from abut.mesh.quadrature import stiffness_rule
from abut.mesh.record import MeshRecord

DEGENERATE = 1e-10  # smallest Jacobian determinant over the largest extent to the power of the dimension


def check_mesh(mesh: MeshRecord) -> None:
    """Raise InputError for points that are not numbers, cells with points that do not exist, inverted or flat cells,
    doubled cells, cells in no body or in two, surfaces that are empty, doubled or not on the boundary."""
    check_entries(mesh)
    _check_bodies(mesh)
    _check_cells(mesh)
    _check_doubles(mesh)
    _check_surfaces(mesh)


def check_entries(mesh: MeshRecord) -> None:
    """Raise InputError for points that are not numbers, and cells with points that do not exist: what takes no time."""
    if not np.isfinite(mesh.points).all():
        bad = np.flatnonzero(~np.isfinite(mesh.points).all(axis=1))
        raise InputError(f"mesh: points {_some(bad)} have coordinates that are not numbers; write the mesh again")
    _check_indices(mesh)


def _check_indices(mesh: MeshRecord) -> None:
    for block, first in zip(mesh.blocks, mesh.starts):
        want = CELLS[block.kind].nodes
        if block.nodes.ndim != 2 or block.nodes.shape[1] != want:
            raise InputError(f"mesh: {block.kind} cells need {want} nodes each, got an array {block.nodes.shape}")
        if CELLS[block.kind].dim != mesh.dim:
            raise InputError(f"mesh: {block.kind} cells do not fit points with {mesh.dim} coordinates")
        bad = np.flatnonzero(((block.nodes < 0) | (block.nodes >= len(mesh.points))).any(axis=1))
        if len(bad):
            raise InputError(
                f"mesh: cells {_some(first + bad)} use points that do not exist (there are {len(mesh.points)}, "
                "counted from 0); write the mesh again"
            )
    for name, nodes in mesh.node_sets.items():
        if len(nodes) and (nodes.min() < 0 or nodes.max() >= len(mesh.points)):
            raise InputError(f"mesh: node set '{name}' has points that do not exist; there are {len(mesh.points)}")


def _check_bodies(mesh: MeshRecord) -> None:
    count = np.zeros(mesh.n_cells, dtype=np.int64)
    for name, cells in mesh.bodies.items():
        if len(cells) == 0:
            raise InputError(f"mesh: body '{name}' has no cells")
        if cells.min() < 0 or cells.max() >= mesh.n_cells:
            raise InputError(f"mesh: body '{name}' has cells that do not exist; there are {mesh.n_cells}")
        np.add.at(count, cells, 1)
    bad = np.flatnonzero(count > 1)
    if len(bad):
        raise InputError(
            f"mesh: cells {_some(bad)} stand more than once in bodies {_names(bodies_at(mesh, bad))}; give each cell "
            "one body"
        )
    bad = np.flatnonzero(count == 0)
    if len(bad):
        raise InputError(f"mesh: cells {_some(bad)} belong to no body; add them to one or take them out")


def _check_surfaces(mesh: MeshRecord) -> None:
    starts = mesh.starts
    facets = np.repeat([len(CELLS[b.kind].facets) for b in mesh.blocks], np.diff(starts))
    for name, rows in mesh.surfaces.items():
        if len(rows) == 0:
            raise InputError(f"mesh: surface '{name}' has no facets")
        cells, local = rows.T
        exists = (cells >= 0) & (cells < mesh.n_cells)
        if not exists.all() or ((local < 0) | (local >= facets[cells])).any():
            raise InputError(f"mesh: surface '{name}' has facets of cells that do not exist; write the mesh again")
        _, where, count = np.unique(_code(rows), return_index=True, return_counts=True)
        if (count > 1).any():
            raise InputError(
                f"mesh: surface '{name}' lists facets of cells {_some(cells[where[count > 1]])} twice; list each once"
            )
    if not mesh.surfaces:
        return
    every = np.concatenate(list(mesh.surfaces.values()))
    keys, owners = facet_keys(mesh, mesh.facets(every).node_ids)
    (facet,) = number_keys(keys)
    shared = np.bincount(facet)[facet] > 1
    for name, rows in mesh.surfaces.items():
        owned = np.isin(_code(owners), _code(rows)) & shared
        if owned.any():
            sides = bodies_at(mesh, owners[np.isin(facet, facet[owned]), 0])
            raise InputError(f"mesh: {inside(name, np.unique(facet[owned]).size, sides)}")


def _code(rows: NDArray[np.int64]) -> NDArray[np.int64]:
    """One number for each (cell, local facet): no cell has more than 8 facets."""
    return 8 * rows[:, 0] + rows[:, 1]


def inside(name: str, count: int, sides: list[str]) -> str:
    """What to say of a surface with ``count`` facets that have cells of the bodies ``sides`` on both sides."""
    if len(sides) > 1:
        return (
            f"surface '{name}' lies between the bodies {_names(sides)}, which share the nodes of {count} of its facets and "
            "are glued there; for contact mesh them separately, each with a surface of its own"
        )
    return (
        f"surface '{name}' lies inside body {_names(sides)}: {count} of its facets have cells on both sides; take them out "
        "of the surface"
    )


def _check_cells(mesh: MeshRecord) -> None:
    for block, first in zip(mesh.blocks, mesh.starts):
        if not len(block.nodes):
            continue
        xi, _ = stiffness_rule(block.kind)
        _, derivatives = shape_functions(CELLS[block.kind].code, np.ascontiguousarray(xi))
        nodes = np.ascontiguousarray(block.nodes, dtype=np.int32)
        # Absurd coordinates give no number, which fails below.
        smallest = smallest_determinants(np.ascontiguousarray(mesh.points), nodes, derivatives)
        bad = np.flatnonzero(~(smallest > DEGENERATE))
        if len(bad):
            inverted = bool((smallest[bad] < -DEGENERATE).all())
            cure = "improve the mesh there (finer, or straight-sided near curved boundaries)"
            if inverted and len(bad) == len(nodes):
                cure = "their nodes run the wrong way round: reverse them"
            elif mesh.dim == 2 and clockwise(mesh)[first + bad].all():
                cure = "their nodes run clockwise, those of other cells do not: reverse them"
            raise InputError(
                f"mesh: {len(bad)} {block.kind} cells of {_names(bodies_at(mesh, first + bad))} are "
                f"{'inverted' if inverted else 'inverted or degenerate'}: cells {_some(first + bad)}; {cure}"
            )


def _check_doubles(mesh: MeshRecord) -> None:
    starts = mesh.starts
    # Cells with the same points have the same sum of their marks: only those few, if any, need their points sorted.
    mark = np.random.default_rng(0).integers(np.iinfo(np.int64).max, size=len(mesh.points))
    for kind in sorted({block.kind for block in mesh.blocks}):  # a cell read in two groups stands in two blocks
        of_kind = [(b.nodes, f + np.arange(len(b.nodes))) for b, f in zip(mesh.blocks, starts) if b.kind == kind]
        nodes, cells = (np.concatenate(part) for part in zip(*of_kind))
        suspect = np.ones(len(cells), dtype=bool)
        suspect[single(mark[nodes].sum(axis=1))] = False
        nodes, cells = nodes[suspect], cells[suspect]
        code = row_codes(np.sort(nodes, axis=1))
        _, where, inverse, count = np.unique(code, return_index=True, return_inverse=True, return_counts=True)
        if (count > 1).any():
            copies = cells[count[inverse] > 1]
            raise InputError(
                f"mesh: cells {_some(cells[where[count > 1]])} of {_names(bodies_at(mesh, copies))} stand in the mesh "
                "twice; put each cell in one body only"
            )


def _names(names: list[str]) -> str:
    return ", ".join(map(repr, names))


def _some(numbers: object) -> str:
    values = np.asarray(numbers).tolist()
    return ", ".join(map(str, values[:5])) + (f", ... ({len(values)} in all)" if len(values) > 5 else "")

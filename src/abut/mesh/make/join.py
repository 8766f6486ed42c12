"""Several meshes into one, with names that start with the body's."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

from abut.errors import InputError
from abut.mesh.cell_block import CellBlock
from abut.mesh.mesh import Mesh


def join(meshes: Mapping[str, Mesh]) -> Mesh:
    """One mesh of all: each becomes the body ``name`` with surfaces and node sets ``name.surface``; no nodes are merged.

    The bodies of a mesh with several become ``name.body``. Raises InputError for no mesh, or plane ones with solid ones.

    >>> from abut.mesh import make
    >>> mesh = make.join({"shaft": make.disc(1.0, cells=2), "block": make.rectangle([-2, 2], [-2, -1], cells=[4, 1])})
    >>> sorted(mesh.surfaces)
    ['block.bottom', 'block.left', 'block.right', 'block.top', 'shaft.round']
    """
    dims = {name: mesh.dim for name, mesh in meshes.items()}
    if len(set(dims.values())) != 1:
        raise InputError(f"join: expected meshes that are all plane or all solid, got dimensions {dims}")
    points, blocks = [], []
    bodies, surfaces, node_sets = {}, {}, {}
    n_points = n_cells = 0
    for name, mesh in meshes.items():
        points.append(mesh.points)
        blocks += [CellBlock(block.kind, (block.nodes + n_points).astype(np.int32)) for block in mesh.blocks]
        for name_of, cells in mesh.bodies.items():
            bodies[name if len(mesh.bodies) == 1 else f"{name}.{name_of}"] = cells + n_cells
        for name_of, rows in mesh.surfaces.items():
            surfaces[f"{name}.{name_of}"] = rows + np.array([n_cells, 0])
        for name_of, nodes in mesh.node_sets.items():
            node_sets[f"{name}.{name_of}"] = nodes + n_points
        n_points += len(mesh.points)
        n_cells += mesh.n_cells
    return Mesh(np.ascontiguousarray(np.concatenate(points)), tuple(blocks), bodies, surfaces, node_sets)

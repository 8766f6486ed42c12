"""Several meshes into one, with names that start with the body's."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

from abut.mesh.mesh import CellBlock, Mesh


def join(meshes: Mapping[str, Mesh]) -> Mesh:
    """One mesh of all: each becomes the body ``name`` with surfaces and node sets ``name.surface``; no nodes are merged."""
    points, blocks = [], []
    bodies, surfaces, node_sets = {}, {}, {}
    n_points = n_cells = 0
    for name, mesh in meshes.items():
        points.append(mesh.points)
        blocks += [CellBlock(block.kind, (block.nodes + n_points).astype(np.int32)) for block in mesh.blocks]
        bodies[name] = np.arange(n_cells, n_cells + mesh.n_cells, dtype=np.int64)
        for own, rows in mesh.surfaces.items():
            surfaces[f"{name}.{own}"] = rows + np.array([n_cells, 0])
        for own, nodes in mesh.node_sets.items():
            node_sets[f"{name}.{own}"] = nodes + n_points
        n_points += len(mesh.points)
        n_cells += mesh.n_cells
    return Mesh(np.ascontiguousarray(np.concatenate(points)), tuple(blocks), bodies, surfaces, node_sets)

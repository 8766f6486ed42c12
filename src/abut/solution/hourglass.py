"""Motions that reduced integration leaves without stiffness: the certificate's line "hourglass".

A hex20 with 8 points has six such motions. Neighbours in two directions forbid each other all of them; in a row of single
cells, as a strip one cell wide becomes, one is free where only the mean of a section is held (Bicanic and Hinton 1979)."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np
from numpy.typing import NDArray

from abut.cells import CELLS
from abut.mesh.facets import corner_keys, row_codes
from abut.mesh.record import MeshRecord
from abut.mesh.reference import reference_nodes
from abut.model import Model
from abut.solution.contacts import Check

KIND = "hex20"
LIMIT, NOTICED = 0.05, 0.01  # of how far the body's points move apart: wrong, and worth knowing
OPPOSITE = ((0, 1), (2, 3), (4, 5))  # facets of a hexahedron
ROW = 2  # directions in which a cell of a row has no neighbour

Array = NDArray[np.float64]
Numbers = NDArray[np.int64]


def hourglass(model: Model, displacement: Array) -> Iterator[Check]:
    """A line for the worst of the bodies with rows of single cells that are integrated at 8 points; displacement:
    (n_points, 3)."""
    reduced = [solid.body for solid in model.solids if model.mesh.dim == 3 and model.integration(solid) == "reduced"]
    found = []
    for body, cells in _rows(model.mesh, reduced):
        apart = float(np.linalg.norm(np.ptp(displacement[model.mesh.nodes_of(body)], axis=0)))
        found.append((float(np.abs(_rest() @ displacement[cells]).max(initial=0.0)) / max(apart, 1e-300), body))
    if found:
        far, body = max(found)
        yield Check("", "hourglass", far, LIMIT,
            f"displacements that no stress resists, over how far points of '{body}' move apart: it has rows of single cells "
            "with reduced integration", notice=NOTICED)  # fmt: skip


def _rows(mesh: MeshRecord, bodies: list[str]) -> Iterator[tuple[str, Numbers]]:
    """Bodies with cells (n, 20) that have a neighbour in one direction at most."""
    found = [
        (body, nodes.astype(np.int64)) for body in bodies for kind, nodes, _ in mesh.cells_of(body) if kind == KIND
    ]
    if not found:
        return
    every = np.concatenate([nodes for _, nodes in found])
    corners = np.stack([every[:, list(facet[:4])] for _, facet in CELLS[KIND].facets], axis=1)
    codes = row_codes(corner_keys(corners.reshape(-1, 4)))
    _, inverse, count = np.unique(codes, return_inverse=True, return_counts=True)
    free = (count[inverse.ravel()] == 1).reshape(-1, len(CELLS[KIND].facets))
    alone = sum((free[:, a] & free[:, b]).astype(int) for a, b in OPPOSITE) >= ROW
    first = 0
    for body, nodes in found:
        mine = alone[first : first + len(nodes)]
        first += len(nodes)
        if mine.any():
            yield body, nodes[mine]


def _rest() -> Array:
    """What a quadratic field leaves of values at the nodes, (20, 20): the part of hourglass motions."""
    x, y, z = reference_nodes(KIND).T
    fields = np.stack([np.ones_like(x), x, y, z, x * y, y * z, z * x, x * x, y * y, z * z, x * y * z], axis=1)
    return np.asarray(np.eye(len(x)) - fields @ np.linalg.pinv(fields))

"""Shapes of cells: scaled Jacobians at the corners, ratios of edges."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from abut.cells import CELLS
from abut.diagnosis.finding import Finding
from abut.mesh.facets import bodies_at
from abut.mesh.integrals import chunks
from abut.mesh.mesh import Mesh

POOR, BAD = 0.2, 0.02  # smallest scaled Jacobian (1 is best) from which on a cell is advised against, and warned of
LONG = 100.0  # longest over shortest edge of a cell
CORNERS = {  # at each corner the ends of its edges, right-handed
    ("tri", 3): ((1, 2), (2, 0), (0, 1)),
    ("quad", 4): ((1, 3), (2, 0), (3, 1), (0, 2)),
    ("tet", 4): ((1, 2, 3), (2, 0, 3), (0, 1, 3), (0, 2, 1)),
    ("hex", 8): ((1, 3, 4), (2, 0, 5), (3, 1, 6), (0, 2, 7), (7, 5, 0), (4, 6, 1), (5, 7, 2), (6, 4, 3)),
    ("wedge", 6): ((1, 2, 3), (2, 0, 4), (0, 1, 5), (5, 4, 0), (3, 5, 1), (4, 3, 2)),
}
BEST = {"tri": np.sqrt(0.75), "quad": 1.0, "tet": np.sqrt(0.5), "hex": 1.0, "wedge": np.sqrt(0.75)}


def quality(mesh: Mesh) -> list[Finding]:
    """Worst cells by scaled Jacobian and by ratio of edges; of quadratic cells the corners count."""
    jacobian, ratio = np.empty(mesh.n_cells), np.empty(mesh.n_cells)
    for kind, nodes, cells in chunks(mesh):
        jacobian[cells], ratio[cells] = _shapes(kind, mesh.points[nodes[:, : CELLS[kind].corners]])
    worst, longest = int(jacobian.argmin()), int(ratio.argmax())
    findings = [
        Finding(
            "info",
            "mesh",
            f"{mesh.n_cells} cells, {len(mesh.points)} points; scaled Jacobian {jacobian[worst]:.2g} to "
            f"{jacobian.max():.2g}, longest over shortest edge up to {ratio[longest]:.3g}",
        )
    ]
    poor = np.flatnonzero(jacobian < POOR)
    if len(poor):
        bad = int((jacobian < BAD).sum())
        findings.append(
            Finding(
                "warning" if bad else "advice",
                "mesh",
                f"{len(poor)} cells of {_bodies(mesh, poor)} are skewed (scaled Jacobian below {POOR:g}, the worst "
                f"{jacobian[worst]:.2g} in cell {worst}{_at(mesh, worst)})",
                "improve the mesh there if stresses near by matter",
            )
        )
    if ratio[longest] > LONG:
        many = np.flatnonzero(ratio > LONG)
        findings.append(
            Finding(
                "advice",
                "mesh",
                f"{len(many)} cells of {_bodies(mesh, many)} are more than {LONG:g} times as long as thick (cell {longest}"
                f"{_at(mesh, longest)})",
                'use more cells along the long sides, and linear = "direct" if the iterative solver is slow',
            )
        )
    return findings


def ratios(mesh: Mesh) -> NDArray[np.float64]:
    """Longest over shortest edge of each cell."""
    result = np.empty(mesh.n_cells)
    for kind, nodes, cells in chunks(mesh):
        result[cells] = _shapes(kind, mesh.points[nodes[:, : CELLS[kind].corners]])[1]
    return result


def _shapes(kind: str, x: NDArray[np.float64]) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Smallest scaled Jacobian over the corners and ratio of edges of cells with corners x (n, corners, dim)."""
    name = next(own for own, _ in CORNERS if kind.startswith(own))
    smallest = np.full(len(x), np.inf)
    short, long = np.full(len(x), np.inf), np.zeros(len(x))
    for corner, ends in enumerate(CORNERS[name, x.shape[1]]):
        edges = x[:, list(ends)] - x[:, [corner]]
        lengths = np.linalg.norm(edges, axis=2)
        short, long = np.minimum(short, lengths.min(axis=1)), np.maximum(long, lengths.max(axis=1))
        scaled = np.linalg.det(edges) / np.maximum(lengths.prod(axis=1), 1e-300) / BEST[name]
        smallest = np.minimum(smallest, scaled)
    return smallest, long / np.maximum(short, 1e-300)


def _bodies(mesh: Mesh, cells: NDArray[np.int64]) -> str:
    return ", ".join(f"'{name}'" for name in bodies_at(mesh, cells))


def _at(mesh: Mesh, cell: int) -> str:
    for block, first, last in zip(mesh.blocks, mesh.starts, mesh.starts[1:]):
        if first <= cell < last:
            middle = mesh.points[block.nodes[cell - first]].mean(axis=0)
            return f" at ({', '.join(f'{value:.4g}' for value in middle)})"
    return ""

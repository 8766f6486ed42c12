"""Shapes of cells: scaled Jacobians at the corners, ratios of edges."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from abut.cells import CELLS
from abut.diagnosis.finding import Finding
from abut.mesh.facets import bodies_at
from abut.mesh.integrals import chunks
from abut.mesh.mesh import Mesh
from abut.mesh.shapes import cell_shapes
from abut.model import Model
from abut.model.locking import locking

POOR, BAD = 0.2, 0.02  # smallest scaled Jacobian (1 is best) from which on a cell is advised against, and warned of
SHOWN = 3  # cells named one by one
LONG = 100.0  # longest over shortest edge of a cell


def quality(mesh: Mesh) -> list[Finding]:
    """Worst cells by scaled Jacobian and by ratio of edges; of quadratic cells the corners count."""
    jacobian, ratio = np.empty(mesh.n_cells), np.empty(mesh.n_cells)
    for kind, nodes, cells in chunks(mesh):
        jacobian[cells], ratio[cells] = cell_shapes(kind, mesh.points[nodes[:, : CELLS[kind].corners]])
    worst, longest = int(jacobian.argmin()), int(ratio.argmax())
    findings = [
        Finding(
            "info",
            "mesh",
            f"{mesh.n_cells} cells, {len(mesh.points)} points; scaled Jacobian {jacobian[worst]:.2g} to "
            f"{jacobian.max():.2g}, longest over shortest edge up to {ratio[longest]:.3g}",
        )
    ]
    findings += _turned(mesh, jacobian)
    poor = np.flatnonzero((jacobian < POOR) & (jacobian >= 0.0))
    if len(poor):
        bad, worst = int((jacobian[poor] < BAD).sum()), int(poor[jacobian[poor].argmin()])
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


def _turned(mesh: Mesh, jacobian: NDArray[np.float64]) -> list[Finding]:
    """An error for cells of negative volume at a corner."""
    turned = np.flatnonzero(jacobian < 0.0)
    if not len(turned):
        return []
    first = [f"{cell}{_at(mesh, int(cell))}" for cell in turned[np.argsort(jacobian[turned])][:SHOWN]]
    more = f" and {len(turned) - SHOWN} more" if len(turned) > SHOWN else ""
    return [
        Finding(
            "error",
            "mesh",
            f"{len(turned)} cells of {_bodies(mesh, turned)} are turned inside out at a corner (negative Jacobian, scaled "
            f"{jacobian[turned].min():.2g} at worst): {', '.join(first)}{more}",
            "mesh anew there, finer or with other cells; with Gmsh, Mesh.Optimize = 1 and Mesh.HighOrderOptimize = 2, for "
            "quadrilaterals Mesh.RecombineNodeRepositioning = 1",
        )
    ]


def too_stiff(model: Model) -> list[Finding]:
    """Bodies whose cells lock: a warning for each."""
    return [
        Finding(
            "warning",
            f"body '{one.body}'",
            f"{one.kind} cells with full integration are too stiff for Poisson's ratio {one.poisson:g}",
            one.cure,
        )
        for one in locking(model)
    ]


def _bodies(mesh: Mesh, cells: NDArray[np.int64]) -> str:
    return ", ".join(f"'{name}'" for name in bodies_at(mesh, cells))


def _at(mesh: Mesh, cell: int) -> str:
    for block, first, last in zip(mesh.blocks, mesh.starts, mesh.starts[1:]):
        if first <= cell < last:
            middle = mesh.points[block.nodes[cell - first]].mean(axis=0)
            return f" at ({', '.join(f'{value:.4g}' for value in middle)})"
    return ""

"""Estimated time of a run, stage by stage: counts of operations times the measured cost of each.

All constants are seconds on one core of a server of 2023 (some 5 Gflop/s in a sparse factorisation). Counts are known from
the mesh and the pairs, but for those of linear solutions and Krylov iterations: these are typical ones.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from abut.cells import CELLS
from abut.contact.geometry import by_kind, nodal_normals
from abut.diagnosis.quality import ratios
from abut.linear.static_condensation import LARGEST
from abut.model import Model
from abut.problem.contact_pairs import Pair

ASSEMBLY = {  # seconds a cell
    "tri3": 1.0e-6, "tri6": 2.5e-6, "quad4": 1.5e-6, "quad8": 4e-6, "quad9": 5e-6, "tet4": 1.5e-6, "tet10": 1.2e-5,
    "hex8": 4.5e-6, "hex20": 5e-5, "hex27": 8.5e-5, "wedge6": 4e-6, "wedge15": 3e-5,
}  # fmt: skip
COUPLED = {  # entries in a row of the stiffness
    "tri3": 14, "tri6": 23, "quad4": 18, "quad8": 30, "quad9": 32, "tet4": 45, "tet10": 85, "hex8": 81, "hex20": 190,
    "hex27": 192, "wedge6": 63, "wedge15": 130,
}  # fmt: skip
SEGMENT = {  # seconds a segment between flat facets, between curved ones
    "line2": (4e-6, 1e-5), "line3": (4e-6, 1e-5), "tri3": (1.2e-5, 3e-5), "quad4": (2.5e-5, 9e-5), "tri6": (3e-5, 2.5e-4),
    "quad8": (6e-5, 2.8e-4), "quad9": (7e-5, 3e-4),
}  # fmt: skip
A_PAIR, A_BODY = 8e-3, 4e-4  # seconds a pair and a body, whatever their size
RESULT = 1.0e-6  # seconds a free displacement and step: stresses, checks
ROW, FRONT = 5e-6, 1.5e-9  # seconds a row of the stiffness, and an operation on a front, to factorise
ELIMINATIONS = {1: 1, 2: 2}  # of a step, by degree: on quadratic facets functions change where contact is closed
DENSE, SOLUTION = 1.5e-10, 2e-3  # seconds a cube of the number of multipliers, and a solution, whatever their size
LEVELS, CYCLE = 5e-8, 3e-9  # seconds an entry of the stiffness for setting multigrid up, and for one iteration
FIRST, NEXT = 10, 5  # solutions of the first load step, and of one that begins where the last ended
KRYLOV, STRETCHED = 75, 0.8  # iterations of a step between cells of equal edges; power of the ratio of edges
START = 0.005


@dataclass(frozen=True)
class Effort:
    """What has to be done. cells: of each kind; entries: of the stiffness; fronts: operations on them, up to a factor;
    multipliers, pairs, bodies: how many; cutting: seconds; steps; displacements: free ones; stretched: mean ratio of the
    cells' edges."""

    cells: dict[str, int]
    entries: float
    fronts: float
    multipliers: int
    pairs: int
    bodies: int
    cutting: float
    steps: int
    displacements: int
    stretched: float


def effort(model: Model, displacements: int, pairs: Sequence[Pair]) -> Effort:
    """Count what a model asks for."""
    mesh = model.mesh
    cells: dict[str, int] = {}
    for block in mesh.blocks:
        cells[block.kind] = cells.get(block.kind, 0) + len(block.nodes)
    share = np.array([count * CELLS[kind].nodes for kind, count in cells.items()], dtype=float)
    row = float(share @ [COUPLED[kind] for kind in cells] / share.sum())
    return Effort(
        cells=cells,
        entries=displacements * row,
        fronts=sum(_fronts(model, body) for body in mesh.bodies),
        multipliers=sum(map(len, pairs)),
        pairs=len(pairs),
        bodies=len(mesh.bodies),
        cutting=sum(map(_cutting, pairs)),
        steps=model.solve.steps,
        displacements=displacements,
        stretched=float(np.exp(np.log(ratios(mesh)).mean())),
    )


def seconds(own: Effort, solver: str) -> dict[str, float]:
    """Seconds of each stage, with "direct" or "amg" as the linear solver."""
    solutions = FIRST + NEXT * (own.steps - 1) if own.multipliers else own.steps
    if solver == "amg":
        krylov = KRYLOV * own.stretched**STRETCHED * (FIRST + NEXT * (own.steps - 1)) / FIRST
        solving = own.entries * (LEVELS + CYCLE * krylov)
    else:
        degree = max(CELLS[kind].degree for kind in own.cells)
        eliminated = own.multipliers <= LARGEST
        times = (1 + (ELIMINATIONS[degree] - 1) * own.steps if own.multipliers else 1) if eliminated else solutions
        solving = times * (ROW * own.displacements + FRONT * own.fronts)
        solving += A_PAIR * own.pairs + solutions * (SOLUTION + (DENSE * own.multipliers**3 if eliminated else 0.0))
    return {
        "assembly": START + sum(ASSEMBLY[kind] * count for kind, count in own.cells.items()),
        "interface": own.cutting + A_PAIR * own.pairs + A_BODY * own.bodies,
        "solve": solving,
        "results": own.steps * (RESULT * own.displacements + A_PAIR * own.pairs),
    }


def _fronts(model: Model, body: str) -> float:
    """Operations of nested dissection: as many fronts as cross-sections that cut the body into cubes, each to the third."""
    nodes, dim = model.mesh.nodes_of(body), model.dim
    extent = np.ptp(model.mesh.points[nodes], axis=0)
    n = float(dim * len(nodes))
    slender = float(extent.prod()) ** (1.0 / dim) / float(extent.max())
    section = n ** ((dim - 1) / dim) * slender
    return n * section ** (1.0 if dim == 2 else 1.5)


def _cutting(pair: Pair) -> float:
    """Seconds to cut and integrate a pair."""
    surface, total = pair.contactor, 0.0
    normals = nodal_normals(surface)
    used = surface.nodes >= 0
    turn = np.where(used[..., None], np.abs(normals - normals[:, :1]), 0.0).max(axis=(1, 2))
    for kind, facets in by_kind(surface):
        flat, curved = SEGMENT[kind]
        total += float((pair.coupling.segments[facets] * np.where(turn[facets] > 1e-9, curved, flat)).sum())
    return total

"""Cost of a run, time and memory, stage by stage: counts of operations times the measured cost of each.

It is used by the choice of the linear solver (``abut.linear.choice``), the announced times of stages, and `abut check`.

All constants are seconds on one core of a server of 2023 (some 5 Gflop/s in a sparse factorisation). Counts are known from
the mesh and the pairs, but for those of linear solutions and Krylov iterations: these are typical ones.
"""

from __future__ import annotations

from collections.abc import Collection, Sequence
from dataclasses import dataclass

import numpy as np

from abut.cells import CELLS
from abut.contact.geometry import by_kind, nodal_normals
from abut.dofs import n_dofs
from abut.linear.static_condensation import LARGEST
from abut.mesh.mesh import Mesh
from abut.mesh.shapes import ratios
from abut.model import Model
from abut.problem.pair import Pair
from abut.problem.springs import Springs
from abut.problem.straight_cells import rounds

ASSEMBLY = {  # seconds a cell
    "tri3": 1.0e-6, "tri6": 2.5e-6, "quad4": 1.5e-6, "quad8": 4e-6, "quad9": 5e-6, "tet4": 1.5e-6, "tet10": 1.2e-5,
    "hex8": 4.5e-6, "hex20": 5e-5, "hex27": 8.5e-5, "wedge6": 4e-6, "wedge15": 3e-5,
}  # fmt: skip
COUPLED = {  # entries in a row of the stiffness
    "tri3": 14, "tri6": 23, "quad4": 18, "quad8": 30, "quad9": 32, "tet4": 45, "tet10": 85, "hex8": 81, "hex20": 190,
    "hex27": 192, "wedge6": 63, "wedge15": 130,
}  # fmt: skip
SEGMENT = {  # seconds a segment between flat facets, between curved ones, with the search for what lies beyond the rim
    "line2": (4e-6, 1e-5), "line3": (4e-6, 1e-5), "tri3": (2.1e-5, 1.5e-4), "quad4": (2.8e-5, 1.8e-4),
    "tri6": (3e-5, 1.6e-4), "quad8": (4.5e-5, 2e-4), "quad9": (5.5e-5, 2.2e-4),
}  # fmt: skip
A_PAIR, A_BODY = 8e-3, 4e-4  # seconds a pair and a body, whatever their size
CUT = 3.0  # all of the interface (normals, gaps, checks) over cutting alone
RESULT, RESULT_PAIR, RESULT_MULTIPLIER = 8e-6, 3.5e-2, 4e-5  # seconds a step: by free displacement, pair and multiplier
# Where triangles and tetrahedra of first order are solved once more: seconds a free displacement for the forces and for a
# substitution with the factors, share of the iterations of a step that multigrid takes
AGAIN, SUBSTITUTION, AGAIN_KRYLOV = 4e-6, 2e-6, 0.25
# Entries and operations on fronts where pressures are continuous, over those of cells alone
WIDE_ROWS, WIDE_FRONTS = 1.2, 1.6
ROW, FRONT = 5e-6, 1.5e-9  # seconds a row of the stiffness, and an operation on a front, to factorise
ELIMINATIONS = {1: 1, 2: 2}  # of a step, by degree: on quadratic facets functions change where contact is closed
DENSE, SOLUTION = 1.5e-10, 8e-3  # seconds a cube of the number of multipliers, and a solution, whatever their size
LEVELS, CYCLE = 5e-8, 3e-9  # seconds an entry of the stiffness for setting multigrid up, and for one iteration
FIRST, NEXT = 10, 5  # solutions of the first load step, and of one that begins where the last ended
KRYLOV, STRETCHED = 75, 0.8  # iterations of a step between cells of equal edges; power of the ratio of edges
START = 0.005
FOUND, ITERATIONS = 18, 6  # load steps at large displacements where a run finds them, and iterations in one: 5 to 8
SLIPS = (
    10  # load steps at small displacements that follow the onset of slip, on one way: 8 to 12, with those taken again
)
FINITE, TANGENT, UNSYMMETRIC = (
    4e-3,
    3.0,
    2.0,
)  # seconds an iteration; its cells and factors over those of small displacements
FOLLOWED = 6e-5  # seconds a multiplier and iteration: contact at current positions and its derivatives
LARGE = {1: 30_000, 2: 40_000}  # free displacements in 3D, by degree of the cells, from where on multigrid wins
LARGE_FINITE = {1: 5_000, 2: 10_000}  # the same with kinematics "finite": unsymmetric factors in every iteration
LARGE_ON_MANY = {1: 5_000, 2: 5_000}  # the same on several processes: MUMPS factorises at every iteration


@dataclass(frozen=True)
class Stiffness:
    """What the stiffness of the bodies asks of a linear solver: free displacements; entries; operations on fronts, up to a
    factor."""

    displacements: int
    entries: float
    fronts: float


@dataclass(frozen=True)
class Effort:
    """What has to be done. cells: of each kind; multipliers, pairs, bodies, steps: how many; cutting: seconds; stretched:
    mean ratio of the cells' edges; finite: large displacements; changing: small ones with a stiffness that changes; again:
    how often each step is solved once more under the forces that straight cells leave."""

    stiffness: Stiffness
    cells: dict[str, int]
    multipliers: int
    pairs: int
    bodies: int
    cutting: float
    steps: int
    stretched: float
    finite: bool = False
    changing: bool = False
    again: int = 0


def of_stiffness(mesh: Mesh, displacements: int, wide: Collection[str] = ()) -> Stiffness:
    """Count what the stiffness on ``displacements`` free ones asks for; wide: bodies with pressures that are continuous."""
    cells = _cells(mesh)
    share = np.array([count * CELLS[kind].nodes for kind, count in cells.items()], dtype=float)
    row = float(share @ [COUPLED[kind] for kind in cells] / share.sum())
    entries = displacements * row * (1.0 + (WIDE_ROWS - 1.0) * share_of(mesh, wide))
    fronts = sum(_fronts(mesh, body) * (WIDE_FRONTS if body in wide else 1.0) for body in mesh.bodies)
    return Stiffness(displacements, entries, fronts)


def share_of(mesh: Mesh, bodies: Collection[str]) -> float:
    """Of all nodes, those of some bodies."""
    return sum(len(mesh.nodes_of(body)) for body in bodies) / max(len(mesh.points), 1)


def effort(model: Model, displacements: int, pairs: Sequence[Pair]) -> Effort:
    """Count what a model asks for."""
    changing = not model.finite and _changes(model)
    return Effort(
        stiffness=of_stiffness(model.mesh, displacements, model.integrations.wide),
        cells=_cells(model.mesh),
        multipliers=sum(map(len, pairs)),
        pairs=len(pairs),
        bodies=len(model.mesh.bodies),
        cutting=sum(map(_cutting, pairs)),
        steps=typical_steps(model),
        finite=model.finite,
        changing=changing,
        again=0 if changing else rounds(model, pairs),
        stretched=float(np.exp(np.log(ratios(model.mesh)).mean())),
    )


def typical_steps(model: Model) -> int:
    """Load steps of a run; a typical number where it finds them."""
    if not model.solve.finds_steps:
        return len(model.ends)
    return (
        FOUND
        if model.finite
        else len(model.ends) + (SLIPS if any(contact.frictional for contact in model.contacts) else 0)
    )


def _changes(model: Model) -> bool:
    """Whether each iteration at small displacements has new factors, as materials, springs, dashpots and bolts drawn by a
    force ask (``abut.problem.assembly``)."""
    springs = Springs.of(model)
    drawn = any(preload.force is not None for preload in model.preloads)
    return (
        not model.linear_bodies
        or drawn
        or bool(model.physics or model.connectors)
        or not (springs is None or springs.constant)
        or any(spring.dashpot for spring in model.springs)
    )


def preparing(size: Stiffness, solver: str) -> float:
    """Seconds to set a linear solver up: to factorise once ("direct"), or to make the levels of multigrid ("amg")."""
    return size.entries * LEVELS if solver == "amg" else ROW * size.displacements + FRONT * size.fronts


def seconds(effort: Effort, solver: str) -> dict[str, float]:
    """Seconds of each stage, with "direct" or "amg" as the linear solver."""
    solutions = FIRST + NEXT * (effort.steps - 1) if effort.multipliers else effort.steps
    prepared, displacements = preparing(effort.stiffness, solver), effort.stiffness.displacements
    if effort.finite or effort.changing:
        anew = effort.stiffness.entries * CYCLE * KRYLOV * effort.stretched**STRETCHED if solver == "amg" else 0.0
        each = FINITE + anew + (1.0 if solver == "amg" else UNSYMMETRIC) * prepared
        each += (
            TANGENT * (_assembly(effort) + (effort.cutting if effort.finite else 0.0)) + FOLLOWED * effort.multipliers
        )
        solving = ITERATIONS * effort.steps * each if effort.finite else solutions * (SOLUTION + each)
    elif solver == "amg":
        krylov = KRYLOV * effort.stretched**STRETCHED * (FIRST + NEXT * (effort.steps - 1)) / FIRST
        solving = prepared + effort.stiffness.entries * CYCLE * krylov + solutions * SOLUTION
    else:
        degree = max(CELLS[kind].degree for kind in effort.cells)
        eliminated = effort.multipliers <= LARGEST
        times = (
            (1 + (ELIMINATIONS[degree] - 1) * effort.steps if effort.multipliers else 1) if eliminated else solutions
        )
        solving = times * prepared
        solving += A_PAIR * effort.pairs + solutions * (
            SOLUTION + (DENSE * effort.multipliers**3 if eliminated else 0.0)
        )
    return {
        "assembly": START + _assembly(effort),
        "interface": CUT * effort.cutting + A_PAIR * effort.pairs + A_BODY * effort.bodies,
        "solve": solving,
        "results": effort.steps
        * (
            RESULT * displacements
            + RESULT_PAIR * effort.pairs
            + RESULT_MULTIPLIER * effort.multipliers
            + effort.again * _again(effort, solver)
        ),
    }


def _again(effort: Effort, solver: str) -> float:
    """Seconds of a further solution of a step."""
    made = AGAIN * effort.stiffness.displacements
    if solver == "amg":
        iterations = AGAIN_KRYLOV * KRYLOV * effort.stretched**STRETCHED
        return made + effort.stiffness.entries * CYCLE * iterations
    return made + SUBSTITUTION * effort.stiffness.displacements + DENSE * effort.multipliers**3


def _assembly(effort: Effort) -> float:
    return sum(ASSEMBLY[kind] * count for kind, count in effort.cells.items())


def _cells(mesh: Mesh) -> dict[str, int]:
    """How many cells of each kind."""
    result: dict[str, int] = {}
    for block in mesh.blocks:
        result[block.kind] = result.get(block.kind, 0) + len(block.nodes)
    return result


def _fronts(mesh: Mesh, body: str) -> float:
    """Operations of nested dissection: as many fronts as cross-sections that cut the body into cubes, each to the third."""
    nodes, dim = mesh.nodes_of(body), mesh.dim
    extent = np.ptp(mesh.points[nodes], axis=0)
    n = float(n_dofs(len(nodes), dim))
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

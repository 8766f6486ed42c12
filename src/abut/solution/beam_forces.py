"""Forces and moments across the sections of a beam that was made solid.

Of each cell the nodal forces of its stresses, int B^T s, theory (E4): those at the nodes of one end are what holds it there,
so that F is their sum and M that of (x - c) x f, c the section's centroid. They balance what is put on nodes exactly, where
recovered stresses would miss shear and torsion through one cell. At a section between two cells the mean of what both say
counts: of loads along the beam each has half a cell's at its nodes, which then cancel."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray
from scipy.sparse import coo_array
from scipy.sparse.csgraph import connected_components

from abut import checks
from abut.bodies.assemble import internal_force
from abut.bodies.loads import facet_points
from abut.bodies.solids import Solids
from abut.cells import CELLS
from abut.errors import InputError
from abut.mesh.cell_block import CellBlock
from abut.mesh.mesh import Mesh
from abut.mesh.record import MeshRecord
from abut.model import Model, Temperature
from abut.solution.records import Solution, Step

Vector = NDArray[np.float64]
Numbers = NDArray[np.int64]
START, END = 0, 1  # facets at the ends of the hex20 that beams become (mesh.thin.beams)


@dataclass(frozen=True)
class BeamForces:
    """Forces and moments across the sections of a beam, which that beyond a section (in the direction of ``tangent``) exerts
    on what is before it.

    Parameters
    ----------
    points, tangent : (s, 3) arrays
        Centroids of the sections [length], where they are in finite deformations; unit vectors along the beam.
    force : (s, 3) array
        Along the global axes [force].
    moment : (s, 3) array
        About the centroids, along the global axes [force*length].
    """

    points: Vector
    tangent: Vector
    force: Vector
    moment: Vector

    @property
    def normal_force(self) -> Vector:
        """(s,), positive where it pulls."""
        return np.asarray((self.force * self.tangent).sum(axis=1))

    @property
    def shear_force(self) -> Vector:
        """(s, 3): the force across the beam."""
        return np.asarray(self.force - self.normal_force[:, None] * self.tangent)

    @property
    def torque(self) -> Vector:
        """(s,): the moment about the tangent through the centroid."""
        return np.asarray((self.moment * self.tangent).sum(axis=1))

    @property
    def bending_moment(self) -> Vector:
        """(s, 3): the moment across the beam."""
        return np.asarray(self.moment - self.torque[:, None] * self.tangent)


def beam_forces(solution: Solution, body: str, step: int = -1) -> BeamForces:
    """Forces and moments across the sections of a beam.

    Parameters
    ----------
    solution : Solution
        Of a model with ``thicken``'s mesh, or of a deck with beams.
    body : str
        The beam.
    step : int
        Which of the steps, the last where left out.

    Returns
    -------
    BeamForces
        At the end of the step, in the order of the cells, of which each gives the section at its end.

    Raises
    ------
    InputError
        For a body that is no beam, one that is heated or has a material with a history (the solution does not keep that),
        and a step that there is not.
    """
    model = checks.instance(solution, Solution, "beam_forces", "a solution (abut.Solution)").model
    if not -len(solution.steps) <= step < len(solution.steps):
        raise InputError(f"beam_forces: step: there are {len(solution.steps)} steps, got {step}")
    rows, section = _sections(model.mesh, body)
    why = unknown(model, body)
    if why:
        raise InputError(f"beam_forces: body {body!r} {why}")
    return _summed(model, solution.steps[step], body, rows, section)


def unknown(model: Model, body: str) -> str:
    """Why the forces of a beam are not known, empty where they are: stresses depend on more than the displacement."""
    if body not in model.materials:
        return "has no material"
    if len(model.materials[body].initial(1)[0]):
        return "has a material with a history, which the solution does not keep"
    heated = any(isinstance(load, Temperature) for load in model.loads)
    if heated or any(solid.temperature for solid in model.solids if solid.body == body):
        return "is heated; forces of beams are known without temperatures"
    return ""


def of_step(model: Model, step: Step, body: str) -> tuple[BeamForces, Numbers]:
    """The same of a step of a beam whose forces are known, and the sections (c, 2) at the ends of its cells."""
    rows, section = _sections(model.mesh, body)
    starts, ends = (section[rows[:, 1] == which] for which in (START, END))  # both in the order of the cells
    return _summed(model, step, body, rows, section), np.unique(np.stack([starts, ends], axis=1), axis=0)


def _sections(mesh: MeshRecord, body: str) -> tuple[Numbers, Numbers]:
    """Facets (f, 2) across a beam, and the number of the section of each, along the beam. Raises InputError."""
    blocks = mesh.cells_of(body)
    cells = np.concatenate([numbers for _, _, numbers in blocks])
    starts, ends = (np.stack([cells, np.full(len(cells), which)], axis=1) for which in (START, END))
    beam = body not in mesh.shells and {kind for kind, _, _ in blocks} == {"hex20"}
    if beam:
        before = np.isin(mesh.facets(starts).nodes[:, :8], mesh.facets(ends).nodes[:, :8])
        beam = bool((before.all(axis=1) | ~before.any(axis=1)).all())
    if not beam:
        raise InputError(f"beam_forces: body {body!r} is no beam: it has other cells than hex20 one behind the other")
    rows = np.concatenate([starts, ends])
    rows = rows[np.lexsort(rows.T[::-1])]
    nodes = mesh.facets(rows).nodes[:, :8].astype(np.int64)
    facet = np.repeat(np.arange(len(rows)), 8)
    links = coo_array(
        (np.ones(nodes.size), (facet, len(rows) + nodes.ravel())), shape=(len(rows) + len(mesh.points),) * 2
    )
    label = connected_components(links, directed=False)[1][: len(rows)]
    _, first, number = np.unique(label, return_index=True, return_inverse=True)
    return rows, np.argsort(np.argsort(first))[number.ravel()]


def _summed(model: Model, step: Step, body: str, rows: Numbers, section: Numbers) -> BeamForces:
    moved = np.zeros_like(step.displacement) if model.small_strains else step.displacement
    surface = replace(model.mesh.facets(rows), points=model.mesh.points + moved)
    ((nodes, _, weights, normal, at),) = facet_points(surface)
    ways = np.where(rows[:, 1] == START, -1.0, 1.0)[:, None]
    normal = normal * weights[:, None]
    area = np.linalg.norm(normal, axis=2)
    count = int(section.max()) + 1
    middle = _by_section(section, np.einsum("fq,fqa->fa", area, at), count)
    middle /= _by_section(section, area.sum(axis=1, keepdims=True), count)
    along = _by_section(section, ways * normal.sum(axis=1), count)
    sides = np.zeros((count, 2))
    sides[section, rows[:, 1]] = 1.0
    forces = ways[:, None] * _held(model, step, body, rows) / sides.sum(axis=1)[section][:, None, None]
    moment = np.cross(surface.points[nodes] - middle[section][:, None], forces)
    return BeamForces(
        middle, along / np.linalg.norm(along, axis=1, keepdims=True), _by_section(section, forces.sum(axis=1), count),
        _by_section(section, moment.sum(axis=1), count),
    )  # fmt: skip


def _held(model: Model, step: Step, body: str, rows: Numbers) -> Vector:
    """Nodal forces (f, 8, 3) of the stresses of each facet's cell alone at the facet's nodes: cells with nodes of their
    own."""
    mesh, blocks = model.mesh, model.mesh.cells_of(body)
    numbers = np.concatenate([which for _, _, which in blocks])
    order = np.argsort(numbers)
    nodes = np.concatenate([own for _, own, _ in blocks])[order]
    place = np.searchsorted(numbers[order], rows[:, 0])
    apart = np.arange(nodes.size, dtype=np.int32).reshape(nodes.shape)
    alone = Mesh(mesh.points[nodes.ravel()], (CellBlock("hex20", apart),), {body: np.arange(len(numbers))})
    whole = model.deformable
    one = Solids(alone, {body: whole.materials[body]}, None, {body: whole.integration[body]}, whole.kinematics)
    force = internal_force(one, step.displacement[nodes.ravel()]).reshape(*nodes.shape, 3)
    local = np.array([CELLS["hex20"].facets[which][1] for which in (START, END)])[rows[:, 1]]
    return np.asarray(force[place[:, None], local])


def _by_section(section: Numbers, values: Vector, count: int) -> Vector:
    """Sums (count, k) of rows (f, k)."""
    result = np.zeros((count, values.shape[1]))
    np.add.at(result, section, values)
    return result

"""The contact patch test on a model's own meshes: uniform pressure through each of its interfaces."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
import scipy.linalg
import scipy.sparse as sp
from numpy.typing import NDArray

from abut.analysis.certificate import BALANCE, balance
from abut.bodies.assemble import stiffness
from abut.bodies.loads import stress_load
from abut.bodies.rigid_modes import rigid_modes
from abut.cells import MAX_FACET_NODES
from abut.contact.coupling import couple, surface_degree
from abut.contact.geometry import nodal_normals
from abut.contact.nodal_recovery import facet_node_values
from abut.contact.sides import Sides
from abut.dofs import component_of, dofs_at, place_of
from abut.errors import InputError
from abut.linear.saddle_point import newton_step
from abut.materials.elastic import LinearElastic
from abut.mesh.facets import facet_keys, number_keys
from abut.mesh.mesh import Mesh
from abut.mesh.surface import Surface
from abut.model import Contact, Model, Solid
from abut.model.conditions import support_along
from abut.problem.constraints import supports
from abut.problem.contact_pairs import pair
from abut.problem.linearised import Rows
from abut.problem.pair import Pair

EXACT = 1e-8  # of pressure and displacement, relative: rounding times the condition of the user's meshes
FLAT = 1e-6  # deviation of normals, and of points from their plane over their extent, that still counts as plane
POISSON = 0.3
PINS = 12  # points of a body among which those that hold it are chosen


@dataclass(frozen=True)
class InterfacePatch:
    """What the patch test of one contact found. On a plane interface: the largest relative errors of pressure and
    displacement; on a curved one these are None, and only resultant and moment of a uniform pressure are compared
    between the two sides (relative to the force, and to force times extent)."""

    contact: str
    flat: bool
    pressure: float | None
    displacement: float | None
    force_balance: float
    moment_balance: float

    @property
    def passed(self) -> bool:
        errors = [] if self.pressure is None or self.displacement is None else [self.pressure, self.displacement]
        return bool(max(errors, default=0.0) <= EXACT and max(self.force_balance, self.moment_balance) <= BALANCE)


def interface_patch(model: Model) -> tuple[InterfacePatch, ...]:
    """Run the patch test on every contact of a model, on its meshes as they are.

    Materials are made equal, loads and supports replaced by a uniform stress normal to the interface, gaps set to zero;
    where the surfaces do not cover each other, the bare part carries the same stress as a load. Raises InputError for a
    model without contact, or one whose surfaces do not face each other.
    """
    if not model.contacts:
        raise InputError("verify: the model has no contact to test; add one ([[contacts]])")
    return tuple(_test(model, contact) for contact in model.contacts)


def _test(model: Model, contact: Contact) -> InterfacePatch:
    if contact.method == "node-to-segment-two-pass":
        raise InputError(
            f"verify: contact '{contact.name}' is {contact.method}, whose pressure is not unique; take another method"
        )
    contact = replace(contact, kind="contact", law="complementarity", offset=0.0, friction=0.0, friction_amplitude=None)
    contact = contact.forced(contact.contactor, contact.target)  # the sides that the run has
    sides = model.sides(contact)
    normal = _plane_normal(model.mesh.axisymmetric, sides)
    bodies = Model(
        model.mesh,
        [Solid(s.body, LinearElastic(1.0, POISSON), integration=s.integration) for s in model.solids],
        contacts=[contact],
        plane=model.plane,
    )
    if normal is None:
        built = pair(bodies, contact, supports(bodies), sides=sides)
        force, moment = balance(built, np.ones(MAX_FACET_NODES * len(built.contactor)))
        return InterfacePatch(contact.name, False, None, None, force, moment)
    stress = -np.outer(normal, normal)
    exact = model.mesh.points @ _strain(stress, model.plane)
    pinned = _pinned(bodies, exact)
    constraints = supports(pinned)
    built = pair(pinned, contact, constraints, sides=sides)
    load = _load(model.mesh, built.contactor, built.target, stress)
    full = stiffness(pinned.deformable)
    displacement, pressure = _solve(full, load, constraints.free, constraints.prescribed[:, 0], built)
    values = built.space.transfer @ pressure
    nodal = facet_node_values(built.contactor, built.coupling.degree, values)[built.coupling.segments > 0]
    force, moment = balance(built, values)
    return InterfacePatch(
        contact.name,
        True,
        float(np.nanmax(np.abs(nodal - 1.0))),
        float(np.abs(displacement.reshape(exact.shape) - exact).max() / np.abs(exact).max()),
        force,
        moment,
    )


def _plane_normal(axisymmetric: bool, sides: Sides) -> NDArray[np.float64] | None:
    """The unit normal of a plane interface, None where it is curved (or, axisymmetric, not across the axis)."""
    used = [nodal_normals(s)[s.nodes >= 0] for s in sides]
    normal = used[0].mean(axis=0)
    normal /= max(float(np.linalg.norm(normal)), 1e-300)
    if axisymmetric and abs(normal[0]) > FLAT:
        return None
    for cells, sign in zip(used, (1.0, -1.0)):
        if np.abs(cells - sign * normal).max() > FLAT:
            return None
    return np.asarray(normal)


def _strain(stress: NDArray[np.float64], plane: str | None) -> NDArray[np.float64]:
    """Strain of a unit modulus; in plane strain the stress out of the plane is what keeps that strain zero."""
    trace = np.trace(stress)
    if plane == "strain":
        trace = trace * (1.0 + POISSON)
    return np.asarray((1.0 + POISSON) * stress - POISSON * trace * np.eye(len(stress)))


def _pinned(model: Model, exact: NDArray[np.float64]) -> Model:
    """Every body (or group of glued bodies) held in a statically determinate way at its exact displacement."""
    mesh, dim = model.mesh, model.dim
    rigid = rigid_modes(mesh)
    sets: dict[str, NDArray[np.int64]] = {}
    pins = []
    for i, group in enumerate(rigid.groups):
        nodes = np.unique(np.concatenate([mesh.nodes_of(body) for body in group]))
        far = _spread_out(mesh.points[nodes])
        candidates = dofs_at(nodes[far], dim).ravel()
        modes = rigid.modes[candidates, rigid.per_group * i : rigid.per_group * (i + 1)]
        chosen = scipy.linalg.qr(modes.T, mode="r", pivoting=True)[1][: rigid.per_group]
        for dof in candidates[chosen]:
            node, axis = int(place_of(dof, dim)), int(component_of(dof, dim))
            sets[f"pin {dof}"] = np.array([node])
            pins.append(support_along(f"pin {dof}", "xyz"[axis], float(exact[node, axis])))
    return replace(model, mesh=replace(mesh, node_sets={**mesh.node_sets, **sets}), supports=pins)


def _spread_out(points: NDArray[np.float64]) -> NDArray[np.int64]:
    """Some points far from each other: each next one is farthest from those before."""
    chosen = [int(np.linalg.norm(points - points.mean(axis=0), axis=1).argmax())]
    distance = np.linalg.norm(points - points[chosen[0]], axis=1)
    while len(chosen) < min(PINS, len(points)):
        chosen.append(int(distance.argmax()))
        distance = np.minimum(distance, np.linalg.norm(points - points[chosen[-1]], axis=1))
    return np.array(chosen)


def _load(mesh: Mesh, contactor: Surface, target: Surface, stress: NDArray[np.float64]) -> NDArray[np.float64]:
    """Traction of the uniform stress on the whole boundary, less what the contact carries. That part comes from cutting
    the target by the contactor, the other way round than the test does: an answer of its own."""
    keys, rows = facet_keys(mesh, np.arange(len(mesh.points)))
    (number,) = number_keys(keys)
    boundary = mesh.facets(rows[np.bincount(number)[number] == 1])
    back = couple(target, contactor, surface_degree(target))
    ones = np.ones(MAX_FACET_NODES * len(target))
    carried = back.contactor_part.T @ ones - back.target_part.T @ ones
    return np.asarray(stress_load(boundary, stress) - carried)


def _solve(
    full: sp.csr_matrix, load: NDArray[np.float64], free: sp.csr_matrix, prescribed: NDArray[np.float64], built: Pair
) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Displacement at all points, (dim n_points,), and pressure with every multiplier in contact and no initial gap."""
    n = len(built)
    rows = Rows(
        residual=-(built.rows @ prescribed),
        by_displacement=-built.operator,
        by_pressure=sp.csr_matrix((n, n)),
        decoupled=np.zeros(n, dtype=bool),
        symmetric=True,
    )
    residual = free.T @ (full @ prescribed - load)
    moved, pressure = newton_step((free.T @ full @ free).tocsr(), built.operator, rows, residual, np.zeros(n))
    return np.asarray(free @ moved + prescribed), pressure


def describe(result: InterfacePatch) -> Sequence[str]:
    """The result in lines for a person."""
    verdict = "pass" if result.passed else "FAIL"
    balanced = f"force balance {result.force_balance:.1e}, moment balance {result.moment_balance:.1e}"
    if result.pressure is None or result.displacement is None:
        return (
            f"{verdict}  {result.contact}: curved interface, where a uniform pressure is no exact solution: {balanced} of a "
            f"uniform pressure (limit {BALANCE:.0e})",
        )
    return (
        f"{verdict}  {result.contact}: plane interface, error of the pressure {result.pressure:.1e}, of the displacement "
        f"{result.displacement:.1e} (limit {EXACT:.0e}); {balanced} (limit {BALANCE:.0e})",
    )

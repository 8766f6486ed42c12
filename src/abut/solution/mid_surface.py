"""Results of a shell that was made solid, on its mid-surface: displacement, turn, section forces.

Of the nodes b at its negative and t at its positive side: u = (u_b + u_t) / 2, turn n x (u_t - u_b) / h. With the stress s
at these, recovered as everywhere in each layer and linear between them, N = h (s_b + s_t) / 2 and M = h^2 (s_t - s_b) / 12;
of all layers as one N is their sum, M that of M + z N, z from the middle of all to that of the layer. Q = div M on the
surface, as moments balance, averaged over the cells around a node: through one cell the shear stress itself is no
parabola. (Tractions along the faces, times h / 2, are moments, too; they are left out.)"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from abut import checks
from abut.errors import InputError
from abut.mesh.record import MeshRecord
from abut.mesh.thin.shells import slopes_at_nodes
from abut.solution.grids import Grid
from abut.solution.records import Solution, Step

Vector = NDArray[np.float64]
Numbers = NDArray[np.int64]
THROUGH = {  # of a solid: its kind on the mid-surface, corners; nodes: below, above, below and above edges, between corners
    "hex20": ("quad8", 4),
    "wedge15": ("tri6", 3),
}
LAYER = "-layer"  # between the name of a shell and the number of its layer, in that of the body
ALONG = np.cos(np.radians(0.1))  # of the global x and the normal, from which on z leads instead (as in CalculiX)


@dataclass(frozen=True)
class MidSurface:
    """Results of a shell on its mid-surface, in the order of its points.

    Parameters
    ----------
    points : (n, 3) array
        Where they lie before they move [length].
    cells : mapping of str to (c, k) array of int
        "quad8" and "tri6": rows of points.
    normal, first : (n, 3) arrays
        Unit vectors: to the positive side, and the first direction of forces, the global x in the surface (z where x is
        within 0.1 degree of the normal). The second is normal x first.
    thickness : (n,) array
        At each point [length].
    displacement, rotation : (n, 3) arrays
        Mean of both sides [length]; turn of the line through the thickness [radian].
    membrane : (n, 3) array
        Forces n11, n22, n12 [force per length].
    moment : (n, 3) array
        m11, m22, m12, positive where they pull at the positive side [force].
    shear : (n, 2) array
        q1, q2 across [force per length].
    """

    points: Vector
    cells: dict[str, Numbers]
    normal: Vector
    first: Vector
    thickness: Vector
    displacement: Vector
    rotation: Vector
    membrane: Vector
    moment: Vector
    shear: Vector


def mid_surface(solution: Solution, body: str, step: int = -1) -> MidSurface:
    """Results of a shell on its mid-surface.

    Parameters
    ----------
    solution : Solution
        Of a model with ``thicken``'s mesh, or of a deck with shells.
    body : str
        The shell; of one of layers its name, for all as one, or a layer's.
    step : int
        Which of the steps, the last where left out.

    Returns
    -------
    MidSurface
        At the end of the step.

    Raises
    ------
    InputError
        For a body that is no shell, and a step that there is not.
    """
    mesh = checks.instance(solution, Solution, "mid_surface", "a solution (abut.Solution)").model.mesh
    if not layers_of(mesh, body):
        known = ", ".join([*mesh.shells, *laminates(mesh)]) or "none"
        raise InputError(f"mid_surface: body {body!r} is no shell; shells: {known}")
    if not -len(solution.steps) <= step < len(solution.steps):
        raise InputError(f"mid_surface: step: there are {len(solution.steps)} steps, got {step}")
    return of_step(mesh, solution.steps[step], body, solution.model.small_strains)


def laminates(mesh: MeshRecord) -> tuple[str, ...]:
    """Names of the shells that have layers, NAME-layer1 and so on."""
    names = [body.removesuffix(f"{LAYER}1") for body in mesh.shells if body.endswith(f"{LAYER}1")]
    return tuple(name for name in names if name not in mesh.shells)


def layers_of(mesh: MeshRecord, name: str) -> tuple[str, ...]:
    """The bodies of a shell from its negative side: itself, or its layers; none for what is no shell."""
    if name in mesh.shells:
        return (name,)
    count = next(i for i in range(len(mesh.shells) + 1) if f"{name}{LAYER}{i + 1}" not in mesh.shells)
    return tuple(f"{name}{LAYER}{i + 1}" for i in range(count))


def of_step(mesh: MeshRecord, step: Step, body: str, small: bool) -> MidSurface:
    """The same of a step. small: turns are, and normals those of the undeformed shell."""
    bodies = layers_of(mesh, body)
    through, cells = _through(mesh, bodies)
    below, above = through[:, 0], through[:, -1]
    x, u = mesh.points, step.displacement
    across = x[above] - x[below]
    rest, normal = _unit(across)
    thickness = rest
    moved = u[above] - u[below]
    rotation = np.cross(normal, moved) / rest[:, None]
    if not small:
        before = normal
        thickness, normal = _unit(across + moved)
        rotation = _turn(before, normal)
    first = _first(normal)
    axes = np.stack([first, np.cross(normal, first), normal], axis=1)
    points, moved = 0.5 * (x[below] + x[above]), 0.5 * (u[below] + u[above])
    at = (
        np.linalg.norm(x[through] - x[below][:, None], axis=2) / rest[:, None] - 0.5
    )  # of the thickness, from the middle
    force, bending = np.zeros((2, len(points), 3, 3))
    for i, layer in enumerate(bodies):
        stress = _stress(mesh, step, layer)
        low, high = _tensors(stress[through[:, i]]), _tensors(stress[through[:, i + 1]])
        own, middle = thickness * (at[:, i + 1] - at[:, i]), thickness * (at[:, i + 1] + at[:, i]) / 2.0
        carried = own[:, None, None] * (low + high) / 2.0
        force += carried
        bending += own[:, None, None] ** 2 * (high - low) / 12.0 + middle[:, None, None] * carried
    inside = np.eye(3) - normal[:, :, None] * normal[:, None, :]
    shear = _divergence(points if small else points + moved, cells, inside @ bending @ inside)
    return MidSurface(
        points, cells, normal, first, thickness, moved, rotation, _flat(_local(force, axes)), _flat(_local(bending, axes)),
        np.einsum("nad,nd->na", axes[:, :2], shear),
    )  # fmt: skip


def grid(mesh: MeshRecord, step: Step, small: bool, shells: Sequence[str]) -> Grid:
    """Shells of a mesh, for viewers; cells have the number of their body, or of the first one of layers."""
    points, blocks, bodies, data, first = [], [], [], list[dict[str, Vector]](), 0
    names = list(mesh.bodies)
    for body in shells:
        of = of_step(mesh, step, body, small)
        points.append(of.points)
        for kind, cells in of.cells.items():
            blocks.append((kind, (cells + first).astype(np.int32)))
            bodies.append(np.full(len(cells), names.index(layers_of(mesh, body)[0]), np.int32))
        first += len(of.points)
        data.append(
            {
                "displacement": of.displacement,
                "rotation": of.rotation,
                "membrane_force": of.membrane,
                "moment": of.moment,
                "shear_force": np.column_stack([of.shear, np.zeros(len(of.shear))]),
                "thickness": of.thickness,
                "normal": of.normal,
                "first_direction": of.first,
            }
        )
    joined = {name: np.concatenate([each[name] for each in data]) for name in data[0]}
    return Grid(np.concatenate(points), tuple(blocks), joined, {"body": np.concatenate(bodies)})


def _through(mesh: MeshRecord, bodies: Sequence[str]) -> tuple[Numbers, dict[str, Numbers]]:
    """Points (n, layers + 1) through the thickness at each point of the mid-surface, between layers too, and its cells."""
    through, cells = _layers(mesh, bodies[0])
    for body in bodies[1:]:
        layer = _layers(mesh, body)[0]
        layer = layer[np.argsort(layer[:, 0])]
        through = np.column_stack([through, layer[np.searchsorted(layer[:, 0], through[:, -1]), 1]])
    return through, cells


def _stress(mesh: MeshRecord, step: Step, body: str) -> Vector:
    """At the mesh's points (n_points, 6), that of the body where it shares some with others."""
    if body not in step.own_stress:
        return step.stress
    result = np.zeros_like(step.stress)
    result[mesh.nodes_of(body)] = step.own_stress[body]
    return result


def _layers(mesh: MeshRecord, body: str) -> tuple[Numbers, dict[str, Numbers]]:
    """Points (n, 2) below and above each point of the mid-surface, and its cells."""
    rows, kinds = [], []
    for kind, nodes, _ in mesh.cells_of(body):
        flat, corners = THROUGH[kind]
        below, above, below_edges, above_edges, _ = np.split(nodes.astype(np.int64), np.cumsum([corners] * 4), axis=1)
        rows.append(np.stack([np.hstack([below, below_edges]), np.hstack([above, above_edges])], axis=2))
        kinds.append(flat)
    every = np.concatenate([each.reshape(-1, 2) for each in rows])
    layers, inverse = np.unique(every, axis=0, return_inverse=True)
    split = np.split(inverse.ravel(), np.cumsum([each.shape[0] * each.shape[1] for each in rows])[:-1])
    return layers, {kind: part.reshape(each.shape[:2]) for kind, part, each in zip(kinds, split, rows)}


def columns(mesh: MeshRecord, body: str) -> Numbers:
    """Of each point of the mesh that which is below it, through the thickness of a shell; (n_points,)."""
    result = np.arange(len(mesh.points))
    for kind, nodes, _ in mesh.cells_of(body):
        corners = THROUGH[kind][1]
        below, above, below_edges, above_edges, between = np.split(nodes, np.cumsum([corners] * 4), axis=1)
        result[above], result[between], result[above_edges] = below, below, below_edges
    return result


def _divergence(points: Vector, cells: dict[str, Numbers], tensor: Vector) -> Vector:
    """Of tensors (n, 3, 3) at the points (n, 3) of a surface, the vector (n, 3): in each cell at its nodes, then their
    mean."""
    total, count = np.zeros((len(points), 3)), np.zeros(len(points))
    for kind, rows in cells.items():
        slopes = slopes_at_nodes(kind)
        along = np.einsum("akd,nkx->nadx", slopes, points[rows])
        dual = np.linalg.solve(along @ along.transpose(0, 1, 3, 2), along)
        change = np.einsum("akd,nkxy->nadxy", slopes, tensor[rows])
        np.add.at(total, rows, np.einsum("nady,nadxy->nax", dual, change))
        np.add.at(count, rows, 1.0)
    return np.asarray(total / count[:, None])


def _unit(vectors: Vector) -> tuple[Vector, Vector]:
    size = np.linalg.norm(vectors, axis=1)
    return size, vectors / size[:, None]


def _turn(before: Vector, after: Vector) -> Vector:
    """Turns (n, 3) about axes across that take unit vectors to others."""
    across = np.cross(before, after)
    sine = np.linalg.norm(across, axis=1)
    angle = np.arctan2(sine, (before * after).sum(axis=1))
    return np.asarray(across * np.where(sine > 0.0, angle / np.maximum(sine, 1e-300), 1.0)[:, None])


def _first(normal: Vector) -> Vector:
    leads = np.where(np.abs(normal[:, :1]) > ALONG, [[0.0, 0.0, 1.0]], [[1.0, 0.0, 0.0]])
    along = leads - (leads * normal).sum(axis=1, keepdims=True) * normal
    return np.asarray(along / np.linalg.norm(along, axis=1, keepdims=True))


def _tensors(stress: Vector) -> Vector:
    """Of rows (n, 6), xx yy zz xy yz xz, the symmetric tensors (n, 3, 3)."""
    return np.asarray(stress[:, [[0, 3, 5], [3, 1, 4], [5, 4, 2]]])


def _local(tensor: Vector, axes: Vector) -> Vector:
    """Tensors (n, 3, 3) along rows (n, 3, 3)."""
    return np.asarray(axes @ tensor @ axes.transpose(0, 2, 1))


def _flat(tensor: Vector) -> Vector:
    """11, 22, 12 of (n, 3, 3)."""
    return np.asarray(np.stack([tensor[:, 0, 0], tensor[:, 1, 1], tensor[:, 0, 1]], axis=1))

"""Stresses at the nodes by superconvergent patch recovery (Zienkiewicz and Zhu 1992); theory (Z1), (Z2), (Z5)."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import scipy.sparse as sp
from numpy.typing import NDArray

from abut._core import evaluate_patches, fit_patches, shape_functions, stress_errors
from abut.bodies.evaluation import History
from abut.bodies.image_cells import ImageCells, image_cells, planes_of
from abut.bodies.solids import UNHEATED, Array, Group, Solids, TemperatureChange
from abut.bodies.stress import PointStress, point_stress
from abut.cells import CELLS
from abut.materials.material import Material, linear
from abut.materials.places import Places, is_local, placed
from abut.mesh.patches import Patches
from abut.mesh.quadrature import Rule, error_rule, superconvergent_rule
from abut.types import Sparse

HEAVY = 1.0  # weight of all equations at a patch's surface over that of its samples
PLANE = (0, 1, 2, 3)  # components in 2D


@dataclass(frozen=True)
class Equations:
    """What is known of the stress at the surface. x: (n, dim); coefficients: (n, 4 or 6) of xx yy zz xy (yz zx), shear
    doubled, whose sum with the stress is value (n,); of: (n_patches, n) CSR, nonzero where an equation takes part in a
    patch; planes: (n_patches, 3) planes through its corner that mirror a patch, -1 for none; normals: (n_planes, dim); bare:
    (n_patches,) patches that end at a surface which no plane continues; node: (m,) points of the mesh, of one body each, at
    which the whole stress is known, given: (m, 4 or 6)."""

    x: Array
    coefficients: Array
    value: Array
    of: Sparse
    planes: NDArray[np.int32]
    normals: Array
    bare: NDArray[np.bool_]
    node: NDArray[np.int64]
    given: Array


def no_equations(of: Patches, dim: int) -> Equations:
    """Nothing is known."""
    n, none = len(of.corner), np.zeros((0, 4 if dim == 2 else 6))
    return Equations(
        np.zeros((0, dim)), none, np.zeros(0), sp.csr_matrix((n, 0)),
        np.full((n, 3), -1, dtype=np.int32), np.zeros((0, dim)), np.diff(of.skin.indptr) > 0,
        np.zeros(0, dtype=np.int64), none,
    )  # fmt: skip


def recovered(solids: Solids, points: Array, stress: PointStress, known: Equations | None = None) -> Array:
    """Stresses xx yy zz xy yz zx of each body at its points, (n_values, 6) in the order of ``solids.patches``, fitted to
    those at the integration points. points: (n_points, dim) where they are now."""
    of, dim = solids.patches, points.shape[1]
    if known is None:
        known = no_equations(of, dim)
    used, fits = _used(dim), _fits(solids, points, stress, known)
    result = np.zeros((len(of.point), 6))
    result[:, used] = evaluate_patches(
        np.ascontiguousarray(points[of.point]), of.blend.indptr.astype(np.int64), of.blend.indices.astype(np.int64),
        of.blend.data, *fits,
    )  # fmt: skip
    value = np.zeros(len(points), dtype=np.int64)
    value[of.point] = np.arange(len(of.point))
    result[value[known.node][:, None], used] = known.given
    return result


def in_cells(solids: Solids, points: Array, stress: PointStress, known: Equations) -> list[Array | None]:
    """Of each block of the mesh the mean of the polynomials of its cells' corners at the cells' nodes, (n, n_nodes, 6); None
    for cells with other nodes than corners, or without a material. points, known: as in ``recovered``."""
    of, dim = solids.patches, points.shape[1]
    fits, patch = _fits(solids, points, stress, known), np.full(len(of.point), -1, dtype=np.int64)
    patch[of.corner] = np.arange(len(of.corner))
    result: list[Array | None] = []
    for block, nodes in zip(solids.mesh.blocks, of.nodes):
        if CELLS[block.kind].degree > 1 or not len(nodes) or (nodes < 0).all():
            result.append(None)
            continue
        some = nodes[(nodes >= 0).all(axis=1)]
        n, k = some.shape
        values = np.zeros((*nodes.shape, 6))
        found = evaluate_patches(
            np.ascontiguousarray(points[of.point[some]].reshape(n * k, dim)), np.arange(0, n * k * k + 1, k),
            np.repeat(patch[some], k, axis=0).ravel(), np.full(n * k * k, 1.0 / k), *fits,
        )  # fmt: skip
        full = np.zeros((n * k, 6))
        full[:, _used(dim)] = found
        values[(nodes >= 0).all(axis=1)] = full.reshape(n, k, 6)
        result.append(values)
    return result


def _used(dim: int) -> list[int]:
    return list(PLANE) if dim == 2 else list(range(6))


def _fits(solids: Solids, points: Array, stress: PointStress, known: Equations) -> tuple[Array, Array, Array]:
    """Middles, coefficients and metrics of the patches' polynomials, as ``evaluate_patches`` takes them."""
    of, dim = solids.patches, points.shape[1]
    inner = (of.degree == 1) & ~known.bare
    centre = np.ascontiguousarray(points[of.point[of.corner]])
    images = image_cells(of.around, planes_of(known.planes, centre), dim)
    cells = _widened(of, inner | known.bare, images)
    coefficients, metrics = fit_patches(
        _with_images(_samples(solids, points, stress, _used(dim)), images),
        (centre, cells.indptr.astype(np.int64), cells.indices.astype(np.int64),
         np.where(inner, 2, of.degree).astype(np.int32)),
        (known.planes, known.normals),
        (known.of.indptr.astype(np.int64), known.of.indices.astype(np.int64), known.x, known.coefficients, known.value),
        HEAVY,
    )  # fmt: skip
    return centre, coefficients, metrics


def at_points(of: Patches, values: Array, n_points: int) -> Array:
    """Values (n_values, 6) at the mesh's points, (n_points, 6): the mean of those of the bodies that share one, 0 where
    there are none."""
    total = np.zeros((n_points, values.shape[1]))
    if not of.shared:
        total[of.point] = values
        return total
    for column in range(values.shape[1]):
        total[:, column] = np.bincount(of.point, values[:, column], n_points)
    return np.asarray(total / np.maximum(np.bincount(of.point, minlength=n_points), 1)[:, None])


def nodal_stress(
    solids: Solids, displacement: Array, temperature: TemperatureChange = UNHEATED, history: History | None = None
) -> Array:
    """Stresses at the points (n_points, 6) under a displacement (n_points, dim), of which nothing is known at the surface:
    ``point_stress`` recovered."""
    stress = point_stress(solids, displacement, temperature, history)
    points = solids.points + displacement if solids.kinematics == "finite" else solids.points
    return at_points(solids.patches, recovered(solids, np.ascontiguousarray(points), stress), len(points))


def energies(solids: Solids, points: Array, stress: PointStress, values: Array) -> Array:
    """Of each cell (n_cells, 3) int e C^-1 e of the recovered less the element's stress, the same of the recovered one, and
    the volume; theory (Z6). values: (n_values, 6)."""
    of, result = solids.patches, np.zeros((solids.mesh.n_cells, 3))
    compliance, which = compliances(solids)
    for group, at in zip(solids.groups(), stress):
        rule = error_rule(group.kind)
        shapes, derivatives = shape_functions(CELLS[group.kind].code, np.ascontiguousarray(rule[0]))
        at = np.ascontiguousarray(carried(group.kind, group.rule, rule[0]) @ at).reshape(-1, 6)
        result[group.cells] = stress_errors(
            points, group.nodes, (shapes, derivatives, rule[1]), solids.mesh.axisymmetric, at,
            (_own(solids, of, group), values), (compliance, which[group.cells]),
        )  # fmt: skip
    return result


def _own(solids: Solids, of: Patches, group: Group) -> NDArray[np.int32]:
    block = int(np.searchsorted(solids.mesh.starts, group.cells[0], side="right")) - 1
    return np.ascontiguousarray(of.nodes[block][group.cells - solids.mesh.starts[block]])


def compliances(solids: Solids) -> tuple[Array, NDArray[np.int32]]:
    """(k, 6, 6) at rest, and which each cell has, (n_cells,): that of its body, or one in its own middle."""
    which = solids.body_of.copy()
    found = []
    for number, material in enumerate(solids.materials.values()):
        if not is_local(material):
            found.append(_compliance(material)[None])
            which[solids.body_of == number] = sum(map(len, found)) - 1
            continue
        cells = np.flatnonzero(solids.body_of == number)
        centre = _spread(solids, solids.points)[cells, 0]
        here = placed(material, Places(centre, np.zeros(len(cells))))
        tangent = here.evaluate(np.zeros((len(cells), 6)), here.initial(len(cells)))[1]
        which[cells] = sum(map(len, found)) + np.arange(len(cells))
        found.append(np.asarray(np.linalg.pinv(tangent, hermitian=True), dtype=float))
    return np.concatenate(found), which


def _compliance(material: Material) -> Array:
    """(6, 6), at rest."""
    rest = linear(material)
    if rest is not None:
        result = np.diag([1.0] * 3 + [2.0] * 3) * (1.0 + rest.poisson)
        result[:3, :3] -= rest.poisson
        return np.asarray(result / rest.young)
    tangent = material.evaluate(np.zeros((1, 6)), material.initial(1))[1][0]
    return np.ascontiguousarray(np.linalg.pinv(tangent, hermitian=True))


Samples = tuple[Array, Array, NDArray[np.int64], Array]


def _samples(solids: Solids, points: Array, stress: PointStress, used: list[int]) -> Samples:
    """Positions (m, dim) and stresses (m, 4 or 6) at the points where they are best, cell after cell, the first of each
    cell, (n_cells + 1,), and ``_spread``."""
    count = np.zeros(solids.mesh.n_cells, dtype=np.int64)
    groups = solids.groups()
    rules = [superconvergent_rule(group.kind) for group in groups]
    for group, rule in zip(groups, rules):
        count[group.cells] = len(rule[1])
    first = np.concatenate([[0], np.cumsum(count)])
    x, values = np.empty((first[-1], points.shape[1])), np.empty((first[-1], 6))
    for group, rule, at in zip(groups, rules, stress):
        rows = first[group.cells][:, None] + np.arange(len(rule[1]))
        shapes, _ = shape_functions(CELLS[group.kind].code, np.ascontiguousarray(rule[0]))
        x[rows] = shapes @ points[group.nodes]
        values[rows] = carried(group.kind, group.rule, rule[0]) @ at
    return x, np.ascontiguousarray(values[:, used]), first, _spread(solids, points)


def _spread(solids: Solids, points: Array) -> Array:
    """Mean of the corners of each cell and their second moments about it, (n_cells, dim + 1, dim)."""
    dim = points.shape[1]
    result = np.zeros((solids.mesh.n_cells, dim + 1, dim))
    for block, first in zip(solids.mesh.blocks, solids.mesh.starts.tolist()):
        x = points[block.nodes[:, : CELLS[block.kind].corners]]
        mean = x.mean(axis=1)
        apart = x - mean[:, None]
        rows = slice(first, first + len(x))
        result[rows, 0] = mean
        result[rows, 1:] = np.swapaxes(apart, 1, 2) @ apart / x.shape[1]
    return result


def carried(kind: str, rule: Rule, xi: Array) -> Array:
    """Linear (on quadrilaterals and hexahedra linear along each axis) fit over a cell to values at the points of a rule, at
    points xi: (len(xi), points)."""
    if len(rule[0]) == len(xi) and np.allclose(rule[0], xi, rtol=0.0, atol=1e-14):
        return np.eye(len(xi))
    root = np.sqrt(np.abs(rule[1]))[:, None]
    terms = _monomials(kind, rule[0])
    rank = np.linalg.matrix_rank(root * terms)
    while terms.shape[1] > rank:  # fewer points: constant
        terms = terms[:, :1]
        rank = 1
    return np.asarray(_monomials(kind, xi)[:, : terms.shape[1]] @ np.linalg.pinv(root * terms) * root.T)


def _monomials(kind: str, xi: Array) -> Array:
    """Of degree 1, for cubes and along wedges times each other."""
    columns = [np.ones(len(xi))]
    if kind.startswith(("quad", "hex")):
        for a in range(xi.shape[1]):
            columns += [column * xi[:, a] for column in columns]
    else:
        columns += [xi[:, a] for a in range(xi.shape[1])]
        if kind.startswith("wedge"):
            columns += [xi[:, 0] * xi[:, 2], xi[:, 1] * xi[:, 2]]
    return np.stack(columns, axis=1)


def _widened(of: Patches, wide: NDArray[np.bool_], images: ImageCells) -> Sparse:
    """The cells of each patch, of some also those around the corners of these, with images beyond planes but for those by
    planes through the patch's own corner, of which it has the images of all its cells."""
    rows = np.flatnonzero(wide)
    more = (of.around[rows] @ of.around.T) @ images.around
    more = _pattern(more - more.multiply(images.own[rows] > 0.0))
    if wide.all():
        return more
    place = sp.csr_matrix((np.ones(len(rows)), (rows, np.arange(len(rows)))), shape=(len(of.corner), len(rows)))
    plain = sp.hstack([of.around, sp.csr_matrix((len(of.corner), len(images.cell)))])
    return (plain + place @ more).tocsr()


def _pattern(matrix: Sparse) -> Sparse:
    result = matrix.tocsr()
    result.eliminate_zeros()
    return result


def _with_images(samples: Samples, images: ImageCells) -> Samples:
    """The same with those of image cells after the cells' own."""
    x, values, first, spread = samples
    if not len(images.cell):
        return samples
    dim, count = x.shape[1], np.diff(first)[images.cell]
    which = np.repeat(np.arange(len(count)), count)
    rows = first[images.cell][which] + np.arange(len(which)) - np.repeat(np.cumsum(count) - count, count)
    mean, moments = spread[images.cell, 0], spread[images.cell, 1:]
    sign = np.where(images.turned, -1.0, 1.0)
    every = np.arange(len(count))
    more = np.concatenate([images.places(mean, every)[:, None], sign[:, :, None] * moments * sign[:, None]], axis=1)
    return (
        np.concatenate([x, images.places(x[rows], which)]), np.concatenate([values, images.tensors(values[rows], which)]),
        np.concatenate([first, first[-1] + np.cumsum(count)]), np.concatenate([spread, more.reshape(-1, dim + 1, dim)]),
    )  # fmt: skip

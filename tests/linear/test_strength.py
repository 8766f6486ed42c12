"""Multigrid on long and thin cells: what is near, what aggregates take in, and iterations that shapes leave alone."""

from __future__ import annotations

import numpy as np
import pytest
import scipy.sparse as sp
import scipy.sparse.linalg as spla
from numpy.typing import NDArray
from pyamg.aggregation import standard_aggregation

import abut
from abut._core import strong_part
from abut.bodies.assemble import stiffness
from abut.bodies.rigid_modes import rigid_modes
from abut.bodies.solids import Solids
from abut.linear import strength
from abut.linear.multigrid import hierarchy
from abut.linear.strength import means, near
from abut.mesh.make import box
from abut.mesh.mesh import Mesh

STEEL = abut.LinearElastic(210e3, 0.3)


def blocks_of(mesh: Mesh) -> sp.bsr_matrix:
    return stiffness(Solids(mesh, {"body": STEEL})).tobsr((3, 3))


def slab(flat: float, cell: str = "hex8") -> Mesh:
    """Cells ``flat`` times as long and wide as high."""
    return box((0, 6 * flat), (0, 6 * flat), (0, 12), (6, 6, 12), cell)


def test_strong_part_equals_its_twin() -> None:
    """On a random pattern, with no couplings at all in one row, against plain loops."""
    random = np.random.default_rng(1)
    n, reach = 30, 1.5
    pattern = sp.random(n, n, 0.2, random_state=2).toarray() != 0
    pattern |= pattern.T | np.eye(n, dtype=bool)
    pattern[4], pattern[:, 4] = np.arange(n) == 4, np.arange(n) == 4
    rows, columns = np.nonzero(pattern)
    points, values = random.random((n, 3)), random.standard_normal((len(rows), 2, 2))
    indptr = np.concatenate([[0], np.cumsum(pattern.sum(axis=1))]).astype(np.int32)
    found = strong_part(indptr, columns.astype(np.int32), values, points, reach)
    got = sp.bsr_matrix((found[2].reshape(-1, 2, 2), found[1], found[0]), shape=(2 * n, 2 * n)).toarray()
    distance = np.linalg.norm(points[:, None] - points, axis=2)
    nearest = np.where(pattern & ~np.eye(n, dtype=bool), distance, np.inf).min(axis=1)
    nearest[4] = 0.0
    expected = np.zeros((n, n, 2, 2))
    for i, j, value in zip(rows, columns, values):
        weak = distance[i, j] > reach * max(nearest[i], nearest[j])
        expected[i, i if weak else j] += value
    assert 0 < len(found[1]) < len(rows)
    assert got == pytest.approx(expected.transpose(0, 2, 1, 3).reshape(2 * n, 2 * n), abs=1e-14)


@pytest.mark.parametrize("cell", ["hex8", "tet4", "wedge6"])
def test_cubes_are_all_near(cell: str) -> None:
    mesh = slab(1.0, cell)
    matrix = blocks_of(mesh)
    assert near(matrix, mesh.points) is matrix


@pytest.mark.parametrize("cell", ["hex8", "hex20", "tet10"])
def test_thin_cells_are_lumped_across(cell: str) -> None:
    """Aggregates are columns of points above each other; a translation strains the strong part no more than the whole."""
    mesh = slab(20.0, cell)
    matrix = blocks_of(mesh)
    strong = near(matrix, mesh.points)
    graph = sp.csr_matrix((np.ones(len(strong.indices), dtype=np.int8), strong.indices, strong.indptr))
    aggregates, _ = standard_aggregation(graph)
    where = np.round(means(aggregates, mesh.points)[:, :2], 6)
    columns = np.unique(np.round(mesh.points[:, :2], 6), axis=0)
    assert len(np.unique(where, axis=0)) == len(columns)
    assert aggregates.shape[1] < len(mesh.points) / 2
    moved = np.tile([1.0, 2.0, -3.0], len(mesh.points))
    assert np.abs(strong @ moved).max() < 1e-9 * np.abs(matrix.data).max()


def iterations(mesh: Mesh) -> int:
    """Of conjugate gradients with one cycle each, for a block held at its bottom, to 1e-8."""
    n = mesh.points.size
    held = (3 * mesh.nodes_of("bottom")[:, None] + np.arange(3)).ravel()
    free = sp.identity(n, format="csc")[:, np.setdiff1d(np.arange(n), held)]
    matrix = (free.T @ stiffness(Solids(mesh, {"body": STEEL})) @ free).tocsr()
    levels = hierarchy(matrix, free, free.T @ rigid_modes(mesh).together, mesh.points)
    count: list[NDArray[np.float64]] = []
    cycle = spla.LinearOperator(matrix.shape, matvec=levels.cycle, dtype=float)
    load = np.random.default_rng(3).standard_normal(matrix.shape[0])
    _, failed = spla.cg(matrix, load, rtol=1e-8, maxiter=300, M=cycle, callback=count.append)
    assert not failed
    return len(count)


@pytest.mark.parametrize("cell", ["hex8", "tet10"])
def test_iterations_do_not_grow_with_the_aspect_ratio(cell: str, monkeypatch: pytest.MonkeyPatch) -> None:
    """Lumped across, thin cells cost no more than twice the iterations of cubes; lumped blindly, they do."""
    cubes = iterations(slab(1.0, cell))
    thin = iterations(slab(30.0, cell))
    assert thin <= 2 * cubes
    monkeypatch.setattr(strength, "REACH", np.inf)
    assert iterations(slab(30.0, cell)) > 2 * thin


def test_iterations_of_a_graded_mesh() -> None:
    """Cells that grow away from a corner 40 times in all directions, flat ones among them."""
    fine = {"x": [0.0, 1.0], "y": [0.0, 1.0], "z": [7.0, 8.0]}
    graded = box((0, 8), (0, 8), (0, 8), (5, 5, 5), "hex8", fine, 1.5)
    assert iterations(graded) <= 2 * iterations(box((0, 8), (0, 8), (0, 8), (12, 12, 12), "hex8"))

"""What is divided among processes adds up to the whole; without any MPI."""

from __future__ import annotations

from dataclasses import fields
from typing import Any

import numpy as np
import pytest
import scipy.sparse as sp

from abut.bodies.assemble import stiffness
from abut.bodies.solids import Solids
from abut.contact.coupling import CouplingOptions, couple
from abut.contact.merging import added
from abut.materials.elastic import LinearElastic
from abut.mesh.make import box, join, rectangle
from abut.mesh.mesh import Mesh
from abut.parallel import part
from abut.parallel.partition import cell_graph, layout, pieces, point_owners
from models.patch import two_blocks

PAIRS = [("hex8", "hex8"), ("tet10", "hex20"), ("wedge6", "tet4"), ("hex27", "wedge15"), ("quad8", "tri6")]


def blocks(lower: str, upper: str) -> Mesh:
    plane = lower in ("quad8", "tri6")
    return two_blocks(lower, upper, ((3, 2), (4, 3)) if plane else ((3, 2, 2), (2, 3, 2)))


def close(a: object, b: object) -> None:
    if sp.issparse(a):
        assert abs(a - b).max() <= 1e-15 * abs(a).max()
    else:
        assert np.array_equal(a, b, equal_nan=True) or np.abs(a - b).max() <= 1e-15 * np.abs(a).max()


@pytest.mark.parametrize("tied", [False, True])
@pytest.mark.parametrize("pair", PAIRS)
def test_couplings_of_parts_add_up(pair: tuple[str, str], tied: bool) -> None:
    """Each facet by itself sees what it sees in the whole: one part is empty."""
    mesh = blocks(*pair)
    contactor, target = mesh.surface("lower.top"), mesh.surface("upper.bottom")
    options = CouplingOptions(keep_points=True, keep_gap_samples=True, componentwise=tied)
    whole = couple(contactor, target, 1, options)
    owner = np.arange(len(contactor)) % 3
    parts = [couple(contactor, target, 1, options, owner == rank) for rank in (0, 1, 2, 3)]
    assert not parts[3].segments.any()
    assert all(part.segments.any() for part in parts[:3])
    together = added(parts)
    for field in fields(whole):
        a, b = getattr(whole, field.name), getattr(together, field.name)
        if field.name in ("points", "gap_samples"):
            for own in fields(a):
                close(getattr(a, own.name), getattr(b, own.name))
        elif field.name != "degree":
            close(a, b)


def glued() -> Mesh:
    """Hexahedra and wedges that share no nodes, in one mesh."""
    return join({"a": box(cells=(2, 3, 2), cell="hex20"), "b": box(z=(2.0, 3.0), cells=(2, 2, 1), cell="wedge15")})


@pytest.mark.parametrize("size", [1, 3, 40])
def test_pieces_make_the_whole(size: int) -> None:
    mesh = glued()
    owner = np.random.default_rng(1).integers(0, size, mesh.n_cells)
    material = {"a": LinearElastic(2.0, 0.3), "b": LinearElastic(5.0, 0.2)}
    total = sp.csr_matrix((mesh.points.size,) * 2)
    seen = np.zeros(mesh.n_cells, dtype=int)
    for piece in pieces(mesh, owner, size):
        seen[piece.cells] += 1
        if not len(piece.cells):
            continue
        columns = (3 * piece.points[:, None] + np.arange(3)).ravel()
        spread = sp.csr_matrix(
            (np.ones(len(columns)), (columns, np.arange(len(columns)))), (mesh.points.size, len(columns))
        )
        total = total + spread @ stiffness(Solids(piece.mesh, material)) @ spread.T
        assert sorted(piece.mesh.bodies) == ["a", "b"]
    assert (seen == 1).all()
    whole = stiffness(Solids(mesh, material))
    assert abs(total - whole).max() < 1e-14 * abs(whole).max()


def test_cells_are_neighbours_by_facets() -> None:
    """A row of squares, and of the two triangles of each: what touches at a corner alone is no neighbour."""
    line = cell_graph(rectangle(cells=(4, 1), cell="quad4")).toarray()
    assert np.array_equal(line, np.eye(4, k=1) + np.eye(4, k=-1))
    grid = cell_graph(box(cells=(3, 3, 3), cell="hex8"))
    assert grid.nnz == 2 * 3 * 2 * 9  # both sides of the inner facets
    assert cell_graph(glued()).toarray()[:12, 12:].sum() == 0


@pytest.mark.parametrize("coupled", [False, True])
def test_layout_has_a_place_for_each(coupled: bool) -> None:
    """Places are different, each with the process of its point; points stay together, filled up."""
    mesh = glued()
    owner = np.random.default_rng(2).integers(0, 3, mesh.n_cells)
    points = point_owners(mesh, owner)
    kept = np.random.default_rng(3).random(mesh.points.size) < 0.7
    free = sp.identity(mesh.points.size, format="csr")[:, kept]
    places = layout(free, points, 3, 4, coupled)
    assert len(np.unique(places.slot)) == free.shape[1]
    process = np.searchsorted(places.starts, places.slot, side="right") - 1
    of_point = np.flatnonzero(kept) // 3
    assert np.array_equal(process, points[of_point])
    assert places.starts[-1] == (free.shape[1] if coupled else 3 * len(np.unique(of_point)))
    if not coupled:
        assert len(np.unique(np.column_stack([of_point, places.slot // 3]), axis=0)) == len(np.unique(of_point))
    values = np.random.default_rng(4).random((free.shape[1], 2))
    assert np.array_equal(places.values([share for (share,) in places.shares(values)]), values)


def test_forces_of_a_part_are_the_same_without_its_matrix() -> None:
    """A part whose matrix has made room integrates its forces anew, for every column; one without cells has none."""
    mesh = glued()
    own = Solids(mesh, {"a": LinearElastic(2.0, 0.3), "b": LinearElastic(5.0, 0.2)})
    store: dict[str, Any] = {}
    part.assemble(store, own)
    u = np.random.default_rng(5).uniform(-1, 1, (mesh.points.size, 2))
    with_matrix = part.internal(store, u)
    del store["stiffness"]
    for moved, force in ((u, with_matrix), (u[:, 0], with_matrix[:, 0])):
        assert np.abs(part.internal(store, moved) - force).max() < 1e-14 * np.abs(force).max()
    empty = pieces(mesh, np.zeros(mesh.n_cells, dtype=int), 2)[1].mesh
    part.assemble(store, Solids(empty, own.materials))
    assert store["stiffness"].shape == (0, 0)
    del store["stiffness"]
    assert part.internal(store, np.zeros((0, 2))).shape == (0, 2)
    assert part.stresses(store, {}, np.zeros((0, 3)), np.zeros(0), {}) == ((), [])

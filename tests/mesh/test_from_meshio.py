"""Meshes of meshio: names, node order, and what abut does not have."""

from __future__ import annotations

from pathlib import Path
from types import SimpleNamespace

import numpy as np
import pytest

import abut
from abut.cells import CELLS
from abut.mesh.from_meshio import TYPES
from abut.mesh.make import box, join, rectangle
from abut.mesh.write import write_mesh

NAMES = {kind: name for name, kind in TYPES.items()}


def as_meshio(mesh: abut.Mesh) -> SimpleNamespace:
    """A mesh as meshio keeps it: blocks of cells, then of facets; sets by block."""
    blocks = [SimpleNamespace(type=NAMES[b.kind], data=b.nodes) for b in mesh.blocks]
    sets: dict[str, list[np.ndarray]] = {}
    facets = {}
    for name, rows in mesh.surfaces.items():
        surface = mesh.surface(name)
        kind = next(cell for cell in CELLS.values() if cell.code == surface.kinds[0])
        facets[name] = SimpleNamespace(type=NAMES[kind.name], data=surface.nodes[:, : kind.nodes])
        assert len(rows) == len(surface)
    every = [*blocks, *facets.values()]
    nothing = np.zeros(0, dtype=int)
    for name, cells in mesh.bodies.items():
        sets[name] = [cells[(cells >= first) & (cells < first + len(b.nodes))] - first
                      for b, first in zip(mesh.blocks, mesh.starts)] + [nothing] * len(facets)  # fmt: skip
    for i, name in enumerate(facets):
        sets[name] = [np.arange(len(b.data)) if j == len(blocks) + i else nothing for j, b in enumerate(every)]
    points = np.column_stack([mesh.points, np.zeros((len(mesh.points), 3 - mesh.dim))])
    return SimpleNamespace(points=points, cells=every, cell_sets=sets, point_sets=dict(mesh.node_sets))


@pytest.mark.parametrize(
    "cell", ["quad4", "quad8", "quad9", "tri3", "tri6", "hex8", "hex20", "hex27", "tet4", "tet10", "wedge6", "wedge15"]
)
def test_a_mesh_comes_back(cell: str) -> None:
    make = rectangle if CELLS[cell].dim == 2 else box
    cells = (2, 3) if CELLS[cell].dim == 2 else (2, 3, 1)
    mesh = join({"a": make(cells=cells, cell=cell), "b": make((2.0, 3.0), cells=cells, cell=cell)})
    again = abut.from_meshio(as_meshio(mesh))
    assert {*again.bodies} == {"a", "b"}
    assert {*again.surfaces} == {*mesh.surfaces}
    for name in mesh.surfaces:
        one, other = mesh.surface(name), again.surface(name)
        assert sorted(map(tuple, one.points[one.node_ids])) == sorted(map(tuple, other.points[other.node_ids]))


def test_physical_groups_of_gmsh() -> None:
    """Numbers of groups, of which the same may be of a line and of a face."""
    mesh = SimpleNamespace(
        points=np.array([[0.0, 0.0, 0.0], [1, 0, 0], [1, 1, 0], [0, 1, 0]]),
        cells=[("line", np.array([[0, 1], [1, 2]])), ("quad", np.array([[0, 1, 2, 3]]))],
        cell_data={"gmsh:physical": [np.array([1, 2]), np.array([1])]},
        field_data={"bottom": np.array([1, 1]), "right": np.array([2, 1]), "plate": np.array([1, 2])},
    )
    made = abut.from_meshio(mesh)
    assert list(made.bodies) == ["plate"]
    assert sorted(made.nodes_of("right").tolist()) == [1, 2]
    assert sorted(made.nodes_of("bottom").tolist()) == [0, 1]


def test_what_meshio_itself_reads(tmp_path: Path) -> None:
    """A file that abut has written, where meshio is installed: cells and points."""
    meshio = pytest.importorskip("meshio")
    mesh = join({"a": box(cells=(2, 2, 2), cell="hex20")})
    write_mesh(tmp_path / "a.vtu", mesh)
    made = meshio.Mesh(mesh.points, [("hexahedron20", mesh.blocks[0].nodes)], cell_sets={"a": [np.arange(8)]})
    made.write(tmp_path / "b.vtk")
    again = abut.from_meshio(meshio.read(tmp_path / "b.vtk"))
    assert again.points == pytest.approx(mesh.points)
    assert (again.blocks[0].nodes == mesh.blocks[0].nodes).all()


def test_what_abut_does_not_have() -> None:
    points = np.zeros((5, 3))
    with pytest.raises(abut.InputError, match="cells of type 'pyramid' are not known"):
        abut.from_meshio(SimpleNamespace(points=points, cells=[("pyramid", np.arange(5)[None])]))
    with pytest.raises(abut.InputError, match="expected points of 2 or 3 coordinates"):
        abut.from_meshio(SimpleNamespace(points=np.zeros((5, 4)), cells=[]))
    with pytest.raises(abut.InputError, match="cell set 'a' has 2 parts, and there are 1 blocks"):
        abut.from_meshio(
            SimpleNamespace(points=points, cells=[("tetra", np.arange(4)[None])], cell_sets={"a": [[0], [1]]})
        )

"""Mesh files, checks and generators."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from abut._core import single_rows
from abut.bodies.loads import body_load
from abut.errors import InputError
from abut.io.vtu import write_vtu
from abut.mesh.check import check_mesh
from abut.mesh.facets import row_codes
from abut.mesh.make import box, cylinder, disc, half_disc, join, rectangle, sphere_octant
from abut.mesh.mesh import CellBlock, Mesh

PIN_LUG = Path(__file__).parents[2] / "examples" / "pin-lug" / "pin-lug.msh"
TWO_SQUARES = """$MeshFormat
2.2 0 8
$EndMeshFormat
$PhysicalNames
3
1 7 "side"
2 1 "left half"
2 2 "right half"
$EndPhysicalNames
$Nodes
7
1 0 0 0
2 1 0 0
3 1 1 0
4 0 1 0
5 2 0 0
6 2 1 0
9 5 5 5
$EndNodes
$Elements
3
1 1 2 7 1 4 1
2 3 2 1 1 1 2 3 4
3 3 2 2 2 2 5 6 3
$EndElements
"""
TWO_SQUARES_4 = """$MeshFormat
4.1 0 8
$EndMeshFormat
$PhysicalNames
4
1 7 "side"
1 8 "all"
2 1 "left half"
2 2 "right half"
$EndPhysicalNames
$Entities
0 1 2 0
1 0 0 0 0 1 0 2 7 8 0
1 0 0 0 1 1 0 1 1 0
2 1 0 0 2 1 0 1 2 0
$EndEntities
$Nodes
1 6 1 6
2 1 0 6
1
2
3
4
5
6
0 0 0
1 0 0
1 1 0
0 1 0
2 0 0
2 1 0
$EndNodes
$Elements
3 3 1 3
1 1 1 1
1 4 1
2 1 3 1
2 1 2 3 4
2 2 3 1
3 2 5 6 3
$EndElements
"""


def volume(mesh: Mesh) -> float:
    direction = np.eye(mesh.dim)[0]
    return float(body_load(mesh, dict.fromkeys(mesh.bodies, direction)).sum())


@pytest.mark.parametrize("text", [TWO_SQUARES, TWO_SQUARES_4], ids=["2.2", "4.1"])
def test_gmsh_groups_become_bodies_and_surfaces(text: str, tmp_path: Path) -> None:
    path = tmp_path / "two.msh"
    path.write_text(text)
    mesh = Mesh.read(path)
    assert mesh.dim == 2
    assert set(mesh.bodies) == {"left half", "right half"}
    assert len(mesh.points) == 6  # the unused point is gone
    side = mesh.surface("side")
    assert mesh.points[side.node_ids][:, 0] == pytest.approx(0.0)
    if "4.1" in text:  # an entity in two groups belongs to both
        assert np.array_equal(mesh.surfaces["all"], mesh.surfaces["side"])
    assert volume(mesh) == pytest.approx(2.0)


def test_binary_gmsh_of_second_order() -> None:
    """The committed mesh of the pin and lug: quarter volumes of the ideal shapes, to the error of parabolic edges."""
    mesh = Mesh.read(PIN_LUG)
    assert set(mesh.bodies) == {"pin", "lug"}
    assert {block.kind for block in mesh.blocks} == {"tet10"}
    pin = 0.5 * np.pi * 9.9**2 * 14.0
    lug = (45.0 * 22.0 + 0.25 * np.pi * 22.0**2 - 0.5 * np.pi * 10.0**2) * 8.0
    assert volume(mesh) == pytest.approx(pin + lug, rel=1e-4)


@pytest.mark.parametrize("cut", [0.02, 0.3, 0.5, 0.7, 0.9, 0.97])
@pytest.mark.parametrize("source", ["2.2", "4.1", "binary", "garbage"])
def test_damaged_files_are_refused(source: str, cut: float, tmp_path: Path) -> None:
    data = {
        "2.2": TWO_SQUARES.encode(),
        "4.1": TWO_SQUARES_4.encode(),
        "binary": PIN_LUG.read_bytes(),
        "garbage": b"$MeshFormat\n4.1 0 8\n$EndMeshFormat\n$Nodes\n" + bytes(range(256)) * 20,
    }[source]
    path = tmp_path / "cut.msh"
    path.write_bytes(data[: int(cut * len(data))])
    with pytest.raises(InputError, match=r"cut\.msh"):
        Mesh.read(path)


def test_vtu_round_trip(tmp_path: Path) -> None:
    made = join({"a": box(cells=(2, 2, 2), cell="hex20"), "b": box(z=(2, 3), cells=(1, 1, 1), cell="wedge15")})
    path = tmp_path / "made.vtu"
    write_vtu(path, made.points, [(b.kind, b.nodes) for b in made.blocks], {"x": made.points[:, 0]})
    read = Mesh.read(path)
    assert set(read.bodies) == {"body_1", "body_2"}
    assert volume(read) == pytest.approx(2.0)
    path.write_text("<VTKFile>")
    with pytest.raises(InputError, match="not a readable VTU"):
        Mesh.read(path)


def test_inverted_and_flat_cells_are_named() -> None:
    square = np.array([[0.0, 0], [1, 0], [1, 1], [0, 1]])
    for order in ([[0, 3, 2, 1]], [[0, 1, 1, 0]]):
        block = CellBlock("quad4", np.array(order, dtype=np.int32))
        with pytest.raises(InputError, match="cells 0"):
            check_mesh(Mesh(square, (block,), {"one": np.array([0])}))


def test_points_that_are_no_numbers() -> None:
    mesh = rectangle(cells=(1, 1), cell="quad4")
    mesh.points[0, 0] = np.nan
    with pytest.raises(InputError, match="not numbers"):
        check_mesh(mesh)


@pytest.mark.parametrize("cell", ["tri3", "tri6", "quad4", "quad8", "quad9"])
def test_half_disc(cell: str) -> None:
    mesh = half_disc(2.0, cells=8, cell=cell)
    check_mesh(mesh)
    assert volume(mesh) == pytest.approx(2.0 * np.pi, rel=0.02)
    assert np.linalg.norm(mesh.points[mesh.nodes_of("round")], axis=1) == pytest.approx(2.0)


@pytest.mark.parametrize("cell", ["tri6", "quad8"])
def test_disc(cell: str) -> None:
    mesh = disc(2.0, centre=(1.0, 2.0), cells=6, cell=cell)
    check_mesh(mesh)
    assert volume(mesh) == pytest.approx(4.0 * np.pi, rel=1e-3)


@pytest.mark.parametrize("cell", ["tet10", "hex8", "hex20", "hex27", "wedge15"])
def test_cylinder(cell: str) -> None:
    mesh = cylinder(2.0, z=(0.0, 3.0), cells=(8, 2), cell=cell)
    check_mesh(mesh)
    assert volume(mesh) == pytest.approx(12.0 * np.pi, rel=0.03)


@pytest.mark.parametrize("cell", ["tet4", "tet10", "hex8", "hex20", "hex27", "wedge6", "wedge15"])
def test_sphere_octant(cell: str) -> None:
    mesh = sphere_octant(2.0, cells=3, cell=cell, fine=0.5)
    check_mesh(mesh)
    assert volume(mesh) == pytest.approx(np.pi * 8 / 6, rel=0.03)


def test_fine_zone() -> None:
    mesh = rectangle(x=(-5, 5), y=(-5, 0), cells=(4, 4), cell="quad4", fine={"x": [-1, 1], "y": [-1, 0]})
    x = np.unique(np.round(mesh.points[:, 0], 12))
    assert x[0] == -5.0
    assert x[-1] == 5.0
    assert np.diff(x).min() == pytest.approx(0.5)
    assert volume(mesh) == pytest.approx(50.0)


def test_facets_of_one_cell_only_and_numbers_for_rows() -> None:
    draw = np.random.default_rng(6)
    rows = draw.integers(0, 9, (400, 4)).astype(np.int32)
    rows[::2, 3] = -1
    _, first, count = np.unique(np.sort(rows, axis=1), axis=0, return_index=True, return_counts=True)
    assert np.array_equal(single_rows(rows, 9), np.sort(first[count == 1]))
    with pytest.raises(IndexError, match="does not exist"):
        single_rows(rows, 8)
    for largest in (9, 2**40):  # powers of the second do not fit a number any more
        many = draw.integers(-1, 5, (400, 5)) * (largest // 9)
        _, want = np.unique(many := np.maximum(many, -1), axis=0, return_inverse=True)
        _, got = np.unique(row_codes(many), return_inverse=True)
        assert np.array_equal(got, want.ravel())

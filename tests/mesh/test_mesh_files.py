"""Mesh files: versions of Gmsh's format, groups, VTU names; damaged files end in a message, never in a traceback."""

from __future__ import annotations

import importlib
import random
import time
from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from abut.errors import InputError
from abut.io.raw import RawMesh
from abut.io.vtu import write_vtu
from abut.mesh.make import box, cylinder, join, rectangle
from abut.mesh.mesh import Mesh
from abut.mesh.read import build
from abut.mesh.write import write_mesh
from models.volume import volume

DATA = Path(__file__).parent / "data"


@pytest.fixture
def gmsh() -> Iterator[Any]:
    try:
        module = importlib.import_module("gmsh")
    except (ImportError, OSError) as error:  # its library needs the system's OpenGL libraries
        pytest.skip(f"gmsh cannot be loaded here: {error}")
    module.initialize(interruptible=False)
    module.option.setNumber("General.Terminal", 0)
    yield module
    module.finalize()


def outside(gmsh: Any, tag: int) -> bool:
    """Is this face part of the cylinder of radius 1?"""
    x, y, _ = gmsh.model.getValue(2, tag, [0.5 * sum(b) for b in zip(*gmsh.model.getParametrizationBounds(2, tag))])
    return bool(gmsh.model.getType(2, tag) == "Cylinder" and abs(np.hypot(x, y) - 1.0) < 1e-6)


@pytest.mark.parametrize("binary", [0, 1])
@pytest.mark.parametrize("version", [2.2, 4.1])
@pytest.mark.parametrize("cell", ["tet4", "tet10", "hex8", "hex20", "hex27", "wedge6", "wedge15"])
def test_every_solid_cell_of_gmsh(gmsh: Any, cell: str, version: float, binary: int, tmp_path: Path) -> None:
    """The curved side of a quarter cylinder tells wrong node orders apart: volume and boundary would be off."""
    occ = gmsh.model.occ
    if cell.startswith("tet"):
        occ.addCylinder(0, 0, 0, 0, 0, 1, 1, angle=np.pi / 2)
    else:
        for tag, xy in enumerate([(0, 0), (1, 0), (0, 1), (0.5, 0), (0, 0.5)], start=1):
            occ.addPoint(*xy, 0, tag=tag)
        arcs = [occ.addCircleArc(2, 1, 3), occ.addCircleArc(5, 1, 4)]
        plane = occ.addPlaneSurface([occ.addCurveLoop([occ.addLine(4, 2), arcs[0], occ.addLine(3, 5), arcs[1]])])
        occ.extrude([(2, plane)], 0, 0, 1, numElements=[2], recombine=True)
        occ.synchronize()
        if cell.startswith("hex"):
            for _, curve in gmsh.model.getBoundary([(2, plane)]):
                gmsh.model.mesh.setTransfiniteCurve(abs(curve), 5)
            gmsh.model.mesh.setTransfiniteSurface(plane)
            gmsh.model.mesh.setRecombine(2, plane)
    occ.synchronize()
    round_side = [tag for _, tag in gmsh.model.getEntities(2) if outside(gmsh, tag)]
    gmsh.model.addPhysicalGroup(3, [1], name="quarter")
    gmsh.model.addPhysicalGroup(2, round_side, name="round")
    gmsh.model.addPhysicalGroup(2, round_side, name="round again")
    gmsh.model.addPhysicalGroup(0, [2], name="corner")
    for name, value in {
        "Mesh.MeshSizeMax": 0.5,
        "Mesh.SecondOrderIncomplete": float(cell != "hex27"),
        "Mesh.MshFileVersion": version,
        "Mesh.Binary": binary,
    }.items():
        gmsh.option.setNumber(name, value)
    gmsh.model.mesh.generate(3)
    gmsh.model.mesh.setOrder(1 if cell in ("tet4", "hex8", "wedge6") else 2)
    path = tmp_path / "quarter.msh"
    gmsh.write(str(path))
    mesh = Mesh.read(path)
    assert {block.kind for block in mesh.blocks} == {cell}
    quadratic = cell in ("tet10", "hex20", "hex27", "wedge15")
    exact = np.pi / 4 * (1.0 if cell.startswith("tet") else 0.75)
    assert volume(mesh) == pytest.approx(exact, rel=1e-3 if quadratic else 4e-2)
    assert np.linalg.norm(mesh.points[mesh.nodes_of("round"), :2], axis=1) == pytest.approx(1.0)
    assert np.array_equal(mesh.surfaces["round"], mesh.surfaces["round again"])
    assert len(mesh.nodes_of("corner")) == 1


@pytest.mark.parametrize("cell", ["tri3", "tri6", "quad4", "quad8", "quad9"])
def test_every_plane_cell_of_gmsh(gmsh: Any, cell: str, tmp_path: Path) -> None:
    gmsh.model.occ.addDisk(0, 0, 3, 1, 1)
    gmsh.model.occ.synchronize()
    gmsh.model.addPhysicalGroup(2, [1], 7)
    gmsh.model.addPhysicalGroup(1, [1], name="rim")
    gmsh.option.setNumber("Mesh.MeshSizeMax", 0.4)
    gmsh.option.setNumber("Mesh.RecombineAll", float(cell.startswith("quad")))
    gmsh.option.setNumber("Mesh.RecombinationAlgorithm", 3)
    gmsh.option.setNumber("Mesh.SecondOrderIncomplete", float(cell != "quad9"))
    gmsh.model.mesh.generate(2)
    gmsh.model.mesh.setOrder(1 if cell in ("tri3", "quad4") else 2)
    path = tmp_path / "disc.msh"
    gmsh.write(str(path))
    mesh = Mesh.read(path)
    assert (mesh.dim, list(mesh.bodies)) == (2, ["group_2_7"])
    assert cell in {block.kind for block in mesh.blocks}
    assert volume(mesh) == pytest.approx(np.pi, rel=1e-3 if cell in ("tri6", "quad8", "quad9") else 6e-2)
    assert np.linalg.norm(mesh.points[mesh.nodes_of("rim")], axis=1) == pytest.approx(1.0)


def two_squares(**change: str) -> str:
    parts = {"tags": "2 2 2", "side": "1 4 1", "version": "2.2 0 8", "z": "0", "x": "2", "number": "6"} | change
    return (
        f"$MeshFormat\n{parts['version']}\n$EndMeshFormat\n$Nodes\n6\n1 0 0 0\n2 1 0 0\n3 1 1 0\n4 0 1 0\n"
        f"5 {parts['x']} 0 {parts['z']}\n{parts['number']} 2 1 0\n$EndNodes\n$Elements\n3\n1 {parts['side']}\n"
        f"2 3 2 1 1 1 2 3 4\n3 3 {parts['tags']} 2 5 6 3\n$EndElements\n"
    )


@pytest.mark.parametrize(
    ("change", "message"),
    [
        ({"tags": "2 2 2", "side": "1 2 7 1 2 3"}, r"'group_1_7' lies between the bodies 'group_2_1', 'group_2_2'"),
        ({"tags": "2 1 1", "side": "1 2 7 1 2 3"}, r"'group_1_7' lies inside body 'group_2_1'"),
        ({"side": "1 2 7 1 1 3"}, r"'group_1_7' has 1 facets that belong to no cell"),
        ({"side": "15 2 9 1 7"}, r"use nodes that the file does not list"),
        ({"version": "3.0 0 8"}, r"version 3\.0 is not supported; export it as 4\.1 or 2\.2"),
        ({"z": "1"}, r"not in a plane z = constant"),
        ({"z": "nan"}, r"a coordinate that is no number"),
        ({"x": "two"}, r"not a number in section \$Nodes"),
        ({"number": "5"}, r"node 5 stands in the file twice"),
        ({"tags": "2 2 2 1"}, r"cannot read element 3 in section \$Elements"),
    ],
)
def test_faults_are_named_with_the_file(change: dict[str, str], message: str, tmp_path: Path) -> None:
    side = {"side": "1 2 7 1 4 1"}
    path = tmp_path / "two.msh"
    path.write_text(two_squares(**side))
    assert len(Mesh.read(path).surfaces["group_1_7"]) == 1
    path.write_text(two_squares(**side | change))
    with pytest.raises(InputError, match=message) as caught:
        Mesh.read(path)
    assert "two.msh" in str(caught.value)


def test_a_cell_in_two_bodies_is_refused() -> None:
    with pytest.raises(InputError, match="of 'group_2_1', 'group_2_2' stand in the mesh twice"):
        Mesh.read(DATA / "cell-in-two-groups.msh")


def test_cells_outside_every_group_are_left_out_with_a_note(tmp_path: Path) -> None:
    points = np.array([[0.0, 0, 0], [1, 0, 0], [0, 1, 0], [1, 1, 0]])
    raw = RawMesh(points, {"body": {"tri3": np.array([[0, 1, 2]])}, "": {"tri3": np.array([[1, 3, 2]])}})
    mesh = build(Mesh, raw, "part.msh")
    assert mesh.notes == ("part.msh: 1 cells outside every group of cells were left out",)
    assert len(mesh.points) == 3


def test_a_group_of_unused_points_is_refused(tmp_path: Path) -> None:
    text = two_squares(side="15 2 9 1 7").replace("$Nodes\n6\n", "$Nodes\n7\n7 5 5 0\n")
    (tmp_path / "two.msh").write_text(text)
    with pytest.raises(InputError, match="no cell of a body uses the points of group 'group_0_9'"):
        Mesh.read(tmp_path / "two.msh")


@pytest.mark.parametrize("name", ["none.msh", "none.stl"])
def test_files_that_are_not_there_or_of_unknown_kind(name: str, tmp_path: Path) -> None:
    with pytest.raises(InputError, match=r"none\.(msh does not exist|stl: unknown mesh format)"):
        Mesh.read(tmp_path / name)


@pytest.mark.parametrize("cell", ["tri6", "quad9", "tet10", "hex27", "wedge15"])
def test_vtu_keeps_bodies_surfaces_and_curved_cells(cell: str, tmp_path: Path) -> None:
    if cell in ("tri6", "quad9"):
        made = join(
            {"one": rectangle(cells=(3, 2), cell=cell), "the other": rectangle(x=(2, 3), cells=(1, 1), cell=cell)}
        )
    else:
        tube = cylinder(2.0, cells=(1, 6, 1), cell=cell, inner=1.0)
        made = join({"one": tube, "the other": box(x=(3, 4), cells=(1, 1, 1), cell=cell)})
    write_mesh(tmp_path / "made.vtu", made)
    read = Mesh.read(tmp_path / "made.vtu")
    assert list(read.bodies) == list(made.bodies)
    assert set(read.surfaces) == set(made.surfaces)
    assert np.allclose(read.points, made.points, atol=0.0)
    for name in made.surfaces:
        assert np.array_equal(read.nodes_of(name), made.nodes_of(name))
    assert volume(read) == pytest.approx(volume(made), rel=1e-14)
    assert [p.name for p in tmp_path.iterdir()] == ["made.vtu"]  # no temporary file is left


def test_vtu_keeps_node_sets(tmp_path: Path) -> None:
    made = replace(rectangle(cells=(2, 2)), node_sets={"corner": np.array([0]), "some": np.array([0, 4, 8])})
    write_mesh(tmp_path / "made.vtu", made)
    read = Mesh.read(tmp_path / "made.vtu")
    for name in made.node_sets:
        assert np.array_equal(read.points[read.node_sets[name]], made.points[made.node_sets[name]])


def test_writing_refuses_to_lose_names(tmp_path: Path) -> None:
    mesh = rectangle(cells=(1, 1))
    with pytest.raises(InputError, match="all named 'left'"):
        write_mesh(tmp_path / "m.vtu", replace(mesh, node_sets={"left": np.array([0])}))
    with pytest.raises(InputError, match="all named 'left'"):
        write_mesh(tmp_path / "m.vtu", replace(mesh, bodies={"left": np.array([0])}))
    assert not list(tmp_path.iterdir())


@pytest.mark.parametrize("values", [np.array([0.5]), np.array([[0, 1]])], ids=["float", "pair"])
def test_regions_must_be_one_integer_a_cell(values: np.ndarray[Any, Any], tmp_path: Path) -> None:
    mesh = rectangle(cells=(1, 1), cell="quad4")
    write_vtu(tmp_path / "m.vtu", mesh.points, [("quad4", mesh.blocks[0].nodes)], {}, {"region": values})
    with pytest.raises(InputError, match="'region' must be one integer for each cell"):
        Mesh.read(tmp_path / "m.vtu")


def fault(path: Path) -> str:
    """What reading the file complains of; nothing for a sound one. Any other error passes through."""
    try:
        Mesh.read(path)
    except InputError as error:
        return str(error)
    return ""


@pytest.mark.parametrize("suffix", ["msh", "vtu"])
def test_random_damage_ends_in_a_message(suffix: str, tmp_path: Path) -> None:
    """Bytes changed, lost and added: read as something sound, or refused by name; quickly either way."""
    if suffix == "vtu":
        write_mesh(tmp_path / "made.vtu", join({"a": box(cells=(2, 1, 1), cell="hex20")}))
        data = (tmp_path / "made.vtu").read_bytes()
    else:
        data = two_squares(side="1 2 7 1 4 1").encode()
    draw = random.Random(3)
    path = tmp_path / f"damaged.{suffix}"
    refused, begin = 0, time.monotonic()
    for _ in range(150):
        bad = bytearray(data)
        for _ in range(draw.randint(1, 3)):
            at = draw.randrange(len(bad))
            end = at + draw.choice([0, 1, 8])
            bad[at:end] = draw.choice([b"", b"9" * 9, b"-1 ", b"\xff" * 8, b"nan", bytes([draw.randrange(256)])])
        path.write_bytes(bad)
        said = fault(path)
        refused += bool(said)
        assert not said or path.name in said or said.startswith("mesh:")
    assert refused > 75
    assert time.monotonic() - begin < 20.0

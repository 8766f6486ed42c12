"""Values of result files at any position: exact for what their cells hold, whoever wrote the file."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

import abut
from abut.benchmarks import BENCHMARKS, run
from abut.errors import InputError
from abut.io.frd import Dataset, Increment, write_frd
from abut.io.vtu import write_vtu
from abut.mesh.make import box, join, rectangle, ring
from abut.mesh.mesh import Mesh

# as CalculiX writes it: a he20 lists the edges between bottom and top before those of the top
CALCULIX = """    1C
    2C                            20                                     1
{nodes} -3
    3C                             1                                     1
 -1         1    4    0    1
 -2        11        12        13        14        15        16        17        18        19        20
 -2        21        22        27        28        29        30        23        24        25        26
 -3
    1PSTEP                         1           1           1
  100CL  101 1.000000000          20                     0    1           1
 -4  DISP        4    1
 -5  D1          1    2    1    0
 -5  D2          1    2    2    0
 -5  D3          1    2    3    0
 -5  ALL         1    2    0    0    1ALL
{zeros} -3
    1PSTEP                         2           1           1
  100CL  102 2.000000000          20                     0    2           1
 -4  DISP        4    1
 -5  D1          1    2    1    0
 -5  D2          1    2    2    0
 -5  D3          1    2    3    0
 -5  ALL         1    2    0    0    1ALL
{moved} -3
 9999
"""


def calculix() -> str:
    """A cube from 0 to 2 of 20 nodes, numbered from 11 in the order of CalculiX's elements; (x y, z, 1 - x) in the end."""
    corners = np.array([(0, 0, 0), (1, 0, 0), (1, 1, 0), (0, 1, 0), (0, 0, 1), (1, 0, 1), (1, 1, 1), (0, 1, 1)]) * 2.0
    edges = [(0, 1), (1, 2), (2, 3), (3, 0), (4, 5), (5, 6), (6, 7), (7, 4), (0, 4), (1, 5), (2, 6), (3, 7)]
    points = np.vstack([corners, [(corners[a] + corners[b]) / 2.0 for a, b in edges]])
    x, y, z = points.T
    values = np.column_stack([x * y, z, 1.0 - x])
    lines = {
        name: "".join(f" -1{11 + i:10d}" + "".join(f"{v:12.5E}" for v in row) + "\n" for i, row in enumerate(table))
        for name, table in (("nodes", points), ("moved", values), ("zeros", 0.0 * values))
    }
    return CALCULIX.format(**lines)


def test_file_of_calculix(tmp_path: Path) -> None:
    """The last step counts; components have the file's names, or x, y, z; quadratic cells hold x y; 6 digits."""
    path = tmp_path / "cube.frd"
    path.write_text(calculix())
    points = np.random.default_rng(0).uniform(0.0, 2.0, (30, 3))
    for component in ("D1", "x", 0):
        assert abut.result_field(path, "DISP", component)(points) == pytest.approx(
            points[:, 0] * points[:, 1], abs=1e-5
        )
    assert abut.result_field(path, "DISP", "z")(points) == pytest.approx(1.0 - points[:, 0], abs=1e-5)


def written(folder: Path, mesh: Mesh, values: np.ndarray, ending: str) -> Path:
    path = folder / f"values.{ending}"
    blocks = [(block.kind, block.nodes) for block in mesh.blocks]
    if ending == "vtu":
        write_vtu(path, mesh.points, blocks, {"T": values})
    else:
        data = Dataset("T", ("T",), np.arange(len(values)), values[:, None])
        cells = np.zeros(mesh.n_cells, dtype=np.int64)
        write_frd(path, mesh.points, blocks, cells, ["all"], [Increment(1, 1.0, (data,))])
    return path


@pytest.mark.parametrize("ending", ["vtu", "frd"])
@pytest.mark.parametrize(
    "cell", ["tri3", "tri6", "quad4", "quad8", "tet4", "tet10", "hex8", "hex20", "wedge6", "wedge15"]
)
def test_every_cell(cell: str, ending: str, tmp_path: Path) -> None:
    """A linear field comes back anywhere, to the digits of the file."""
    plane = cell.startswith(("tri", "quad"))
    mesh = join(
        {"b": rectangle((0, 3), (0, 2), (3, 2), cell) if plane else box((0, 3), (0, 2), (0, 1), (3, 2, 1), cell)}
    )
    slope = np.array([0.3, -0.7, 1.1])[: mesh.dim]
    field = abut.result_field(written(tmp_path, mesh, 2.0 + mesh.points @ slope, ending), "T")
    points = np.random.default_rng(1).uniform(0.0, 1.0, (40, mesh.dim)) * mesh.points.max(axis=0)
    assert field(points) == pytest.approx(2.0 + points @ slope, abs=1e-12 if ending == "vtu" else 2e-5)


def test_curved_faces_meshed_unlike(tmp_path: Path) -> None:
    """The facets of a coarse mesh are chords: nodes of a fine one outside of them have the value at the nearest point."""
    coarse = join({"b": ring((1.0, 2.0), (0.0, 90.0), cells=(3, 5), cell="quad4")})
    fine = join({"b": ring((1.0, 2.0), (0.0, 90.0), cells=(4, 12), cell="quad8")})
    field = abut.result_field(written(tmp_path, coarse, np.linalg.norm(coarse.points, axis=1), "vtu"), "T")
    assert field(fine.points) == pytest.approx(
        np.linalg.norm(fine.points, axis=1), abs=2.0 * (1.0 - np.cos(np.pi / 20)) * 1.01
    )


@pytest.mark.parametrize(
    ("points", "said"),
    [
        ([[0.5, 0.5, 0.5]], "its mesh has 2 dimensions, the model 3"),
        (
            [[0.5, 0.5], [500.0, 0.5]],
            r"\(500, 0.5\) lies 498 outside its mesh, which reaches from \(0, 0\) to \(2, 1\)",
        ),
    ],
)
def test_points_elsewhere(points: list[list[float]], said: str, tmp_path: Path) -> None:
    mesh = join({"b": rectangle((0, 2), (0, 1), (4, 2), "quad4")})
    field = abut.result_field(written(tmp_path, mesh, np.ones(len(mesh.points)), "vtu"), "T")
    with pytest.raises(InputError, match=said):
        field(np.array(points))


def test_what_is_not_in_the_file(tmp_path: Path) -> None:
    (tmp_path / "cube.frd").write_text(calculix())
    for array, component, said in (
        ("DISQ", None, "no values named 'DISQ' at its points; did you mean 'DISP'"),
        ("DISP", None, "'DISP' has 3 components; say which one: D1, D2, D3"),
        ("DISP", "D4", "no component 'D4'; known: D1, D2, D3, x, y, z"),
        ("DISP", 3, "numbers go from 0 to 2"),
    ):
        with pytest.raises(InputError, match=said):
            abut.result_field(tmp_path / "cube.frd", array, component)
    (tmp_path / "cut.frd").write_text(calculix().replace("        11 ", "        99 ", 1))
    with pytest.raises(InputError, match=r"not a readable \.frd file of text"):
        abut.result_field(tmp_path / "cut.frd", "DISP", 0)
    (tmp_path / "values.txt").write_text("1 2 3")
    with pytest.raises(InputError, match=r"values are read from \.vtu and \.frd files"):
        abut.result_field(tmp_path / "values.txt", "T")
    with pytest.raises(InputError, match="no result file"):
        abut.result_field(tmp_path / "none.vtu", "T")


def test_no_value_there(tmp_path: Path) -> None:
    """Points that the file leaves out, as results of a part of the nodes do, are told where they are needed."""
    mesh = join({"b": rectangle((0, 2), (0, 1), (2, 1), "quad4")})
    values = np.where(mesh.points[:, 0] > 1.5, np.nan, 1.0)
    field = abut.result_field(written(tmp_path, mesh, values, "vtu"), "T")
    assert field(np.array([[0.5, 0.5], [1.0, 0.3]])) == pytest.approx([1.0, 1.0])
    with pytest.raises(InputError, match=r"no value of 'T' around \[1.5, 0.5\]"):
        field(np.array([[0.5, 0.5], [1.5, 0.5]]))


@pytest.mark.parametrize("name", ["mapped-temperature", "submodel"])
def test_closed_form(name: str) -> None:
    for outcome in run(BENCHMARKS[name]):
        assert outcome.passed, outcome


def test_restart_files_see_other_values(tmp_path: Path) -> None:
    """Another result file is another model."""
    from abut.output.restart import description, differences

    mesh = join({"b": rectangle((0, 2), (0, 1), (2, 1), "quad4")})
    field = abut.result_field(written(tmp_path, mesh, mesh.points[:, 0], "vtu"), "T")
    model = BENCHMARKS["mapped-temperature"].model(0)
    one, other = (
        replace(model, loads=[abut.Temperature("bar", f)]) for f in (field, replace(field, values=2.0 * field.values))
    )
    assert differences(description(one), description(one)) == []
    assert differences(description(one), description(other)) != []


@pytest.mark.parametrize("ending", ["vtu", "frd", "run", "mesh"])
def test_bodies_that_touch_have_values_of_their_own(ending: str, tmp_path: Path) -> None:
    """Two bars side by side, 1 + x in one and 10 + x in the other: at the plane between both, each by its name and number;
    in files of abut's runs and meshes and in those of other programs. Without a body it is one of both."""
    mesh = join({"left": box((0, 1), (0, 1), (0, 1), (2, 2, 2)), "right": box((1, 2), (0, 1), (0, 1), (3, 1, 1))})
    values = mesh.points[:, 0] + np.where(np.arange(len(mesh.points)) < 27, 1.0, 10.0)
    blocks = [(block.kind, block.nodes) for block in mesh.blocks]
    number = np.zeros(mesh.n_cells, dtype=np.int64)
    number[mesh.bodies["right"]] = 1
    path, array, first = tmp_path / f"values.{ending}", "T", 0
    if ending == "frd":
        data = Dataset("T", ("T",), np.arange(len(values)), values[:, None])
        write_frd(path, mesh.points, blocks, number, list(mesh.bodies), [Increment(1, 1.0, (data,))])
        first = 1
    elif ending == "run":
        moved = (("left", "1 + x"), ("right", "10 + x"))  # drawn at both ends, without lateral contraction
        supports = [abut.Support(f"{n}.{end}", x=to, y=0, z=0) for n, to in moved for end in ("left", "right")]
        model = abut.Model(mesh, [abut.Solid(name, abut.LinearElastic(1.0, 0.0)) for name in mesh.bodies], supports)
        abut.write(abut.solve(model), tmp_path)
        path, array = tmp_path / "fields_0001.vtu", "displacement"
    else:
        path = tmp_path / "values.vtu"
        names = {"region_names": list(mesh.bodies)} if ending == "mesh" else None
        write_vtu(path, mesh.points, blocks, {"T": values}, {"region" if names else "body": number}, names)
    component = "x" if ending == "run" else None
    between = np.array([[1.0, 0.3, 0.6], [1.0, 0.9, 0.1]])
    named = ("left", "right") if ending != "vtu" else (0, 1)
    for bodies in (named, (first, first + 1)):
        for body, wanted in zip(bodies, (2.0, 11.0)):
            field = abut.result_field(path, array, component, body)
            assert field(between) == pytest.approx(wanted, rel=1e-6)
            assert len(field.mesh.points) == (27 if wanted < 3.0 else 16)
    assert set(abut.result_field(path, array, component)(between)) <= {2.0, 11.0}
    with pytest.raises(InputError, match="outside its mesh"):
        abut.result_field(path, array, component, first)(np.array([[1.9, 0.5, 0.5]]))
    with pytest.raises(InputError, match=r"no body 'lid'.*left, right|no body 'lid'.*there are 0, 1"):
        abut.result_field(path, array, component, "lid")

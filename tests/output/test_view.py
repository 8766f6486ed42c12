"""Solutions as PyVista data and pictures, and the files that ParaView opens, read by VTK's own readers."""

from __future__ import annotations

import sys
import xml.etree.ElementTree as ET
from math import factorial
from pathlib import Path

import numpy as np
import pytest

import abut
from abut.cells import CELLS
from abut.mesh import make
from models.friction import pushed

SOLID = ("tet4", "tet10", "hex8", "hex20", "hex27", "wedge6", "wedge15")
PLANE = ("tri3", "tri6", "quad4", "quad8", "quad9")
STEPS = 2
SINGLE = float(np.finfo(np.float32).eps)  # files hold 32-bit numbers


def solved(cell: str) -> abut.Solution:
    """Two blocks of other cell sizes, the upper one half as wide, pressed together in two steps."""
    if cell in SOLID:
        lower = make.box([0, 1], [0, 1], [0, 1], cells=[2, 2, 1], cell=cell)
        upper = make.box([0, 0.5], [0, 1], [1, 2], cells=[1, 3, 1], cell=cell)
        hold, push, plane = {"x": 0, "y": 0, "z": 0}, {"x": 0, "y": 0, "z": -0.01}, None
    else:
        lower = make.rectangle([0, 1], [0, 1], cells=[3, 2], cell=cell)
        upper = make.rectangle([0, 0.5], [1, 2], cells=[2, 1], cell=cell)
        hold, push, plane = {"x": 0, "y": 0}, {"x": 0, "y": -0.01}, "strain"
    steel = abut.LinearElastic(1000.0, 0.3)
    return abut.solve(
        abut.Model(
            make.join({"lower": lower, "upper": upper}),
            plane=plane,
            solids=[abut.Solid("lower", steel), abut.Solid("upper", steel)],
            supports=[abut.Support("lower.bottom", **hold), abut.Support("upper.top", **push)],
            contacts=[abut.Contact(contactor="upper.bottom", target="lower.top", name="blocks")],
            solve=abut.SolveOptions(steps=STEPS),
        )
    )


def read(path: Path):
    """A VTU file by VTK's reader, which must find no fault with it."""
    from vtkmodules.vtkIOXML import vtkXMLUnstructuredGridReader

    reader, errors = vtkXMLUnstructuredGridReader(), []
    reader.AddObserver("ErrorEvent", lambda *_: errors.append("error"))
    reader.SetFileName(str(path))
    reader.Update()
    assert errors == []
    return reader.GetOutput()


def arrays(data) -> dict[str, np.ndarray]:
    from vtkmodules.util.numpy_support import vtk_to_numpy

    return {data.GetArrayName(i): vtk_to_numpy(data.GetArray(i)) for i in range(data.GetNumberOfArrays())}


def measure(grid) -> float:
    """Length, area or volume of all cells, by VTK's own division into simplices (up to VTK 9.5 its filter for sizes leaves
    wedges out)."""
    from vtkmodules.vtkCommonCore import vtkIdList, vtkPoints

    total = 0.0
    for i in range(grid.GetNumberOfCells()):
        cell, ids, points = grid.GetCell(i), vtkIdList(), vtkPoints()
        cell.Triangulate(0, ids, points)
        corners = np.array([points.GetPoint(k) for k in range(points.GetNumberOfPoints())])
        simplices = corners.reshape(-1, cell.GetCellDimension() + 1, 3)
        edges = simplices[:, 1:] - simplices[:, :1]
        total += np.sqrt(np.linalg.det(edges @ edges.transpose(0, 2, 1))).sum() / factorial(cell.GetCellDimension())
    return float(total)


@pytest.mark.parametrize("cell", PLANE + SOLID)
def test_paraview_opens_every_file(cell: str, tmp_path: Path) -> None:
    """Every file of a series is read without complaint, with the cells of the mesh as they were (quadratic ones too), all
    arrays at all points, and a size that is that of the bodies."""
    solution = solved(cell)
    abut.write(solution, tmp_path)
    mesh = solution.model.mesh
    facets = {CELLS[kind].vtk for kind, _ in CELLS[cell].facets}
    for stem, kinds in (("fields", {CELLS[cell].vtk}), ("contact_blocks", facets)):
        entries = list(ET.parse(tmp_path / f"{stem}.pvd").getroot().iter("DataSet"))
        assert [float(e.attrib["timestep"]) for e in entries] == [(k + 1) / STEPS for k in range(STEPS)]
        for entry, step in zip(entries, solution.steps):
            grid = read(tmp_path / entry.attrib["file"])
            found = {grid.GetCellType(i) for i in range(grid.GetNumberOfCells())}
            points, cells = arrays(grid.GetPointData()), arrays(grid.GetCellData())
            assert all(len(values) == grid.GetNumberOfPoints() for values in points.values())
            assert all(len(values) == grid.GetNumberOfCells() for values in cells.values())
            if stem == "fields":
                assert found == kinds
                assert grid.GetNumberOfCells() == mesh.n_cells
                assert points["displacement"][:, : mesh.dim] == pytest.approx(step.displacement, abs=0)
                assert points["stress"].shape == (len(mesh.points), 6)
                assert points["von_mises"].min() > 0.0
                assert set(cells["body"]) == {0, 1}
                assert measure(grid) == pytest.approx(1.5, rel=1e-9)
            else:
                assert found <= kinds  # the top and bottom of wedges are triangles only
                assert set(points) == {"pressure", "multiplier", "gap", "displacement", "contact_force", "node"}
                assert points["pressure"].max() == pytest.approx(step.contacts[0].max_pressure, rel=SINGLE)
                assert set(cells["side"]) == {0, 1}
                assert measure(grid) == pytest.approx(1.5, rel=1e-9)


def test_collections_open_elsewhere(tmp_path: Path) -> None:
    """PyVista's reader of collections finds the steps and their files (VTK's own is part of ParaView only)."""
    pyvista = pytest.importorskip("pyvista")
    abut.write(solved("hex20"), tmp_path)
    for stem in ("fields", "contact_blocks"):
        reader = pyvista.get_reader(tmp_path / f"{stem}.pvd")
        assert reader.time_values == [0.5, 1.0]
        reader.set_active_time_value(1.0)
        assert reader.read()[0].n_cells > 0


@pytest.mark.parametrize("cell", ["quad8", "hex20", "tet4"])
def test_pyvista_gets_bodies_and_contacts(cell: str) -> None:
    """Blocks by name, quadratic cells kept, volume of the bodies and area of the facets as built."""
    pytest.importorskip("pyvista")
    solution = solved(cell)
    data = solution.to_pyvista()
    assert data.keys() == ["bodies", "contacts"]
    assert data["bodies"].keys() == ["lower", "upper"]
    assert data["contacts"].keys() == ["blocks"]
    sizes = {name: measure(data["bodies"][name]) for name in ("lower", "upper")}
    assert sizes == pytest.approx({"lower": 1.0, "upper": 0.5}, rel=1e-9)
    assert set(data["bodies"]["upper"].celltypes) == {CELLS[cell].vtk}
    sides = data["contacts"]["blocks"]
    assert measure(sides["contactor"]) == pytest.approx(0.5, rel=1e-9)
    assert measure(sides["target"]) == pytest.approx(1.0, rel=1e-9)
    assert sides["contactor"]["pressure"].max() == pytest.approx(solution.contacts[0].max_pressure, rel=1e-12)
    pushed = data["bodies"]["upper"]["displacement"][:, solution.model.dim - 1].min()
    assert pushed == pytest.approx(-0.01, rel=1e-9)
    first = solution.to_pyvista(0)["bodies"]["upper"]["displacement"][:, solution.model.dim - 1].min()
    assert first == pytest.approx(-0.005, rel=1e-9)
    with pytest.raises(abut.InputError, match="index into the 2 steps"):
        solution.to_pyvista(2)


@pytest.mark.long
@pytest.mark.parametrize("what", ["pressure", "von Mises"])
def test_a_picture_has_a_picture_in_it(what: str, tmp_path: Path) -> None:
    pytest.importorskip("pyvista")
    image = pytest.importorskip("matplotlib.image")
    path = tmp_path / "picture.png"
    solved("hex8").plot(what, path=path)
    pixels = image.imread(path)[..., :3].reshape(-1, 3)
    assert len(np.unique(np.round(pixels, 2), axis=0)) > 50  # shades and a scale of colours
    with pytest.raises(abut.InputError, match="what"):
        solved("tri3").plot("pressur")


@pytest.mark.long
def test_friction_in_pictures(tmp_path: Path) -> None:
    """Traction and slip are there with friction, and refused where no contact has any."""
    pytest.importorskip("pyvista")
    solution = abut.solve(pushed())
    for what in ("traction", "slip"):
        plotter = solution.plot(what, path=tmp_path / f"{what}.png")
        own = solution.contacts[0].friction
        assert plotter.mapper.scalar_range[1] == pytest.approx(
            {"traction": own.max_traction, "slip": own.max_total_slip}[what]
        )
    assert {"traction", "friction_status"} <= set(solution.to_pyvista()["contacts"][0]["contactor"].point_data)
    with pytest.raises(abut.InputError, match="needs a contact with friction"):
        solved("tri3").plot("slip", path=tmp_path / "none.png")


def test_pyvista_is_optional(monkeypatch: pytest.MonkeyPatch) -> None:
    solution = solved("tri3")
    monkeypatch.setitem(sys.modules, "pyvista", None)
    with pytest.raises(abut.InputError, match=r"pip install 'abut\[picture\]'"):
        solution.to_pyvista()
    with pytest.raises(abut.InputError, match=r"pip install 'abut\[picture\]'"):
        abut.plot(solution)

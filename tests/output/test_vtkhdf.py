"""fields.vtkhdf and its like: VTK's reader finds in them what the VTU files of the steps hold."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from test_frd import unit_cell
from vtkmodules.util.numpy_support import vtk_to_numpy
from vtkmodules.vtkIOHDF import vtkHDFReader

import abut
from abut.cells import CELLS
from abut.io.vtkhdf import write_vtkhdf
from abut.io.vtu import load_grid
from abut.mesh import make

MIDDLE = 1e-7  # times are numbers of 32 bits in the format


def pushed(cell: str) -> abut.Model:
    """A metal block that yields, on a wider one, pushed down and aside with friction in three steps."""
    lower = make.box([0, 4], [0, 4], [0, 2], cells=[2, 2, 1], cell=cell)
    upper = make.box([1, 3], [1, 3], [2, 3], cells=[1, 1, 1], cell=cell)
    return abut.Model(
        make.join({"lower": lower, "upper": upper}),
        solids=[
            abut.Solid("lower", abut.LinearElastic(1000.0, 0.3)),
            abut.Solid("upper", abut.Plastic(1000.0, 0.3, 5.0)),
        ],
        supports=[abut.Support("lower.bottom", x=0, y=0, z=0), abut.Support("upper.top", x=0.002, y=0, z=-0.02)],
        contacts=[abut.Contact("lower.top", "upper.bottom", name="touch", friction=0.3)],
        solve=abut.SolveOptions(steps=3),
    )


def opened(path: Path) -> vtkHDFReader:
    reader = vtkHDFReader()
    reader.SetFileName(str(path))
    reader.UpdateInformation()
    return reader


def same(one, other) -> None:
    """Points, cells and all data of two grids are the same, number for number."""
    np.testing.assert_array_equal(vtk_to_numpy(one.GetPoints().GetData()), vtk_to_numpy(other.GetPoints().GetData()))
    for cells in (lambda g: g.GetCells().GetConnectivityArray(), lambda g: g.GetCells().GetOffsetsArray()):
        np.testing.assert_array_equal(vtk_to_numpy(cells(one)), vtk_to_numpy(cells(other)))
    assert [one.GetCellType(i) for i in range(one.GetNumberOfCells())] == [
        other.GetCellType(i) for i in range(other.GetNumberOfCells())
    ]
    for data in (lambda g: g.GetPointData(), lambda g: g.GetCellData()):
        a, b = data(one), data(other)
        names = {a.GetArrayName(i) for i in range(a.GetNumberOfArrays())}
        assert names == {b.GetArrayName(i) for i in range(b.GetNumberOfArrays())}
        for name in names:
            found, wanted = vtk_to_numpy(a.GetArray(name)), vtk_to_numpy(b.GetArray(name))
            assert found.dtype == wanted.dtype
            np.testing.assert_array_equal(found, wanted, err_msg=name)


@pytest.mark.parametrize("cell", ["hex8", "hex20"])
def test_what_the_vtu_files_hold(cell: str, tmp_path: Path) -> None:
    """Every step: points, cells, all data of bodies and of contact; the mesh stands in the file once."""
    solution = abut.solve(pushed(cell))
    abut.write(solution, tmp_path, output=abut.Output(formats=["vtu", "vtkhdf"]))
    for label in ("fields", "contact_touch"):
        reader = opened(tmp_path / f"{label}.vtkhdf")
        assert reader.GetNumberOfSteps() == 3
        for number, step in enumerate(solution.steps):
            reader.SetStep(number)
            reader.Update()
            assert reader.GetTimeValue() == pytest.approx(step.factor, rel=MIDDLE)
            same(reader.GetOutput(), load_grid(tmp_path / f"{label}_{step.number:04d}.vtu")[0])


def test_mesh_stands_there_once(tmp_path: Path) -> None:
    """Points and cells, and whether VTK keeps them from step to step, as HDF5 itself says."""
    h5py = pytest.importorskip("h5py", reason="reads HDF5 without VTK: pip install h5py")
    model = pushed("hex20")
    abut.write(abut.solve(model), tmp_path, output=abut.Output(formats=["vtkhdf"]))
    with h5py.File(tmp_path / "fields.vtkhdf") as file:
        root = file["VTKHDF"]
        assert bytes(root.attrs["Type"]) == b"UnstructuredGrid"
        np.testing.assert_array_equal(root["Points"], model.mesh.points)
        assert root["Steps/PointOffsets"][:].tolist() == [0, 0, 0]
        assert len(root["Types"]) == model.mesh.n_cells
        assert len(root["PointData/displacement"]) == 3 * len(model.mesh.points)


def test_size_of_a_mesh_that_stays(tmp_path: Path) -> None:
    """Of ten times on one mesh the file holds ten times the data, but points and cells once: hardly larger than for one."""
    points = np.random.default_rng(1).random((20_000, 3))
    cells = [("tet4", np.arange(20_000).reshape(-1, 4))]

    def data(number: int):
        return {"number": np.full(len(points), float(number))}, {}

    for count in (1, 10):
        write_vtkhdf(tmp_path / f"{count}.vtkhdf", points, cells, np.arange(1.0, count + 1.0).tolist(), data)
    once, ten = ((tmp_path / f"{count}.vtkhdf").stat().st_size for count in (1, 10))
    assert ten - once < 0.5 * points.nbytes


@pytest.mark.parametrize("kind", [kind for kind, cell in CELLS.items() if cell.dim > 1])
def test_every_type_of_cell(kind: str, tmp_path: Path) -> None:
    """Points, cells and data at two times, in two dimensions and in three."""
    points = unit_cell(kind)
    cells = [(kind, np.arange(len(points))[None])]
    times = [0.25, 1.0]
    write_vtkhdf(tmp_path / "a.vtkhdf", points, cells, times, lambda i: ({"x": points[:, 0] + i}, {"c": np.ones(1)}))
    reader = opened(tmp_path / "a.vtkhdf")
    for number, time in enumerate(times):
        reader.SetStep(number)
        reader.Update()
        grid = reader.GetOutput()
        assert reader.GetTimeValue() == time
        assert (grid.GetCellType(0), grid.GetNumberOfCells()) == (CELLS[kind].vtk, 1)
        np.testing.assert_array_equal(vtk_to_numpy(grid.GetPoints().GetData())[:, : points.shape[1]], points)
        np.testing.assert_array_equal(vtk_to_numpy(grid.GetCells().GetConnectivityArray()), np.arange(len(points)))
        np.testing.assert_array_equal(vtk_to_numpy(grid.GetPointData().GetArray("x")), points[:, 0] + number)


def test_asked_for_or_not(tmp_path: Path) -> None:
    """Alone there are no VTU files; with steps and fields as asked; the next run takes it away."""
    solution = abut.solve(pushed("hex8"))
    abut.write(solution, tmp_path, output=abut.Output(formats=["vtkhdf"], steps="last", fields=["displacement"]))
    there = {path.name for path in tmp_path.iterdir()}
    assert "fields.vtkhdf" in there
    assert not [name for name in there if name.endswith((".vtu", ".pvd")) or name.startswith("contact")]
    reader = opened(tmp_path / "fields.vtkhdf")
    reader.Update()
    data = reader.GetOutput().GetPointData()
    assert [data.GetArrayName(i) for i in range(data.GetNumberOfArrays())] == ["displacement"]
    np.testing.assert_array_equal(vtk_to_numpy(data.GetArray(0)), solution.steps[-1].displacement)
    abut.write(solution, tmp_path, output=abut.Output(formats=["vtkhdf"], fields=["contact"]))
    assert {path.name for path in tmp_path.glob("*.vtkhdf")} == {"contact_touch.vtkhdf"}
    abut.write(solution, tmp_path)
    assert not list(tmp_path.glob("*.vtkhdf"))


def test_pyvista_reads_it(tmp_path: Path) -> None:
    pyvista = pytest.importorskip("pyvista", reason="pip install 'abut[picture]'")
    solution = abut.solve(pushed("hex20"))
    abut.write(solution, tmp_path, output=abut.Output(formats=["vtkhdf"]))
    grid = pyvista.read(tmp_path / "fields.vtkhdf")
    assert grid.n_cells == solution.model.mesh.n_cells
    np.testing.assert_array_equal(grid.point_data["displacement"], solution.steps[0].displacement)
    assert list(grid.field_data["body_names"]) == ["lower", "upper"]


def test_cannot_be_written(tmp_path: Path) -> None:
    solution = abut.solve(pushed("hex8"))
    (tmp_path / "fields.vtkhdf").mkdir()
    with pytest.raises(abut.InputError, match=r"cannot write .*fields\.vtkhdf"):
        abut.write(solution, tmp_path, output=abut.Output(formats=["vtkhdf"]))

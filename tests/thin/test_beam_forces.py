"""Forces and moments across the sections of beams, by statics: what is beyond a section balances them, whatever the section.
To 1e-6, what the means of the section at the loaded end are held to."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

import abut
from abut.errors import InputError
from models.gmsh_files import write_msh
from models.thin import CLAMPED, LENGTH, E, solved, strip

Y = (0.0, 1.0, 0.0)
SECTIONS = {
    "rectangle": abut.Beam((4.0, 6.0), direction=Y, offsets=(0.0, 0.5)),
    "circle": abut.Beam(direction=Y, radius=3.0),
    "pipe": abut.Beam(direction=Y, radius=3.0, wall=0.5),
    "box": abut.Beam((6.0, 6.0), direction=Y, wall=0.2),
}
each = pytest.mark.parametrize("section", SECTIONS)
LOAD = abut.MidForce("tip", (10.0, 1.0, 2.0), (50.0, 0.0, 0.0))


def line(path: Path, count: int = 5) -> Path:
    """Along x, its cells in another order than along the line."""
    points = np.outer(np.linspace(0.0, LENGTH, count + 1), [1.0, 0.0, 0.0])
    cells = np.stack([np.arange(count), np.arange(1, count + 1)], axis=1)[::-1]
    return write_msh(path, points, {"rib": {"line2": cells}, "root": {"point": [[0]]}, "tip": {"point": [[count]]}})


def cantilever(section: str, folder: Path, *loads: abut.MidForce, finite: bool = False) -> abut.Thick:
    held = [abut.MidSupport("root", **CLAMPED)]
    return abut.thicken(line(folder / "a.msh"), {"rib": SECTIONS[section]}, held, loads, finite=finite)


@each
def test_loaded_at_the_tip(section: str, tmp_path: Path) -> None:
    """N, V and T are those at the tip, the moment grows with the arm; an offset section has a moment of N too."""
    of = abut.beam_forces(solved(cantilever(section, tmp_path, LOAD), "rib", "full"), "rib")
    assert sorted(of.points[:, 0]) == pytest.approx(np.linspace(0.0, LENGTH, 6))
    assert of.tangent == pytest.approx(np.tile([1.0, 0.0, 0.0], (6, 1)))
    assert of.normal_force == pytest.approx(10.0, rel=1e-6)
    assert of.shear_force == pytest.approx(np.tile([0.0, 1.0, 2.0], (6, 1)), abs=1e-5)
    moment = np.array([50.0, 0.0, 0.0]) + np.cross([LENGTH, 0.0, 0.0] - of.points, [10.0, 1.0, 2.0])
    assert of.torque == pytest.approx(moment[:, 0], abs=1e-4)
    assert of.bending_moment == pytest.approx(moment * [0.0, 1.0, 1.0], abs=2e-4)


@each
def test_loaded_along_it(section: str, tmp_path: Path) -> None:
    """q (L - x) and q (L - x)^2 / 2 between the ends; at an end the load of half a cell is left out or comes twice."""
    thick = cantilever(section, tmp_path)
    surface = thick.mesh.surface("rib.side")
    from abut.bodies.loads import surface_area

    q = 0.01 * surface_area(surface) / LENGTH
    solution = solved(thick, "rib", "full", loads=[abut.Traction("rib.side", (0.0, 0.0, 0.01))])
    of = abut.beam_forces(solution, "rib")
    inner = (of.points[:, 0] > 1.0) & (of.points[:, 0] < LENGTH - 1.0)
    rest = LENGTH - of.points[inner, 0]
    assert of.force[inner, 2] == pytest.approx(q * rest, rel=1e-6)
    assert of.moment[inner, 1] == pytest.approx(-0.5 * q * rest**2, rel=1e-6)


def test_far_bent(tmp_path: Path) -> None:
    """A dead load in large displacements: the force stays, its arm is that to where the tip has moved."""
    load = abut.MidForce("tip", (0.0, 0.0, 2e4))
    solution = solved(cantilever("circle", tmp_path, load, finite=True), "rib", "full", kinematics="finite")
    of = abut.beam_forces(solution, "rib")
    assert of.force == pytest.approx(np.tile([0.0, 0.0, 2e4], (6, 1)), rel=1e-5, abs=0.1)
    tip = of.points[np.argmax(of.points[:, 0])]
    assert tip[2] > 0.2 * LENGTH
    assert of.moment == pytest.approx(np.cross(tip - of.points, [0.0, 0.0, 2e4]), abs=1e-5 * 2e4 * LENGTH)


def test_refused(tmp_path: Path) -> None:
    solution = solved(cantilever("circle", tmp_path, LOAD), "rib", "full")
    with pytest.raises(InputError, match=r"step: there are 1 steps, got 3"):
        abut.beam_forces(solution, "rib", 3)
    with pytest.raises(InputError, match="no body named 'pipe'"):
        abut.beam_forces(solution, "pipe")
    model = solution.model
    hot = replace(model, solids=[replace(model.solids[0], temperature=10.0)])
    with pytest.raises(InputError, match="is heated"):
        abut.beam_forces(replace(solution, model=hot), "rib")
    metal = abut.Plastic(E, 0.3, [(0.0, 200.0), (0.1, 300.0)])
    yields = replace(model, solids=[replace(model.solids[0], material=metal)])
    with pytest.raises(InputError, match="with a history"):
        abut.beam_forces(replace(solution, model=yields), "rib")
    held = [abut.MidSupport("left", **CLAMPED)]
    sheet = abut.thicken(strip(tmp_path / "b.msh"), {"strip": abut.Shell(1.0)}, held)
    with pytest.raises(InputError, match="'strip' is no beam"):
        abut.beam_forces(solved(sheet, "strip"), "strip")


def test_in_files(tmp_path: Path) -> None:
    """``beams.pvd`` with lines that VTK reads, ``beams.csv`` with a row for each section, both of which go with what is
    written, and the report."""
    import csv

    from vtkmodules.vtkIOXML import vtkXMLUnstructuredGridReader

    solution = solved(cantilever("circle", tmp_path, LOAD), "rib", "full")
    out = abut.write(solution, tmp_path / "out")
    assert "beams_0001.vtu" in (out / "beams.pvd").read_text()
    reader = vtkXMLUnstructuredGridReader()
    reader.SetFileName(str(out / "beams_0001.vtu"))
    reader.Update()
    grid = reader.GetOutput()
    assert (grid.GetNumberOfCells(), grid.GetNumberOfPoints()) == (5, 6)
    for i in range(5):  # each from one section to the next
        ends = [grid.GetPoint(grid.GetCell(i).GetPointId(k))[0] for k in range(2)]
        assert ends[1] - ends[0] == pytest.approx(LENGTH / 5)
    assert grid.GetPointData().GetArray("normal_force").GetValue(3) == pytest.approx(10.0, rel=1e-5)
    rows = list(csv.DictReader((out / "beams.csv").read_text().splitlines()))
    assert len(rows) == 6
    for row in rows:
        arm = LENGTH - float(row["x"])
        assert float(row["torque"]) == pytest.approx(50.0, abs=1e-4)
        assert float(row["moment_z"]) == pytest.approx(arm, abs=2e-4)
    report = (out / "report.html").read_text()
    assert "Forces across the sections of beams" in report
    hot = replace(solution, model=replace(solution.model, solids=[replace(solution.model.solids[0], temperature=10.0)]))
    abut.write(hot, out)
    assert not list(out.glob("beams*"))
    assert "not known: it is heated" in (out / "report.html").read_text()

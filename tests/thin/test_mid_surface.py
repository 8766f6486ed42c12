"""Results of shells on their mid-surface: section forces of strips and plates of the textbook."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from numpy.typing import NDArray

import abut
from abut.errors import InputError
from abut.output.results import is_written
from models.gmsh_files import write_msh
from models.thin import CLAMPED, INERTIA, LENGTH, THICK, WIDTH, E, solved, strip

FORCE = 0.1 * WIDTH * THICK  # of a traction 0.1 at the end


def pulled(tmp_path: Path, traction: tuple[float, float, float], **place: object) -> abut.Solution:
    path = strip(tmp_path / "a.msh", **place)  # type: ignore[arg-type]
    thick = abut.thicken(path, {"strip": abut.Shell(THICK)}, [abut.MidSupport("left", **CLAMPED)])
    return solved(thick, "strip", loads=[abut.Traction("right.edge", traction)])


def test_cantilever(tmp_path: Path) -> None:
    """A force P up at the end: m11 = -P (L - x) / w, as it pulls at the lower side, q1 = P / w, turn
    -P (L x - x^2 / 2) / E I. The recovered stress follows the moment, which is linear, exactly away from the clamp; shear,
    which is its slope, to 2 %, at the clamp, where the recovered stress bends off within a cell, to 40 %."""
    of = abut.mid_surface(pulled(tmp_path, (0.0, 0.0, 0.1)), "strip")
    x = of.points[:, 0]
    inner = (x > 0.15 * LENGTH) & (x < 0.85 * LENGTH)
    assert of.moment[inner, 0] == pytest.approx(-FORCE * (LENGTH - x[inner]) / WIDTH, rel=1e-3)
    assert of.shear[inner, 0] == pytest.approx(FORCE / WIDTH, rel=0.02)
    assert of.shear[:, 0] == pytest.approx(FORCE / WIDTH, rel=0.4)
    assert np.abs(of.moment[:, 1:]).max() < 1e-6 * np.abs(of.moment).max()
    assert np.abs(of.membrane).max() * THICK < 1e-6 * np.abs(of.moment).max()
    turn = -FORCE * (LENGTH * x - x**2 / 2) / (E * INERTIA)
    assert of.rotation[:, 1] == pytest.approx(turn, abs=1e-3 * np.abs(turn).max())
    end = of.displacement[x > LENGTH - 1e-9, 2]
    assert end == pytest.approx(FORCE * LENGTH**3 / (3 * E * INERTIA), rel=0.002)


def upright(x: NDArray[np.float64]) -> NDArray[np.float64]:
    """Normals along x: the first direction is the global z."""
    return np.array([0.0, x[0], x[1]])


def test_pulled(tmp_path: Path) -> None:
    """n = s h in the direction of the pull, which is the second one where normals are along x: the width is along z."""
    of = abut.mid_surface(pulled(tmp_path, (0.1, 0.0, 0.0)), "strip")
    assert of.membrane == pytest.approx(np.broadcast_to([0.1, 0.0, 0.0], of.membrane.shape), abs=1e-9)
    of = abut.mid_surface(pulled(tmp_path, (0.0, 0.1, 0.0), place=upright), "strip")
    assert of.normal == pytest.approx(np.broadcast_to([1.0, 0.0, 0.0], of.normal.shape), abs=1e-12)
    assert of.first == pytest.approx(np.broadcast_to([0.0, 0.0, 1.0], of.first.shape), abs=1e-12)
    assert of.membrane == pytest.approx(np.broadcast_to([0.0, 0.1, 0.0], of.membrane.shape), abs=1e-9)


def test_bent_to_a_cylinder(tmp_path: Path) -> None:
    """A plate strip whose sides do not turn: m11 = D w'', m22 = nu m11, D = E h^3 / 12 (1 - nu^2). One cell
    through the thickness, without a node half way in the middle of its edges, is half a per cent too stiff for nu = .3."""
    angle, nu = 1e-2, 0.3
    held = [abut.MidSupport("left", **CLAMPED), abut.MidSupport("right", ry=angle), abut.MidSupport("strip", y=0, rx=0)]
    thick = abut.thicken(strip(tmp_path / "a.msh"), {"strip": abut.Shell(THICK)}, held)
    solid = abut.Solid("strip", abut.LinearElastic(E, nu), integration="reduced")
    model = abut.Model(thick.mesh, [solid], thick.supports, equations=thick.equations, couplings=thick.couplings)
    of = abut.mid_surface(abut.solve(model), "strip")
    moment = E * THICK**3 / (12 * (1 - nu**2)) * angle / LENGTH
    middle = np.abs(of.points[:, 0] - LENGTH / 2) < LENGTH / 4
    assert of.moment[middle, 0] == pytest.approx(moment, rel=0.01)
    assert of.moment[middle, 1] == pytest.approx(nu * moment, rel=0.01)


def test_rolled(tmp_path: Path) -> None:
    """Bent far by the turn of its end: an arc of angle a, m11 = E h^3 / 12 a / L all along it, turns linear, and the end at
    (L sin a / a, L (1 - cos a) / a). Cells that turn by a tenth each hold the moment to 1 %."""
    angle = 1.0
    thick = abut.thicken(strip(tmp_path / "a.msh"), {"strip": abut.Shell(THICK)}, finite=True)
    grips = [
        abut.Coupling("root", "left", x=0, y=0, z=0, rx=0, ry=0, rz=0),
        abut.Coupling("grip", "right", y=0, rx=0, ry=-angle, rz=0),
    ]
    solid = abut.Solid("strip", abut.Hencky(E, 0.0), integration="reduced")
    model = abut.Model(
        thick.mesh, [solid], couplings=[*thick.couplings, *grips], kinematics="finite", solve=abut.SolveOptions(steps=5)
    )
    of = abut.mid_surface(abut.solve(model), "strip")
    x, radius = of.points[:, 0], LENGTH / angle
    middle = np.abs(x - LENGTH / 2) < LENGTH / 3
    assert of.moment[middle, 0] == pytest.approx(-E * THICK**3 / 12 * angle / LENGTH, rel=0.01)
    assert of.rotation[:, 1] == pytest.approx(-angle * x / LENGTH, abs=2e-3)
    assert of.points[:, 0] + of.displacement[:, 0] == pytest.approx(radius * np.sin(angle * x / LENGTH), abs=0.1)
    assert of.displacement[:, 2] == pytest.approx(radius * (1 - np.cos(angle * x / LENGTH)), abs=0.1)


def test_files(tmp_path: Path) -> None:
    """``shells.pvd`` with a file a step, which VTK reads, and ``shells.csv`` with a row for each point; other bodies are not
    in them."""
    import csv

    from vtkmodules.vtkIOXML import vtkXMLUnstructuredGridReader

    abut.write(pulled(tmp_path, (0.1, 0.0, 0.0)), tmp_path / "out")
    assert "shells_0001.vtu" in (tmp_path / "out" / "shells.pvd").read_text()
    reader = vtkXMLUnstructuredGridReader()
    reader.SetFileName(str(tmp_path / "out" / "shells_0001.vtu"))
    reader.Update()
    data = reader.GetOutput().GetPointData()
    assert reader.GetOutput().GetNumberOfCells() == 20
    assert data.GetArray("membrane_force").GetComponent(0, 0) == pytest.approx(0.1, rel=1e-6)
    assert {data.GetArrayName(i) for i in range(data.GetNumberOfArrays())} >= {"rotation", "moment", "shear_force"}
    rows = list(csv.DictReader((tmp_path / "out" / "shells.csv").read_text().splitlines()))
    assert len(rows) == reader.GetOutput().GetNumberOfPoints()
    for row in rows:
        assert (row["step"], row["shell"], float(row["first_x"]), float(row["normal_z"])) == ("1", "strip", 1.0, 1.0)
        assert float(row["n11"]) == pytest.approx(0.1, rel=1e-6)
    abut.write(pulled(tmp_path, (0.1, 0.0, 0.0)), tmp_path / "out", output=abut.Output(fields=["contact"]))
    assert not list((tmp_path / "out").glob("shells*"))


def test_a_step_whose_file_is_gone_is_not_written(tmp_path: Path) -> None:
    """A resumed run writes its files again."""
    solution = pulled(tmp_path, (0.1, 0.0, 0.0))
    out = abut.write(solution, tmp_path / "out")
    assert is_written(out, solution, solution.steps[0])
    (out / "shells_0001.vtu").unlink()
    assert not is_written(out, solution, solution.steps[0])


def test_no_shell(tmp_path: Path) -> None:
    solution = pulled(tmp_path, (0.1, 0.0, 0.0))
    with pytest.raises(InputError, match="body 'pipe' is no shell; shells: strip"):
        abut.mid_surface(solution, "pipe")
    with pytest.raises(InputError, match="there are 1 steps, got 3"):
        abut.mid_surface(solution, "strip", 3)


@pytest.mark.long
def test_round_plate(tmp_path: Path) -> None:
    """Clamped all round, under a pressure p: in the middle m = p R^2 (1 + nu) / 16 both ways, shear p r / 2 along the radius
    whatever the directions of the mesh."""
    from abut.mesh import make

    flat, radius, nu = make.disc(LENGTH, fine=LENGTH / 8, growth=1.01), LENGTH, 0.3
    points = np.column_stack([flat.points, np.zeros(len(flat.points))])
    kind, cells, _ = flat.cells_of("")[0] if "" in flat.bodies else flat.cells_of(next(iter(flat.bodies)))[0]
    rim = np.flatnonzero(np.linalg.norm(points, axis=1) > radius * (1 - 1e-9))
    path = write_msh(tmp_path / "a.msh", points, {"plate": {kind: cells}, "rim": {"point": rim[:, None]}})
    thick = abut.thicken(path, {"plate": abut.Shell(2.0)}, [abut.MidSupport("rim", **CLAMPED)])
    solid = abut.Solid("plate", abut.LinearElastic(E, nu), integration="reduced")
    model = abut.Model(
        thick.mesh, [solid], thick.supports, [abut.Pressure("plate.sneg", 1e-3)], equations=thick.equations
    )
    of = abut.mid_surface(abut.solve(model), "plate")
    r = np.linalg.norm(of.points, axis=1)
    middle = r.argmin()
    assert of.moment[middle, :2] == pytest.approx(np.full(2, 1e-3 * radius**2 * (1 + nu) / 16), rel=0.02)
    inner = (r > 0.3 * radius) & (r < 0.7 * radius)
    outward = (of.shear * of.points[:, :2]).sum(axis=1)[inner] / r[inner]
    assert outward == pytest.approx(-1e-3 * r[inner] / 2, rel=0.1)

"""forces.csv, and which VTU files are written with what in them."""

from __future__ import annotations

import csv
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

import abut
from abut.errors import InputError
from abut.io.vtu import read_vtu
from abut.mesh import make
from abut.output import restart
from abut.output.stream import Stream

YOUNG = 1000.0


def drawn(steps: int = 5, **more: object) -> abut.Model:
    """A bar 2 long and 1 high in plane stress, without lateral contraction, drawn out by .02."""
    return abut.Model(
        make.join({"bar": make.rectangle([0, 2], [0, 1], cells=[2, 1])}),
        plane="stress",
        solids=[abut.Solid("bar", abut.LinearElastic(YOUNG, 0.0))],
        supports=[abut.Support("bar.left", x=0), abut.Support("bar.bottom", y=0), abut.Support("bar.right", x=0.02)],
        solve=abut.SolveOptions(steps=steps),
        **more,
    )


def rows(folder: Path) -> list[dict[str, str]]:
    with (folder / "forces.csv").open(encoding="utf-8") as file:
        return list(csv.DictReader(file))


def test_force_over_displacement_of_supports(tmp_path: Path) -> None:
    """Hooke's law in every step: force E A u / L at the end that moves, its opposite at the other; in the bottom none."""
    abut.write(abut.solve(drawn()), tmp_path)
    table = rows(tmp_path)
    assert [(r["step"], r["name"]) for r in table[:3]] == [("1", n) for n in ("bar.left", "bar.bottom", "bar.right")]
    assert {r["kind"] for r in table} == {"support"}
    assert len(table) == 15
    for row in table:
        u = 0.02 * float(row["factor"])
        force = YOUNG * u / 2.0
        wanted = {"bar.left": (0.0, -force), "bar.right": (u, force), "bar.bottom": (u / 2.0, 0.0)}[row["name"]]
        assert [float(row["displacement_x"]), float(row["force_x"])] == pytest.approx(wanted, rel=1e-9, abs=1e-12)
        assert row["converged"] == "1"


def test_force_over_displacement_of_references(tmp_path: Path) -> None:
    """A coupling that is pulled and a rigid body that is pushed stand in it by their kinds, with moments."""
    model = drawn(2)
    model = replace(
        model,
        supports=model.supports[:2],
        couplings=[abut.Coupling("grip", "bar.right", reference=(2.0, 0.5), x=0.02, rz=0.0, y=0.0)],
    )
    abut.write(abut.solve(model), tmp_path)
    last = rows(tmp_path)[-1]
    assert (last["kind"], last["name"]) == ("coupling", "grip")
    assert float(last["displacement_x"]) == pytest.approx(0.02)
    assert float(last["force_x"]) == pytest.approx(YOUNG * 0.01, rel=1e-9)
    assert float(last["moment_z"]) == pytest.approx(0.0, abs=1e-9)  # along the middle of the bar


@pytest.mark.parametrize(
    ("steps", "wanted"), [("all", [1, 2, 3, 4, 5]), ("last", [5]), (2, [2, 4, 5]), ([1, 3], [1, 3, 5])]
)
def test_files_of_some_steps(steps: object, wanted: list[int], tmp_path: Path) -> None:
    """The same from a whole solution and from a run that writes as it goes; the collection names the files there are, and
    the tables have every step."""
    model, output = drawn(), abut.Output(steps=steps)  # type: ignore[arg-type]
    solution = abut.solve(model)
    abut.write(solution, tmp_path / "whole", output=output)
    with Stream(tmp_path / "run", restart.description(model), output=output) as stream:
        stream.finish(_streamed(model, stream))
    for folder in (tmp_path / "whole", tmp_path / "run"):
        assert sorted(p.name for p in folder.glob("*.vtu")) == [f"fields_{n:04d}.vtu" for n in wanted]
        text = (folder / "fields.pvd").read_text(encoding="utf-8")
        assert [n for n in range(1, 6) if f"fields_{n:04d}.vtu" in text] == wanted
        assert len(rows(folder)) == 15


def _streamed(model: abut.Model, stream: Stream) -> abut.Solution:
    from abut.analysis import solve

    return solve(model, on_step=stream.step)


def test_files_of_some_fields(tmp_path: Path) -> None:
    """What is asked for and the body's number; principal stresses of simple tension, largest shear its half; numbers of
    32 bits but for places."""
    from vtkmodules.util.numpy_support import vtk_to_numpy
    from vtkmodules.vtkIOXML import vtkXMLUnstructuredGridReader

    solution = abut.solve(drawn(1))
    abut.write(solution, tmp_path, output=abut.Output(fields=["principal-stress", "max-shear", "displacement"]))
    reader = vtkXMLUnstructuredGridReader()
    reader.SetFileName(str(tmp_path / "fields_0001.vtu"))
    reader.Update()
    points, cells = reader.GetOutput().GetPointData(), reader.GetOutput().GetCellData()
    names = {points.GetArrayName(i) for i in range(points.GetNumberOfArrays())}
    assert names == {"principal_stress", "max_shear", "displacement"}
    assert [cells.GetArrayName(i) for i in range(cells.GetNumberOfArrays())] == ["body"]
    stress = vtk_to_numpy(points.GetArray("principal_stress"))
    assert stress.dtype == np.float32
    assert stress == pytest.approx(np.tile([YOUNG * 0.01, 0.0, 0.0], (len(stress), 1)), abs=1e-5)
    assert vtk_to_numpy(points.GetArray("max_shear")) == pytest.approx(YOUNG * 0.005, abs=1e-5)
    assert (vtk_to_numpy(points.GetArray("displacement"))[:, :2] == solution.displacement).all()
    assert len(read_vtu(tmp_path / "fields_0001.vtu").points) == len(solution.model.mesh.points)


def test_no_fields_no_files(tmp_path: Path) -> None:
    abut.write(abut.solve(drawn(1)), tmp_path, output=abut.Output(fields=[]))
    assert not [*tmp_path.glob("*.vtu"), *tmp_path.glob("*.pvd")]
    assert len(rows(tmp_path)) == 3


@pytest.mark.parametrize(
    ("given", "words"),
    [
        ({"steps": 0}, "output.steps: expected"), ({"steps": []}, "output.steps: expected"),
        ({"steps": "first"}, "output.steps"),
        ({"steps": True}, "output.steps"), ({"fields": ["stres"]}, "output.fields"),
        ({"fields": "stress"}, r"\['stress'\]"),
    ],
)  # fmt: skip
def test_what_is_not_understood(given: dict[str, object], words: str) -> None:
    with pytest.raises(InputError, match=words):
        abut.Output(**given)  # type: ignore[arg-type]

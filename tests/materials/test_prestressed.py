"""Stress that undeformed bodies have: what is balanced stays, what is not springs back."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

import abut
from abut.benchmarks import BENCHMARKS, run
from abut.cli import main
from abut.errors import InputError
from abut.job.convert import write_job
from abut.job.load import load_job
from abut.materials.invariants import von_mises
from abut.mesh.make import box, join, rectangle
from abut.output.options import Output
from abut.report.quantities import extremes
from abut.verify.tangents import material_tangent

YOUNG, POISSON = 1000.0, 0.3
STEEL = abut.LinearElastic(YOUNG, POISSON)
PARABOLA = "10*(1 - 12*y**2)"  # without force or moment over the height 1
LINE = "10*y + 5"


def strip(cell: str) -> abut.Mesh:
    mesh = join({"strip": rectangle((0.0, 4.0), (-0.5, 0.5), (8, 4), cell)})
    return replace(mesh, node_sets={"pin": np.array([int(np.linalg.norm(mesh.points, axis=1).argmin())])})


def along(stress: str, plane: str) -> tuple:
    """A stress along the strip, and that across the plane with which there is no strain."""
    return stress, 0, 0 if plane == "stress" else f"{POISSON}*({stress})", 0


def test_closed_form() -> None:
    for outcome in run(BENCHMARKS["spring-back"]):
        assert outcome.passed, outcome


@pytest.mark.parametrize("kinematics", ["small", "finite", "small-strain"])
@pytest.mark.parametrize("plane", ["stress", "strain"])
@pytest.mark.parametrize("cell", ["quad4", "quad8", "tri6", "tri3"])
def test_balanced_stress_stays(cell: str, plane: str, kinematics: str) -> None:
    """Between ends that are held, of any size, nothing moves, and stresses in the middle of cells are those given."""
    mesh = strip(cell)
    supports = [abut.Support("strip.left", x=0), abut.Support("strip.right", x=0), abut.Support("pin", y=0)]
    solid = abut.Solid("strip", STEEL, initial_stress=along(PARABOLA, plane))
    step = abut.solve(abut.Model(mesh, [solid], supports, plane=plane, kinematics=kinematics)).steps[-1]
    assert np.abs(step.displacement).max() < 1e-14
    middle = mesh.points[:, 1] == 0.0
    if cell in ("quad8", "tri6"):
        assert step.stress[middle, 0] == pytest.approx(10.0, rel=2e-2)  # a parabola, recovered from two cells beside it


@pytest.mark.parametrize("plane", ["stress", "strain"])
@pytest.mark.parametrize("cell", ["quad8", "quad9", "tri6"])
def test_what_has_no_balance_springs_back(cell: str, plane: str) -> None:
    """A strip that is let go at one end shortens and bends, exactly so on cells of second order, and no stress is left."""
    mesh = strip(cell)
    solid = abut.Solid("strip", STEEL, initial_stress=along(LINE, plane))
    model = abut.Model(mesh, [solid], [abut.Support("strip.left", x=0), abut.Support("pin", y=0)], plane=plane)
    step = abut.solve(model).steps[-1]
    stiff, ratio = (YOUNG, POISSON) if plane == "stress" else (YOUNG / (1 - POISSON**2), POISSON / (1 - POISSON))
    x, y = mesh.points.T
    moved = np.column_stack([-(10.0 * y + 5.0) * x, 5.0 * x**2 + ratio * (5.0 * y**2 + 5.0 * y)]) / stiff
    assert step.displacement == pytest.approx(moved, abs=1e-11)
    assert np.abs(step.stress).max() < 1e-9


def test_in_space_with_heat() -> None:
    """A block held all round: its stress, and that of warming, add up, in all components."""
    mesh = join({"b": box((0, 1), (0, 1), (0, 1), (2, 2, 2), "hex8")})
    held = [abut.Support(f"b.{side}", x=0, y=0, z=0) for side in ("left", "right", "front", "back", "bottom", "top")]
    steel = replace(STEEL, expansion=1e-3)
    solid = abut.Solid("b", steel, temperature=2.0, initial_stress=(1, 2, 3, 4, 5, 6))
    step = abut.solve(abut.Model(mesh, [solid], held)).steps[-1]
    warm = -YOUNG * 2e-3 / (1.0 - 2.0 * POISSON)
    assert step.stress == pytest.approx(
        np.tile([1 + warm, 2 + warm, 3 + warm, 4, 5, 6], (len(mesh.points), 1)), abs=1e-9
    )


def test_metal_yields_where_the_sum_does() -> None:
    """A bar with 100 yields at 200 after a strain of (200 - 100) / E, and is unloaded elastically."""
    metal = abut.Plastic(YOUNG, POISSON, yield_stress=200.0)
    mesh = join({"b": box((0, 1), (0, 1), (0, 1), (1, 1, 1), "hex8")})
    supports = [abut.Support("b.left", x=0), abut.Support("b.front", y=0), abut.Support("b.bottom", z=0)]

    def pulled(strain: float) -> float:
        model = abut.Model(
            mesh, [abut.Solid("b", metal, initial_stress=(100.0, 0, 0, 0, 0, 0))],
            [*supports, abut.Support("b.right", x=strain)],
        )  # fmt: skip
        return float(abut.solve(model).steps[-1].stress[:, 0].mean())

    assert pulled(0.09) == pytest.approx(190.0, rel=1e-9)
    assert pulled(0.15) == pytest.approx(200.0, rel=1e-9)
    assert pulled(-0.35) == pytest.approx(-200.0, rel=1e-9)


def test_contact_closes() -> None:
    """A bar under -50 between walls .02 apart: it grows into them and keeps 50 - E .02."""
    mesh = join({"b": rectangle((0.0, 1.0), (0.0, 1.0), (2, 2)), "wall": rectangle((1.02, 2.0), (-0.5, 1.5), (2, 2))})
    model = abut.Model(
        mesh, [abut.Solid("b", abut.LinearElastic(YOUNG, 0.0), initial_stress=(-50.0, 0, 0, 0))],
        [abut.Support("b.left", x=0), abut.Support("b.bottom", y=0)], rigid=[abut.Rigid("wall", x=0, y=0, rz=0)],
        contacts=[abut.Contact("b.right", "wall.left")], plane="strain",
    )  # fmt: skip
    pressure = abut.solve(model).contacts[0].pressure
    assert pressure[~np.isnan(pressure)] == pytest.approx(30.0, rel=1e-9)


def test_tangent() -> None:
    """Of metal that flows, against differences."""
    metal = abut.Plastic(YOUNG, POISSON, yield_stress=2.0, hardening=50.0)
    law = abut.Solid("b", metal, initial_stress=(1.0, -2.0, 0.5, 1.0, 0.0, 1.0)).law
    strain = 0.01 * np.random.default_rng(0).normal(size=(20, 6))
    assert material_tangent(law, strain) < 1e-6


JOB = """schema = 1
model.plane = "stress"
materials.steel = {{ kind = "linear-elastic", young = 1000, poisson = 0.3 }}
solids = [{{ body = "strip", material = "steel", initial_stress = {stress} }}]
supports = [{{ on = "strip.left", x = 0 , y = 0 }}]
mesh.bodies.strip = {{ kind = "rectangle", x = [0, 4], y = [-0.5, 0.5], cells = [8, 4] }}
"""


def test_jobs(tmp_path: Path) -> None:
    """Numbers and expressions, and back from the model."""
    path = tmp_path / "job.toml"
    path.write_text(JOB.format(stress='["10*y + 5", 0, 0, 1.5]'))
    job = load_job(path)
    moved = abut.solve(job.model).steps[-1].displacement
    written, _ = write_job(tmp_path / "again.toml", job)
    again = abut.solve(load_job(written).model).steps[-1].displacement
    assert again == pytest.approx(moved, abs=1e-12)
    assert np.abs(moved).max() > 1e-3


@pytest.mark.parametrize(
    ("stress", "said"),
    [
        ("[1, 2, 3]", "initial_stress: expected xx yy zz xy in 2D, xx yy zz xy yz zx in 3D, got 3 values"),
        ("[1, 2, 3, 4, 5, 6]", "initial_stress: expected xx yy zz xy in 2D, got 6 values"),
        ('["q*y", 0, 0, 0]', r"solids\[0\].initial_stress\[0\]: unknown name 'q'"),
    ],
)
def test_messages(stress: str, said: str, tmp_path: Path, capsys: pytest.CaptureFixture) -> None:
    (tmp_path / "job.toml").write_text(JOB.format(stress=stress))
    assert main(["check", str(tmp_path / "job.toml")]) == 2
    text = capsys.readouterr()
    with pytest.raises(InputError, match=said):
        raise InputError(text.out + text.err)


@pytest.mark.parametrize("kinematics", ["small", "finite"])
def test_field_of_results(kinematics: str, tmp_path: Path) -> None:
    """A line over the height is carried to nodes exactly, and stays when the body has sprung back, in files and in the
    report's picture; zero in the body that has none."""
    pieces = {
        "a": rectangle((0, 4), (-0.5, 0.5), (8, 4), "quad8"),
        "b": rectangle((9, 10), (-0.5, 0.5), (1, 2), "tri3"),
    }
    mesh = join(pieces)
    supports = [abut.Support(f"{name}.left", x=0, y=0) for name in pieces]
    solids = [abut.Solid("a", STEEL, initial_stress=(LINE, 0, 3, "x")), abut.Solid("b", STEEL)]
    load = abut.Traction("b.right", (0.1, 0.0))
    solution = abut.solve(
        abut.Model(
            mesh, solids, supports, [load], plane="strain", kinematics=kinematics, solve=abut.SolveOptions(steps=2)
        )
    )
    x, y = mesh.points.T
    wanted = np.column_stack([10.0 * y + 5.0, 0.0 * x, 0.0 * x + 3.0, x, 0.0 * x, 0.0 * x])
    wanted[mesh.nodes_of("b")] = 0.0
    for step in solution.steps:
        assert step.remembered["initial_stress"] == pytest.approx(wanted, abs=1e-12)
    abut.write(solution, tmp_path, output=Output(formats=("vtu", "frd")))
    assert abut.result_field(tmp_path / "fields_0002.vtu", "initial_stress", 0, "a")(np.array([[2.2, 0.3]])) == (
        pytest.approx(8.0, rel=1e-6)  # 7 digits
    )
    assert abut.result_field(tmp_path / "fields.frd", "ISTRESS", 3, "a")(
        np.array([[2.2, 0.3, 0.0]])[:, :2]
    ) == pytest.approx(2.2, rel=1e-5)
    shown = extremes(solution)["initial von Mises"].high
    inside = wanted[mesh.nodes_of("a")]
    assert shown[:, 0] == pytest.approx(float(von_mises(inside).max()), rel=1e-9)
    assert np.isnan(shown[:, 1]).all() or not shown[:, 1].any()


def test_check_lists_it(tmp_path: Path, capsys: pytest.CaptureFixture) -> None:
    """Components that are not zero, from end to end at the nodes; and what has no value there is an error with its place."""
    path = tmp_path / "job.toml"
    path.write_text(JOB.format(stress='["10*y + 5", 0, 0, 1.5]'))
    assert main(["check", str(path)]) == 0
    assert "body 'strip': initial stress xx 0 to 10, xy 1.5" in capsys.readouterr().out
    path.write_text(JOB.format(stress='["1/x", 0, 0, 0]'))
    assert main(["check", str(path)]) == 2
    assert "initial_stress: xx" in capsys.readouterr().out


def test_rubber_has_none() -> None:
    with pytest.raises(
        InputError, match="initial_stress: rubber and other materials for finite strains alone hold none"
    ):
        abut.Solid("b", abut.MooneyRivlin(c10=1.0, c01=0.2, bulk=100.0), initial_stress=(1, 0, 0, 0))

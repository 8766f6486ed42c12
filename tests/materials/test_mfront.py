"""Behaviours of MFront: with a stand-in for the module mgis.behaviour everywhere, with MGIS itself where it is installed."""

from __future__ import annotations

import importlib
import pickle
import subprocess
import sys
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import abut
from abut.errors import InputError, Unsound
from abut.job import load_job
from abut.job.convert import write_job
from abut.materials.places import Places
from abut.mesh.make import join, rectangle
from abut.nonlinear.settings import DEFAULT
from abut.verify.tangents import differences
from models.steps import stop_in

E, NU, Y, H = 210e3, 0.3, 250.0, 2000.0
ELASTIC = {"YoungModulus": E, "PoissonRatio": NU}
METAL = {**ELASTIC, "YieldStress": Y, "Hardening": H}
RNG_STRAIN = 3e-3
WHY = "MGIS is not installed: package mgis of conda-forge or Spack; it is not on PyPI"


@pytest.fixture(scope="session")
def compiled(tmp_path_factory: pytest.TempPathFactory) -> str:
    """Behaviours by hand that MGIS can load."""
    path = tmp_path_factory.mktemp("mfront") / "behaviours.so"
    source = Path(__file__).with_name("behaviours.cpp")
    subprocess.run(["c++", "-std=c++17", "-O2", "-shared", "-fPIC", str(source), "-o", str(path)], check=True)
    return str(path)


@pytest.fixture
def stand_in(monkeypatch: pytest.MonkeyPatch) -> str:
    monkeypatch.setitem(sys.modules, "mgis.behaviour", importlib.import_module("models.stand_in_mgis"))
    return "stand-in"


@pytest.fixture(params=["stand-in", "mgis"])
def library(request: pytest.FixtureRequest) -> str:
    if request.param == "stand-in":
        return str(request.getfixturevalue("stand_in"))
    pytest.importorskip("mgis.behaviour", reason=WHY)
    return str(request.getfixturevalue("compiled"))


def metal(library: str, **more: Any) -> abut.MFront:
    return abut.MFront(library, "Metal", METAL, **more)


def test_path(library: str) -> None:
    """A path with reversals: stresses, tangents and state variables of abut's own metal, tangents against differences."""
    theirs, ours = metal(library), abut.Plastic(E, NU, Y, H)
    rng, n = np.random.default_rng(0), 40
    there, here, strain = theirs.initial(n), ours.initial(n), np.zeros((n, 6))
    flow, elastic = theirs.fields["equivalent_plastic_strain"], theirs.fields["ElasticStrain"]
    for _ in range(6):
        strain = strain + rng.uniform(-RNG_STRAIN, RNG_STRAIN, (n, 6))
        stress, tangent, now = theirs.evaluate(strain, there)
        told, slope, here = ours.evaluate(strain, here)
        assert np.abs(stress - told).max() < 1e-12 * np.abs(told).max()
        assert np.abs(tangent - slope).max() < 1e-12 * E
        found = differences(lambda x, before=there: theirs.evaluate(x, before)[0], strain)
        assert np.abs(tangent - found).max() < 1e-7 * np.abs(tangent).max()
        there = now
        assert there[:, flow] == pytest.approx(here[:, 6:7], rel=1e-11)
        twice = [1.0, 1.0, 1.0, 2.0, 2.0, 2.0]
        assert there[:, elastic] * twice == pytest.approx(strain - here[:, :6], abs=1e-15)
    assert here[:, 6].min() > 0.0


def test_at_rest(library: str) -> None:
    """What contact takes its scales from: the elastic moduli."""
    law = metal(library)
    assert law.linear is not None
    assert (law.linear.young, law.linear.poisson) == pytest.approx((E, NU), rel=1e-12)
    assert law.modulus == pytest.approx(E, rel=1e-12)
    assert law.small
    assert pickle.loads(pickle.dumps(law)) == law  # as other processes get it
    assert hash(law) == hash(metal(library))


def punch(material: Any, plane: str, kinematics: str = "small") -> abut.Model:
    """A steel block of which a harder one marks the middle, taken away by half."""
    mesh = join(
        {"block": rectangle((0, 4), (0, 2), (8, 4), "quad4"), "punch": rectangle((1.1, 2.9), (2, 3), (5, 2), "quad4")}
    )
    course = abut.Amplitude(((0.0, 0.0), (0.8, 1.0), (1.0, 0.9)))
    return abut.Model(
        replace(mesh, axisymmetric=plane == "axisymmetric"),
        [abut.Solid("block", material), abut.Solid("punch", abut.LinearElastic(3 * E, NU))],
        [abut.Support("block.bottom", y=0), abut.Support("block.left", x=0),
         abut.Support("punch.top", x=0, y=-0.01, amplitude=course)],
        contacts=[abut.Contact("punch.bottom", "block.top", name="c")],
        plane=plane,
        kinematics=kinematics,
        solve=abut.SolveOptions(steps=20),
    )  # fmt: skip


@pytest.mark.parametrize("plane", ["strain", "stress", "axisymmetric"])
def test_contact(library: str, plane: str) -> None:
    """Pressed into a body that yields, forces, flow and displacements are those with abut's own metal at every step."""
    tight = replace(DEFAULT, newton=replace(DEFAULT.newton, balanced=1e-12))
    ours = abut.solve(punch(abut.Plastic(E, NU, Y, H), plane), settings=tight)
    theirs = abut.solve(punch(metal(library, volume_preserving=True), plane), settings=tight)
    assert theirs.converged
    for one, other in zip(ours.steps, theirs.steps, strict=True):
        assert other.contacts[0].force == pytest.approx(one.contacts[0].force, rel=1e-10)
        size = np.abs(one.displacement).max()
        assert np.abs(other.displacement - one.displacement).max() < 1e-10 * size
        flow = one.remembered["equivalent_plastic_strain"]
        assert np.abs(other.remembered["equivalent_plastic_strain"] - flow).max() <= 1e-9 * flow.max()
        assert other.flow is not None
        assert other.flow.largest == pytest.approx(one.flow.largest, rel=1e-9)
        assert other.flow.work == pytest.approx(one.flow.work, rel=0.1)  # by differences in time
    assert ours.steps[-1].flow.largest > 0.003


def test_large_turns(library: str) -> None:
    """A behaviour of small strains, and one of deformation gradients, see those of Green and Lagrange: Kirchhoff's law."""
    rng = np.random.default_rng(1)
    strain = rng.uniform(-0.15, 0.15, (30, 6))
    stress, tangent, _ = abut.LinearElastic(E, NU).evaluate(strain, np.zeros((30, 0)))
    law = abut.MFront(library, "Kirchhoff", ELASTIC)
    assert not law.small
    told, slope, after = law.evaluate_finite(strain, law.initial(30))
    assert np.abs(told - stress).max() < 1e-12 * np.abs(stress).max()
    assert np.abs(slope - tangent).max() < 1e-12 * E
    again = law.evaluate_finite(strain, after)[0]
    assert np.abs(again - stress).max() < 1e-12 * np.abs(stress).max()
    first = abut.solve(punch(abut.LinearElastic(E, NU), "strain", "finite"))
    other = abut.solve(punch(law, "strain", "finite"))
    assert other.contacts[0].force == pytest.approx(first.contacts[0].force, rel=1e-10)
    with pytest.raises(InputError, match="MFront of body 'block' is for finite strains"):
        punch(law, "strain")


def test_time_step(library: str) -> None:
    """A fluid of Maxwell's, strained at once and held: with backward differences the stress falls by 1 + dt / tau a step,
    with the times of the run."""
    law = abut.MFront(library, "Maxwell", {**ELASTIC, "RelaxationTime": 3.0})
    rod = abut.Model(
        join({"rod": rectangle((0, 1), (0, 1), (1, 1))}),
        [abut.Solid("rod", law)],
        [abut.Support("rod.left", x=0), abut.Support("rod.bottom", y=0),
         abut.Support("rod.right", x=1e-3, amplitude=abut.Amplitude(((0.0, 0.0), (2.0, 1.0))))],
        plane="stress",
        solve=abut.SolveOptions(end=8.0, times=(2.0, 4.0, 8.0)),
    )  # fmt: skip
    stresses = [step.stress[0, 0] for step in abut.solve(rod).steps]
    first = E * 1e-3 / (1.0 + 2.0 / 3.0)
    expected = [first, first / (1.0 + 2.0 / 3.0), first / (1.0 + 2.0 / 3.0) / (1.0 + 4.0 / 3.0)]
    assert stresses == pytest.approx(expected, rel=1e-9)


def test_variables(stand_in: str) -> None:
    """Temperature follows the body's, others and parameters are constant; what heat strains is taken away first."""
    law = abut.MFront(
        stand_in, "Heated", ELASTIC, parameters={"Shift": 0.1}, variables={"Humidity": 0.2}, initial_temperature=303.15,
        expansion=1e-4,
    )  # fmt: skip
    here = law.at(Places(np.zeros((2, 2)), np.array([0.0, 20.0])))
    strain = np.zeros((2, 6))
    strain[:, 0] = 1e-3
    stress, _, after = here.evaluate(strain, law.initial(2))
    soft = 1.0 - 0.01 * np.array([10.0, 30.0]) - 0.3
    strain[1, :3] -= 2e-3
    elastic = abut.LinearElastic(E, NU).evaluate(strain, np.zeros((2, 0)))[0]
    assert stress == pytest.approx(soft[:, None] * elastic, rel=1e-12)
    assert after[:, 0] == pytest.approx([303.15, 323.15])


def test_axes(library: str) -> None:
    """Axes do nothing to an isotropic law; its history is along them."""
    law = metal(library, axes=abut.Axes(x=(1.0, 2.0)))
    here, there = (each.at(Places(np.zeros((5, 2)), np.zeros(5))) for each in (law, metal(library)))
    strain = np.random.default_rng(2).uniform(-RNG_STRAIN, RNG_STRAIN, (5, 6))
    one, other = (each.evaluate(strain, law.initial(5)) for each in (here, there))
    assert one[0] == pytest.approx(other[0], abs=1e-11 * np.abs(other[0]).max())
    assert one[1] == pytest.approx(other[1], abs=1e-11 * E)
    assert np.abs(one[2] - other[2]).max() > 1e-4


def test_not_integrated(stand_in: str) -> None:
    """Where MFront gives up, the step is too large."""
    law = abut.MFront(stand_in, "Maxwell", {**ELASTIC, "RelaxationTime": 1.0})
    with pytest.raises(Unsound, match="'Maxwell' of MFront was not integrated at some point; try more load steps"):
        law.evaluate(np.full((1, 6), np.nan), law.initial(1))


@pytest.mark.parametrize(
    ("given", "words"),
    [
        (
            {"library": "nowhere.so"},
            "library: behaviour 'Metal' of library 'nowhere.so' can't be loaded for the hypoth",
        ),
        ({"behaviour": "Metl"}, "library: behaviour 'Metl' of library .* can't be loaded"),
        ({"properties": ELASTIC}, "properties: missing of behaviour 'Metal': YieldStress, Hardening"),
        (
            {"properties": None},
            "properties: missing of behaviour 'Metal': YoungModulus, PoissonRatio, YieldStress, Hard",
        ),
        ({"properties": {**METAL, "Young": 1.0}}, "properties.Young: behaviour 'Metal' has no such material property"),
        ({"parameters": {"Shift": 1.0}}, "parameters.Shift: behaviour 'Metal' has no such parameter"),
        ({"variables": {"Damp": 1.0}}, "variables.Damp: behaviour 'Metal' has no such external state variable"),
        ({"properties": {"YoungModulus": "x"}}, "properties.YoungModulus: expected a number, got 'x'"),
        ({"density": -1.0}, "density: expected a number >= 0"),
        ({"axes": 3}, "axes: expected Axes or a function"),
    ],
)
def test_wrong(library: str, given: dict[str, Any], words: str) -> None:
    with pytest.raises(InputError, match=words):
        abut.MFront(**{"library": library, "behaviour": "Metal", "properties": METAL, **given})


def test_without_mgis(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setitem(sys.modules, "mgis.behaviour", None)
    with pytest.raises(InputError, match=r"kind: the Python module mgis\.behaviour, .* not on PyPI: .* conda-forge"):
        abut.MFront("library.so", "Metal", METAL)


JOB = """
schema = 1
[model]
plane = "strain"
[mesh.bodies.block]
kind = "rectangle"
x = [0, 4]
y = [0, 2]
cells = [8, 4]
cell = "quad4"
[mesh.bodies.punch]
kind = "rectangle"
x = [1.1, 2.9]
y = [2, 3]
cells = [5, 2]
cell = "quad4"
[materials.metal]
kind = "mfront"
library = "LIBRARY"
behaviour = "Metal"
volume_preserving = true
properties = { YoungModulus = 210e3, PoissonRatio = 0.3, YieldStress = 250, Hardening = 2000 }
[materials.tool]
kind = "linear-elastic"
young = 600e3
poisson = 0.3
[[solids]]
body = "block"
material = "metal"
[[solids]]
body = "punch"
material = "tool"
[[supports]]
on = "block.bottom"
x = 0
y = 0
[[supports]]
on = "punch.top"
x = 0
y = -0.02
amplitude = [[0, 0], [0.5, 1], [1, 0.7]]
[[contacts]]
name = "c"
surfaces = ["punch.bottom", "block.top"]
[solve]
steps = 4
"""


def written(folder: Path, library: str) -> Path:
    folder.mkdir()
    path = folder / "job.toml"
    path.write_text(JOB.replace("LIBRARY", library))
    return path


def test_job(library: str, tmp_path: Path) -> None:
    """What a job says, is written back, and goes on after a stop: histories come from the restart file."""
    from abut.cli import main

    paths = [written(tmp_path / name, library) for name in ("whole", "parts")]
    law = load_job(paths[0]).model.solids[0].material
    assert law == metal(library, volume_preserving=True)
    write_job(tmp_path / "again.toml", load_job(paths[0]))
    assert load_job(tmp_path / "again.toml").model.solids[0].material == law
    assert main(["run", str(paths[0]), "--quiet"]) == 0
    stop_in(paths[1], 4)
    assert main(["run", str(paths[1]), "--restart", "--quiet"]) == 0
    rows = [np.array([[float(x) for x in line.split(",")[4:]] for line in
                      (path.parent / "results" / "history.csv").read_text().splitlines()[1:]])
            for path in paths]  # fmt: skip
    assert rows[1] == pytest.approx(rows[0], rel=1e-11, abs=1e-12 * np.nanmax(np.abs(rows[0])), nan_ok=True)
    solution = abut.solve(load_job(paths[0]).model)
    assert [line.name for line in solution.certificate if not line.passed] in ([], ["overlap"])  # at the sharp corner


def test_job_finds_the_library(tmp_path: Path, compiled: str, stand_in: str) -> None:
    """From the job's folder on; the stand-in then says that it is none of its own."""
    path = written(tmp_path / "job", "here.so")
    (path.parent / "here.so").write_bytes(Path(compiled).read_bytes())
    with pytest.raises(InputError, match=f"library '{path.parent / 'here.so'}'"):
        load_job(path)

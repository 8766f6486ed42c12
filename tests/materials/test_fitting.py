"""Constants of rubber from tests made of known laws, the stress in these tests, stability, and the command."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

import abut
from abut.cli import main
from abut.errors import InputError
from abut.io.toml import read_toml
from abut.job.convert import material_table
from abut.materials.fitting import fit
from abut.materials.rubber import Energy, Rubber
from abut.materials.rubber_tests import ACROSS, RubberTest, nominal_stress, stable_range

STRETCH = np.linspace(0.7, 2.5, 15)
LAWS: dict[str, Rubber] = {
    "mooney-rivlin": abut.MooneyRivlin(bulk=100.0, c10=0.4, c01=0.1),
    "yeoh": abut.Yeoh(bulk=100.0, c10=0.5, c20=-0.01, c30=0.002),
    "ogden": abut.Ogden(bulk=100.0, terms=[(1.491, 1.3), (0.003, 5.0), (-0.0237, -2.0)]),
    "arruda-boyce": abut.ArrudaBoyce(bulk=100.0, shear=0.7, locking=2.8),
}


def made(law: Rubber | Energy) -> list[RubberTest]:
    energy = law.energy if isinstance(law, Rubber) else law
    return [RubberTest(kind, STRETCH, nominal_stress(energy, kind, STRETCH)) for kind in ACROSS]


@pytest.mark.parametrize("name", LAWS)
@pytest.mark.parametrize("kind", ACROSS)
def test_nominal_stress(name: str, kind: str) -> None:
    """That of the law at the point: difference of principal Cauchy stresses over the stretch."""
    law = LAWS[name]
    for stretch in (0.8, 1.7):
        f = stretch ** np.array(ACROSS[kind])
        strain = np.array([[*(0.5 * (f**2 - 1.0)), 0.0, 0.0, 0.0]])
        s = law.evaluate_finite(strain, law.initial(1))[0][0]
        want = (f[0] ** 2 * s[0] - f[2] ** 2 * s[2]) / stretch
        assert nominal_stress(law.energy, kind, np.array([stretch]))[0] == pytest.approx(want, rel=1e-10)


@pytest.mark.parametrize("name", LAWS)
def test_known_law_is_found(name: str) -> None:
    """Its constants, from three tests without noise."""
    law = LAWS[name]
    found = fit(name, made(law), bulk=100.0).material
    if isinstance(law, abut.Ogden):
        assert isinstance(found, abut.Ogden)
        assert np.array(sorted(found.terms)) == pytest.approx(np.array(sorted(law.terms)), rel=1e-6)
        return
    own, known = material_table(found), material_table(law)
    assert own.pop("kind") == known.pop("kind")
    assert own == pytest.approx(known, rel=1e-6)


def test_neo_hooke() -> None:
    """Shear modulus, and the bulk modulus of Poisson's ratio."""
    found = fit("neo-hooke", made(Energy((), (0.6,), (1.0,))), poisson=0.49).material
    assert isinstance(found, abut.NeoHooke)
    assert found.shear == pytest.approx(1.2, rel=1e-12)
    assert found.linear.poisson == pytest.approx(0.49, rel=1e-12)


def test_every_test_counts_alike() -> None:
    """Stresses of one test in other units, and more points of it, change nothing where laws fit; noise is told."""
    rng, law = np.random.default_rng(0), LAWS["yeoh"]
    tests = [replace(test, stress=test.stress * (1.0 + 0.01 * rng.normal(size=len(STRETCH)))) for test in made(law)]
    found = fit("yeoh", tests)
    assert all(1e-4 < error < 0.02 for error in found.errors)
    assert fit("yeoh", [*tests, *tests]).energy.shear == pytest.approx(found.energy.shear, rel=1e-12)


def test_stable_range() -> None:
    """Neo-Hooke everywhere; of Yeoh with a negative second constant up to where the stress, which the second derivative
    along the test bounds, has its maximum: in uniaxial tension W' = 0 at the latest."""
    assert stable_range(Energy((), (0.5,), (1.0,)), "uniaxial") == (0.1, 10.0)
    _, high = stable_range(Energy((), (0.5, -0.02), (1.0,)), "uniaxial")
    last = float(np.roots([1.0, 0.0, -3.0 - 0.5 / 0.04, 2.0]).real.max())  # 0.5 = 0.04 (I1 - 3)
    assert 1.5 < high < last
    stretch = np.linspace(1.0, high, 400)
    push = stretch * nominal_stress(Energy((), (0.5, -0.02), (1.0,)), "uniaxial", stretch)
    assert (np.diff(push) > 0.0).all()


def csv(path: Path, test: RubberTest, strain: bool = False) -> str:
    name, offset = ("strain", 1.0) if strain else ("stretch", 0.0)
    rows = [f"{float(a) - offset!r};{float(b)!r}" for a, b in zip(test.stretch, test.stress)]
    path.write_text("\n".join(["# a test", f"{name};stress", *rows]) + "\n", encoding="utf-8")
    return str(path)


def test_command(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    """Prints a table that a job file takes, and writes the page."""
    one, two, _ = made(LAWS["yeoh"])
    page = tmp_path / "fit.html"
    files = ["--uniaxial", csv(tmp_path / "u.csv", one), "--planar", csv(tmp_path / "p.csv", two, strain=True)]
    assert main(["fit", "yeoh", *files, "--bulk", "100", "--name", "seal", "--plot", str(page)]) == 0
    out = capsys.readouterr().out
    (tmp_path / "seal.toml").write_text(out, encoding="utf-8")
    told, known = read_toml(tmp_path / "seal.toml")[1]["materials"]["seal"], material_table(LAWS["yeoh"])
    assert told.pop("kind") == known.pop("kind")
    assert told == pytest.approx(known, rel=1e-6)
    assert "u.csv: uniaxial, stretch 0.7 to 2.5" in out
    assert "stable for stretches" in out
    assert page.read_text(encoding="utf-8").count("<svg") == 2


@pytest.mark.parametrize(
    ("text", "said"),
    [
        ("stretch,stress\n1.0,0.0\n1.5,x\n", "line 3: expected two numbers"),
        ("stretch,stress\n-1.0,0.0\n", "line 2: a stretch must be > 0"),
        ("lambda,stress\n1.0,0.0\n", "expected the names stretch or strain, and stress, got 'lambda'"),
        ("stretch,strain\n1.0,0.0\n", "expected two columns"),
        ("", "expected a line of names"),
        ("stretch,stress\n1.5,0.4\n", "yeoh: 3 constants need as many points at least, the tests have 1"),
        ("stretch,stress\n1.5,-0.4\n1.6,-0.5\n1.7,-0.6\n", "shear modulus"),
    ],
)
def test_bad_data(text: str, said: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    """One message, status 2."""
    path = tmp_path / "data.csv"
    path.write_text(text, encoding="utf-8")
    assert main(["fit", "yeoh", "--uniaxial", str(path)]) == InputError.exit_status
    assert said in capsys.readouterr().err
    assert main(["fit", "yeoh"]) == InputError.exit_status

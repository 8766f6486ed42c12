"""Laws of rubber beside Treloar's tests of vulcanised rubber (1944), the ones that such laws are measured by: three kinds of
test, stretches to 7.6. Values as P. Steinmann, M. Hossain and G. Possart have them, Arch. Appl. Mech. 82 (2012)
1183-1217."""

from __future__ import annotations

from functools import cache
from pathlib import Path

import numpy as np
import pytest

import abut
from abut.materials.fitting import Fit, fit
from abut.materials.rubber import Energy
from abut.materials.rubber_tests import ACROSS, RubberTest, nominal_stress, read_test, stable_range

DATA = Path(__file__).parent / "treloar"
KG_BY_CM2 = 0.0980665  # MPa
# R. W. Ogden, Proc. R. Soc. Lond. A 326 (1972) 565-584, in kg/cm2; drawn through these points.
OGDEN = Energy(tuple((mu * KG_BY_CM2, alpha) for mu, alpha in ((6.3, 1.3), (0.012, 5.0), (-0.1, -2.0))), (), (1.0,))
# E. M. Arruda, M. C. Boyce, J. Mech. Phys. Solids 41 (1993) 389-412: nkT = 0.27 MPa, N = 26.5 from the uniaxial
# test, with the inverse Langevin function, of which the law has five terms.
CHAINS = abut.ArrudaBoyce(bulk=100.0, shear=0.27, locking=26.5**0.5).energy


@cache
def measured() -> list[RubberTest]:
    return [read_test(DATA / f"{kind}.csv", kind) for kind in ACROSS]


@cache
def fitted(law: str) -> Fit:
    return fit(law, measured())


def errors(energy: Energy) -> np.ndarray:
    """Root of the mean square over the largest stress, of each test."""
    left = [(nominal_stress(energy, test.kind, test.stretch) - test.stress) / test.stress.max() for test in measured()]
    return np.array([float(np.sqrt((values**2).mean())) for values in left])


def slopes(kind: str, stretch: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Nominal stress of W(I1, I2) by hand: the factors of dW/dI1 and dW/dI2, and I1 - 3."""
    x = stretch
    if kind == "uniaxial":
        return 2.0 * (x - x**-2), 2.0 * (x - x**-2) / x, x**2 + 2.0 / x - 3.0
    if kind == "planar":
        return 2.0 * (x - x**-3), 2.0 * (x - x**-3), x**2 + 1.0 + x**-2 - 3.0
    return 2.0 * (x - x**-5), 2.0 * (x - x**-5) * x**2, 2.0 * x**2 + x**-4 - 3.0


def least_squares(law: str) -> np.ndarray:
    """Constants of a law that is linear in them, by hand."""
    rows, sides = [], []
    for test in measured():
        by_first, by_second, over = slopes(test.kind, test.stretch)
        columns = (
            [by_first, by_second] if law == "mooney-rivlin" else [by_first, 2 * over * by_first, 3 * over**2 * by_first]
        )
        weight = 1.0 / (test.stress.max() * np.sqrt(len(test.stress)))
        rows.append(weight * np.stack(columns, axis=1))
        sides.append(weight * test.stress)
    return np.asarray(np.linalg.lstsq(np.vstack(rows), np.concatenate(sides), rcond=None)[0])


def test_published_constants_of_ogden() -> None:
    """Ogden's lie on the points to some percent of the largest stress, as his figures show."""
    assert (errors(OGDEN) < 0.06).all()


@pytest.mark.parametrize(("law", "published"), [("ogden", OGDEN), ("arruda-boyce", CHAINS)])
def test_no_worse_than_published(law: str, published: Energy) -> None:
    """The least sum of squares is no larger than that of any other constants."""
    found = fitted(law)
    assert np.sum(np.square(found.errors)) <= np.sum(errors(published) ** 2)
    assert np.array(found.errors) == pytest.approx(errors(found.energy), rel=1e-9)


@pytest.mark.parametrize("law", ["mooney-rivlin", "yeoh"])
def test_linear_laws(law: str) -> None:
    """Constants are those of the normal equations, with stresses by hand."""
    material = fitted(law).material
    assert isinstance(material, (abut.MooneyRivlin, abut.Yeoh))
    names = ("c10", "c01") if isinstance(material, abut.MooneyRivlin) else ("c10", "c20", "c30")
    assert [getattr(material, name) for name in names] == pytest.approx(least_squares(law), rel=1e-7)


def test_order_of_laws() -> None:
    """As is known of these data: two constants miss the upturn of large stretches, which chains of a finite length and a
    third power of I1 have; three terms of Ogden follow all three tests within two percent."""
    total = {
        law: float(np.linalg.norm(fitted(law).errors)) for law in ("mooney-rivlin", "yeoh", "arruda-boyce", "ogden")
    }
    assert max(fitted("ogden").errors) < 0.02
    assert total["ogden"] < 0.5 * min(total["yeoh"], total["arruda-boyce"])
    assert max(total["yeoh"], total["arruda-boyce"]) < 0.5 * total["mooney-rivlin"]


@pytest.mark.parametrize("law", ["mooney-rivlin", "yeoh", "arruda-boyce", "ogden"])
def test_stable_over_the_tests(law: str) -> None:
    """Mooney's constants of one sign, Ogden's terms with mu alpha > 0 and chains are stable whatever the stretch; of all,
    Yeoh's too, the Cauchy stress grows over each test."""
    energy = fitted(law).energy
    assert all(mu * alpha > 0.0 for mu, alpha in energy.terms)
    for test in measured():
        low, high = stable_range(energy, test.kind)
        assert low <= 1.0
        assert high >= test.stretch.max()
        stretch = np.linspace(1.0, float(test.stretch.max()), 400)
        assert (np.diff(stretch * nominal_stress(energy, test.kind, stretch)) > 0.0).all()

"""Laws for rubber at points: closed forms at constant volume, tangents against differences, and neo-Hooke's among them."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

import abut
from abut.bodies.assemble import respond
from abut.bodies.solids import Solids
from abut.materials.rubber import ArrudaBoyce, MooneyRivlin, Ogden, Rubber, Yeoh
from abut.mesh.make import rectangle
from abut.verify.tangents import differences

BULK = 50.0
MU = (1.491, 0.003, -0.0237)  # of Treloar's rubber, kg/cm^2 / 4.18..., in Ogden's form (Ogden 1972)
ALPHA = (1.3, 5.0, -2.0)
LAWS: dict[str, Rubber] = {
    "mooney": MooneyRivlin(bulk=BULK, c10=0.4, c01=0.1),
    "yeoh": Yeoh(bulk=[25.0, 10.0], c10=0.5, c20=-0.01, c30=0.002),
    "ogden": Ogden(bulk=BULK, terms=list(zip(MU, ALPHA))),
    "arruda-boyce": ArrudaBoyce(bulk=BULK, shear=1.0, locking=2.8),
}
CHAIN = (1 / 2, 1 / 20, 11 / 1050, 19 / 7000, 519 / 673750)


def by_invariants(name: str, i1: float) -> tuple[float, float]:
    """dW/dI1 and dW/dI2."""
    if name == "mooney":
        return 0.4, 0.1
    if name == "yeoh":
        return 0.5 - 0.02 * (i1 - 3) + 0.006 * (i1 - 3) ** 2, 0.0
    return sum((i + 1) * c * i1**i / 2.8 ** (2 * i) for i, c in enumerate(CHAIN)), 0.0


def cauchy(law: Rubber, f: np.ndarray) -> np.ndarray:
    e = 0.5 * (f.T @ f - np.eye(3))
    strain = np.array([[e[0, 0], e[1, 1], e[2, 2], 2 * e[0, 1], 2 * e[1, 2], 2 * e[2, 0]]])
    s, _, _ = law.evaluate_finite(strain, law.initial(1))
    xx, yy, zz, xy, yz, zx = s[0]
    return np.asarray(f @ np.array([[xx, xy, zx], [xy, yy, yz], [zx, yz, zz]]) @ f.T / np.linalg.det(f))


@pytest.mark.parametrize("name", LAWS)
@pytest.mark.parametrize("stretch", [0.6, 1.0001, 1.3, 2.0])
@pytest.mark.parametrize("how", ["uniaxial", "biaxial", "shear"])
def test_closed_forms(name: str, stretch: float, how: str) -> None:
    """At constant volume: difference of two principal stresses, and in simple shear the shear stress (Rivlin 1948)."""
    across = stretch**-0.5 if how == "uniaxial" else stretch**-2.0
    f = np.diag([stretch, across, across] if how == "uniaxial" else [stretch, stretch, across])
    if how == "shear":
        f = np.eye(3)
        f[0, 1] = stretch - 1.0
    sigma = cauchy(LAWS[name], f)
    b = f @ f.T
    if name == "ogden" and how != "shear":
        want = sum(mu * (stretch**a - across**a) for mu, a in zip(MU, ALPHA))
    elif name == "ogden":
        squares, axes = np.linalg.eigh(b)
        tau = axes @ np.diag(sum(mu * squares ** (a / 2) for mu, a in zip(MU, ALPHA))) @ axes.T
        want = tau[0, 1]
    else:
        first, second = by_invariants(name, float(np.trace(b)))
        tau = 2.0 * (first * b - second * np.linalg.inv(b))
        want = tau[0, 1] if how == "shear" else tau[0, 0] - tau[2, 2]
    told = sigma[0, 1] if how == "shear" else sigma[0, 0] - sigma[2, 2]
    assert told == pytest.approx(want, abs=1e-10)
    assert np.trace(sigma) == pytest.approx(0.0, abs=1e-10)


@pytest.mark.parametrize("name", LAWS)
def test_tangent(name: str) -> None:
    """Against central differences, also where stretches are equal or nearly so; symmetric; at rest that of ``linear``."""
    law, rng = LAWS[name], np.random.default_rng(0)
    strain = rng.uniform(-0.25, 0.4, (40, 6))
    strain[0] = [0.3, 0.3, 0.3, 0, 0, 0]
    strain[1] = [0.3, 0.3, -0.1, 1e-8, 0, 0]
    strain[2] = [0.3, 0.30002, -0.1, 0, 0, 0]
    strain[3] = 0.0
    _, tangent, _ = law.evaluate_finite(strain, law.initial(40))
    found = differences(lambda x: law.evaluate_finite(x, law.initial(40))[0], strain)
    assert np.abs(tangent - found).max() < 1e-7 * np.abs(tangent).max()
    assert np.abs(tangent - np.swapaxes(tangent, 1, 2)).max() < 1e-12 * np.abs(tangent).max()
    rest = law.linear.evaluate(strain[3:4], law.initial(1))[1]
    assert np.abs(tangent[3] - rest).max() < 1e-12 * np.abs(rest).max()


@pytest.mark.parametrize("plane", ["strain", "stress", "axisymmetric"])
def test_neo_hooke(plane: str) -> None:
    """Mooney and Rivlin's law without its second constant, and Yeoh's with the first alone, is the isochoric neo-Hooke's."""
    mesh = rectangle((1.0, 2.0), (0.0, 1.0), (2, 2), "quad8")
    mesh = replace(mesh, axisymmetric=plane == "axisymmetric")
    moved = np.random.default_rng(1).uniform(-0.05, 0.05, mesh.points.shape) + 0.1 * mesh.points
    told = []
    for law in (
        abut.NeoHooke(shear=1.0, bulk=BULK, volumetric="isochoric"),
        MooneyRivlin(bulk=BULK, c10=0.5, c01=0.0),
        Yeoh(bulk=BULK, c10=0.5),
        Ogden(bulk=BULK, terms=[(1.0, 2.0)]),
    ):
        told.append(respond(Solids(mesh, {"body": law}, plane, {}, "finite"), moved))
    first = told[0]
    for other in told[1:]:
        assert np.abs(other.force - first.force).max() < 1e-10 * np.abs(first.force).max()
        assert np.abs((other.tangent - first.tangent).toarray()).max() < 1e-9 * np.abs(first.tangent.toarray()).max()
        assert other.energy == pytest.approx(first.energy, rel=1e-10)


@pytest.mark.parametrize(
    ("make", "words"),
    [
        (lambda: MooneyRivlin(bulk=0.0, c10=1.0, c01=0.0), "bulk: expected a number > 0"),
        (lambda: MooneyRivlin(bulk=1.0, c10=-1.0, c01=0.5), "shear modulus at rest"),
        (lambda: Ogden(bulk=1.0, terms=[(1.0, 0.0)]), "not 0"),
        (lambda: Yeoh(bulk=[0.0, 1.0], c10=1.0), "of which the first is > 0"),
        (lambda: ArrudaBoyce(bulk=1.0, shear=1.0, locking=0.0), "locking: expected a number > 0"),
    ],
)
def test_refused(make: object, words: str) -> None:
    with pytest.raises(abut.InputError, match=words):
        make()  # type: ignore[operator]

"""Von Mises plasticity at points: closed forms, tangents against differences, unloading, turns, and a user's own copy."""

from __future__ import annotations

import numpy as np
import pytest

import abut
from abut.materials.plane_stress import in_plane_stress
from abut.materials.plastic import Plastic
from abut.verify.tangents import differences
from models.j2 import J2

E, NU, Y = 210e3, 0.3, 250.0
K, G = E / (3 * (1 - 2 * NU)), E / (2 * (1 + NU))
LAWS = {
    "perfect": Plastic(E, NU, Y),
    "linear": Plastic(E, NU, Y, hardening=2000.0),
    "voce": Plastic(E, NU, Y, saturation=150.0, rate=20.0),
    "table": Plastic(E, NU, [(0.0, Y), (0.01, 300.0), (0.1, 400.0)]),
    "prager": Plastic(E, NU, Y, backstresses=[(5000.0, 0.0)]),
    "mixed": Plastic(E, NU, Y, 500.0, 50.0, 30.0, [(50e3, 500.0), (3000.0, 10.0)]),
}


def yield_stress(name: str, x: float) -> float:
    if name == "voce":
        return Y + 150.0 * (1.0 - np.exp(-20.0 * x))
    if name == "table":
        return float(np.interp(x, [0.0, 0.01, 0.1], [Y, 300.0, 400.0]))
    return Y + (2000.0 * x if name == "linear" else 0.0)


def along(law: Plastic, path: np.ndarray, finite: bool = False) -> tuple[np.ndarray, np.ndarray]:
    """Stress and history at the end of a path of strains (steps, 6)."""
    history = law.initial(1)
    stress = np.zeros((1, 6))
    for strain in path:
        stress, _, history = (law.evaluate_finite if finite else law.evaluate)(strain[None], history)
    return stress[0], history[0]


@pytest.mark.parametrize("name", ["perfect", "linear", "voce", "table"])
@pytest.mark.parametrize("ratio", [0.0, 1.0, -1.0])
def test_closed_forms(name: str, ratio: float) -> None:
    """Stresses s, ratio s in proportion: plastic strains follow from the yield stress at the end alone."""
    plastic = 0.02
    size = np.sqrt(1.0 - ratio + ratio**2)
    s = yield_stress(name, plastic) / size
    stress = np.array([s, ratio * s, 0.0, 0.0, 0.0, 0.0])
    mean = stress[:3].mean()
    flow = 1.5 * plastic / (s * size) * (stress - mean * np.array([1, 1, 1, 0, 0, 0]))
    elastic = (stress * (1.0 + NU) - 3.0 * NU * mean * np.array([1, 1, 1, 0, 0, 0])) / E
    told, history = along(LAWS[name], np.array([elastic + flow]))
    assert told == pytest.approx(stress, abs=1e-10 * s)
    assert history[6] == pytest.approx(plastic, rel=1e-10)
    assert history[:6] == pytest.approx(flow, abs=1e-12)


@pytest.mark.parametrize("name", ["perfect", "linear", "voce", "table", "prager"])
def test_shear(name: str) -> None:
    """Pure shear: tau = (yield stress + back stress) / sqrt 3; the doubled plastic shear is sqrt 3 times the equivalent."""
    plastic = 0.03
    kinematic = 5000.0 * plastic if name == "prager" else 0.0
    tau = (yield_stress(name, plastic) + kinematic) / np.sqrt(3.0)
    gamma = tau / G + np.sqrt(3.0) * plastic
    stress, history = along(LAWS[name], np.array([[0, 0, 0, gamma, 0, 0]]))
    assert stress == pytest.approx([0, 0, 0, tau, 0, 0], abs=1e-10 * tau)
    assert history[6] == pytest.approx(plastic, rel=1e-10)


def test_armstrong_frederick() -> None:
    """Uniaxial back stress C/g (1 - exp(-g x)); in n small steps to about 1/n (Armstrong and Frederick 1966)."""
    modulus, recall, x = 40e3, 200.0, 0.01
    law = Plastic(E, NU, Y, backstresses=[(modulus, recall)])
    s = Y + modulus / recall * (1.0 - np.exp(-recall * x))
    lateral = -NU * s / E - x / 2.0
    end = np.array([s / E + x, lateral, lateral, 0, 0, 0])
    start = Y / E * np.array([1, -NU, -NU, 0, 0, 0])
    errors = []
    for n in (100, 200):
        stress, _ = along(law, start + np.linspace(0, 1, n + 1)[1:, None] * (end - start))
        errors.append(abs(stress[0] - stress[1] - s) / s)
    assert errors[1] < 2e-3
    assert errors[1] < 0.55 * errors[0]


@pytest.mark.parametrize("finite", [False, True])
@pytest.mark.parametrize("name", LAWS)
def test_tangent(name: str, finite: bool) -> None:
    """Against central differences, in flow from rest and from a history, with equal stretches as well."""
    law, rng = LAWS[name], np.random.default_rng(0)
    told = law.evaluate_finite if finite else law.evaluate
    size = 0.2 if finite else 3e-3
    first = rng.uniform(-size, size, (30, 6))
    first[0] = [size, size, size / 2, 0, 0, 0]
    first[1] = [size, size, -size, 1e-9, 0, 0]
    history = told(first, law.initial(30))[2]
    for strain, before in ((first, law.initial(30)), (first + rng.uniform(-size / 2, size / 2, (30, 6)), history)):
        _, tangent, _ = told(strain, before)
        found = differences(lambda x, before=before: told(x, before)[0], strain)
        assert np.abs(tangent - found).max() < 1e-7 * np.abs(tangent).max()


@pytest.mark.parametrize("name", LAWS)
def test_unloading(name: str) -> None:
    """The same strain again changes nothing; a strain taken back is elastic."""
    law, rng = LAWS[name], np.random.default_rng(1)
    strain = rng.uniform(-3e-3, 3e-3, (20, 6))
    stress, _, history = law.evaluate(strain, law.initial(20))
    again, _, after = law.evaluate(strain, history)
    assert np.abs(again - stress).max() < 1e-12 * Y
    assert np.array_equal(after, history)
    back = 1e-4 * (strain - history[:, :6])
    less, tangent, after = law.evaluate(strain - back, history)
    assert np.array_equal(after, history)
    elastic = abut.LinearElastic(E, NU).evaluate(back, np.zeros((20, 0)))
    assert np.abs(stress - less - elastic[0]).max() < 1e-12 * E
    assert np.abs(tangent - elastic[1]).max() < 1e-12 * E


@pytest.mark.parametrize("name", LAWS)
def test_turns(name: str) -> None:
    """A body and its axes turned: stress and history turn with them (isotropy); small strains meet logarithmic ones."""
    law, rng = LAWS[name], np.random.default_rng(2)
    turn, _ = np.linalg.qr(rng.standard_normal((3, 3)))
    path = np.cumsum(rng.uniform(-0.05, 0.05, (5, 6)), axis=0)
    there = _voigt(turn @ _tensor(path, 0.5) @ turn.T, 2.0)
    stress, history = along(law, path, finite=True)
    turned, after = along(law, there, finite=True)
    assert np.abs(_tensor(turned[None], 1.0) - turn @ _tensor(stress[None], 1.0) @ turn.T).max() < 1e-9 * E
    assert after[6:8] == pytest.approx(history[6:8], rel=1e-9)
    tiny = 1e-7 * path / np.abs(path).max() * np.array([1, 1, 1, 1, 1, 1])
    soft = Plastic(E, NU, 1e-7 * Y, backstresses=law.backstresses)  # flows at such strains
    assert along(soft, tiny, True)[0] == pytest.approx(
        along(soft, tiny)[0], abs=1e-5 * np.abs(along(soft, tiny)[0]).max()
    )


def _tensor(strain: np.ndarray, shear: float) -> np.ndarray:
    xx, yy, zz, xy, yz, zx = (strain * [1, 1, 1, shear, shear, shear]).T
    return np.stack([np.stack(row, -1) for row in ((xx, xy, zx), (xy, yy, yz), (zx, yz, zz))], -2)


def _voigt(t: np.ndarray, shear: float) -> np.ndarray:
    parts = [t[..., 0, 0], t[..., 1, 1], t[..., 2, 2], *(shear * t[..., a, b] for a, b in ((0, 1), (1, 2), (2, 0)))]
    return np.stack(parts, -1)


def test_logarithmic_tension() -> None:
    """Uniaxial tension to a stretch of 1.5: Kirchhoff's stress is the yield stress at the logarithmic plastic strain."""
    law, plastic = LAWS["linear"], 0.4
    tau = Y + 2000.0 * plastic
    log = np.array([tau / E + plastic, -NU * tau / E - plastic / 2.0, -NU * tau / E - plastic / 2.0])
    green = np.zeros(6)
    green[:3] = np.expm1(2.0 * log) / 2.0
    stress, history = along(law, green[None], finite=True)
    assert stress[:3] * np.exp(2.0 * log) == pytest.approx([tau, 0.0, 0.0], abs=1e-10 * tau)
    assert history[6] == pytest.approx(plastic, rel=1e-10)


def test_users_copy() -> None:
    """The same law in Python gives the same stresses, tangents and histories over a path with reversals."""
    own, ours = J2(K, G, Y, 2000.0, 3000.0), Plastic(E, NU, Y, 2000.0, backstresses=[(3000.0, 0.0)])
    rng, n = np.random.default_rng(3), 50
    history, before = own.initial(n), ours.initial(n)
    for _ in range(6):
        strain = rng.uniform(-4e-3, 4e-3, (n, 6))
        stress, tangent, history = own.evaluate(strain, history)
        told, slope, before = ours.evaluate(strain, before)
        assert np.abs(told - stress).max() < 1e-12 * np.abs(stress).max()
        assert np.abs(slope - tangent).max() < 1e-12 * E
        now = np.hstack([before[:, :7], 2.0 / 3.0 * 3000.0 * before[:, 8:]])
        assert np.abs(now - history).max() < 1e-12 * np.abs(history).max()


@pytest.mark.parametrize("name", LAWS)
def test_plane_stress(name: str) -> None:
    """The compiled core and Python find the same strain out of the plane: forces on two cells, one step after another."""
    from abut.bodies.assemble import respond
    from abut.bodies.solids import Solids
    from abut.materials.material import OwnMaterial
    from abut.mesh.make import rectangle

    law = LAWS[name]

    class Uncompiled(OwnMaterial):
        modulus = E

        def initial(self, n: int) -> np.ndarray:
            return law.initial(n)

        def evaluate(self, strain: np.ndarray, history: np.ndarray) -> tuple:
            return law.evaluate(strain, history)

        def evaluate_finite(self, strain: np.ndarray, history: np.ndarray) -> tuple:
            return law.evaluate_finite(strain, history)

    mesh, rng = rectangle(cells=(2, 1), cell="quad4"), np.random.default_rng(4)
    for kinematics, size in (("small", 2e-3), ("finite", 0.1)):
        ours, theirs = (Solids(mesh, {"body": m}, "stress", {}, kinematics) for m in (law, Uncompiled()))
        one = other = None
        for _ in range(3):
            moved = rng.uniform(-size, size, mesh.points.shape)
            told, found = respond(ours, moved, history=one), respond(theirs, moved, history=other)
            one, other = told.history, found.history
            assert np.abs(told.force - found.force).max() < 1e-9 * np.abs(found.force).max()
            assert np.abs((told.tangent - found.tangent).toarray()).max() < 1e-8 * np.abs(found.tangent.toarray()).max()


@pytest.mark.parametrize(
    ("given", "words"),
    [
        ({"yield_stress": 0.0}, "yield_stress: expected a number > 0"),
        ({"yield_stress": [(0.1, 1.0)]}, "the first row must have the equivalent plastic strain 0"),
        ({"yield_stress": [(0.0, 1.0), (0.0, 2.0)]}, "must grow"),
        ({"yield_stress": [(0.0, 2.0), (0.1, 1.0)]}, "softens"),
        ({"yield_stress": [(0.0, 2.0), 3.0]}, "expected two numbers"),
        ({"yield_stress": 1.0, "hardening": -1.0}, "hardening: expected a number >= 0"),
        ({"yield_stress": 1.0, "saturation": 1.0}, "needs both of them"),
        ({"yield_stress": 1.0, "backstresses": [(1.0,)]}, "backstresses"),
        ({"yield_stress": 1.0, "poisson": 0.51}, "poisson"),
    ],
)
def test_refused(given: dict, words: str) -> None:
    with pytest.raises(abut.InputError, match=words):
        Plastic(**{"young": 1.0, "poisson": 0.3, **given})


def test_plane_stress_of_points() -> None:
    """Uniaxial tension in plane stress from strains in the plane alone."""
    law = LAWS["linear"]
    s = Y + 2000.0 * 0.01
    strain = np.array([[s / E + 0.01, -NU * s / E - 0.005, 0, 0, 0, 0]])
    _, (stress, _, _) = in_plane_stress(law.evaluate, strain, law.initial(1))
    assert stress[0] == pytest.approx([s, 0, 0, 0, 0, 0], abs=1e-9 * s)

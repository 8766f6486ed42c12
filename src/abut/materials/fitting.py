"""Constants of rubber from tests, by least squares: theory (D22), (D23)."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from itertools import combinations

import numpy as np
from scipy.optimize import least_squares

from abut.errors import InputError
from abut.materials.evaluated import Array
from abut.materials.hyperelastic import NeoHooke
from abut.materials.material import Material
from abut.materials.rubber import ArrudaBoyce, Energy, MooneyRivlin, Ogden, Yeoh
from abut.materials.rubber_tests import RubberTest, nominal_stress

POISSON = 0.4995  # at rest, where nothing is said
STARTS = (-5.0, -2.0, -0.5, 1.0, 2.0, 4.0, 8.0)  # of Ogden's powers
LARGEST = 30.0  # of them
LOCKING = (1.5, 2.5, 4.0, 7.0)  # starts of the stretch at which chains lock
CLOSE = 1e-14  # change at which the search ends


@dataclass(frozen=True)
class Form:
    """A law as a sum of energies times factors. energies: at parameters that do not come in as factors; material: of
    parameters, factors and bulk modulus; starts: of the parameters; bounds: smallest and largest of each."""

    energies: Callable[[Array], list[Energy]]
    material: Callable[[Array, Array, float], Material]
    starts: Sequence[tuple[float, ...]] = ((),)
    bounds: tuple[float, float] = (-np.inf, np.inf)


@dataclass(frozen=True)
class Fit:
    """material, its energy without that of volume changes; errors: of each test, root of the mean square over its largest
    stress."""

    material: Material
    energy: Energy
    errors: tuple[float, ...]


def fit(
    law: str, tests: Sequence[RubberTest], terms: int = 3, bulk: float | None = None, poisson: float = POISSON
) -> Fit:
    """law: a key of ``LAWS``; terms: of Ogden's; bulk modulus, left out: that of Poisson's ratio at rest. Every test counts
    alike, its stresses over the largest of them. Raises InputError for too few points, and where no sound material fits."""
    form = _ogden(terms) if law == "ogden" else LAWS[law]
    needed = len(form.starts[0]) + len(form.energies(np.array(form.starts[0])))
    points = sum(len(test.stretch) for test in tests)
    if points < needed:
        raise InputError(f"{law}: {needed} constants need as many points at least, the tests have {points}")
    weights = [1.0 / (max(float(np.abs(t.stress).max()), 1e-300) * len(t.stress) ** 0.5) for t in tests]
    target = np.concatenate([w * t.stress for w, t in zip(weights, tests)])

    def factors(parameters: Array) -> tuple[Array, Array]:
        """Of the energies, and what they leave."""
        energies = form.energies(parameters)
        columns = [
            np.concatenate([w * nominal_stress(e, t.kind, t.stretch) for w, t in zip(weights, tests)]) for e in energies
        ]
        matrix = np.stack(columns, axis=1)
        size = np.maximum(np.linalg.norm(matrix, axis=0), 1e-300)
        found = np.linalg.lstsq(matrix / size, target, rcond=1e-13)[0]
        return found / size, matrix @ (found / size) - target

    best = min(
        (_searched(form, start, factors) for start in form.starts), key=lambda p: float((factors(p)[1] ** 2).sum())
    )
    found, left = factors(best)
    energy = _summed(form.energies(best), found)
    if not energy.shear > 0.0:
        raise InputError(
            f"{law}: what fits best has the shear modulus {energy.shear:.3g} at rest, which no material has; take a law "
            "with fewer constants, or more tests"
        )
    own = bulk if bulk is not None else energy.shear * 2.0 * (1.0 + poisson) / (3.0 * (1.0 - 2.0 * poisson))
    ends = np.cumsum([len(test.stretch) for test in tests])
    errors = tuple(float(np.linalg.norm(part)) for part in np.split(left, ends[:-1]))
    return Fit(form.material(best, found, own), energy, errors)


def _searched(form: Form, start: tuple[float, ...], factors: Callable[[Array], tuple[Array, Array]]) -> Array:
    """Parameters near those to start from."""
    if not start:
        return np.zeros(0)
    found = least_squares(
        lambda parameters: factors(parameters)[1],
        start,
        bounds=form.bounds,
        xtol=CLOSE,
        ftol=CLOSE,
        gtol=CLOSE,
        x_scale="jac",
    )
    return np.asarray(found.x)


def _summed(energies: Sequence[Energy], factors: Array) -> Energy:
    terms = tuple((c * mu, alpha) for c, e in zip(factors.tolist(), energies) for mu, alpha in e.terms)
    powers = np.zeros(max(len(e.powers) for e in energies))
    for c, e in zip(factors.tolist(), energies):
        powers[: len(e.powers)] += c * np.array(e.powers)
    return Energy(terms, tuple(powers.tolist()), (1.0,))


def _power(i: int, factor: float = 1.0) -> Energy:
    return Energy((), (0.0,) * i + (factor,), (1.0,))


def _term(mu: float, alpha: float) -> Energy:
    return Energy(((mu, alpha),), (), (1.0,))


def _ogden(terms: int) -> Form:
    if terms not in (1, 2, 3):
        raise InputError(f"terms: expected 1, 2 or 3, got {terms!r}")
    return Form(
        lambda p: [_term(1.0, float(alpha)) for alpha in p],
        lambda p, c, bulk: Ogden(bulk=bulk, terms=list(zip(c.tolist(), p.tolist()))),
        tuple(combinations(STARTS, terms)), (-LARGEST, LARGEST),
    )  # fmt: skip


def _chain(locking: float) -> Energy:
    return ArrudaBoyce(bulk=1.0, shear=1.0, locking=locking).energy


LAWS: dict[str, Form] = {
    "neo-hooke": Form(
        lambda _: [_power(0, 0.5)],
        lambda _, c, bulk: NeoHooke(shear=float(c[0]), bulk=bulk, volumetric="isochoric"),
    ),
    "mooney-rivlin": Form(
        lambda _: [_term(2.0, 2.0), _term(-2.0, -2.0)],
        lambda _, c, bulk: MooneyRivlin(bulk=bulk, c10=float(c[0]), c01=float(c[1])),
    ),
    "yeoh": Form(
        lambda _: [_power(i) for i in range(3)],
        lambda _, c, bulk: Yeoh(bulk=bulk, c10=float(c[0]), c20=float(c[1]), c30=float(c[2])),
    ),
    "ogden": _ogden(3),
    "arruda-boyce": Form(
        lambda p: [_chain(float(p[0]))],
        lambda p, c, bulk: ArrudaBoyce(bulk=bulk, shear=float(c[0]), locking=float(p[0])),
        tuple((start,) for start in LOCKING), (1.0, 100.0),
    ),
}  # fmt: skip

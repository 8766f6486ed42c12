"""Bodies that relax: a material without a history, whose stresses fade in part, theory (W1)."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np

from abut import checks
from abut.errors import InputError
from abut.materials.directions import PAIRS
from abut.materials.elastic import LinearElastic, bulk_and_shear
from abut.materials.evaluated import Array, Evaluated
from abut.materials.hyperelastic import NeoHooke
from abut.materials.logarithmic import Hencky
from abut.materials.material import Material, OwnMaterial, check_model, is_small, linear, symmetric
from abut.materials.places import Places
from abut.materials.rubber import ArrudaBoyce, MooneyRivlin, Ogden, Yeoh

KNOWN = (LinearElastic, Hencky, MooneyRivlin, Yeoh, Ogden, ArrudaBoyce)
FIRST, SECOND = np.array(PAIRS).T
PLACE = np.array([[0, 3, 5], [3, 1, 4], [5, 4, 2]])  # components of a tensor's rows among xx yy zz xy yz zx
TWICE = np.array([1.0, 1.0, 1.0, 2.0, 2.0, 2.0])  # stress with strain, without doubled shear
ONE = np.array([1.0, 1.0, 1.0, 0.0, 0.0, 0.0])


@dataclass(frozen=True)
class Viscoelastic(OwnMaterial):
    """A material that relaxes: linear viscoelasticity by a Prony series, of rubber that of finite strains.

    The stress that a sudden strain makes is that of the material; of its part that changes the shape the share
    g (1 - exp(-t / tau)) is gone after a time t, of the mean stress k (1 - exp(-t / tau)). Times are those of the run
    (``SolveOptions.end``); over a load step strains (under finite ones stresses at once) are taken to grow evenly.

    Parameters
    ----------
    material : LinearElastic, Hencky, MooneyRivlin, Yeoh, Ogden or ArrudaBoyce
        What it is at once; neo-Hooke's law is that of Mooney and Rivlin with c01 = 0.
    terms : sequence of (float, float, float)
        g, k and tau of each term: shares of shear and bulk, from 0 on, whose sums are less than 1 [1; 1; time].

    Raises
    ------
    InputError
        For other materials, and values out of these ranges.

    References
    ----------
    J. C. Simo and T. J. R. Hughes, Computational Inelasticity (1998), 10.3; G. A. Holzapfel, Nonlinear Solid Mechanics
    (2000), 6.10.

    Examples
    --------
    >>> import abut
    >>> pad = abut.Viscoelastic(abut.LinearElastic(10.0, 0.4), terms=[(0.5, 0.0, 2.0)])
    >>> round(pad.linear.young, 3)  # after a long time
    5.172
    """

    material: LinearElastic | Hencky | MooneyRivlin | Yeoh | Ogden | ArrudaBoyce
    terms: Sequence[Sequence[float]]

    def __post_init__(self) -> None:
        if not isinstance(self.material, KNOWN):
            raise InputError(
                f"material: expected {', '.join(kind.__name__ for kind in KNOWN)}, got {type(self.material).__name__}"
                + ("; neo-Hooke's law is MooneyRivlin with c01 = 0" if isinstance(self.material, NeoHooke) else "")
            )
        terms = checks.listed(self.terms, "terms", "triples of numbers")
        if not terms:
            raise InputError("terms: expected at least one triple [g, k, tau]; without any it is the material alone")
        object.__setattr__(self, "terms", tuple(_term(term, f"terms[{i}]") for i, term in enumerate(terms)))
        for column, name in enumerate(("g", "k")):
            total = sum(term[column] for term in self.terms)
            if not total < 1.0:
                raise InputError(f"terms: the shares {name} add up to {total:g}; what never fades has to be left: < 1")

    @property
    def density(self) -> float:  # type: ignore[override]
        """That of the material, as the rest."""
        return self.material.density

    @property
    def expansion(self) -> float:  # type: ignore[override]
        """As in ``Material``."""
        return self.material.expansion

    @property
    def small(self) -> bool:  # type: ignore[override]
        """As in ``OwnMaterial``."""
        return is_small(self.material)

    @property
    def symmetric(self) -> bool:  # type: ignore[override]
        """As in ``OwnMaterial``: Saint Venant and Kirchhoff's law is not where shear and bulk relax unalike."""
        return symmetric(self.material) or all(g == k for g, k, _ in self.terms)

    @cached_property
    def linear(self) -> LinearElastic | None:  # type: ignore[override]
        """What it is after a long time, at small strains."""
        rest = linear(self.material)
        if rest is None or rest.poisson == 0.5:
            return rest
        bulk, shear = bulk_and_shear(rest.young, rest.poisson)
        left = 1.0 - np.sum(self.terms, axis=0)
        bulk, shear = bulk * left[1], shear * left[0]
        young = 9.0 * bulk * shear / (3.0 * bulk + shear)
        return replace(rest, young=float(young), poisson=float(0.5 * young / shear - 1.0))

    @property
    def modulus(self) -> float:
        """After a long time."""
        rest = self.linear
        return self.material.modulus if rest is None else rest.young

    def initial(self, n: int) -> Array:
        """The material's own stresses, of shape and of volume, and those that fade, of each term: (n, 12 + 6 terms)."""
        return np.zeros((n, 12 + 6 * len(self.terms)))

    def at(self, places: Places) -> Material:
        """As in ``LocalMaterial``."""
        return _Relaxing(self, self.expansion * places.change, places.elapsed)

    def evaluate(self, strain: Array, history: Array) -> Evaluated:
        """As in ``Material``, at once."""
        return _Relaxing(self, np.zeros(1), 0.0).evaluate(strain, history)

    def evaluate_finite(self, strain: Array, history: Array) -> Evaluated:
        """As in ``FiniteMaterial``, at once."""
        return _Relaxing(self, np.zeros(1), 0.0).evaluate_finite(strain, history)

    def check(self, dim: int, plane: str | None, where: str) -> None:
        """As in ``OwnMaterial``."""
        check_model(self.material, dim, plane, where)


@dataclass(frozen=True)
class _Relaxing(OwnMaterial):
    """At points, over a time. swelling: (n or 1,) thermal strains."""

    law: Viscoelastic
    swelling: Array
    elapsed: float

    @property
    def modulus(self) -> float:
        return self.law.modulus

    def initial(self, n: int) -> Array:
        return self.law.initial(n)

    def evaluate(self, strain: Array, history: Array) -> Evaluated:
        elastic = np.array(strain, dtype=float)
        elastic[:, :3] -= self.swelling[:, None]
        stress, tangent, _ = self.law.material.evaluate(elastic, np.zeros((len(strain), 0)))
        mean = np.outer(ONE, ONE) / 3.0
        return self._faded(stress, tangent, stress @ mean, mean @ tangent, history)

    def evaluate_finite(self, strain: Array, history: Array) -> Evaluated:
        """Heat stretches first, alike in all directions, theory (A3)."""
        stretch = 1.0 + self.swelling
        elastic = np.array(strain, dtype=float)
        elastic[:, :3] -= 0.5 * (stretch**2 - 1.0)[:, None]
        elastic /= (stretch**2)[:, None]
        base = self.law.material  # LinearElastic is that of Saint Venant and Kirchhoff
        told = base.evaluate if isinstance(base, LinearElastic) else base.evaluate_finite
        stress, tangent, _ = told(elastic, np.zeros((len(strain), 0)))
        stress, tangent, after = self._faded(stress, tangent, *_of_volume(elastic, stress, tangent), history)
        return stretch[:, None] * stress, tangent / stretch[:, None, None], after

    def _faded(self, stress: Array, tangent: Array, volume: Array, by_volume: Array, history: Array) -> Evaluated:
        """Of the material's own stress and tangent, and those of the change of volume in them: theory (W2), (W3)."""
        parts, slopes = (stress - volume, volume), (tangent - by_volume, by_volume)
        grown = [part - history[:, 6 * i : 6 * i + 6] for i, part in enumerate(parts)]
        left = 1.0 - np.sum(self.law.terms, axis=0)
        total = left[0] * parts[0] + left[1] * parts[1]
        slope = left[0] * slopes[0] + left[1] * slopes[1]
        after = np.empty_like(history)
        after[:, :6], after[:, 6:12] = parts
        for i, (g, k, tau) in enumerate(self.law.terms):
            columns = slice(12 + 6 * i, 18 + 6 * i)
            x = self.elapsed / tau
            kept, even = np.exp(-x), 1.0 if x == 0.0 else -np.expm1(-x) / x
            after[:, columns] = kept * history[:, columns] + even * (g * grown[0] + k * grown[1])
            total = total + after[:, columns]
            slope = slope + even * (g * slopes[0] + k * slopes[1])
        return total, slope, after


def _of_volume(strain: Array, stress: Array, tangent: Array) -> tuple[Array, Array]:
    """Of second stresses of Piola and Kirchhoff at strains of Green and Lagrange: the part along the inverse of C, which
    the mean stress of Cauchy makes, and its tangent: theory (W1), (W4)."""
    right = 2.0 * strain / TWICE + ONE
    inverse = np.linalg.inv(right[:, PLACE])
    along = inverse[:, FIRST, SECOND]
    size = (stress * right * TWICE).sum(axis=1) / 3.0
    slope = ((right * TWICE)[:, None] @ tangent)[:, 0] / 3.0 + 2.0 / 3.0 * stress
    i, j = FIRST[:, None], SECOND[:, None]
    square = 0.5 * (inverse[:, i, FIRST] * inverse[:, j, SECOND] + inverse[:, i, SECOND] * inverse[:, j, FIRST])
    return size[:, None] * along, along[:, :, None] * slope[:, None] - 2.0 * size[:, None, None] * square


def _term(given: object, where: str) -> tuple[float, float, float]:
    values = checks.listed(given, where, "numbers")
    if len(values) != 3:
        raise InputError(f"{where}: expected g, k and tau, got {len(values)} values")
    g, k, tau = (checks.finite(value, f"{where}[{i}]") for i, value in enumerate(values))
    for name, share in (("g", g), ("k", k)):
        if share < 0.0:
            raise InputError(f"{where}: expected a share {name} >= 0, got {share!r}")
    return g, k, checks.positive(tau, f"{where}[2]")

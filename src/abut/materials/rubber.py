"""Rubber by several constants, theory (D18): Mooney-Rivlin, Yeoh, Ogden, Arruda-Boyce; for finite strains."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from math import comb

import numpy as np

from abut import checks
from abut._core import PointLaw, stretches
from abut.errors import InputError
from abut.materials.elastic import LinearElastic
from abut.materials.kernel import Compiled, PointKernel
from abut.materials.logarithmic import evaluated
from abut.materials.material import Array, Evaluated
from abut.materials.volume_split import Powers, VolumeSplit

CHAIN = (1.0 / 2.0, 1.0 / 20.0, 11.0 / 1050.0, 19.0 / 7000.0, 519.0 / 673750.0)  # of Arruda and Boyce (1993)


@dataclass(frozen=True)
class Energy:
    """Constants of (D18): terms (mu, alpha); powers, volume: factors from the first power on."""

    terms: tuple[tuple[float, float], ...]
    powers: tuple[float, ...]
    volume: tuple[float, ...]

    @property
    def shear(self) -> float:
        """Shear modulus at rest, force per area."""
        return sum(mu * alpha for mu, alpha in self.terms) / 2.0 + (2.0 * self.powers[0] if self.powers else 0.0)

    @property
    def linear(self) -> tuple[float, float]:
        """Young's modulus and Poisson's ratio at rest."""
        bulk, shear = 2.0 * self.volume[0], self.shear
        return 9.0 * bulk * shear / (3.0 * bulk + shear), (3.0 * bulk - 2.0 * shear) / (6.0 * bulk + 2.0 * shear)

    def law(self) -> PointLaw:
        """For the compiled core."""
        return stretches([x for term in self.terms for x in term], list(self.powers), list(self.volume))


@dataclass(frozen=True)
class Rubber:
    """What the laws for rubber share: ``bulk`` modulus K of the energy K/2 (J - 1)^2, or a list of factors of (J - 1)^2,
    (J - 1)^4, ... (CalculiX' 1/D1, 1/D2, ...), density per undeformed volume, and expansion."""

    bulk: float | Sequence[float]
    density: float = 0.0
    expansion: float = 0.0

    def __post_init__(self) -> None:
        if isinstance(self.bulk, Sequence):
            object.__setattr__(self, "bulk", tuple(checks.finite(k, "bulk") for k in self.bulk))
            if not self._volume or not self._volume[0] > 0.0:
                raise InputError(f"bulk: expected factors of which the first is > 0, got {self.bulk!r}")
        else:
            checks.positive(self.bulk, "bulk")
        if not self.energy.shear > 0.0:
            raise InputError(f"constants: the shear modulus at rest must be > 0, they give {self.energy.shear:g}")
        LinearElastic(*self.energy.linear, self.density, self.expansion)

    @property
    def _volume(self) -> tuple[float, ...]:
        return tuple(self.bulk) if isinstance(self.bulk, Sequence) else (0.5 * self.bulk,)

    @property
    def energy(self) -> Energy:
        """Its constants in the form of (D18)."""
        raise NotImplementedError

    @property
    def linear(self) -> LinearElastic:
        """The material that it is under small strains."""
        return LinearElastic(*self.energy.linear, self.density, self.expansion)

    @property
    def constant(self) -> bool:
        """False, as in ``Material``."""
        return False

    @property
    def symmetric(self) -> bool:
        """True, as in ``OwnMaterial``: stresses come of an energy."""
        return True

    @property
    def small(self) -> bool:
        """False, as in ``OwnMaterial``."""
        return False

    @property
    def modulus(self) -> float:
        """Young's modulus at rest."""
        return self.energy.linear[0]

    def initial(self, n: int) -> Array:
        """It has no history: (n, 0)."""
        return np.zeros((n, 0))

    def evaluate(self, strain: Array, history: Array) -> Evaluated:
        """Stresses, tangents and histories at n points, as in ``Material``, for small strains."""
        return self.linear.evaluate(strain, history)

    def evaluate_finite(self, strain: Array, history: Array) -> Evaluated:
        """Stresses, tangents and histories at n points under finite strains, as in ``FiniteMaterial``."""
        return evaluated(self.energy.law(), strain, history, finite=True)

    def compiled(self, finite: bool) -> Compiled | None:
        """The compiled law, as in ``OwnMaterial``."""
        return Compiled(PointKernel(self.energy.law(), True)) if finite else self.linear.compiled(False)

    def volume_split(self, finite: bool) -> VolumeSplit | None:
        """What the change of volume alone adds to energy and stress, as in ``OwnMaterial``."""
        if not finite:
            return self.linear.volume_split(False)
        kept, (first, *others) = self.energy.shear / 3.0, self._volume
        return VolumeSplit(replace(self, bulk=2.0 * kept), Powers([first - kept, *others])) if first > kept else None


@dataclass(frozen=True, kw_only=True)
class MooneyRivlin(Rubber):
    """Mooney and Rivlin: C10 (I1 - 3) + C01 (I2 - 3) of the volume-preserving invariants.

    Parameters
    ----------
    bulk : float or sequence of float
        Modulus K of the energy K/2 (J - 1)^2 [force per area], > 0; or factors of (J - 1)^2, (J - 1)^4, ... as
        CalculiX' 1/D1, 1/D2, ...
    density : float
        Mass per undeformed volume, used by gravity.
    expansion : float
        Thermal expansion [1/temperature], used by temperature changes.
    c10, c01 : float
        The constants [force per area].

    Raises
    ------
    InputError
        For constants that are out of range or no numbers.

    Examples
    --------
    >>> import abut
    >>> abut.MooneyRivlin(c10=0.4, c01=0.1, bulk=1000.0).energy.shear
    1.0
    """

    c10: float
    c01: float

    @property
    def energy(self) -> Energy:
        """Energy by the invariants, with derivatives, as in ``Rubber``."""
        c10, c01 = checks.finite(self.c10, "c10"), checks.finite(self.c01, "c01")
        return Energy(((2.0 * c10, 2.0), (-2.0 * c01, -2.0)), (), self._volume)


@dataclass(frozen=True, kw_only=True)
class Yeoh(Rubber):
    """Yeoh: C10 (I1 - 3) + C20 (I1 - 3)^2 + C30 (I1 - 3)^3 of the volume-preserving invariant.

    Parameters
    ----------
    bulk : float or sequence of float
        Modulus K of the energy K/2 (J - 1)^2 [force per area], > 0; or factors of (J - 1)^2, (J - 1)^4, ... as
        CalculiX' 1/D1, 1/D2, ...
    density : float
        Mass per undeformed volume, used by gravity.
    expansion : float
        Thermal expansion [1/temperature], used by temperature changes.
    c10, c20, c30 : float
        The constants [force per area].

    Raises
    ------
    InputError
        For constants that are out of range or no numbers.
    """

    c10: float
    c20: float = 0.0
    c30: float = 0.0

    @property
    def energy(self) -> Energy:
        """Energy by the invariants, with derivatives, as in ``Rubber``."""
        return Energy((), tuple(checks.finite(getattr(self, k), k) for k in ("c10", "c20", "c30")), self._volume)


@dataclass(frozen=True, kw_only=True)
class Ogden(Rubber):
    """Ogden: sum of mu / alpha (l1^alpha + l2^alpha + l3^alpha - 3), with volume-preserving stretches l.

    This is Ogden's own form. Abaqus and CalculiX have 2 mu / alpha^2: their mu is half of mu alpha here.

    Parameters
    ----------
    bulk : float or sequence of float
        Modulus K of the energy K/2 (J - 1)^2 [force per area], > 0; or factors of (J - 1)^2, (J - 1)^4, ... as
        CalculiX' 1/D1, 1/D2, ...
    density : float
        Mass per undeformed volume, used by gravity.
    expansion : float
        Thermal expansion [1/temperature], used by temperature changes.
    terms : sequence of (float, float)
        Pairs of mu [force per area] and alpha, which is not 0.

    Raises
    ------
    InputError
        For constants that are out of range or no numbers.
    """

    terms: Sequence[Sequence[float]]

    def __post_init__(self) -> None:
        rows = []
        for i, row in enumerate(checks.listed(self.terms, "terms", "pairs")):
            if not isinstance(row, Sequence) or len(row) != 2 or checks.finite(row[1], f"terms[{i}][1]") == 0.0:
                raise InputError(f"terms[{i}]: expected mu and alpha, which is not 0, got {row!r}")
            rows.append((checks.finite(row[0], f"terms[{i}][0]"), float(row[1])))
        object.__setattr__(self, "terms", tuple(rows))
        super().__post_init__()

    @property
    def energy(self) -> Energy:
        """Energy by the invariants, with derivatives, as in ``Rubber``."""
        return Energy(tuple((mu, alpha) for mu, alpha in self.terms), (), self._volume)


@dataclass(frozen=True, kw_only=True)
class ArrudaBoyce(Rubber):
    """Arruda and Boyce: chains of eight, five terms of their series.

    Parameters
    ----------
    bulk : float or sequence of float
        Modulus K of the energy K/2 (J - 1)^2 [force per area], > 0; or factors of (J - 1)^2, (J - 1)^4, ... as
        CalculiX' 1/D1, 1/D2, ...
    density : float
        Mass per undeformed volume, used by gravity.
    expansion : float
        Thermal expansion [1/temperature], used by temperature changes.
    shear : float
        mu of the series [force per area], > 0.
    locking : float
        Stretch at which the chains lock, > 0.

    Raises
    ------
    InputError
        For constants that are out of range or no numbers.
    """

    shear: float
    locking: float

    @property
    def energy(self) -> Energy:
        """Energy by the invariants, with derivatives, as in ``Rubber``: powers of I less those of 3, written as powers
        of I - 3."""
        shear, locking = checks.positive(self.shear, "shear"), checks.positive(self.locking, "locking")
        factors = [shear * c / locking ** (2 * i) for i, c in enumerate(CHAIN)]
        powers = [
            sum(factors[n - 1] * comb(n, k) * 3.0 ** (n - k) for n in range(k, len(CHAIN) + 1))
            for k in range(1, len(CHAIN) + 1)
        ]
        return Energy((), tuple(powers), self._volume)

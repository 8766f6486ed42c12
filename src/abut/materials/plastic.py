"""Metal that yields: von Mises plasticity, theory (Y1) to (Y10)."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from itertools import pairwise
from types import MappingProxyType

import numpy as np

from abut import checks
from abut._core import PointLaw, j2
from abut.errors import InputError
from abut.materials.elastic import LinearElastic, bulk_and_shear, without_bulk
from abut.materials.kernel import Compiled, PointKernel
from abut.materials.logarithmic import evaluated
from abut.materials.material import Array, Evaluated
from abut.materials.volume_split import LogSquared, Powers, VolumeSplit

EQUIVALENT, WORK = "equivalent_plastic_strain", "plastic_work"
FIELDS = MappingProxyType({"plastic_strain": slice(0, 6), EQUIVALENT: slice(6, 7), WORK: slice(7, 8)})


@dataclass(frozen=True)
class Plastic:
    """Von Mises (J2) plasticity with associated flow, rate-independent.

    Under small strains, and under finite ones in the space of logarithmic strains.

    Parameters
    ----------
    young : float
        Young's modulus [force per area], > 0.
    poisson : float
        Poisson's ratio, between -1 and 0.5.
    yield_stress : float or sequence of (float, float)
        In uniaxial tension [force per area], > 0; or a table of (equivalent plastic strain, yield stress), from 0 on and
        growing, between which it is linear and beyond which it stays; true stresses and logarithmic strains.
    hardening : float
        Isotropic, yield stress over equivalent plastic strain [force per area], >= 0, added to the table.
    saturation, rate : float
        Voce's isotropic hardening: adds saturation (1 - exp(-rate x)) at an equivalent plastic strain x [force per area;
        1].
    backstresses : sequence of (float, float)
        Kinematic hardening, (modulus, recall) of each back stress of Armstrong and Frederick: modulus is stress over
        plastic strain in tension from rest [force per area], recall the rate at which it saturates, 0 for linear
        (Prager's).
    density : float
        Mass per volume, used by gravity.
    expansion : float
        Thermal expansion [1/temperature], used by temperature changes.

    Raises
    ------
    InputError
        For values out of these ranges.

    Examples
    --------
    >>> import abut
    >>> steel = abut.Plastic(210e3, 0.3, yield_stress=300.0, hardening=1000.0)
    >>> bool(steel.evaluate([[0.01, 0, 0, 0, 0, 0]], steel.initial(1))[2][0, 6] > 0)  # it flows
    True
    """

    young: float
    poisson: float
    yield_stress: float | Sequence[Sequence[float]]
    hardening: float = 0.0
    saturation: float = 0.0
    rate: float = 0.0
    backstresses: Sequence[Sequence[float]] = ()
    density: float = 0.0
    expansion: float = 0.0

    def __post_init__(self) -> None:
        LinearElastic(self.young, self.poisson, self.density, self.expansion)
        if isinstance(self.yield_stress, Sequence):
            object.__setattr__(self, "yield_stress", _pairs(self.yield_stress, "yield_stress"))
        else:
            checks.positive(self.yield_stress, "yield_stress")
        _check_table(self.table)
        object.__setattr__(self, "backstresses", _pairs(self.backstresses, "backstresses"))
        given = {"hardening": self.hardening, "saturation": self.saturation, "rate": self.rate}
        given |= {f"backstresses[{i}]": value for i, pair in enumerate(self.backstresses) for value in pair}
        for name, value in given.items():
            if checks.finite(value, name) < 0.0:
                raise InputError(
                    f"{name}: expected a number >= 0 (a law that softens has no unique results), got {value!r}"
                )
        if (self.saturation > 0.0) != (self.rate > 0.0):
            raise InputError("saturation, rate: Voce's hardening needs both of them; give both or none")

    @property
    def table(self) -> tuple[tuple[float, float], ...]:
        """Equivalent plastic strains and yield stresses."""
        if isinstance(self.yield_stress, Sequence):
            return tuple((float(strain), float(stress)) for strain, stress in self.yield_stress)
        return ((0.0, float(self.yield_stress)),)

    @cached_property
    def linear(self) -> LinearElastic:
        """The material that it is until it yields."""
        return LinearElastic(self.young, self.poisson, self.density, self.expansion)

    @property
    def constant(self) -> bool:
        """False, as in ``Material``."""
        return False

    @property
    def modulus(self) -> float:
        """Young's modulus."""
        return self.young

    @property
    def volume_preserving(self) -> bool:
        """True, as in ``OwnMaterial``: flow keeps the volume."""
        return True

    @property
    def symmetric(self) -> bool:
        """Whether tangents are symmetric, as in ``OwnMaterial``: but for back stresses that fade."""
        return all(recall == 0.0 for _, recall in self.backstresses)

    @property
    def fields(self) -> MappingProxyType[str, slice]:
        """Columns of the history that are written, as in ``OwnMaterial``: plastic strain (n, 6), equivalent plastic
        strain and plastic work per volume (n, 1)."""
        return FIELDS

    def initial(self, n: int) -> Array:
        """Plastic strain, equivalent plastic strain, plastic work per volume, and of each back stress the strain of which it
        is 2/3 of the modulus: (n, 8 + 6 of each)."""
        return np.zeros((n, 8 + 6 * len(self.backstresses)))

    def evaluate(self, strain: Array, history: Array) -> Evaluated:
        """Stresses, tangents and histories at n points, as in ``Material``."""
        return evaluated(self._law(), np.asarray(strain, dtype=float), history, finite=False)

    def evaluate_finite(self, strain: Array, history: Array) -> Evaluated:
        """Stresses, tangents and histories at n points under finite strains, as in ``FiniteMaterial``."""
        return evaluated(self._law(), np.asarray(strain, dtype=float), history, finite=True)

    def compiled(self, finite: bool) -> Compiled | None:
        """The compiled law, as in ``OwnMaterial``."""
        return Compiled(PointKernel(self._law(), finite))

    def volume_split(self, finite: bool) -> VolumeSplit | None:
        """What the change of volume alone adds to energy and stress, as in ``OwnMaterial``: flow does not see the mean
        stress."""
        if not self.poisson > 0.0:
            return None
        bulk, rest = without_bulk(self.linear)
        law = LogSquared(bulk) if finite else Powers([0.5 * bulk])
        return VolumeSplit(replace(self, young=rest.young, poisson=rest.poisson), law)

    def _law(self) -> PointLaw:
        table = [value for row in self.table for value in row]
        back = [float(value) for pair in self.backstresses for value in pair]
        moduli = bulk_and_shear(self.young, self.poisson)
        return j2(*moduli, table, float(self.hardening), float(self.saturation), float(self.rate), back)


def _pairs(rows: object, name: str) -> tuple[tuple[float, float], ...]:
    """Of numbers, hashable."""
    result = []
    for i, row in enumerate(rows if isinstance(rows, (list, tuple)) else [rows]):
        if not isinstance(row, (list, tuple)) or len(row) != 2:
            raise InputError(f"{name}[{i}]: expected two numbers, got {row!r}")
        result.append((checks.finite(row[0], f"{name}[{i}][0]"), checks.finite(row[1], f"{name}[{i}][1]")))
    return tuple(result)


def _check_table(table: Sequence[tuple[float, float]]) -> None:
    if not table or table[0][0] != 0.0:
        raise InputError("yield_stress: the first row must have the equivalent plastic strain 0")
    if not table[0][1] > 0.0:
        raise InputError(f"yield_stress[0]: expected a stress > 0, got {table[0][1]!r}")
    for i, (before, row) in enumerate(pairwise(table), 1):
        if not row[0] > before[0]:
            raise InputError(f"yield_stress[{i}]: equivalent plastic strains must grow, got {before[0]!r}, {row[0]!r}")
        if row[1] < before[1]:
            raise InputError(
                f"yield_stress[{i}]: the yield stress falls from {before[1]!r} to {row[1]!r}; a law that softens has no "
                "unique results; keep the larger one"
            )

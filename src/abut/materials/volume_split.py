"""What of a material its change of volume alone decides, apart from the rest: theory (E9)."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any, Protocol

import numpy as np

from abut.materials.evaluated import Array


class VolumeLaw(Protocol):
    """An energy of the change of volume J - 1 alone, per undeformed volume."""

    def evaluate(self, growth: Array) -> tuple[Array, Array, Array]:
        """Energy, its slope (the mean stress of Cauchy) and the slope of that, each (n,), at changes J - 1 (n,)."""
        ...


@dataclass(frozen=True)
class VolumeSplit:
    """A material in two parts that add up. rest: the same with a bulk modulus of the size of its shear modulus, which locks
    no cell; volume: all that is left."""

    rest: Any
    volume: VolumeLaw


@dataclass(frozen=True)
class Powers:
    """Sum of k_i (J - 1)^(2 i), i from 1 on; factors: k_i [force per area]."""

    factors: Sequence[float]

    def evaluate(self, growth: Array) -> tuple[Array, Array, Array]:
        """Energy of the change of volume, with derivatives, as in ``VolumeLaw``."""
        energy, slope, bend = (np.zeros_like(growth) for _ in range(3))
        for i, k in enumerate(self.factors, 1):
            n, last = 2 * i, growth ** (2 * i - 2)
            energy += k * last * growth**2
            slope += n * k * last * growth
            bend += n * (n - 1) * k * last
        return energy, slope, bend


@dataclass(frozen=True)
class LogSquared:
    """modulus/2 (ln J)^2."""

    modulus: float

    def evaluate(self, growth: Array) -> tuple[Array, Array, Array]:
        """Energy of the change of volume, with derivatives, as in ``VolumeLaw``."""
        log, j = np.log1p(growth), 1.0 + growth
        return 0.5 * self.modulus * log**2, self.modulus * log / j, self.modulus * (1.0 - log) / j**2


@dataclass(frozen=True)
class SquareLog:
    """modulus/2 ((J^2 - 1)/2 - ln J)."""

    modulus: float

    def evaluate(self, growth: Array) -> tuple[Array, Array, Array]:
        """Energy of the change of volume, with derivatives, as in ``VolumeLaw``."""
        j, half = 1.0 + growth, 0.5 * self.modulus
        energy = half * (growth * (2.0 + growth) / 2.0 - np.log1p(growth))
        return energy, half * growth * (2.0 + growth) / j, half * (1.0 + 1.0 / j**2)


def volume_split(material: object, finite: bool) -> VolumeSplit | None:
    """As ``OwnMaterial.volume_split``, None of materials that do not say."""
    said = getattr(material, "volume_split", None)
    result: VolumeSplit | None = None if said is None else said(finite)
    return result

"""Materials whose constants and expansion depend on the temperature, theory (A5), (A6), (Y12)."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property
from itertools import pairwise

import numpy as np

from abut import checks
from abut._core import J2OverTemperature
from abut.errors import InputError
from abut.materials.anisotropic import LocalElastic
from abut.materials.directional import Directional
from abut.materials.elastic import INCOMPRESSIBLE, LinearElastic
from abut.materials.evaluated import Array, Evaluated
from abut.materials.kernel import Compiled
from abut.materials.material import Material, OwnMaterial
from abut.materials.places import Places
from abut.materials.plastic import FIELDS, Plastic
from abut.materials.plastic_over_temperature import HeatedKernel, HeatedPlastic, between

AtOne = LinearElastic | LocalElastic | Plastic


@dataclass(frozen=True)
class OverTemperature(OwnMaterial):
    """Linear elasticity, isotropic or with directions, or metal that yields, between materials at some temperatures.

    Constants are linear in the temperature between those given and constant beyond (of isotropic materials Young's modulus
    and Poisson's ratio, of metal also the yield stress at every plastic strain, of others the stiffness). The stress is that
    of the strain and the temperature at a time, and of what has flowed.

    Parameters
    ----------
    temperatures : sequence of float
        Growing [temperature].
    materials : sequence of LinearElastic, Plastic, Orthotropic or Anisotropic
        One at each temperature: all of them ``LinearElastic``, or ``Plastic`` with as many back stresses, or with
        directions along the same axes.
    initial_temperature : float
        Temperature at the beginning, to which changes (``Temperature``, ``Solid.temperature``) add up.
    zero : float, optional
        Temperature from which expansions count: they are secants alpha(T) of the strain alpha(T) (T - zero). Left out: that
        at the beginning. Bodies are not strained at the beginning, whatever it is.

    Raises
    ------
    InputError
        For temperatures that do not grow, and materials that do not go together.

    Examples
    --------
    >>> import abut
    >>> cold, hot = abut.LinearElastic(210e3, 0.3, expansion=11e-6), abut.LinearElastic(150e3, 0.3, expansion=14e-6)
    >>> steel = abut.OverTemperature([20, 600], [cold, hot], initial_temperature=20)
    >>> round(steel.linear.young)
    210000
    """

    temperatures: Sequence[float]
    materials: Sequence[AtOne]
    initial_temperature: float = 0.0
    zero: float | None = None

    def __post_init__(self) -> None:
        given = tuple(
            checks.finite(value, "temperatures")
            for value in checks.listed(self.temperatures, "temperatures", "numbers")
        )
        object.__setattr__(self, "temperatures", given)
        object.__setattr__(self, "materials", checks.listed(self.materials, "materials"))
        checks.finite(self.initial_temperature, "initial_temperature")
        if self.zero is not None:
            checks.finite(self.zero, "zero")
        if not given or len(given) != len(self.materials):
            raise InputError(
                f"temperatures, materials: expected as many of both, at least one, got {len(given)} and "
                f"{len(self.materials)}"
            )
        for before, after in pairwise(given):
            if not after > before:
                raise InputError(f"temperatures: must grow, got {after:g} after {before:g}")
        for material in self.materials:
            if not isinstance(material, (LinearElastic, LocalElastic, Plastic)):
                raise InputError(
                    f"materials: {type(material).__name__} does not depend on temperature; give LinearElastic, Plastic, "
                    "Orthotropic or Anisotropic"
                )
        alike = {material.axes if isinstance(material, LocalElastic) else type(material) for material in self.materials}
        if len(alike) > 1:
            raise InputError("materials: expected all elastic, all plastic, or all with directions and the same axes")
        _ = self._flowing

    @property
    def density(self) -> float:  # type: ignore[override]
        """That of the first material."""
        return self.materials[0].density

    @cached_property
    def linear(self) -> LinearElastic | None:  # type: ignore[override]
        """That at the beginning, of isotropic materials."""
        if not self._isotropic:
            return None
        young, poisson = (float(np.interp(self.initial_temperature, self.temperatures, x)) for x in self._constants)
        return LinearElastic(young, poisson, self.density)

    @property
    def volume_preserving(self) -> bool:  # type: ignore[override]
        """Whether the volume hardly changes where most is strained, as in ``OwnMaterial``: flow keeps the volume."""
        return bool(self._metals)

    @property
    def symmetric(self) -> bool:  # type: ignore[override]
        """Whether tangents are symmetric, as in ``OwnMaterial``: of metal as of each of its materials."""
        return all(material.symmetric for material in self.materials if isinstance(material, Plastic))

    @property
    def fields(self) -> Mapping[str, slice]:  # type: ignore[override]
        """Columns of the history that are written, as in ``OwnMaterial``."""
        return FIELDS if self._metals else {}

    def initial(self, n: int) -> Array:
        """The history before anything has happened, as in ``Material``."""
        law = self._flowing
        return np.zeros((n, 0 if law is None else law.history))

    @property
    def modulus(self) -> float:
        """At the beginning."""
        if self.linear is not None:
            return self.linear.young
        nearest = np.abs(np.array(self.temperatures) - self.initial_temperature).argmin()
        return self.materials[int(nearest)].modulus

    def at(self, places: Places) -> Material:
        """The material at points, with their axes and temperatures, as in ``LocalMaterial``."""
        now = self.initial_temperature + places.change
        law = self._flowing
        if law is not None:
            return HeatedPlastic(law, now, self._swelling_alike(places.change), self.modulus)
        if not now.any() or (now == now[0]).all():
            now = now[:1]
        if self._isotropic:
            stiffness, frame = self._hooke(now), np.eye(3)[None]
        else:
            each = np.stack([material.stiffness for material in self._local])
            stiffness, frame = _between(self.temperatures, each, now), self._local[0].frame(places.points)
        return Directional(stiffness, frame, self._swelling(places.change) if places.change.any() else None)

    def compiled(self, finite: bool) -> Compiled | None:
        """The compiled law, as in ``OwnMaterial``: metal that yields."""
        law = self._flowing
        if law is None:
            return None
        return Compiled(HeatedKernel(law, self.initial_temperature, self._swelling_alike, finite))

    def evaluate(self, strain: Array, history: Array) -> Evaluated:
        """Stresses, tangents and histories at n points, as in ``Material``, at the temperature of the beginning, for
        axes that are the same everywhere."""
        if not self._isotropic:
            self._local[0].evaluate(strain, history)  # which says where it has to be asked
        return self.at(Places(np.zeros((1, 3)), np.zeros(1))).evaluate(np.asarray(strain, dtype=float), history)

    def evaluate_finite(self, strain: Array, history: Array) -> Evaluated:
        """Stresses, tangents and histories at n points under finite strains, as in ``FiniteMaterial``: the law of Saint
        Venant and Kirchhoff, of metal that in logarithmic strains."""
        here = self.at(Places(np.zeros((1, 3)), np.zeros(1)))
        if isinstance(here, HeatedPlastic):
            return here.evaluate_finite(np.asarray(strain, dtype=float), history)
        return self.evaluate(strain, history)

    def check(self, dim: int, plane: str | None, where: str) -> None:
        """Refuse what the law cannot be used with, as in ``OwnMaterial``."""
        for material in self._local:
            material.check(dim, plane, where)

    @property
    def _isotropic(self) -> bool:
        return not isinstance(self.materials[0], LocalElastic)

    @property
    def _metals(self) -> list[Plastic]:
        """What yields."""
        return [material for material in self.materials if isinstance(material, Plastic)]

    @property
    def _flowing(self) -> J2OverTemperature | None:
        """Of metal that yields; made anew, so that no record of a model holds on to a compiled object."""
        return between(self.temperatures, self._metals) if self._metals else None

    @property
    def _local(self) -> list[LocalElastic]:
        return [material for material in self.materials if isinstance(material, LocalElastic)]

    @property
    def _constants(self) -> tuple[list[float], list[float]]:
        own = [material for material in self.materials if not isinstance(material, LocalElastic)]
        return [material.young for material in own], [material.poisson for material in own]

    def _hooke(self, now: Array) -> Array:
        young, poisson = (np.interp(now, self.temperatures, x) for x in self._constants)
        shear = young / (2.0 * (1.0 + poisson))
        bulk = young / (3.0 * np.maximum(1.0 - 2.0 * poisson, young / (3.0 * INCOMPRESSIBLE * shear)))
        result = shear[:, None, None] * np.diag([2.0] * 3 + [1.0] * 3)
        result[:, :3, :3] += (bulk - 2.0 * shear / 3.0)[:, None, None]
        return np.asarray(result)

    def _swelling(self, change: Array) -> Array:
        """Thermal strains (n, 3) along the local axes."""
        each = np.stack([np.broadcast_to(np.asarray(m.expansion, dtype=float), (3,)) for m in self.materials])
        begin = np.full(1, self.initial_temperature)
        zero = self.initial_temperature if self.zero is None else self.zero
        now = begin + change
        swollen = _between(self.temperatures, each, now) * (now - zero)[:, None]
        return np.asarray(swollen - _between(self.temperatures, each, begin) * (begin - zero)[:, None])

    def _swelling_alike(self, change: Array) -> Array:
        """The same (n,) of materials that swell alike in all directions."""
        return self._swelling(change)[:, 0]


def _between(temperatures: Sequence[float], values: Array, now: Array) -> Array:
    """Values (k, ...) at temperatures (k,), linear between and constant beyond, at others (n,): (n, ...)."""
    at = np.asarray(temperatures)
    upper = np.clip(np.searchsorted(at, now), 1, max(len(at) - 1, 1))
    if len(at) == 1:
        return np.repeat(values, len(now), axis=0)
    share = np.clip((now - at[upper - 1]) / (at[upper] - at[upper - 1]), 0.0, 1.0)
    share = share.reshape(-1, *[1] * (values.ndim - 1))
    return np.asarray((1.0 - share) * values[upper - 1] + share * values[upper])

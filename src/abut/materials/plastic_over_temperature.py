"""Von Mises plasticity whose constants depend on the temperature, at points: theory (Y12)."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, field

import numpy as np

from abut._core import J2OverTemperature, j2_over_temperature
from abut.errors import InputError
from abut.materials.evaluated import Array, Evaluated
from abut.materials.kernel import At, Unsound, Wanted
from abut.materials.material import OwnMaterial
from abut.materials.plastic import Plastic


@dataclass(frozen=True)
class HeatedPlastic(OwnMaterial):
    """At n points. temperature: (n or 1,); swelling: (n or 1,) thermal strains, alike in all directions. Strains that it
    takes are whole ones."""

    law: J2OverTemperature
    temperature: Array
    swelling: Array
    modulus: float = 1.0

    def initial(self, n: int) -> Array:
        """The history before anything has happened, as in ``Material``."""
        return np.zeros((n, self.law.history))

    def evaluate(self, strain: Array, history: Array) -> Evaluated:
        """Stresses, tangents and histories at n points, as in ``Material``."""
        elastic = np.array(strain, dtype=float)
        elastic[:, :3] -= self.swelling[:, None]
        return self._told(elastic, history, False)

    def evaluate_finite(self, strain: Array, history: Array) -> Evaluated:
        """Stresses, tangents and histories at n points under finite strains, as in ``FiniteMaterial``: heat stretches
        first, alike in all directions, theory (A3)."""
        stretch = 1.0 + self.swelling
        elastic = np.array(strain, dtype=float)
        elastic[:, :3] -= 0.5 * (stretch**2 - 1.0)[:, None]
        elastic /= (stretch**2)[:, None]
        stress, tangent, after = self._told(elastic, history, True)
        return stretch[:, None] * stress, tangent / stretch[:, None, None], after

    def _told(self, strain: Array, history: Array, finite: bool) -> Evaluated:
        now = np.ascontiguousarray(np.broadcast_to(self.temperature, len(strain)))
        result: Evaluated = self.law.evaluate(strain, np.ascontiguousarray(history, dtype=float), now, finite)
        return result


@dataclass(frozen=True)
class HeatedKernel:
    """The same in the compiled core. swelling: from changes of temperature (n,) to thermal strains (n,)."""

    law: J2OverTemperature
    initial_temperature: float
    swelling: Callable[[Array], Array] = field(compare=False)
    finite: bool
    name: str = "heated"
    together: bool = False

    def integrate(self, at: At, wanted: Wanted) -> Unsound:
        """Forces, tangents and stresses of cells by the compiled law, as in ``Kernel``."""
        assert at.change is not None
        temperature, swelling = self.initial_temperature + at.change, np.ascontiguousarray(self.swelling(at.change))
        found: Unsound = self.law.integrate(
            at.cells, self.finite, at.plane_stress, at.displacement, temperature, swelling, at.before, wanted.force,
            wanted.tangent, wanted.stress, wanted.energy, wanted.after,
        )  # fmt: skip
        return found


def between(temperatures: Sequence[float], materials: Sequence[Plastic]) -> J2OverTemperature:
    """The law whose constants, and yield stresses at every plastic strain, are linear between those of materials.

    Raises InputError for materials with different numbers of back stresses."""
    counts = [len(material.backstresses) for material in materials]
    for i, count in enumerate(counts):
        if count != counts[0]:
            raise InputError(
                f"materials[{i}].backstresses: has {count}, the first material {counts[0]}; give all of them as many; one "
                "with the modulus 0 does nothing"
            )
    strains = sorted({strain for material in materials for strain, _ in material.table})
    rows = []
    for temperature, material in zip(temperatures, materials):
        yields = np.interp(strains, *np.array(material.table).T)
        table = [float(value) for row in zip(strains, yields) for value in row]
        back = [float(value) for pair in material.backstresses for value in pair]
        constants = float(material.young), float(material.poisson)
        shape = float(material.hardening), float(material.saturation), float(material.rate)
        rows.append((float(temperature), *constants, table, *shape, back))
    return j2_over_temperature(rows)

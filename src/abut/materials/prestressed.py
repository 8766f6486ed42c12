"""A material that holds a stress before anything moves it: rolling, welding, hardening, an excavation."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from abut.errors import InputError
from abut.fields import Given, evaluate
from abut.materials.evaluated import Array, Evaluated
from abut.materials.material import (
    FiniteMaterial,
    Material,
    OwnMaterial,
    check_model,
    history_fields,
    is_small,
    symmetric,
    volume_preserving,
)
from abut.materials.places import Places, is_local, placed

INITIAL = "initial_stress"  # of the field of results
NAMES = {2: ("xx", "yy", "zz", "xy"), 3: ("xx", "yy", "zz", "xy", "yz", "zx")}


@dataclass(frozen=True)
class Prestressed(OwnMaterial):
    """A material of small strains with the stress that undeformed bodies have, theory (E14): it answers to a strain e as the
    material itself does to e + C^-1 s, with C its tangent at rest. So metal yields where the sum does.

    material: without it; stress: xx yy zz xy (yz zx), numbers or functions of points (n, dim), force per area; where: whose
    it is, for messages."""

    material: Material
    stress: tuple[Given, ...]
    where: str

    @property
    def density(self) -> float:  # type: ignore[override]
        """As of the material; so are all others."""
        return self.material.density

    @property
    def expansion(self) -> float | Sequence[float]:  # type: ignore[override]
        return self.material.expansion

    @property
    def modulus(self) -> float:
        return self.material.modulus

    @property
    def small(self) -> bool:  # type: ignore[override]
        return is_small(self.material)

    @property
    def volume_preserving(self) -> bool:  # type: ignore[override]
        return volume_preserving(self.material)

    @property
    def symmetric(self) -> bool:  # type: ignore[override]
        return symmetric(self.material) or self.material.constant

    @property
    def fields(self) -> Mapping[str, slice]:  # type: ignore[override]
        return history_fields(self.material)

    def initial(self, n: int) -> Array:
        return self.material.initial(n)

    def held(self, points: Array) -> Array:
        """The stress at points (n, dim) before anything moves, (n, 6), xx yy zz xy yz zx."""
        result = np.zeros((len(points), 6))
        for column, (name, value) in enumerate(zip(NAMES[points.shape[1]], self.stress)):
            result[:, column] = evaluate(value, points, f"{self.where}: initial_stress: {name}")
        return result

    def at(self, places: Places) -> Material:
        """The material at points, with their axes and temperatures, as in ``LocalMaterial``."""
        here, n = placed(self.material, places), len(places.points)
        held = self.held(places.points)
        tangent = here.evaluate(np.zeros((n, 6)), here.initial(n))[1]
        strain = (np.linalg.pinv(tangent, hermitian=True) @ held[..., None])[..., 0]
        if not is_local(self.material):
            strain[:, :3] -= np.multiply.outer(places.change, np.broadcast_to(self.material.expansion, 3))
        return _Held(here, strain)

    def evaluate(self, strain: Array, history: Array) -> Evaluated:
        """Stresses, tangents and histories at n points, as in ``Material``: of a stress that is the same everywhere."""
        if any(callable(value) for value in self.stress):
            raise InputError(
                f"{self.where}: initial_stress: it differs from place to place; ask for the material at some"
            )
        dim = 2 if len(self.stress) == len(NAMES[2]) else 3
        return self.at(Places(np.zeros((1, dim)), np.zeros(1))).evaluate(np.asarray(strain, dtype=float), history)

    def evaluate_finite(self, strain: Array, history: Array) -> Evaluated:
        """Stresses, tangents and histories at n points under finite strains, as in ``FiniteMaterial``, likewise."""
        here = self.at(Places(np.zeros((1, 2 if len(self.stress) == 4 else 3)), np.zeros(1)))
        assert isinstance(here, _Held)
        return here.evaluate_finite(np.asarray(strain, dtype=float), history)

    def check(self, dim: int, plane: str | None, where: str) -> None:
        """Refuse what the law cannot be used with, as in ``OwnMaterial``."""
        check_model(self.material, dim, plane, where)
        if len(self.stress) != len(NAMES[dim]):
            raise InputError(
                f"{where}: initial_stress: expected {' '.join(NAMES[dim])} in {dim}D, got {len(self.stress)} values"
            )


@dataclass(frozen=True)
class _Held(OwnMaterial):
    """A material at points, to whose strains others (n, 6) are added."""

    material: Material
    strain: Array

    @property
    def modulus(self) -> float:
        return self.material.modulus

    def initial(self, n: int) -> Array:
        return self.material.initial(n)

    def evaluate(self, strain: Array, history: Array) -> Evaluated:
        return self.material.evaluate(strain + self.strain, history)

    def evaluate_finite(self, strain: Array, history: Array) -> Evaluated:
        told = self.material.evaluate_finite if isinstance(self.material, FiniteMaterial) else self.material.evaluate
        return told(strain + self.strain, history)

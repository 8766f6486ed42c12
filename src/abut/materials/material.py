"""What a material is: a function from strains and histories at many points to stresses, tangents and new histories.

Components are xx yy zz xy yz zx; shear strains are doubled (engineering), so that stress times strain is work and the
tangent of a hyperelastic material is symmetric. Axisymmetric: xx radial, yy axial, zz hoop, xy their shear. Strains are
those that stress, without those of temperature; plane strain has zeros out of the plane, and in plane stress the caller
finds the strains out of the plane (``abut.materials.plane_stress``). Stress and tangent: force per area.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Protocol, runtime_checkable

import numpy as np

from abut.materials.elastic import LinearElastic
from abut.materials.evaluated import Array as Array
from abut.materials.evaluated import Evaluated as Evaluated
from abut.materials.kernel import Compiled
from abut.materials.volume_split import VolumeSplit


@runtime_checkable
class Material(Protocol):
    """What bodies ask of their material; every class with these will do. Points are independent of each other.

    What a material may have beside these is in ``OwnMaterial``, with the values of a material that has none of it.
    """

    @property
    def density(self) -> float:
        """Mass per volume, used by gravity."""
        ...

    @property
    def expansion(self) -> float | Sequence[float]:
        """Thermal expansion per degree, alike in all directions; of a ``places.LocalMaterial`` its own matter."""
        ...

    @property
    def constant(self) -> bool:
        """Whether the tangent never changes and there is no history: the stress is linear in the strain."""
        ...

    @property
    def modulus(self) -> float:
        """Young's modulus at rest or another measure of how stiff it is, > 0, force per area: a scale, no result
        depends on it."""
        ...

    def initial(self, n: int) -> Array:
        """The history of n points before anything has happened, (n, h); h = 0 for a material without."""
        ...

    def evaluate(self, strain: Array, history: Array) -> Evaluated:
        """Stress (n, 6), tangent (n, 6, 6) and new history (n, h) at small strains (n, 6), after a history (n, h) that is
        not to be changed in place."""
        ...


class OwnMaterial:
    """What a user's own material may inherit: ``evaluate``, as in ``Material``, and ``modulus`` are left to be written, and
    ``evaluate_finite`` of a material for finite strains.

    small: it is a law for small strains, too. volume_preserving: it flows or deforms nearly without change of volume, so
    that "auto" integrates cells that would lock otherwise. symmetric: its tangent always is, so that solvers for symmetric
    matrices will do. linear: the linear elastic material that it is at rest, where it
    is isotropic; errors and scales use it. fields: columns of the history to write, by name: ``{"damage": slice(6, 7)}``.
    """

    density = 0.0
    expansion = 0.0
    constant = False
    small = True
    volume_preserving = False
    symmetric = False
    linear: LinearElastic | None = None
    fields: Mapping[str, slice] = {}

    def initial(self, n: int) -> Array:
        """No history: (n, 0)."""
        return np.zeros((n, 0))

    def compiled(self, finite: bool) -> Compiled | None:
        """What integrates it in the compiled core; None: it is evaluated in Python."""
        return None

    def volume_split(self, finite: bool) -> VolumeSplit | None:
        """The part that the change of volume alone decides, apart from the rest, for cells whose pressures are continuous;
        None: it has none."""
        return None

    def stored(self, strain: Array, history: Array) -> Array | None:
        """Elastic energy per undeformed volume (n,) at strains of Green and Lagrange (n, 6) with the history (n, h) that
        ``evaluate_finite`` has returned there, for the balance of energy; None: it is not told."""
        return None

    def check(self, dim: int, plane: str | None, where: str) -> None:
        """Raise InputError, beginning with ``where``, for a model of ``dim`` dimensions and a plane assumption (as of
        ``Model``) that it cannot be in."""


@runtime_checkable
class FiniteMaterial(Protocol):
    """A material for finite strains."""

    def evaluate_finite(self, strain: Array, history: Array) -> Evaluated:
        """As ``Material.evaluate`` at strains of Green and Lagrange E = (F^T F - 1) / 2, (n, 6): the stress is the second
        one of Piola and Kirchhoff S, the tangent dS/dE. No turn of the body reaches the law, which is objective so."""
        ...


def compiled(material: Material, finite: bool) -> Compiled | None:
    """As ``OwnMaterial.compiled``, None of materials that do not say."""
    said = getattr(material, "compiled", None)
    return None if said is None else said(finite)


def stored(material: Material, strain: Array, history: Array) -> Array | None:
    """As ``OwnMaterial.stored``, None of materials that do not say."""
    told = getattr(material, "stored", None)
    energy = None if told is None else told(strain, history)
    return None if energy is None else np.asarray(energy, dtype=float)


def check_model(material: Material, dim: int, plane: str | None, where: str) -> None:
    """As ``OwnMaterial.check``."""
    check = getattr(material, "check", None)
    if check is not None:
        check(dim, plane, where)


def is_small(material: Material) -> bool:
    """As ``OwnMaterial.small``."""
    return bool(getattr(material, "small", True))


def linear(material: Material) -> LinearElastic | None:
    """As ``OwnMaterial.linear``."""
    return getattr(material, "linear", None)


def volume_preserving(material: Material) -> bool:
    """As ``OwnMaterial.volume_preserving``."""
    return bool(getattr(material, "volume_preserving", False))


def symmetric(material: Material) -> bool:
    """As ``OwnMaterial.symmetric``."""
    return bool(getattr(material, "symmetric", False))


def history_fields(material: Material) -> Mapping[str, slice]:
    """As ``OwnMaterial.fields``."""
    return getattr(material, "fields", {})


def is_finite(material: Material) -> bool:
    """Whether it knows finite strains."""
    return isinstance(material, FiniteMaterial) or compiled(material, True) is not None

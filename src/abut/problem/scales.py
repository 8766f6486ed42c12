"""Scales of a contact pair: what its two sides yield."""

from __future__ import annotations

from dataclasses import dataclass

from abut.materials.softest import contact_modulus, softest
from abut.mesh.surface import Surface
from abut.model import Model


@dataclass(frozen=True)
class Scales:
    """young: the smaller Young's modulus of the two sides, the scale of the law; compliance: of both sides together, of
    which the target has a ``share``. A rigid side has none."""

    young: float
    compliance: float
    share: float


def scales(model: Model, contactor: Surface, target: Surface) -> Scales:
    """Of the contact of two surfaces. The model has refused two rigid sides."""
    both = [softest(model.mesh, model.materials, surface.cells) for surface in (contactor, target)]
    young = min(material.modulus for material in both if material is not None)
    yields = [0.0 if material is None else 2.0 / contact_modulus(material) for material in both]
    return Scales(young, sum(yields), yields[1] / sum(yields))

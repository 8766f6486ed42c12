"""The same model in other units of length and force."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Any

import abut


@dataclass(frozen=True)
class Units:
    """What a unit of a model is worth in another system: of length and of force."""

    length: float
    force: float


MILLIMETRES_TO = {  # and newtons to newtons, to micronewtons, and to pounds
    "m": Units(1e-3, 1.0),
    "um": Units(1e3, 1e6),
    "inch": Units(1 / 25.4, 1 / 4.4482216152605),
}


def in_units(model: abut.Model, units: Units) -> abut.Model:
    """The same model with its lengths and forces in other units; of what the assemblies are made of."""
    length, pressure = units.length, units.force / units.length**2
    thick = 1.0 if model.plane in (None, "axisymmetric") else units.length

    def material(own: abut.LinearElastic) -> abut.LinearElastic:
        return replace(own, young=own.young * pressure)

    def load(own: Any) -> Any:
        if isinstance(own, abut.Pressure):
            return replace(own, value=own.value * pressure)
        per_area = pressure if isinstance(own, abut.Traction) else pressure / length  # else per volume
        share = units.force / thick if isinstance(own, abut.Force) else per_area
        return replace(own, value=tuple(share * v for v in own.value))

    assert all(not any((s.x, s.y, s.z)) for s in model.supports)
    return replace(
        model,
        mesh=replace(model.mesh, points=model.mesh.points * length),
        solids=[replace(solid, material=material(solid.material)) for solid in model.solids],
        loads=[load(own) for own in model.loads],
        contacts=[replace(c, offset=c.offset * length) for c in model.contacts],
    )

"""Loads that find nothing to act on: gravity without density, warmth without expansion."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from abut.materials.material import Material
from abut.materials.places import is_local
from abut.model import Centrifugal, Gravity, Load, Model, Temperature


@dataclass(frozen=True)
class Idle:
    """Where a load or change of temperature stands in the model, what it lacks, and the cure."""

    where: str
    what: str
    cure: str


def idle_loads(model: Model) -> list[Idle]:
    """What does nothing in bodies that it is meant for, in the order of the loads, and of the solids."""
    result = [idle for i, load in enumerate(model.loads) for idle in _of_load(model, load, f"loads[{i}]")]
    for i, solid in enumerate(model.solids):
        if solid.temperature and _is_rigid_to_heat(solid.material):
            result.append(_unstrained(f"solids[{i}].temperature", [solid.body]))
    return result


def _of_load(model: Model, load: Load, where: str) -> list[Idle]:
    if isinstance(load, (Gravity, Centrifugal)):
        name = "gravity" if isinstance(load, Gravity) else "the centrifugal force"
        light = [s.body for s in model.solids if load.on in (None, s.body) and s.material.density == 0.0]
        return (
            [Idle(where, f"{name} finds no density in body {_list(light)}", "give its material a density")]
            if light
            else []
        )
    if isinstance(load, Temperature):
        warm = model.mesh.nodes_of(load.on)
        bodies = [s for s in model.solids if np.isin(model.mesh.nodes_of(s.body), warm).any()]
        if bodies and all(_is_rigid_to_heat(solid.material) for solid in bodies):
            return [_unstrained(where, [solid.body for solid in bodies])]
    return []


def _unstrained(where: str, bodies: list[str]) -> Idle:
    return Idle(where, f"the temperature finds no expansion in body {_list(bodies)}", "give its material an expansion")


def _is_rigid_to_heat(material: Material) -> bool:
    """Whether a temperature changes nothing: no expansion, and no constants that depend on it."""
    return not (np.any(np.asarray(material.expansion, dtype=float)) or is_local(material))


def _list(bodies: list[str]) -> str:
    return ", ".join(f"'{body}'" for body in bodies)

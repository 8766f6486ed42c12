"""Materials that differ from place to place, or with their temperature."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Protocol, runtime_checkable

from abut.materials.evaluated import Array
from abut.materials.material import Material


@dataclass(frozen=True)
class Places:
    """Where n points of a body are, undeformed, and how much warmer they became. points: (n, dim); change: (n,) degrees;
    elapsed: time since the history that the material is given, of the run, which materials with rates look at; 0 where
    nothing moves on."""

    points: Array
    change: Array
    elapsed: float = 0.0


@runtime_checkable
class LocalMaterial(Protocol):
    """A material that differs from place to place or with its temperature, or that heat does not strain alike in all
    directions; ``Material`` at large, and here what it is at given points."""

    def at(self, places: Places) -> Material:
        """The same at n points, in global axes: the strains (n, 6) that its ``evaluate`` takes include those of
        temperature."""
        ...


def placed(material: Material, places: Places) -> Material:
    """What a material is at points: itself, if it is alike everywhere."""
    return material.at(places) if isinstance(material, LocalMaterial) else material


def is_local(material: Material) -> bool:
    """Whether it has to be asked for what it is at a place, and takes strains of temperature, too."""
    return isinstance(material, LocalMaterial)


def uniform_expansion(material: Material) -> float:
    """Thermal expansion per degree that bodies have to know of: none of a material that takes the temperature itself."""
    return 0.0 if isinstance(material.expansion, Sequence) or is_local(material) else material.expansion

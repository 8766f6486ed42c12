"""Materials of a job file."""

from __future__ import annotations

from typing import Annotated, Literal

from pydantic import Field

from abut.axes import KINDS as AXES
from abut.job.table import Number, OneOf, Table
from abut.materials.hyperelastic import VOLUMETRIC

Three = Annotated[list[Number], Field(min_length=3, max_length=3)]


class MaterialTable(Table):
    kind: Literal["linear-elastic"]
    young: Number
    poisson: Number
    density: Number = 0.0
    expansion: Number = 0.0


class NeoHookeTable(Table):
    """young and poisson, or shear and bulk, or shear and lame"""

    kind: Literal["neo-hooke"]
    young: Number | None = None
    poisson: Number | None = None
    shear: Number | None = None
    bulk: Number | None = None
    lame: Number | None = None
    volumetric: Annotated[str, OneOf(VOLUMETRIC)] = VOLUMETRIC[0]
    density: Number = 0.0
    expansion: Number = 0.0


class AxesTable(Table):
    """local axes at each point"""

    kind: Annotated[str, OneOf(AXES)] = AXES[0]
    origin: list[Number] | None = None
    axis: list[Number] | None = None
    x: list[Number] | None = None
    xy: list[Number] | None = None


class LocalTable(Table):
    axes: AxesTable | None = None
    density: Number = 0.0
    expansion: Number | Three = 0.0


class OrthotropicTable(LocalTable):
    kind: Literal["orthotropic"]
    young: Three
    poisson: Three
    shear: Three


class AnisotropicTable(LocalTable):
    kind: Literal["anisotropic"]
    constants: Annotated[list[Number], Field(min_length=21, max_length=21)]


class OverTemperatureTable(Table):
    kind: Literal["over-temperature"]
    temperatures: Annotated[list[Number], Field(min_length=1)]
    materials: Annotated[list[str], Field(min_length=1)]
    initial_temperature: Number = 0.0
    zero: Number | None = None


class HenckyTable(Table):
    kind: Literal["hencky"]
    young: Number
    poisson: Number
    density: Number = 0.0
    expansion: Number = 0.0


Pairs = list[Annotated[list[Number], Field(min_length=2, max_length=2)]]


class PlasticTable(Table):
    kind: Literal["plastic"]
    young: Number
    poisson: Number
    yield_stress: Number | Pairs
    hardening: Number = 0.0
    saturation: Number = 0.0
    rate: Number = 0.0
    backstresses: Pairs = []
    density: Number = 0.0
    expansion: Number = 0.0


class RubberTable(Table):
    bulk: Number | list[Number]
    density: Number = 0.0
    expansion: Number = 0.0


class MooneyRivlinTable(RubberTable):
    kind: Literal["mooney-rivlin"]
    c10: Number
    c01: Number


class YeohTable(RubberTable):
    kind: Literal["yeoh"]
    c10: Number
    c20: Number = 0.0
    c30: Number = 0.0


class OgdenTable(RubberTable):
    kind: Literal["ogden"]
    terms: Pairs


class ArrudaBoyceTable(RubberTable):
    kind: Literal["arruda-boyce"]
    shear: Number
    locking: Number


Rubber = MooneyRivlinTable | YeohTable | OgdenTable | ArrudaBoyceTable
Materials = (
    MaterialTable
    | OrthotropicTable
    | AnisotropicTable
    | OverTemperatureTable
    | NeoHookeTable
    | HenckyTable
    | PlasticTable
    | Rubber
)

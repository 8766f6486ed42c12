"""Materials of a job file: what they are called, and their tables, derived from their records."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Annotated, Any

from pydantic import Field

from abut.axes import KINDS as AXES
from abut.job.derived import Numbers, one_of, table_of
from abut.job.table import Number, OneOf, Table
from abut.materials.anisotropic import Anisotropic, Orthotropic
from abut.materials.elastic import LinearElastic
from abut.materials.hyperelastic import VOLUMETRIC, NeoHooke
from abut.materials.logarithmic import Hencky
from abut.materials.mfront import MFront
from abut.materials.plastic import Plastic
from abut.materials.rubber import ArrudaBoyce, MooneyRivlin, Ogden, Yeoh
from abut.materials.temperature import OverTemperature
from abut.materials.viscoelastic import Viscoelastic

MATERIALS: Mapping[str, type] = {
    "linear-elastic": LinearElastic, "orthotropic": Orthotropic, "anisotropic": Anisotropic,
    "over-temperature": OverTemperature, "neo-hooke": NeoHooke, "hencky": Hencky, "plastic": Plastic,
    "mooney-rivlin": MooneyRivlin, "yeoh": Yeoh, "ogden": Ogden, "arruda-boyce": ArrudaBoyce,
    "viscoelastic": Viscoelastic, "mfront": MFront,
}  # fmt: skip
MADE_OF: Mapping[type, str] = {OverTemperature: "materials", Viscoelastic: "material"}  # the key that names others


class AxesTable(Table):
    """local axes at each point"""

    kind: Annotated[str, OneOf(AXES)] = AXES[0]
    origin: list[Number] | None = None
    axis: list[Number] | None = None
    x: list[Number] | None = None
    xy: list[Number] | None = None


def _long(least: int, most: int | None = None) -> Any:
    return Field(min_length=least, max_length=most)


THREE = Annotated[Numbers, _long(3, 3)]
NAMED = dict[str, Number] | None
LOCAL: Mapping[str, Any] = {"axes": AxesTable | None, "expansion": Number | THREE}
SAID: Mapping[type, Mapping[str, Any]] = {  # types of keys that say more than the record's
    NeoHooke: {"volumetric": Annotated[str, OneOf(VOLUMETRIC)]},
    Orthotropic: {**LOCAL, "young": THREE, "poisson": THREE, "shear": THREE},
    Anisotropic: {**LOCAL, "constants": Annotated[Numbers, _long(21, 21)]},
    Viscoelastic: {"material": str, "terms": Annotated[list[THREE], _long(1)]},
    MFront: {"axes": AxesTable | None, "properties": NAMED, "parameters": NAMED, "variables": NAMED},
    OverTemperature: {"temperatures": Annotated[Numbers, _long(1)], "materials": Annotated[list[str], _long(1)]},
}
MEANING: Mapping[type, str] = {NeoHooke: "young and poisson, or shear and bulk, or shear and lame"}

TABLES = tuple(table_of(record, SAID.get(record), MEANING.get(record), kind) for kind, record in MATERIALS.items())
MATERIAL = one_of(TABLES)

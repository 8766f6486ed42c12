"""Loads of a job file: what they are called, and their tables, derived from their records."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from abut.job.derived import one_of, table_of
from abut.job.material_tables import AxesTable
from abut.job.table import Varying
from abut.model import Centrifugal, Force, Gravity, Moment, NodalForce, Pressure, Temperature, Traction
from abut.thin.records import MidForce

LOADS: Mapping[str, type] = {
    "pressure": Pressure, "traction": Traction, "force": Force, "moment": Moment,
    "nodal-force": NodalForce, "temperature": Temperature, "gravity": Gravity, "centrifugal": Centrifugal,
}  # fmt: skip
SAID: Mapping[type, Mapping[str, Any]] = {  # types of keys that say more than the record's
    Pressure: {"value": Varying},
    Traction: {"value": list[Varying], "axes": AxesTable | None},
    MidForce: {"axes": AxesTable | None},
    Temperature: {"value": Varying},
}
MEANING: Mapping[type, str] = {
    MidForce: "force at each node of the set",
    Temperature: "change of temperature at the nodes, degrees",
}

KEYS: Mapping[str, type] = {**LOADS, "nodal-force": MidForce}  # at nodes of shells and beams with a moment
TABLES = tuple(table_of(record, SAID.get(record), MEANING.get(record), kind) for kind, record in KEYS.items())
LOAD = one_of(TABLES)

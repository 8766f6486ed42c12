"""The job file as pydantic sees it: the model's own records, plus what only a file has (kinds, names, paths)."""

from __future__ import annotations

from typing import Annotated, Any, Literal

from pydantic import BaseModel, ConfigDict, Field

from abut.model import SolveOptions


class Table(BaseModel):
    """A table of the file: unknown keys are errors, numbers must be finite."""

    model_config = ConfigDict(extra="forbid", allow_inf_nan=False, strict=True)


Number = Annotated[float, Field(strict=False)]


class BodyTable(BaseModel):
    """A body meshed by abut; further keys are the arguments of its generator."""

    model_config = ConfigDict(extra="allow")
    kind: str


class MeshTable(Table):
    file: str | None = None
    bodies: dict[str, BodyTable] = {}


class ModelTable(Table):
    plane: Literal["strain", "stress", "axisymmetric"] | None = None


class MaterialTable(Table):
    kind: Literal["linear-elastic"]
    young: Number
    poisson: Number
    density: Number = 0.0
    expansion: Number = 0.0


class SolidTable(Table):
    body: str
    material: str
    temperature: Number = 0.0
    integration: Literal["full", "reduced", "b-bar"] = "full"


class SupportTable(Table):
    on: str
    x: Number | None = None
    y: Number | None = None
    z: Number | None = None
    normal: Number | None = None


class PressureTable(Table):
    kind: Literal["pressure"]
    on: str
    value: Number


class TractionTable(Table):
    kind: Literal["traction"]
    on: str
    value: list[Number]


class ForceTable(Table):
    kind: Literal["force"]
    on: str
    value: list[Number]


class GravityTable(Table):
    kind: Literal["gravity"]
    value: list[Number]
    on: str | None = None


LoadTable = Annotated[PressureTable | TractionTable | ForceTable | GravityTable, Field(discriminator="kind")]


class IntegrationTable(Table):
    rule: Literal["gauss", "newton-cotes"] = "gauss"
    points: Literal["auto"] | int = "auto"


class ContactTable(Table):
    name: str = ""
    contactor: str
    target: str
    kind: Literal["contact", "tied"] = "contact"
    pressure: Literal["auto", "P0", "P1", "P1-discontinuous", "P2", "P2-discontinuous", "dual"] = "auto"
    law: Literal["complementarity", "constraint-function"] = "complementarity"
    epsilon: Number = 1e-12
    method: Literal["segment-to-segment", "node-to-segment", "node-to-segment-two-pass"] = "segment-to-segment"
    integration: IntegrationTable = IntegrationTable()
    offset: Number = 0.0


class SolveTable(Table):
    steps: int = SolveOptions.steps
    linear: Literal["auto", "direct", "amg"] = "auto"
    max_iterations: int = SolveOptions.max_iterations


class OutputTable(Table):
    directory: str = "results"


class JobFile(Table):
    """A whole job file."""

    schema_: Literal[1] = Field(alias="schema")
    mesh: MeshTable
    model: ModelTable = ModelTable()
    materials: dict[str, MaterialTable]
    solids: list[SolidTable]
    supports: list[SupportTable] = []
    loads: list[LoadTable] = []
    contacts: list[ContactTable] = []
    solve: SolveTable = SolveTable()
    output: OutputTable = OutputTable()


def json_schema() -> dict[str, Any]:
    """The JSON Schema of a job file, for editors."""
    return JobFile.model_json_schema(by_alias=True)

"""The job file as pydantic sees it: the model's own records, plus what only a file has (kinds, names, paths)."""

from __future__ import annotations

from typing import Annotated, Any, Literal

from pydantic import BaseModel, ConfigDict, Field, WithJsonSchema

from abut.bodies.integration import INTEGRATIONS
from abut.job.derived import Of, table_of
from abut.job.key_descriptions import describe
from abut.job.load_tables import LOAD
from abut.job.material_tables import MATERIAL, AxesTable
from abut.job.run_tables import (
    BUCKLING,
    FREQUENCIES,
    HARMONIC,
    SOLVE,
    TRANSIENT,
    OutputTable,
    ResultFieldTable,
    StartTable,
    StepTable,
)
from abut.job.table import Number, OneOf, Points, Table, Time, Varying
from abut.model import Connector, Hold, Penetration, Preload, Removal, Rotation, Spring
from abut.model.connector import KINDS as CONNECTORS
from abut.model.contact import GEOMETRIES, KINDS, LAWS, METHODS, PRESSURES, RULES, Contact, Integration
from abut.model.coupling import KINDS as COUPLINGS
from abut.model.coupling import Coupling
from abut.model.hold import STAY
from abut.model.kinematics import KINEMATICS
from abut.model.probe import QUANTITIES
from abut.model.sector import Sector
from abut.model.step_choice import WORDS as STEPS
from abut.model.stop import Stop
from abut.thin.records import Beam, Shell
from abut.types import Json

# Checked by the model's own record, which says once what is wrong where a choice of types would say it for each.
Friction = Annotated[
    Any,
    WithJsonSchema(
        {
            "anyOf": [
                {"type": "number", "minimum": 0},
                {"type": "string"},
                {
                    "type": "array",
                    "minItems": 1,
                    "items": {"type": "array", "items": {"type": "number"}, "minItems": 2, "maxItems": 2},
                },
            ]
        }
    ),
]


class BodyTable(BaseModel):
    """A body meshed by abut; further keys are the arguments of its generator."""

    model_config = ConfigDict(extra="allow")
    kind: str


SHELL = table_of(Shell, meaning="a group of surface cells that its thickness makes solid")
BEAM = table_of(Beam, meaning="a group of lines that a rectangular or round section, solid or hollow, makes solid")


class MeshTable(Table):
    file: str | None = None
    bodies: dict[str, BodyTable] = {}
    shells: Annotated[dict[str, Any], Of(dict[str, SHELL])] = {}
    beams: Annotated[dict[str, Any], Of(dict[str, BEAM])] = {}


class ModelTable(Table):
    plane: Literal["strain", "stress", "axisymmetric"] | None = None
    kinematics: Annotated[str, OneOf(KINEMATICS)] = KINEMATICS[0]


class SolidTable(Table):
    body: str | None = None
    material: str
    temperature: Number = 0.0
    integration: Annotated[str, OneOf(INTEGRATIONS)] = INTEGRATIONS[0]
    initial_stress: list[Varying] | None = None


class SupportTable(Table):
    on: str
    x: Varying = None
    y: Varying = None
    z: Varying = None
    rx: Varying = None
    ry: Varying = None
    rz: Varying = None
    normal: Number | None = None
    amplitude: Points | None = None
    axes: AxesTable | None = None


class TermTable(Table):
    on: Annotated[str | int, Field(description="a node set of one node, or a point's index")]
    component: Literal["x", "y", "z"]
    coefficient: Number


class EquationTable(Table):
    """sum of coefficient times displacement component = value"""

    terms: list[TermTable]
    value: Number = 0.0
    amplitude: Points | None = None
    supports: list[str] = []


class RigidTable(Table):
    """translation of the reference (length) and turns (radians); what is left out is free"""

    body: str
    reference: list[Number] | None = None
    x: Number | None = None
    y: Number | None = None
    z: Number | None = None
    rx: Number | None = None
    ry: Number | None = None
    rz: Number | None = None
    amplitude: Points | None = None
    amplitudes: dict[str, Points] = {}
    density: Annotated[Number, Field(ge=0)] = 0.0


class CouplingTable(Table):
    """points that move with a reference point; what is left out of x to rz is free"""

    name: str
    on: str
    kind: Annotated[str, OneOf(COUPLINGS)] = Coupling.kind
    reference: list[Number] | None = None
    follow: list[Literal["x", "y", "z"]] | None = None
    weights: list[Number] | None = None
    radius: Number | None = None
    axes: AxesTable | None = None
    mirrors: list[Literal["x", "y", "z"]] | None = None
    x: Number | None = None
    y: Number | None = None
    z: Number | None = None
    rx: Number | None = None
    ry: Number | None = None
    rz: Number | None = None
    amplitude: Points | None = None
    amplitudes: dict[str, Points] = {}
    supports: list[str] = []


Law = Annotated[
    Any,
    WithJsonSchema(
        {
            "anyOf": [
                {"type": "number", "exclusiveMinimum": 0},
                {"type": "array", "minItems": 2, "items": {"type": "array", "items": {"type": "number"}}},
            ]
        }
    ),
]


Limits = Annotated[Any, WithJsonSchema({"type": "array", "items": {"type": "number"}, "minItems": 2, "maxItems": 2})]


Led = Annotated[Any, WithJsonSchema({"anyOf": [{"type": "number"}, {"const": STAY}]})]


ROTATION = table_of(Rotation, meaning="rotation about an axis, exactly on arcs")
PRELOAD = table_of(
    Preload,
    {"lock": Time | None},
    "a section of a body whose two sides are drawn together, as tightening does to a bolt",
)
SPRING = table_of(
    Spring,
    dict.fromkeys(("x", "y", "z", "normal", "along"), Law),
    "springs to the ground, between points, or under a surface",
)
CONNECTOR = table_of(
    Connector,
    {"kind": Annotated[str, OneOf(CONNECTORS)], "limits": Limits | None, "limits2": Limits | None},
    "a joint between two reference points, or one and the ground",
)
HOLD = table_of(
    Hold,
    {**dict.fromkeys("xyz", Led), "since": Time, **dict.fromkeys(("reached", "until", "released"), Time | None)},
    "a support that comes or goes on the way",
)
SECTOR = table_of(Sector, meaning="one of alike sectors around an axis is modelled, whose sides equations join")
STOP = table_of(Stop, meaning="a rigid plane that a surface runs against")
REMOVAL = table_of(
    Removal,
    {"until": Time, **dict.fromkeys(("released", "since"), Time | None)},
    "a body that goes on the way, and may come back",
)
PENETRATION = table_of(
    Penetration, {"source": str | list[Number]}, "a fluid under pressure that enters a contact where it is open"
)


class IntegrationTable(Table):
    rule: Annotated[str, OneOf(RULES)] = Integration.rule
    points: Literal["auto"] | int = "auto"


class OverclosureTable(Table):
    points: Points


# The model's own record says what is allowed and what is the default.
class ContactTable(Table):
    name: str = Contact.name
    surfaces: list[str | list[str]] = []
    contactor: str | list[str] = ""
    target: str | list[str] = ""
    auto: bool = False
    bodies: list[str] | None = None
    reach: Number | None = None
    kind: Annotated[str, OneOf(KINDS)] = Contact.kind
    pressure: Annotated[str, OneOf(PRESSURES)] = Contact.pressure
    law: Annotated[str, OneOf(LAWS)] | OverclosureTable = LAWS[0]
    epsilon: Number = Contact.epsilon
    method: Annotated[str, OneOf(METHODS)] = Contact.method
    integration: IntegrationTable = IntegrationTable()
    offset: Number = Contact.offset
    adjust: Annotated[Number, Field(description="gaps and overlaps up to this size count as zero, length")] = (
        Contact.adjust
    )
    amplitude: Points | None = None
    friction: Friction = 0.0
    friction_amplitude: Points | None = None
    geometry: Annotated[str, OneOf(GEOMETRIES)] = Contact.geometry
    since: Number = Contact.since
    until: Number | None = None
    released: Number | None = None


class ProbeTable(Table):
    name: str
    at: list[Number] | None = None
    line: list[list[Number]] | None = None
    on: str | None = None
    points: int | None = None
    of: list[Annotated[str, OneOf(QUANTITIES)]] | None = None
    contact: str | None = None
    body: str | None = None
    steps: int | list[int] | Annotated[str, OneOf(STEPS)] = "all"
    axes: AxesTable | None = None


class JobFile(Table):
    """A whole job file."""

    schema_: Literal[1] = Field(alias="schema")
    parameters: dict[str, Number | str] = {}
    fields: dict[str, ResultFieldTable] = {}
    mesh: MeshTable
    model: ModelTable = ModelTable()
    materials: dict[str, Annotated[Table, MATERIAL]]
    solids: list[SolidTable]
    supports: list[SupportTable] = []
    loads: list[Annotated[Table, LOAD]] = []
    contacts: list[ContactTable] = []
    equations: list[EquationTable] = []
    sectors: list[Annotated[Table, Of(SECTOR)]] = []
    rigid: list[RigidTable] = []
    rotations: list[Annotated[Table, Of(ROTATION)]] = []
    couplings: list[CouplingTable] = []
    preloads: list[Annotated[Table, Of(PRELOAD)]] = []
    connectors: list[Annotated[Table, Of(CONNECTOR)]] = []
    springs: list[Annotated[Table, Of(SPRING)]] = []
    holds: list[Annotated[Table, Of(HOLD)]] = []
    stops: list[Annotated[Table, Of(STOP)]] = []
    removals: list[Annotated[Table, Of(REMOVAL)]] = []
    penetrations: list[Annotated[Table, Of(PENETRATION)]] = []
    probes: list[ProbeTable] = []
    steps: list[StepTable] = []
    start: StartTable | None = None
    frequencies: Annotated[Table, Of(FREQUENCIES)] | None = None
    buckling: Annotated[Table, Of(BUCKLING)] | None = None
    harmonic: Annotated[Table, Of(HARMONIC)] | None = None
    transient: Annotated[Table, Of(TRANSIENT)] | None = None
    solve: Annotated[Table, Of(SOLVE)] = SOLVE()
    output: OutputTable = OutputTable()


def json_schema() -> Json:
    """The JSON Schema of a job file, for editors and the reference page, with the meaning of every key."""
    return describe(JobFile.model_json_schema(by_alias=True), JobFile.__name__)

"""Tables of a job file that say how it is run: load steps, solver, frequencies, output."""

from __future__ import annotations

from typing import Annotated, Literal

from pydantic import Field

from abut.job.derived import table_of
from abut.job.load_tables import LOAD
from abut.job.table import Number, OneOf, Positive, Table, Time
from abut.model.modes import Buckling, Frequencies
from abut.model.response import Harmonic, Transient
from abut.model.solve_options import LINEAR, SolveOptions
from abut.model.step_choice import WORDS as STEPS
from abut.output.options import COMPRESSIONS, FAST, FIELDS, FORMATS, USUAL, VTU

FREQUENCIES = table_of(Frequencies, {"diameters": list[int], "time": Time | None, "open": list[str]})
BUCKLING = table_of(Buckling, {"time": Time | None})
LOADS = list[Annotated[Table, LOAD]]
NUMBERS = list[Number]
VIBRATING = {"damping": Number | NUMBERS, "rayleigh": NUMBERS, "fields": NUMBERS, "time": Time | None, "loads": LOADS}
HARMONIC = table_of(Harmonic, {**VIBRATING, "between": NUMBERS, "base": NUMBERS | None, "imaginary": LOADS})
TRANSIENT = table_of(Transient, VIBRATING)
SOLVE = table_of(
    SolveOptions,
    {"steps": int | Literal["auto"], "linear": Annotated[str, OneOf(LINEAR)], "times": list[Time] | None},
)


class StepTable(Table):
    """a part of the time, whose name stands for its end"""

    name: str
    period: Positive = 1.0
    increments: Annotated[int, Field(ge=1)] = 1


class ResultFieldTable(Table):
    """values of a result file, which expressions over position have by name"""

    file: str
    array: str
    component: str | int | None = None
    body: str | int | None = None


class StartTable(Table):
    """steps of another job that this one begins with"""

    results: str
    time: Time


class OutputTable(Table):
    directory: str = "results"
    steps: int | list[int] | Annotated[str, OneOf(STEPS)] = "all"
    fields: list[Annotated[str, OneOf(FIELDS)]] = list(USUAL)
    formats: list[Annotated[str, OneOf(FORMATS)]] = [VTU]
    compression: Annotated[str, OneOf(COMPRESSIONS)] = FAST
    restart: bool = False

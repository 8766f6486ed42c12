"""Tables of a job file that say how it is run: load steps, solver, frequencies, output."""

from __future__ import annotations

from typing import Annotated, Literal

from pydantic import Field, WithJsonSchema

from abut.job.table import Number, OneOf, Table
from abut.model.modes import Buckling, Frequencies
from abut.model.solve_options import LINEAR, SolveOptions
from abut.model.step_choice import WORDS as STEPS
from abut.output.options import COMPRESSIONS, FAST, FIELDS, FORMATS, USUAL, VTU

Time = Annotated[Number, WithJsonSchema({"anyOf": [{"type": "number"}, {"type": "string"}]})]  # or the name of a step


class FrequenciesTable(Table):
    count: int = Frequencies.count
    stiffening: bool = Frequencies.stiffening


class BucklingTable(Table):
    count: int = Buckling.count


class SolveTable(Table):
    steps: int | Literal["auto"] = SolveOptions.steps
    linear: Annotated[str, OneOf(LINEAR)] = SolveOptions.linear
    max_iterations: int = SolveOptions.max_iterations
    times: list[Time] | None = None
    seconds: Number | None = None
    end: Number = 1.0


class StepTable(Table):
    """a part of the time, whose name stands for its end"""

    name: str
    period: Annotated[Number, Field(gt=0)] = 1.0
    increments: Annotated[int, Field(ge=1)] = 1


class OutputTable(Table):
    directory: str = "results"
    steps: int | list[int] | Annotated[str, OneOf(STEPS)] = "all"
    fields: list[Annotated[str, OneOf(FIELDS)]] = list(USUAL)
    formats: list[Annotated[str, OneOf(FORMATS)]] = [VTU]
    compression: Annotated[str, OneOf(COMPRESSIONS)] = FAST

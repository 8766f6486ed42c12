"""What all tables of a job file share."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Annotated, Any

from pydantic import AfterValidator, BaseModel, BeforeValidator, ConfigDict, Field, ValidationInfo, WithJsonSchema
from pydantic_core import PydanticCustomError
from pydantic_core.core_schema import CoreSchema, literal_schema

from abut.errors import InputError
from abut.expression import mentions
from abut.fields import number_or_field


class Table(BaseModel):
    """A table of the file: unknown keys are errors, numbers must be finite."""

    model_config = ConfigDict(extra="forbid", allow_inf_nan=False, strict=True)


def _no_truth_value(value: object) -> object:
    """The value, unless it is true or false, which Python takes for 1 and 0."""
    if isinstance(value, bool):
        raise PydanticCustomError("number", "Input should be a number")
    return value


Number = Annotated[float, Field(strict=False), BeforeValidator(_no_truth_value)]
Positive = Annotated[float, Field(strict=False, gt=0), BeforeValidator(_no_truth_value)]
Time = Annotated[Number, WithJsonSchema({"anyOf": [{"type": "number"}, {"type": "string"}]})]  # or the name of a step
HISTORY = "pairs of time (0 to 1 over all steps) and factor; linear between; left out: the factor is the time"
Points = Annotated[list[Annotated[list[Time], Field(min_length=2, max_length=2)]], Field(description=HISTORY)]


@dataclass(frozen=True)
class OneOf:
    """Marks a text as one of those that the model's own record allows."""

    choices: tuple[str, ...]

    def __get_pydantic_core_schema__(self, source: Any, handler: Any) -> CoreSchema:
        return literal_schema(list(self.choices))


def _varying(value: object, info: ValidationInfo) -> object:
    """The value if it is a number or an expression, which the model's own record makes of it; the context of a job are names
    of functions of position that it may have."""
    if isinstance(value, bool) or not isinstance(value, (str, int, float)):
        raise PydanticCustomError("varying", "Input should be a number or an expression of x, y, z")
    if isinstance(value, str) and mentions(value, info.context or ()):
        return value
    try:
        number_or_field(value, "")
    except InputError as error:
        said = str(error).removeprefix(": ").partition(", got")[0]
        raise PydanticCustomError("varying", "{said}", {"said": said}) from None
    return value


Varying = Annotated[Any, AfterValidator(_varying), WithJsonSchema({"anyOf": [{"type": "number"}, {"type": "string"}]})]

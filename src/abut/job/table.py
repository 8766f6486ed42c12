"""What all tables of a job file share."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Annotated, Any

from pydantic import BaseModel, ConfigDict, Field
from pydantic_core.core_schema import CoreSchema, literal_schema


class Table(BaseModel):
    """A table of the file: unknown keys are errors, numbers must be finite."""

    model_config = ConfigDict(extra="forbid", allow_inf_nan=False, strict=True)


Number = Annotated[float, Field(strict=False)]


@dataclass(frozen=True)
class OneOf:
    """Marks a text as one of those that the model's own record allows."""

    choices: tuple[str, ...]

    def __get_pydantic_core_schema__(self, source: Any, handler: Any) -> CoreSchema:
        return literal_schema(list(self.choices))

"""From the tables of a job file to the arguments of the model's records."""

from __future__ import annotations

from collections.abc import Collection

from pydantic import BaseModel

from abut.errors import InputError
from abut.model import Amplitude
from abut.types import Json


def values(table: BaseModel, where: str, leave_out: Collection[str] = ()) -> Json:
    """What a table gives to its record: lists as tuples, the amplitude as one."""
    given = table.model_dump(exclude=set(leave_out))
    result = {key: tuple(value) if isinstance(value, list) else value for key, value in given.items()}
    if result.get("amplitude") is not None:
        try:
            result["amplitude"] = Amplitude(result["amplitude"])
        except InputError as error:
            raise InputError(f"{where}.{error}") from None
    return result

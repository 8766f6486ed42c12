"""From the tables of a job file to the arguments of the model's records."""

from __future__ import annotations

from collections.abc import Collection
from typing import Any

from pydantic import BaseModel

from abut.errors import InputError
from abut.model import Amplitude, Axes
from abut.types import Json

HISTORIES = ("amplitude", "friction_amplitude")


def values(table: BaseModel, where: str, leave_out: Collection[str] = ()) -> Json:
    """What a table gives to its record: lists as tuples, the amplitude as one."""
    given = table.model_dump(exclude=set(leave_out))
    result = {key: tuple(value) if isinstance(value, list) else value for key, value in given.items()}
    for key in HISTORIES:
        if result.get(key) is not None:
            try:
                result[key] = Amplitude(result[key])
            except InputError as error:
                raise InputError(f"{where}.{str(error).replace('amplitude', key, 1)}") from None
    if result.get("axes") is not None:
        try:
            result["axes"] = Axes(**given["axes"])
        except InputError as error:
            raise InputError(f"{where}.{error}") from None
    if "amplitudes" in result:
        single: Json = given["amplitudes"]
        result["amplitudes"] = {
            name: _amplitude(points, f"{where}.amplitudes.{name}") for name, points in single.items()
        }
    return result


def _amplitude(points: Any, where: str) -> Amplitude:
    try:
        return Amplitude(tuple(points))
    except InputError as error:
        raise InputError(f"{where}: {str(error).partition(': ')[2]}") from None

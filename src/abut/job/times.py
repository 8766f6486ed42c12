"""Times of a job file, which run to the end that it names, as shares of that end, which those of models are."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import Any

from abut.types import Json

SINGLE = ("lock", "since", "reached", "until", "released")
PAIRS = ("amplitude", "friction_amplitude")
NAMED_PAIRS = "amplitudes"
LIST = "times"


def with_shares(data: Json, end: float) -> Json:
    """Tables of a job with all times divided by ``end``."""
    return data if end == 1.0 else _with_times(data, lambda time: time / end)


def with_times(data: Json, end: float) -> Json:
    """The other way round: all times multiplied by ``end``."""
    return data if end == 1.0 else _with_times(data, lambda time: time * end)


def _with_times(table: Any, of: Callable[[float], float]) -> Any:
    """Tables, and lists of them, with every time put through a function; what is no number stays, and is told later."""
    if isinstance(table, list):
        return [_with_times(item, of) for item in table]
    if not isinstance(table, Mapping):
        return table
    result = {}
    for key, value in table.items():
        if key in SINGLE:
            result[key] = _number(value, of)
        elif key == LIST and isinstance(value, list):
            result[key] = [_number(time, of) for time in value]
        elif key in PAIRS:
            result[key] = _pairs(value, of)
        elif key == NAMED_PAIRS and isinstance(value, Mapping):
            result[key] = {name: _pairs(points, of) for name, points in value.items()}
        else:
            result[key] = _with_times(value, of)
    return result


def _pairs(points: Any, of: Callable[[float], float]) -> Any:
    if not isinstance(points, list):
        return points
    return [[_number(point[0], of), *point[1:]] if isinstance(point, list) and point else point for point in points]


def _number(value: Any, of: Callable[[float], float]) -> Any:
    return of(value) if isinstance(value, (int, float)) and not isinstance(value, bool) else value

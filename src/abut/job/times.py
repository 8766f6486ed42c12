"""Times of a job file: names of steps and times up to any end, as shares of that end, which times of models are."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import Any

from abut.errors import InputError, nearest
from abut.types import Json

SINGLE = ("lock", "since", "reached", "until", "released")
PAIRS = ("amplitude", "friction_amplitude")
NAMED_PAIRS = "amplitudes"
TRANSIENT = "transient"  # whose loads have a time of their own
VIBRATING = ("frequencies", "buckling", "harmonic", TRANSIENT)
LIST = "times"
START = "start"
Change = Callable[[Any], Any]


def with_shares(data: Json) -> Json:
    """Tables of a job with all times as shares of the end: that of ``solve``, or of all ``steps`` together, names of which
    stand for their ends. What is no time stays, and is told later. Raises InputError for a name that no step has, or that
    several have."""
    data = _transient(data, lambda time, period: time / period)
    steps, solve = data.get("steps"), data.get("solve", {})
    if not isinstance(solve, Mapping) or (steps and not _sound(steps)):
        return data
    named, last = {START: 0.0}, 0.0
    for i, step in enumerate(steps or ()):
        last += step.get("period", 1.0)
        if (name := step["name"]) in named:
            taken = "stands for the beginning of the time" if name == START else "is used twice"
            raise InputError(f"steps[{i}].name: {name!r} {taken}; give each step a name of its own")
        named[name] = last
    if steps and "end" in solve:
        raise InputError("solve.end: the time at the end is that of all steps together; leave it out")
    end = last if steps else solve.get("end", 1.0)
    if not _is_number(end) or not end > 0.0 or (end == 1.0 and not steps):
        return data
    result: Json = _of_job(data, lambda time: _share(time, end, named if steps else {}))
    if isinstance(start := data.get("start"), Mapping) and "time" in start:
        result["start"] = {**start, "time": _share(start["time"], end, named if steps else {})}
    if steps:
        finite = isinstance(data.get("model"), Mapping) and data["model"].get("kinematics", "small") != "small"
        given = {"steps", LIST} & solve.keys()
        divided = any("increments" in step for step in steps)
        times = {} if given or (finite and not divided) else {LIST: [time / end for time in _ends(steps)]}
        result["solve"] = {**result.get("solve", {}), "end": end, **times}
    return result


def with_times(data: Json, end: float) -> Json:
    """The other way round: shares of ``end`` as times."""
    if end != 1.0:
        data = _of_job(data, lambda share: share * end if _is_number(share) else share)
    return _transient(data, lambda share, period: share * period)


def _of_job(data: Json, of: Change) -> Json:
    """With all times, but those of the loads of what is transient, put through a function."""
    result: Json = {key: value if key == TRANSIENT else _with_times(value, of) for key, value in data.items()}
    for name in VIBRATING:
        if isinstance(table := result.get(name), Mapping) and "time" in table:
            result[name] = {**table, "time": of(table["time"])}
    return result


def _transient(data: Json, of: Callable[[float, float], float]) -> Json:
    """With the times of the loads of what is transient put through a function, which has the period, too."""
    table = data.get(TRANSIENT)
    period: Any = table.get("period") if isinstance(table, Mapping) else None
    if not isinstance(table, Mapping) or not _is_number(period) or not period > 0.0:
        return data
    loads = _with_times(table.get("loads", []), lambda time: of(time, period) if _is_number(time) else time)
    return {**data, TRANSIENT: {**table, "loads": loads}}


def _sound(steps: Any) -> bool:
    """Whether steps can be read; of others the schema says what is wrong."""
    return isinstance(steps, list) and all(
        isinstance(step, Mapping)
        and isinstance(step.get("name"), str)
        and _is_number(period := step.get("period", 1.0))
        and period > 0.0
        and isinstance(count := step.get("increments", 1), int)
        and count > 0
        for step in steps
    )


def _ends(steps: list[Any]) -> list[float]:
    """Ends of the load steps."""
    result, start = [], 0.0
    for step in steps:
        period, count = step.get("period", 1.0), step.get("increments", 1)
        result += [start + period * i / count for i in range(1, count)] + [start + period]
        start += period
    return result


def _share(time: Any, end: float, named: Mapping[str, float]) -> Any:
    if isinstance(time, str) and named:
        if time not in named:
            raise InputError(f"steps: no step named {time!r}, whose end a time could be{nearest(time, named)}")
        return named[time] / end
    return time / end if _is_number(time) else time


def _with_times(table: Any, of: Change) -> Any:
    """Tables, and lists of them, with every time put through a function."""
    if isinstance(table, list):
        return [_with_times(item, of) for item in table]
    if not isinstance(table, Mapping):
        return table
    result = {}
    for key, value in table.items():
        if key in SINGLE:
            result[key] = of(value)
        elif key == LIST and isinstance(value, list):
            result[key] = [of(time) for time in value]
        elif key in PAIRS:
            result[key] = _pairs(value, of)
        elif key == NAMED_PAIRS and isinstance(value, Mapping):
            result[key] = {name: _pairs(points, of) for name, points in value.items()}
        else:
            result[key] = _with_times(value, of)
    return result


def _pairs(points: Any, of: Change) -> Any:
    if not isinstance(points, list):
        return points
    return [[of(point[0]), *point[1:]] if isinstance(point, list) and point else point for point in points]


def _is_number(value: Any) -> bool:
    return isinstance(value, (int, float)) and not isinstance(value, bool)

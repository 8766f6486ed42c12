"""Times of a model, from 0 to the end of its run, as shares of that end, which everything but results reckons in."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import fields, replace
from typing import Any, TypeVar

from abut.errors import InputError
from abut.model.conditions import SLIGHTLY, Amplitude
from abut.model.solve_options import SolveOptions

INSIDE = ("lock", "since", "until")  # times that lie before the end
UP_TO = ("reached", "released", "time")  # and those that may be the end
ENDS = "times"  # of load steps
Record = TypeVar("Record")


def in_shares(records: Sequence[Record], name: str, end: float, shares: bool) -> tuple[Record, ...]:
    """The records of one list of a model, by name, with their times as shares of ``end``; shares: they are already.

    Raises InputError for a time after the end."""
    return tuple(_of(record, f"{name}[{i}]", 1.0 if shares else end, end) for i, record in enumerate(records))


def of_ends(options: SolveOptions, shares: bool) -> SolveOptions:
    """Options with the ends of load steps likewise."""
    return _of(options, "solve", 1.0 if shares else options.end, options.end)


def _of(record: Record, where: str, unit: float, end: float) -> Record:
    found: dict[str, Any] = {}
    for each in fields(record):  # type: ignore[arg-type]
        value, place = getattr(record, each.name), f"{where}: {each.name}"
        if each.name in (*INSIDE, *UP_TO) and isinstance(value, (int, float)):
            found[each.name] = _share(float(value), unit, end, place, each.name in INSIDE)
        elif each.name == ENDS and value:
            found[each.name] = tuple(_share(time, unit, end, place) for time in value)
        elif type(value) is Amplitude:
            found[each.name] = _history(value, unit, end, place)
        elif isinstance(value, Mapping) and any(type(part) is Amplitude for part in value.values()):
            found[each.name] = {
                name: _history(part, unit, end, f"{place}.{name}") if type(part) is Amplitude else part
                for name, part in value.items()
            }
    return replace(record, **found) if found and unit != 1.0 else record  # type: ignore[type-var]


def _history(history: Amplitude, unit: float, end: float, where: str) -> Amplitude:
    return Amplitude(tuple((_share(time, unit, end, where), factor) for time, factor in history.points))


def _share(time: float, unit: float, end: float, where: str, inside: bool = False) -> float:
    share = time / unit
    if share > 1.0 + SLIGHTLY or (inside and share >= 1.0):
        before = "before" if inside else "from 0 to"
        raise InputError(
            f"{where}: expected a time {before} {end:g}, the end of the run, got {share * end:g}; give it another end "
            "(SolveOptions.end, in a job file end of [solve])"
        )
    return share

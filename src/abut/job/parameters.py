"""Parameters of a job file: numbers with names, and values "=..." that are worked out of them."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

from abut.errors import InputError, nearest
from abut.expression import AXES, CONSTANTS, FUNCTIONS, OF_TWO, with_names
from abut.types import Json

MARK = "="  # what a text that is to be worked out begins with
TABLE = "parameters"
FIELDS = "fields"


def read_settings(texts: Sequence[str]) -> dict[str, str]:
    """NAME=VALUE of the command line, by name. Raises InputError for what is no such thing, or given twice."""
    result: dict[str, str] = {}
    for text in texts:
        name, equals, value = text.partition("=")
        name = name.strip()
        if not (equals and name and value.strip()):
            raise InputError(f"--set: {text!r}: expected NAME=VALUE")
        if name in result:
            raise InputError(f"--set: {name} is set twice")
        result[name] = value.strip()
    return result


def parameters(data: Json, settings: Mapping[str, float | str]) -> dict[str, float]:
    """The parameters of a job by name, ``settings`` in place of what the job says; expressions may use those above.

    Raises InputError for names that cannot be used, values that are none, and settings of what is no parameter."""
    given = data.get(TABLE, {})
    if not isinstance(given, dict):
        raise InputError(f"{TABLE}: expected a table of names and numbers, got {given!r}")
    for name in settings:
        if name not in given:
            raise InputError(f"--set: no parameter named {name!r} in [{TABLE}]{nearest(name, given)}")
    result: dict[str, float] = {}
    for name, value in given.items():
        _check_name(name, TABLE)
        result[name] = _value(
            settings.get(name, value), result, f"--set {name}" if name in settings else f"{TABLE}.{name}"
        )
    return result


def worked_out(data: Json, names: Mapping[str, float]) -> Json:
    """A job's tables with every text "=..." as its number, or, where it depends on x, y, z, as an expression of these.

    Whole numbers are integers, as counts of cells must be. Raises InputError with the place of what cannot be worked out."""
    fields = field_names(data)
    return {key: value if key == TABLE else _inside(value, names, key, fields) for key, value in data.items()}


def field_names(data: Json) -> tuple[str, ...]:
    """Names of values of result files. Raises InputError for those that cannot be used."""
    given = data.get(FIELDS)
    if not isinstance(given, dict):
        return ()
    for name in given:
        _check_name(name, FIELDS)
    return tuple(given)


def _check_name(name: str, table: str) -> None:
    if not name.isidentifier() or name in (*AXES, *CONSTANTS, *FUNCTIONS, *OF_TWO):
        raise InputError(
            f"{table}.{name}: not a name to use in expressions; take letters, digits and _, none of abut's own"
        )


def _value(value: Any, names: Mapping[str, float], where: str) -> float:
    if isinstance(value, str):
        try:
            value = with_names(value.removeprefix(MARK), names)
        except InputError as error:
            raise InputError(f"{where}: {error}") from None
    if isinstance(value, bool) or not isinstance(value, (int, float)) or not -1e300 < value < 1e300:
        raise InputError(f"{where}: expected a number, or an expression of the parameters above, got {value!r}")
    return float(value)


def _inside(value: Any, names: Mapping[str, float], where: str, fields: Sequence[str]) -> Any:
    if isinstance(value, dict):
        return {key: _inside(item, names, f"{where}.{key}", fields) for key, item in value.items()}
    if isinstance(value, list):
        return [_inside(item, names, f"{where}[{i}]", fields) for i, item in enumerate(value)]
    if not (isinstance(value, str) and value.lstrip().startswith(MARK)):
        return value
    try:
        number = with_names(value.lstrip().removeprefix(MARK), names, fields)
    except InputError as error:
        raise InputError(f"{where}: {error}") from None
    return int(number) if isinstance(number, float) and number.is_integer() and abs(number) < 2**53 else number

"""Values of result files that expressions of a job have by name: [fields.NAME]."""

from __future__ import annotations

import dataclasses
import os
from collections.abc import Iterable, Iterator, Mapping
from pathlib import Path
from typing import Any

import numpy as np

from abut.errors import InputError
from abut.expression import Expression, mentions
from abut.job.run_tables import ResultFieldTable
from abut.probing.result_field import ResultField, result_field
from abut.types import Json

MAY_HAVE = ("x", "y", "z", "value", "initial_stress")  # keys of supports, loads and solids that hold expressions

Named = tuple[tuple[str, ResultField], ...]


def read_fields(
    tables: Mapping[str, ResultFieldTable], taken: Mapping[str, float], folder: Path, results: Path
) -> Named:
    """By name; ``taken``: parameters; ``results``: where the job's own results go. Raises InputError for names
    that parameters have, and for what cannot be read."""
    result = []
    for name, table in tables.items():
        if name in taken:
            raise InputError(f"fields.{name}: there is a parameter of that name; give one of them another")
        if (folder / table.file).resolve().is_relative_to(results.resolve()):
            raise InputError(
                f"fields.{name}.file: {table.file} is in the folder of this job's own results, which a run clears; give "
                "another directory in [output]"
            )
        try:
            result.append((name, result_field(folder / table.file, table.array, table.component, table.body)))
        except InputError as error:
            raise InputError(f"fields.{name}: {error}") from None
    return tuple(result)


def told(named: Named) -> list[str]:
    """What each of them is, in words."""
    return [
        f"{name}: {field.array!r} of {field.path}{'' if field.body is None else f', body {field.body!r}'}, "
        f"{np.nanmin(field.values):.6g} to {np.nanmax(field.values):.6g} at {len(field.values)} points"
        for name, field in named
    ]


def tables_of(records: Iterable[Any], folder: Path) -> Json:
    """The tables of what expressions in some records have by name, for a job file in ``folder``. Raises InputError where two
    of one name differ, and for functions that are not of a file."""
    found: dict[str, ResultField] = {}
    for name, field in (pair for record in records for pair in _named(record)):
        if not isinstance(field, ResultField):
            raise InputError(f"{name}: a job file holds values of result files by name, not functions")
        if found.setdefault(name, field) is not field and field != found[name]:
            raise InputError(f"{name}: a name of two result files; give one of them another")
    return {
        name: {
            "file": Path(os.path.relpath(field.path.resolve(), folder.resolve())).as_posix(),
            "array": field.array,
            **{key: value for key in ("component", "body") if (value := getattr(field, key)) is not None},
        }
        for name, field in found.items()
    }


def _named(value: Any) -> Iterator[tuple[str, Any]]:
    """What expressions in a record have by name."""
    if isinstance(value, Expression):
        yield from value.named
    elif isinstance(value, (tuple, list)):
        for item in value:
            yield from _named(item)
    elif dataclasses.is_dataclass(value):
        for part in dataclasses.fields(value):
            yield from _named(getattr(value, part.name))


def with_fields(given: Json, named: Named, where: str) -> Json:
    """What a table gives to its record, with expressions of such names as functions of position. Raises InputError for what
    else such an expression cannot hold."""
    return {key: _made(value, named, f"{where}.{key}") if key in MAY_HAVE else value for key, value in given.items()}


def _made(value: Any, named: Named, where: str) -> Any:
    if isinstance(value, tuple):
        return tuple(_made(item, named, f"{where}[{i}]") for i, item in enumerate(value))
    if not (isinstance(value, str) and mentions(value, dict(named))):
        return value
    try:
        return Expression(value, named)
    except InputError as error:
        raise InputError(f"{where}: {error}") from None

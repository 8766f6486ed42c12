"""What was solved, in words: bodies, materials, supports, loads, contacts as tables."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import MISSING, fields, is_dataclass
from typing import Any

import numpy as np

from abut.expression import Expression, Expressions
from abut.model import Model
from abut.types import Json

Table = Json  # title, head (names of columns), rows (lists of text)

_GROUPS = (
    ("Supports", "supports"),
    ("Loads", "loads"),
    ("Rigid bodies", "rigid"),
    ("Rotations", "rotations"),
    ("Couplings", "couplings"),
    ("Connectors", "connectors"),
    ("Preloads", "preloads"),
    ("Springs", "springs"),
    ("Supports that come or go", "holds"),
    ("Bodies that go or come", "removals"),
    ("Pressure penetration", "penetrations"),
    ("Equations", "equations"),
    ("Contacts", "contacts"),
    ("Probes", "probes"),
    ("Frequencies, buckling and response", "modes"),
)
_SUBJECT = ("on", "body", "name")  # the first of these that a record has stands in a column of its own


def tables(model: Model) -> list[Table]:
    """The model's records as tables of text."""
    result = [_bodies(model)]
    for title, name in _GROUPS:
        records = getattr(model, name, ())
        if records:
            rows = [[type(r).__name__, _subject(r), _details(r)] for r in records]
            result.append({"title": title, "head": ["kind", "where", "values"], "rows": rows})
    return result


def _bodies(model: Model) -> Table:
    solids = {solid.body: solid for solid in model.solids}
    rows = []
    for name, cells in model.mesh.bodies.items():
        kinds = ", ".join(f"{len(of_kind)} {kind}" for kind, _, of_kind in model.mesh.cells_of(name))
        solid = solids.get(name)
        words = (
            "rigid" if solid is None else ", ".join(filter(None, (_value(solid.material), _details(solid, "material"))))
        )
        rows.append([name, kinds or str(len(cells)), words])
    return {"title": "Bodies", "head": ["body", "cells", "material"], "rows": rows}


def _subject(record: object) -> str:
    value = next((getattr(record, name) for name in _SUBJECT if hasattr(record, name)), None)
    return "everywhere" if value is None else _value(value)


def _details(record: Any, *without: str) -> str:
    """Every value that was given: name and value of fields that differ from their defaults."""
    subject = next((name for name in _SUBJECT if hasattr(record, name)), "")
    parts = []
    for entry in fields(record):
        value = getattr(record, entry.name)
        default = entry.default if entry.default_factory is MISSING else entry.default_factory()
        if entry.name != subject and entry.name not in without and value is not None and not _same(value, default):
            parts.append(f"{entry.name} {_value(value)}")
    return ", ".join(parts)


def _same(value: object, default: object) -> bool:
    return default is not MISSING and type(value) is type(default) and bool(value == default)


def _value(value: object) -> str:
    if isinstance(value, float | np.floating):
        return f"{float(value):.6g}"
    if isinstance(value, str | int):
        return str(value)
    if isinstance(value, Expression):
        return value.text
    if isinstance(value, Expressions):
        return _value(value.components)
    if callable(value):
        return "a function of position"
    if is_dataclass(value):
        return _details(value)
    if isinstance(value, Sequence):
        return "(" + ", ".join(map(_value, value)) + ")"
    return str(value)

"""Tables of a job file that are derived from the model's own records: keys, types, and what they are where left out."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import MISSING, dataclass, fields
from typing import Annotated, Any, Literal, get_type_hints

from pydantic import Field, create_model
from pydantic_core.core_schema import CoreSchema

from abut.job.table import Number, Points, Table
from abut.model import Amplitude

Numbers = list[Number]
Pairs = list[Annotated[Numbers, Field(min_length=2, max_length=2)]]

TYPES: Mapping[Any, Any] = {  # of a record's field: of its key
    **{each: each for each in (str, int, bool, str | None, int | None)},
    float: Number,
    float | None: Number | None,
    tuple[float, ...]: Numbers,
    tuple[float, ...] | None: Numbers | None,
    Sequence[float]: Numbers,
    float | Sequence[float]: Number | Numbers,
    Sequence[Sequence[float]]: Pairs,
    float | Sequence[Sequence[float]]: Number | Pairs,
    Amplitude | None: Points | None,
}


@dataclass(frozen=True)
class Of:
    """Marks a value as one of a type that is made when abut is loaded: a derived table, or a choice of such."""

    made: Any

    def __get_pydantic_core_schema__(self, source: Any, handler: Any) -> CoreSchema:
        schema: CoreSchema = handler.generate_schema(self.made)
        return schema


def table_of(
    record: type,
    others: Mapping[str, Any] | None = None,
    meaning: str | None = None,
    kind: str = "",
) -> type[Table]:
    """The table of a record (a dataclass): a key for each of its fields, those that must be given first.

    others: types of keys that say more than the fields', or that the record has no field for; meaning: of the table; kind:
    what its key ``kind`` says, if it has one."""
    hints, known = get_type_hints(record), others or {}
    keys: dict[str, Any] = {"kind": (Literal[kind], ...)} if kind else {}
    for each in sorted(fields(record), key=lambda own: own.default is not MISSING):
        default = list(each.default) if isinstance(each.default, tuple) else each.default
        as_key = known[each.name] if each.name in known else TYPES[hints[each.name]]
        keys[each.name] = as_key, ... if each.default is MISSING else default
    for name in known.keys() - keys.keys():
        keys[name] = known[name], None
    made: type[Table] = create_model(f"{record.__name__}Table", __base__=Table, __doc__=meaning, **keys)
    return made


def one_of(tables: Sequence[type[Table]]) -> Of:
    """One of several tables, which their ``kind`` tells."""
    every = tables[0]
    for table in tables[1:]:
        every = every | table  # type: ignore[assignment]
    return Of(Annotated[every, Field(discriminator="kind")])

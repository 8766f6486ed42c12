"""Records with large arrays in a few lines, for who prints them."""

from __future__ import annotations

import dataclasses
import textwrap
from collections.abc import Iterable, Mapping, Sequence
from typing import Any

import numpy as np

WIDTH, LINES = 110, 10
FEW = 3  # components of a vector, which are shown
NAMED = 4  # of a list, before "and n more"


def brief(record: Any) -> str:
    """A dataclass with each field in a word or two: arrays by their shape, vectors by their components, records by their
    kind; in at most ten lines."""
    fields = (f"{f.name}={word(getattr(record, f.name))}" for f in dataclasses.fields(record))
    text = f"{type(record).__name__}({', '.join(fields)})"
    return "\n".join(textwrap.wrap(text, WIDTH, subsequent_indent="    ", max_lines=LINES, placeholder=" ..."))


def word(value: Any) -> str:
    """A value in a word or two."""
    if isinstance(value, np.ndarray):
        return vector(value) if value.ndim == 1 and len(value) <= FEW else f"array {value.shape}"
    if isinstance(value, float):
        return f"{value:.6g}"
    if isinstance(value, Mapping):
        return f"{{{listed(map(repr, value))}}}"
    if isinstance(value, Sequence) and not isinstance(value, str):
        return f"{len(value)} of {type(value[0]).__name__}" if value else "()"
    return type(value).__name__ if dataclasses.is_dataclass(value) else repr(value)


def vector(values: Iterable[float]) -> str:
    """Components in brackets."""
    return f"[{', '.join(f'{value:.6g}' for value in values)}]"


def listed(names: Iterable[str]) -> str:
    """Names, and how many more there are."""
    every = list(names)
    more = f" and {len(every) - NAMED} more" if len(every) > NAMED else ""
    return ", ".join(every[:NAMED]) + more

"""Argument checks shared by all layers: each says the name, what was expected and what was got."""

from __future__ import annotations

import math
import os
from collections.abc import Iterable, Mapping, Sequence
from pathlib import Path
from typing import Any, TypeVar

import numpy as np

from abut.errors import InputError, nearest
from abut.types import Array

Kind = TypeVar("Kind")
LARGEST = 1e60  # size of a number that no units need; products of several stay within what a computer can hold


def finite(value: float, name: str) -> float:
    """Return ``value`` as a float; raise InputError unless it is a finite number of a size that units can explain."""
    try:
        number = float(value)
    except (TypeError, ValueError, OverflowError):
        raise InputError(f"{name}: expected a number, got {value!r}") from None
    if isinstance(value, bool) or not math.isfinite(number):
        raise InputError(f"{name}: expected a finite number, got {value!r}")
    if number != 0.0 and not 1.0 / LARGEST <= abs(number) <= LARGEST:
        raise InputError(
            f"{name}: expected a number between 1e-60 and 1e60 in size, or 0, got {value!r}; check the units"
        )
    return number


def positive(value: float, name: str) -> float:
    """Return ``value`` as a float; raise InputError unless it is finite and > 0."""
    number = finite(value, name)
    if number <= 0.0:
        raise InputError(f"{name}: expected a number > 0, got {value!r}")
    return number


def choice(value: str, name: str, allowed: Sequence[str]) -> str:
    """Return ``value``; raise InputError unless it is one of ``allowed``."""
    if value not in allowed:
        hint = nearest(str(value), allowed)
        raise InputError(f"{name}: expected one of {', '.join(allowed)}, got {value!r}{hint if 'mean' in hint else ''}")
    return value


def array(value: object, name: str, *, dtype: Any = np.float64, shape: Sequence[int | None] = ()) -> Array:
    """Return ``value`` as a C-contiguous array of ``dtype``; ``None`` in ``shape`` matches any extent."""
    try:
        result = np.ascontiguousarray(value, dtype=dtype)
    except (TypeError, ValueError, OverflowError) as error:
        raise InputError(
            f"{name}: expected an array of {np.dtype(dtype)}, got {type(value).__name__} ({error})"
        ) from None
    result = _shaped(result, name, shape)
    if np.issubdtype(result.dtype, np.floating) and not np.isfinite(result).all():
        where = np.argwhere(~np.isfinite(result))[0].tolist()
        raise InputError(f"{name}: entry {where} is not a finite number")
    if np.issubdtype(result.dtype, np.floating) and np.abs(result).max(initial=0.0) > LARGEST:
        where = np.argwhere(np.abs(result) > LARGEST)[0].tolist()
        raise InputError(f"{name}: entry {where} is larger than {LARGEST:g}; check the units")
    return result


def numbers(value: object, name: str, shape: Sequence[int | None]) -> Array:
    """Return ``value`` as a C-contiguous array of floats, itself where it is one, whatever they are: inf and nan, too."""
    try:
        given = np.asarray(value)
        result = np.ascontiguousarray(given, dtype=np.float64) if given.dtype.kind in "iufO" else None
    except (TypeError, ValueError, OverflowError):
        result = None
    if result is None:
        raise InputError(f"{name}: expected an array of numbers, got {_kind(value)}")
    return _shaped(result, name, shape)


def whole_numbers(value: object, name: str, dtype: type[np.integer[Any]], shape: Sequence[int | None]) -> Array:
    """Return whole numbers as a C-contiguous array of ``dtype``, itself where it is one. Raises InputError for numbers that
    are not whole, and those that do not fit."""
    if isinstance(value, np.ndarray) and value.dtype == dtype and value.flags.c_contiguous:
        return _shaped(value, name, shape)
    try:
        given = np.asarray(value)
        result = np.ascontiguousarray(given, dtype=dtype) if given.dtype.kind in "iufO" else None
    except (TypeError, ValueError, OverflowError):
        result = None
    if result is None or not np.array_equal(result, given):
        raise InputError(f"{name}: expected an array of whole numbers of {np.dtype(dtype)}, got {_kind(value)}")
    return _shaped(result, name, shape)


def _kind(value: object) -> str:
    """What an argument is, in words."""
    return f"an array of {value.dtype}" if isinstance(value, np.ndarray) else type(value).__name__


def _shaped(result: Array, name: str, shape: Sequence[int | None]) -> Array:
    if len(shape) != result.ndim or any(want is not None and want != got for want, got in zip(shape, result.shape)):
        expected = "(" + ", ".join("any" if extent is None else str(extent) for extent in shape) + ")"
        raise InputError(f"{name}: expected shape {expected}, got {result.shape}")
    return result


def known(name: object, known: Iterable[str] | Mapping[str, object], where: str, what: str) -> None:
    """Raise InputError for a name that is not among the known ones, with the nearest."""
    if not isinstance(name, str) or name not in known:
        raise InputError(f"{where}: no {what} named {name!r} in the mesh{nearest(str(name), known)}")


def listed(values: object, where: str, what: str = "records") -> tuple[Any, ...]:
    """A list as a tuple. Raises InputError for one entry alone, a mapping, or text. what: the entries, in a word."""
    if not isinstance(values, Iterable) or isinstance(values, (str, bytes, Mapping)):
        raise InputError(f"{where}: expected a list of {what}, in brackets [...], got {type(values).__name__}")
    return tuple(values)


def names(values: object, where: str) -> tuple[str, ...]:
    """The same of names."""
    return tuple(text(value, where) for value in listed(values, where, "names"))


def records(values: object, where: str, kinds: tuple[type, ...]) -> tuple[Any, ...]:
    """A list of records of some ``kinds`` as a tuple. Raises InputError for anything else, with its place."""
    result = listed(values, where)
    for i, value in enumerate(result):
        if not isinstance(value, kinds):
            raise InputError(
                f"{where}[{i}]: expected {' or '.join(k.__name__ for k in kinds)}, got {type(value).__name__}"
            )
    return result


def function(value: object, where: str) -> Any:
    """Return ``value``; raise InputError unless it can be called."""
    if not callable(value):
        raise InputError(f"{where}: expected a function, got {type(value).__name__}")
    return value


def mapping(values: object, where: str, what: str) -> Mapping[str, Any]:
    """Return ``values``; raise InputError unless it is a mapping of names. what: that names have, in words."""
    if not isinstance(values, Mapping) or not all(isinstance(name, str) for name in values):
        got = "names that are no text" if isinstance(values, Mapping) else type(values).__name__
        raise InputError(f"{where}: expected {what} by name, as {{name: ...}}, got {got}")
    return values


def instance(value: object, kind: type[Kind], where: str, what: str) -> Kind:
    """Return ``value``; raise InputError unless it is a ``kind``. what: its name in a sentence, "a model (abut.Model)"."""
    if not isinstance(value, kind):
        raise InputError(f"{where}: expected {what}, got {type(value).__name__}")
    return value


def text(value: object, where: str) -> str:
    """Return ``value``; raise InputError unless it is a text that is not empty."""
    if not isinstance(value, str) or not value:
        raise InputError(f"{where}: expected a text that is not empty, got {value!r}")
    return value


def path(value: object, where: str) -> Path:
    """Return a path; raise InputError for what is none, and for an empty text, which would mean the working directory."""
    if not isinstance(value, (str, os.PathLike)) or not isinstance(os.fspath(value), str) or not os.fspath(value):
        raise InputError(f"{where}: expected a path, as text or pathlib.Path, got {value!r}")
    return Path(value)

"""TOML files as tables."""

from __future__ import annotations

import re
import tomllib
from pathlib import Path
from typing import Any

from abut.errors import InputError
from abut.types import Json

PARTS = 50  # of a dotted key; reading one takes time with the square of their number
BITS = 64  # of a whole number, as TOML has them
_PART = r"""(?:[A-Za-z0-9_-]+|"[^"\n]*"|'[^'\n]*')"""
_LONG_KEY = re.compile(rf"(?<![A-Za-z0-9_-]){_PART}(?:[ \t]*\.[ \t]*{_PART}){{{PARTS}}}")


def read_toml(path: Path) -> tuple[str, Json]:
    """The text of a TOML file and its table. Raises InputError for a file that cannot be read or is no TOML."""
    try:
        text = path.read_text(encoding="utf-8-sig")
    except OSError as error:
        raise InputError(f"cannot read job file {path}: {error.strerror}") from None
    except UnicodeDecodeError:
        raise InputError(f"{path}: not a text file in UTF-8; is it a job file?") from None
    if found := _LONG_KEY.search(text):
        line = text.count("\n", 0, found.start()) + 1
        raise InputError(
            f"{path}: line {line}: a name of more than {PARTS} parts between dots; no key of a job has so many"
        )
    try:
        data = tomllib.loads(text)
    except ValueError as error:  # TOMLDecodeError is one, and so is a number of too many digits
        raise InputError(f"{path}: not valid TOML: {error}") from None
    except RecursionError:
        raise InputError(f"{path}: not valid TOML: lists or tables nested too deeply") from None
    _check_sizes(path, data)
    return text, data


def _check_sizes(path: Path, data: Json) -> None:
    """Raise InputError for whole numbers of more bits than TOML has, which Python reads nonetheless."""
    left: list[tuple[str, Any]] = [("", data)]
    while left:
        place, value = left.pop()
        if isinstance(value, dict):
            left += ((f"{place}.{key}" if place else key, item) for key, item in value.items())
        elif isinstance(value, list):
            left += ((f"{place}[{i}]", item) for i, item in enumerate(value) if isinstance(item, (int, dict, list)))
        elif isinstance(value, int) and value.bit_length() >= BITS:
            raise InputError(
                f"{path}: {place}: a whole number of more than {BITS} bits, which TOML does not have; check its size, and "
                "write it as 1e20 where that is right"
            )

"""Arrays in the page: all of them in one compressed text, to which the page's data refer by place and length."""

from __future__ import annotations

import base64
import zlib
from typing import Any

import numpy as np

from abut.types import Array, Json

DIGITS = 17  # bits of a value's mantissa: 5 digits; the rest would be noise that does not compress
SHARE = 2.0**-20  # of the largest component, to which displacements are rounded
LEVEL = 6  # of zlib


class Packer:
    """Collects arrays; ``text`` has all of them at the end.

    Each array is 32-bit floats or unsigned integers, little-endian, the first bytes of all of its numbers, then the second
    ones and so on: equal signs and exponents lie side by side, which halves what compression leaves."""

    def __init__(self) -> None:
        self._parts: list[bytes] = []
        self._length = 0

    def put(self, values: Array) -> Json:
        """Where an array is: type, first number, count."""
        real = np.issubdtype(values.dtype, np.floating)
        array = np.ascontiguousarray(values, dtype="<f4" if real else "<u4").ravel()
        self._parts.append(array.view(np.uint8).reshape(-1, 4).T.tobytes())
        place = {"type": "f4" if real else "u4", "at": self._length, "count": array.size}
        self._length += array.size
        return place

    def all(self, data: Any) -> Any:
        """A structure of lists and dictionaries with its arrays put aside."""
        if isinstance(data, np.ndarray):
            return self.put(data)
        if isinstance(data, dict):
            return {name: self.all(value) for name, value in data.items()}
        if isinstance(data, list):
            return [self.all(value) for value in data]
        return data

    @property
    def text(self) -> str:
        """Deflated (RFC 1951), as base64."""
        squeeze = zlib.compressobj(LEVEL, zlib.DEFLATED, -15)
        return base64.b64encode(squeeze.compress(b"".join(self._parts)) + squeeze.flush()).decode("ascii")


def size(data: Any) -> int:
    """Bytes of all arrays in a structure, before they are compressed."""
    if isinstance(data, np.ndarray):
        return 4 * data.size
    values = data.values() if isinstance(data, dict) else data if isinstance(data, list) else ()
    return sum(map(size, values))


def rounded(values: Array) -> Array:
    """Values to show, with as many digits as a reader may want."""
    mantissa, exponent = np.frexp(np.asarray(values, dtype=float))
    return np.asarray(np.ldexp(np.round(np.ldexp(mantissa, DIGITS)), exponent - DIGITS), dtype=np.float32)


def moved(values: Array) -> Array:
    """Displacements, rounded to a power of two that is small beside the largest of them."""
    largest = float(np.nanmax(np.abs(values), initial=0.0))
    if not 0.0 < largest < np.inf:
        return np.asarray(values, dtype=np.float32)
    step = 2.0 ** np.floor(np.log2(largest * SHARE))
    return np.asarray(np.round(values / step) * step, dtype=np.float32)

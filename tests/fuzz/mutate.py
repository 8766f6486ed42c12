"""Damage to files: the same number gives the same damage."""

from __future__ import annotations

import random
import re
import struct
from collections.abc import Sequence

TOKENS = [
    b"0", b"-1", b"1", b"2", b"3", b"7", b"15", b"255", b"65536", b"2147483647", b"2147483648", b"4294967295",
    b"-2147483649", b"9223372036854775807", b"18446744073709551615", b"123456789012345678901234567890", b"1e308",
    b"-1e308", b"1e309", b"1e-320", b"5e-324", b"1e-12", b"1e12", b"0.5", b"-0.0", b"nan", b"inf", b"-inf", b"NaN",
    b"", b" ", b"x", b"1.5.2", b"1e", b"0x10", b"1_000", b"+3", b"\xff\xfe", b"\x00", b"\xc3\xa9", b"$", b"$End",
    b"\"", b"'", b"[", b"]", b"{", b"#", b"\\", b"%s",
]  # fmt: skip
VALUES = [
    "nan", "inf", "-inf", "1e308", "-1e308", "1e-320", "5e-324", "1e400", "0", "-0.0", "-1", "1", "2", "3", "0.5",
    "1e-9", "1e9", "10000000000", "9223372036854775807", "170141183460469231731687303715884105728", "true", "false",
    '""', '"x"', '"auto"', '"\\u0000"', '"../../x"', '"/"', '"."', '"a\\nb"', "'\U0001f600'", "[]", "[0]", "[0, 0]",
    "[1, 2]", "[0, 0, 0]", "[1, 2, 3]", "[1e308, -1e308]", "[nan, 0, 0]", "[true, false, true]", '["a", "b"]',
    "[[1, 2], [3, 4]]", "{}", "{ a = 1 }", "2001-06-07", "07:32:00", "[" * 40 + "]" * 40, "[" * 5000 + "]" * 5000,
    '"x + 1"', '"y / x"', '"-x**y**y"', '"log(x - y)"', '"1e308*x"', '"z"', '"x^2"', '"0.1 if x < 0 else 1/y"', '"((((x"',
    "{ a = " * 300 + "1" + " }" * 300, '"' + "x" * 100_000 + '"', "9" * 5000,
]  # fmt: skip
NUMBER = re.compile(rb"[-+]?\d+(\.\d*)?([eE][-+]?\d+)?")


def damaged(data: bytes, others: Sequence[bytes], chance: random.Random) -> bytes:
    """One to three kinds of damage to any file; ``others``: files to take pieces from."""
    for _ in range(chance.choice([1, 1, 1, 2, 3])):
        data = chance.choice(_BYTES)(data, others, chance)
    return data


def damaged_job(text: str, others: Sequence[str], chance: random.Random) -> str:
    """One to three kinds of damage to a job file, most of which leave it valid TOML."""
    for _ in range(chance.choice([1, 1, 2, 3])):
        text = chance.choice(_TEXTS)(text, others, chance)
    return text


def _cut(data: bytes, _: Sequence[bytes], chance: random.Random) -> bytes:
    return data[: chance.randrange(len(data) + 1)]


def _flip(data: bytes, _: Sequence[bytes], chance: random.Random) -> bytes:
    result = bytearray(data)
    for _i in range(chance.choice([1, 1, 2, 8, 64])):
        if result:
            result[chance.randrange(len(result))] = chance.randrange(256)
    return bytes(result)


def _field(data: bytes, _: Sequence[bytes], chance: random.Random) -> bytes:
    """A binary number replaced by one that is likely to hurt."""
    whole = [0, -1, 1, 2, 3, 2**15, 2**31 - 1, -(2**31), 10**6]
    field = chance.choice(
        [
            struct.pack("<i", chance.choice(whole)),
            struct.pack("<q", chance.choice([*whole, 2**31, 2**32, 2**40, 2**62, 2**63 - 1, -(2**63)])),
            struct.pack("<d", chance.choice([float("nan"), float("inf"), 1e308, -1e308, 5e-324, 1e-320, 0.0, 1e12])),
        ]
    )
    step = chance.choice([1, 4])
    at = step * chance.randrange(max(len(data) // step, 1))
    return data[:at] + field + data[at + len(field) :]


def _token(data: bytes, _: Sequence[bytes], chance: random.Random) -> bytes:
    places = list(NUMBER.finditer(data))
    if not places:
        return data
    place = chance.choice(places)
    return data[: place.start()] + chance.choice(TOKENS) + data[place.end() :]


def _drop(data: bytes, _: Sequence[bytes], chance: random.Random) -> bytes:
    at = chance.randrange(len(data) + 1)
    return data[:at] + data[at + chance.choice([1, 2, 4, 8, 40, 400]) :]


def _repeat(data: bytes, _: Sequence[bytes], chance: random.Random) -> bytes:
    at, size = chance.randrange(len(data) + 1), chance.choice([1, 4, 8, 40, 400])
    return data[: at + size] + data[at : at + size] * chance.choice([1, 1, 1, 50]) + data[at + size :]


def _insert(data: bytes, _: Sequence[bytes], chance: random.Random) -> bytes:
    at = chance.randrange(len(data) + 1)
    return data[:at] + chance.choice([*TOKENS, chance.randbytes(16)]) + data[at:]


def _splice(data: bytes, others: Sequence[bytes], chance: random.Random) -> bytes:
    other = chance.choice(others)
    at, end = chance.randrange(len(data) + 1), chance.randrange(len(other) + 1)
    return data[:at] + other[end:]


def _lines(data: bytes, _: Sequence[bytes], chance: random.Random) -> bytes:
    lines = data.split(b"\n")
    a, b = chance.randrange(len(lines)), chance.randrange(len(lines))
    kind = chance.randrange(4)
    if kind == 0:
        del lines[a]
    elif kind == 1:
        lines[a], lines[b] = lines[b], lines[a]
    elif kind == 2:
        lines.insert(a, lines[b])
    else:
        del lines[min(a, b) : max(a, b)]
    return b"\n".join(lines)


_BYTES = [_cut, _flip, _field, _field, _token, _token, _token, _drop, _repeat, _insert, _splice, _lines]


def _value(text: str, others: Sequence[str], chance: random.Random) -> str:
    """A value replaced: by nonsense, or by that of another line."""
    lines = text.splitlines()
    own = [i for i, line in enumerate(lines) if "=" in line]
    if not own:
        return text
    i = chance.choice(own)
    taken = [line.split("=", 1)[1] for line in chance.choice(others).splitlines() if "=" in line]
    lines[i] = f"{lines[i].split('=', 1)[0]}= {chance.choice([*VALUES, *taken])}"
    return "\n".join(lines)


def _scaled(text: str, _: Sequence[str], chance: random.Random) -> str:
    """A number changed: by sign, by size, by one."""
    places = list(re.finditer(r"(?<![\w.])-?\d+(\.\d*)?(e[-+]?\d+)?", text))
    if not places:
        return text
    place = chance.choice(places)
    number = float(place.group())
    fresh = chance.choice(
        [-number, 0.0, number + 1, number - 1, 2 * number, number * 1e-6, number * 1e150, number * 1e-300]
    )
    if "." not in place.group() and abs(fresh) < 10:
        return text[: place.start()] + str(round(fresh)) + text[place.end() :]
    return text[: place.start()] + repr(fresh) + text[place.end() :]


def _key(text: str, others: Sequence[str], chance: random.Random) -> str:
    """A line out, twice, or with another key."""
    lines = text.splitlines()
    i = chance.randrange(len(lines)) if lines else 0
    if not lines:
        return text
    kind = chance.randrange(3)
    if kind == 0:
        del lines[i]
    elif kind == 1:
        lines.insert(chance.randrange(len(lines)), lines[i])
    else:
        lines.insert(i, chance.choice(chance.choice(others).splitlines()))
    return "\n".join(lines)


def _name(text: str, _: Sequence[str], chance: random.Random) -> str:
    """One name in quotation marks for another."""
    places = list(re.finditer(r'"[^"\n]*"', text))
    if not places:
        return text
    place, other = chance.choice(places), chance.choice(places)
    return text[: place.start()] + other.group() + text[place.end() :]


def _section(text: str, others: Sequence[str], chance: random.Random) -> str:
    """A table out, twice, or taken from another job."""
    parts = re.split(r"\n(?=\[)", text)
    other = re.split(r"\n(?=\[)", chance.choice(others))
    i = chance.randrange(len(parts))
    kind = chance.randrange(3)
    if kind == 0:
        del parts[i]
    elif kind == 1:
        parts.append(parts[i])
    else:
        parts.append(chance.choice(other))
    return "\n".join(parts)


def _any(text: str, others: Sequence[str], chance: random.Random) -> str:
    data = damaged(text.encode("utf-8", "surrogateescape"), [other.encode() for other in others], chance)
    return data.decode("utf-8", "surrogateescape")


_TEXTS = [_value, _value, _value, _scaled, _scaled, _key, _name, _section, _any]

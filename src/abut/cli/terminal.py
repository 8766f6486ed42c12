"""What the command line prints: names come from files, and must not steer the terminal."""

from __future__ import annotations

import re
import sys
from typing import TextIO

LONGEST = 4000  # characters of a line of a message; a longer one is damaged data, not words

# Control characters but tab and line feed, those of eight bits, what turns the direction of text, other ends of lines, and
# bytes of file names that are no text
_STEERING = re.compile("[\x00-\x08\x0b-\x1f\x7f-\x9f\u061c\u200e\u200f\u2028-\u202e\u2066-\u2069\ud800-\udfff]")


def plain(text: str) -> str:
    """Text with control characters written out, as \\x1b."""
    return _STEERING.sub(lambda found: found.group().encode("unicode_escape").decode(), text)


def shortened(text: str) -> str:
    """A message whose longest lines are cut."""
    lines = text.split("\n")
    return "\n".join(
        line if len(line) <= LONGEST else f"{line[:LONGEST]} ... ({len(line)} characters)" for line in lines
    )


def show(*values: object, sep: str = " ", end: str = "\n", file: TextIO | None = None, flush: bool = False) -> None:
    """As ``print``, with control characters written out, and those that the output does not know."""
    text = plain(sep.join(map(str, values)))
    encoding = getattr(sys.stdout if file is None else file, "encoding", None) or "utf-8"
    print(text.encode(encoding, "backslashreplace").decode(encoding), end=end, file=file, flush=flush)

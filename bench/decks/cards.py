"""A deck as a list of cards: just enough to edit one for a reference run."""

from __future__ import annotations

import gzip
import tempfile
from collections.abc import Iterable, Iterator
from contextlib import contextmanager
from dataclasses import dataclass, field, replace
from pathlib import Path


@dataclass(frozen=True)
class Card:
    """A keyword line and the data lines below it; ``options`` has the parameters, names in capitals."""

    name: str
    options: dict[str, str] = field(default_factory=dict)
    data: tuple[str, ...] = ()
    line: int = 0

    def without(self, *names: str) -> Card:
        """The same card with some parameters left out."""
        return replace(self, options={k: v for k, v in self.options.items() if k not in names})

    def text(self) -> str:
        head = ", ".join([f"*{self.name}", *(f"{k}={v}" if v else k for k, v in self.options.items())])
        return "\n".join([head, *self.data])


def read(path: Path) -> list[Card]:
    """Cards of a deck, plain or compressed (.gz); comments are left out."""
    opener = gzip.open if path.suffix == ".gz" else open
    with opener(path, "rt", encoding="latin-1") as file:
        return list(_cards(file))


def _cards(lines: Iterable[str]) -> Iterator[Card]:
    head, data, start = "", [], 0
    for number, raw in enumerate(lines, 1):
        line = raw.strip()
        if not line or line.startswith("**"):
            continue
        if line.startswith("*") and not (head and head.rstrip().endswith(",") and not data):
            if head:
                yield _card(head, data, start)
            head, data, start = line, [], number
        elif head.rstrip().endswith(",") and not data:
            head += line  # a keyword line goes on after a comma
        else:
            data.append(line)
    if head:
        yield _card(head, data, start)


def _card(head: str, data: list[str], line: int) -> Card:
    name, *parts = (part.strip() for part in head[1:].split(","))
    options = {}
    for part in parts:
        key, _, value = part.partition("=")
        if key.strip():
            options[key.strip().upper()] = value.strip()
    return Card(" ".join(name.upper().split()), options, tuple(data), line)


@contextmanager
def plain(path: Path) -> Iterator[Path]:
    """The deck as a plain text file, while the context lasts."""
    if path.suffix != ".gz":
        yield path
        return
    with tempfile.TemporaryDirectory() as folder:
        result = Path(folder) / path.stem
        result.write_bytes(gzip.decompress(path.read_bytes()))
        yield result


def write(cards: Iterable[Card], path: Path) -> None:
    path.write_text("\n".join(card.text() for card in cards) + "\n", encoding="latin-1")

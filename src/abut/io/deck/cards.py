"""The lexer of Abaqus and CalculiX decks: cards with their parameters and data lines, each with its file and line."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable, Iterator, Mapping
from dataclasses import dataclass
from pathlib import Path

from abut.errors import InputError
from abut.io.deck.reasons import DeckError, Place, Reasons, UnknownName

DEEPEST = 20  # includes within includes


@dataclass(frozen=True)
class Line:
    """A data line: its fields between the commas, stripped; fields that are left out read as empty."""

    fields: tuple[str, ...]
    place: Place
    card: str

    def text(self, i: int) -> str:
        return self.fields[i] if i < len(self.fields) else ""

    def error(self, message: str) -> DeckError:
        return DeckError(self.place, f"{self.card}: {message}")

    def unknown(self, message: str) -> DeckError:
        return UnknownName(self.place, f"{self.card}: {message}")

    def number(self, i: int, what: str, default: float | None = None) -> float:
        """Field i as a finite number. Raises InputError for anything else, and where it is empty without a default."""
        text = self.text(i)
        if not text:
            if default is None:
                raise self.error(f"{what} is missing (entry {i + 1} of the line)")
            return default
        value = as_float(text)
        if value is None:
            raise self.error(f"{what}: expected a number, got {text!r}")
        return value

    def integer(self, i: int, what: str, default: int | None = None) -> int:
        """Field i as a whole number > 0. Raises InputError for anything else, and where it is empty without a default."""
        text = self.text(i)
        if not text and default is not None:
            return default
        value = as_integer(text)
        if value is None:
            raise self.error(f"{what}: expected a whole number > 0, got {text!r}")
        return value


@dataclass(frozen=True)
class Card:
    """A card: ``key`` is its name in capitals without blanks, ``title`` as people write it, with the star; parameters by
    name (capitals, no blanks), with None for those without a value."""

    key: str
    title: str
    parameters: Mapping[str, str | None]
    lines: tuple[Line, ...]
    place: Place

    def error(self, message: str) -> DeckError:
        return DeckError(self.place, f"{self.title}: {message}")

    def unknown(self, message: str) -> DeckError:
        return UnknownName(self.place, f"{self.title}: {message}")

    def refusal(self, message: str, option: str) -> DeckError:
        """option: what ``--ignore`` takes, "" where that makes no sense."""
        return DeckError(self.place, f"{self.title}: {message}", option)

    def get(self, name: str, default: str | None = None) -> str | None:
        """The value of a parameter, None where it is left out or has none."""
        value = self.parameters.get(key(name))
        return default if value is None else value

    def has(self, name: str) -> bool:
        return key(name) in self.parameters

    def need(self, name: str) -> str:
        """The value of a parameter. Raises InputError where it is missing."""
        value = self.get(name)
        if not value:
            raise self.error(f"parameter {name} is missing; write {self.title}, {name}=...")
        return value

    def first(self, what: str) -> Line:
        """The first data line. Raises InputError where there is none."""
        if not self.lines:
            raise self.unknown(f"its data line is missing: expected {what}")
        return self.lines[0]


def key(name: str) -> str:
    """Names of cards and parameters are the same in any case and with any blanks."""
    return "".join(name.upper().split())


def of(cards: Iterable[Card], name: str) -> Iterator[Card]:
    """The cards with a name."""
    wanted = key(name)
    return (card for card in cards if card.key == wanted)


def as_float(text: str) -> float | None:
    """A finite number as Fortran or C write it (1.d-3 too), or None."""
    try:
        value = float(text)
    except ValueError:
        try:
            value = float(text.upper().replace("D", "E"))
        except ValueError:
            return None
    return value if math.isfinite(value) and "_" not in text else None


def as_integer(text: str) -> int | None:
    """A whole number from 1 to 2^53, or None."""
    return int(text) if text.isascii() and text.isdigit() and len(text) < 16 and int(text) > 0 else None


Opens = Callable[[str, Mapping[str, str | None]], bool]


def read_cards(path: Path, opens: Opens, reasons: Reasons) -> tuple[Card, ...]:
    """All cards of a deck, includes in their place. ``opens``: whether a card, by key and parameters, has its data read from
    the file that INPUT names; ``reasons`` gets the files that do not exist.

    Raises InputError, with file and line, for a deck that cannot be read and lines that are neither card nor data.
    """
    cards: list[Card] = []
    head: tuple[str, str, dict[str, str | None], Place] | None = None
    data: list[Line] = []
    pending, begun = "", Place(str(path), 0)

    def close() -> None:
        nonlocal data
        if head is not None:
            cards.append(Card(head[0], head[1], head[2], tuple(data), head[3]))
        data = []

    for text, place in _lines(path, (), opens, reasons):
        if pending:  # the card goes on after a comma at the end of its line
            text = pending + text
            pending = ""
        elif text.startswith("*"):
            begun = place
        if text.startswith("*"):
            if text.endswith(","):
                pending = text
                continue
            close()
            head = (*_parse(text, begun), begun)
            continue
        if head is None:
            raise DeckError(place, "a data line before the first card; decks begin with a card such as *NODE")
        data.append(Line(_fields(text), place, head[1]))
    if pending:
        close()
        head = (*_parse(pending.rstrip(","), begun), begun)
    close()
    if not cards and not reasons.found:
        raise InputError(f"{path}: no card in the file; is it an Abaqus or CalculiX deck?")
    return tuple(cards)


def _parse(text: str, place: Place) -> tuple[str, str, dict[str, str | None]]:
    """Key, title and parameters of a card's line."""
    parts = _split(text.rstrip(","))
    name = parts[0].lstrip("*").strip()
    if not name:
        raise DeckError(place, "a star without the name of a card; comments begin with two stars")
    parameters: dict[str, str | None] = {}
    for part in parts[1:]:
        keyword, equals, value = part.partition("=")
        if not keyword.strip():
            continue
        value = value.replace('"', "").strip()
        parameters[key(keyword)] = value if equals else None
    return key(name), "*" + " ".join(name.upper().split()), parameters


def _fields(text: str) -> tuple[str, ...]:
    """Of a data line; names may stand in quotes, also those of instances: "a b".SET."""
    if '"' not in text:
        return tuple(part.strip() for part in text.split(","))
    return tuple(part.replace('"', "").strip() for part in _split(text))


def _split(text: str) -> list[str]:
    """At commas outside quotes."""
    parts, inside = [""], False
    for letter in text:
        if letter == '"':
            inside = not inside
        if letter == "," and not inside:
            parts.append("")
        else:
            parts[-1] += letter
    return parts


def _lines(path: Path, above: tuple[Path, ...], opens: Opens, reasons: Reasons) -> Iterator[tuple[str, Place]]:
    """Lines that say something, those of included files in their place."""
    pending = card = ""  # a card to include from may go on over several lines, as any other
    for number, raw in enumerate(_text(path).splitlines(), start=1):
        text = raw.strip()
        place = Place(str(path), number)
        if not text or text.startswith("**"):
            continue
        if pending or (text.startswith("*") and key(text[1:8]) == "INCLUDE"):
            pending += text
            if not pending.endswith(","):
                name, title, parameters = _parse(pending, place)
                pending = ""
                if name != "INCLUDE" or not parameters.get("INPUT"):
                    raise DeckError(place, f"{title}: the file is missing; write *INCLUDE, INPUT=file")
                yield from _included(path, str(parameters["INPUT"]), place, above, opens, reasons)
            continue
        yield text, place
        if card or text.startswith("*"):
            card += text
        if card and not card.endswith(","):
            if "INPUT" in key(card):
                name, _, parameters = _parse(card, place)
                if parameters.get("INPUT") and opens(name, parameters):
                    yield from _included(path, str(parameters["INPUT"]), place, above, opens, reasons)
            card = ""


def _included(
    path: Path, file: str, place: Place, above: tuple[Path, ...], opens: Opens, reasons: Reasons
) -> Iterator[tuple[str, Place]]:
    inner = path.parent / file
    if inner in (*above, path) or len(above) >= DEEPEST:
        raise DeckError(place, f"the file {file} includes itself; take the *INCLUDE out")
    if not inner.is_file():
        missing = DeckError(place, f"included file {inner} does not exist")
        reasons.add(missing, defines=True)
        return
    yield from _lines(inner, (*above, path), opens, reasons)


def _text(path: Path) -> str:
    try:
        data = path.read_bytes()
    except OSError as error:
        raise InputError(f"cannot read deck {path}: {error.strerror}") from None
    if b"\0" in data:
        raise InputError(f"{path}: not a text file; is it an Abaqus or CalculiX deck?")
    return data.decode("latin-1")

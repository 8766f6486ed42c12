"""The lexer of Abaqus and CalculiX decks: cards with their parameters and data lines, each with its file and line."""

from __future__ import annotations

import codecs
import math
import re
from collections.abc import Callable, Iterable, Iterator, Mapping
from dataclasses import dataclass
from pathlib import Path

from abut.errors import InputError
from abut.io.deck.reasons import DeckError, Place, Reasons, UnknownName
from abut.io.names import is_file

DEEPEST = 20  # includes within includes
FLAGS = frozenset(  # parameters without a value, by which a line shows that it goes on with its card
    (
        "ADJUST",
        "ALLEXTERIOR",
        "CONTINUE",
        "CYCLICSYMMETRY",
        "DIRECT",
        "GENERATE",
        "INTERNAL",
        "LAGRANGE",
        "MOONEY-RIVLIN",
        "NEOHOOKE",
        "NLGEOM",
        "NODALTHICKNESS",
        "NOSEPARATION",
        "NOTHICKNESS",
        "PERTURBATION",
        "ROUGH",
        "SMALLSLIDING",
        "STABILIZE",
        "TIMERESET",
        "UNSORTED",
    )
)
LONGEST_FLAG = 40  # characters of a line in which one would stand

LONGEST_NUMBER = 60  # characters
_LINE_END = re.compile("\r\n|\r|\n")  # not all that str.splitlines takes: a byte of Windows' three dots is among it
_FORTRAN = re.compile(r"([+-]?(?:[0-9]+\.?[0-9]*|\.[0-9]+))(?:[dD]|(?=[+-]))([+-]?[0-9]+)")


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
    """A finite number as Fortran or C write it (1.d-3 too, and 2.1+5 for 2.1e5), or None."""
    try:
        value = float(text)
    except ValueError:
        fortran = _FORTRAN.fullmatch(text) if len(text) <= LONGEST_NUMBER else None
        if fortran is None:
            return None
        value = float(f"{fortran[1]}e{fortran[2]}")
    return value if math.isfinite(value) and "_" not in text else None


def as_integer(text: str) -> int | None:
    """A whole number from 1 to 2^53, or None."""
    return int(text) if text.isascii() and text.isdigit() and len(text) < 16 and int(text) > 0 else None


TEXT = "HEADING"
Opens = Callable[[str, Mapping[str, str | None]], bool]


def read_cards(path: Path, opens: Opens, reasons: Reasons) -> tuple[Card, ...]:
    """All cards of a deck, includes in their place. ``opens``: whether a card, by key and parameters, has its data read from
    the file that INPUT names; ``reasons`` gets the files that do not exist.

    Raises InputError, with file and line, for a deck that cannot be read and lines that are neither card nor data.
    """
    cards: list[Card] = []
    head: tuple[str, str, dict[str, str | None], Place] | None = None
    data: list[Line] = []
    pending: list[str] = []  # lines of a card that has not ended yet
    begun = Place(str(path), 0)

    def close() -> None:
        nonlocal data, head
        if pending:
            head = (*_parse("".join(pending).rstrip(","), begun), begun)
            pending.clear()
        if head is not None and (head[0] or data):
            if not head[0]:
                raise DeckError(head[3], "a star without the name of a card; comments begin with two stars")
            cards.append(Card(head[0], head[1], head[2], tuple(data), head[3]))
        head, data = None, []

    for text, place in _lines(path, (), opens, reasons):
        if pending and pending[-1].endswith(",") and _goes_on(text):
            pending.append(text)
            continue
        if text.startswith("*"):
            close()
            pending.append(text)
            begun = place
            continue
        if pending:
            head = (*_parse("".join(pending).rstrip(","), begun), begun)
            pending.clear()
        if head is None and not text[0].isalpha() and text[0] != ">":
            raise DeckError(place, "a data line before the first card; decks begin with a card such as *NODE")
        head = head or ("HEADING", "text before the first card", {}, place)  # which CalculiX passes over
        data.append(Line(_fields(text), place, head[1]))
    close()
    if not cards and not reasons.found:
        raise InputError(f"{path}: no card in the file; is it an Abaqus or CalculiX deck?")
    return tuple(cards)


def _parse(text: str, place: Place) -> tuple[str, str, dict[str, str | None]]:
    """Key, title and parameters of a card's line; no key for a star alone. A comma may be missing after the name."""
    parts = _split(text.rstrip(","))
    name = parts[0].lstrip("*").strip()
    if key(name[: len(TEXT)]) == TEXT:  # and what stands behind it is text
        name = TEXT
    if "=" in name:  # *EXPANSION TYPE=ISO
        before, _, value = name.partition("=")
        *words, keyword = before.split()
        name, parts[1:1] = " ".join(words), [f"{keyword}={value}"]
        if not name:
            raise DeckError(place, f"{text.strip()}: a parameter in place of the name of a card; write the name first")
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
    parts: list[list[str]] = [[]]
    for i, piece in enumerate(text.split('"')):
        if i:
            parts[-1].append('"')
        if i % 2:
            parts[-1].append(piece)
            continue
        first, *rest = piece.split(",")
        parts[-1].append(first)
        parts += [[each] for each in rest]
    return ["".join(part) for part in parts]


def _goes_on(text: str) -> bool:
    """Whether a line after a card that ends in a comma has more of its parameters. CalculiX writes such commas before data
    lines as well."""
    first = text.partition(",")[0]
    return "=" in first or key(first[:LONGEST_FLAG]) in FLAGS


def _lines(path: Path, above: tuple[Path, ...], opens: Opens, reasons: Reasons) -> Iterator[tuple[str, Place]]:
    """Lines that say something, those of included files in their place."""
    card: list[str] = []  # lines of a card that may go on, which may include a file
    begun = Place(str(path), 0)
    for number, raw in enumerate(_LINE_END.split(_text(path)), start=1):
        text = raw.strip()
        if not text or text.startswith("**"):
            continue
        place = Place(str(path), number)
        if card and not (card[-1].endswith(",") and _goes_on(text)):
            yield from _of_card(path, card, begun, above, opens, reasons)
            card = []
        if text.startswith("*"):
            card, begun = [text], place
        elif card:
            card.append(text)
        if not _includes(card):
            yield text, place
    if card:
        yield from _of_card(path, card, begun, above, opens, reasons)


def _includes(card: list[str]) -> bool:
    return bool(card) and key(card[0][1:8]) == "INCLUDE"


def _of_card(
    path: Path, card: list[str], place: Place, above: tuple[Path, ...], opens: Opens, reasons: Reasons
) -> Iterator[tuple[str, Place]]:
    """Lines of the file that a card names: in place of *INCLUDE, or the data of another one."""
    text = "".join(card)
    if _includes(card):
        name, title, parameters = _parse(text, place)
        if name != "INCLUDE" or not parameters.get("INPUT"):
            raise DeckError(place, f"{title}: the file is missing; write *INCLUDE, INPUT=file")
    elif "INPUT" in key(text):
        name, _, parameters = _parse(text, place)
        if not (parameters.get("INPUT") and opens(name, parameters)):
            return
    else:
        return
    yield from _included(path, str(parameters["INPUT"]), place, above, opens, reasons)


def _included(
    path: Path, file: str, place: Place, above: tuple[Path, ...], opens: Opens, reasons: Reasons
) -> Iterator[tuple[str, Place]]:
    """A file is looked for beside the deck, as CalculiX does it, then beside the file that includes it."""
    first = (*above, path)[0].parent / file
    inner = path.parent / file if not is_file(first) and is_file(path.parent / file) else first
    if inner in (*above, path) or len(above) >= DEEPEST:
        raise DeckError(place, f"the file {file} includes itself; take the *INCLUDE out")
    if not is_file(inner):
        missing = DeckError(place, f"included file {inner} does not exist")
        reasons.add(missing, defines=True)
        return
    yield from _lines(inner, (*above, path), opens, reasons)


def _text(path: Path) -> str:
    try:
        data = path.read_bytes()
    except OSError as error:
        raise InputError(f"cannot read deck {path}: {error.strerror}") from None
    if data.startswith(b"\x1f\x8b"):
        raise InputError(f"{path}: packed by gzip; unpack it first (gunzip {path.name})")
    if b"\0" in data:
        raise InputError(f"{path}: not a text file; is it an Abaqus or CalculiX deck?")
    return data.removeprefix(codecs.BOM_UTF8).decode("latin-1")

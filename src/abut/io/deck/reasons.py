"""All errors of a deck, collected so that they are reported at once."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass, field

from abut.errors import InputError

MOST = 20  # reasons that a message holds; a deck with more is wrong from the ground up


@dataclass(frozen=True)
class Place:
    """Where something stands."""

    file: str
    line: int

    def __str__(self) -> str:
        return f"{self.file}:{self.line}"


class DeckError(InputError):
    """What is wrong at a place of a deck. option: what ``--ignore`` takes to solve without it, "" where that makes no
    sense."""

    def __init__(self, place: Place, text: str, option: str = "") -> None:
        super().__init__(f"{place}: {text}")
        self.place, self.text, self.option = place, text, option


class UnknownName(DeckError):
    """A name or number that stands for nothing, or for nothing yet."""


@dataclass
class Reasons:
    """found: errors so far; incomplete: whether something failed that others refer to, so that unknown names may be but a
    consequence of it."""

    found: list[DeckError] = field(default_factory=list)
    incomplete: bool = False

    def add(self, error: DeckError, defines: bool = False) -> None:
        if str(error) not in {str(earlier) for earlier in self.found}:
            self.found.append(error)
        self.incomplete |= defines

    @contextmanager
    def gathered(self, defines: bool = False) -> Iterator[None]:
        """Go on after an error inside. ``defines``: whether other cards refer to what is read inside."""
        try:
            yield
        except DeckError as error:
            self.add(error, defines)

    def tell(self) -> None:
        """Raise InputError for all that was found, in the order of the deck, if anything was."""
        left = [e for e in self.found if not (self.incomplete and isinstance(e, UnknownName))] or self.found
        if not left:
            return
        files = list(dict.fromkeys(error.place.file for error in left))
        left.sort(key=lambda error: (files.index(error.place.file), error.place.line))
        texts, file = [], ""
        for error in left[:MOST]:
            at = f"line {error.place.line}" if error.place.file == file else str(error.place)
            texts.append(f"{at}: {error.text}")
            file = error.place.file
        if len(left) > MOST:
            texts.append(f"and {len(left) - MOST} more")
        raise InputError("\n  ".join(texts) + _cure(left))


def _cure(errors: list[DeckError]) -> str:
    if not all(error.option for error in errors):
        return ""
    options = " ".join(
        f'--ignore "{option}"' if " " in option else f"--ignore {option}"
        for option in dict.fromkeys(e.option for e in errors)
    )
    return f"; to solve without {'it' if len(errors) == 1 else 'them'}: {options}"

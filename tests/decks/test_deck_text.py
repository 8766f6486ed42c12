"""Decks as text: ends of lines and of cards, numbers, included files, bytes that are no words."""

from __future__ import annotations

import time
from pathlib import Path

import pytest

import abut
from abut.cli import main
from abut.errors import InputError
from abut.io.deck.cards import as_float
from abut.job.load import load_job
from models.decks import BRICKS, HELD, PAIR, PUSH, load, write

DECK = BRICKS + PAIR + HELD + PUSH


@pytest.mark.parametrize(
    ("text", "value"),
    [("2.1+5", 2.1e5), ("-2.1-2", -2.1e-2), (".5+1", 5.0), ("1+2", 100.0), ("1.D3", 1e3), ("1d-3", 1e-3), ("1.d+3", 1e3),
     ("1.5", 1.5), ("+2.e1", 20.0), ("1-", None), ("1+-2", None), ("d3", None), ("1 2", None), ("1_0", None),
     ("nan", None), ("1e999", None), ("--1", None), ("9" * 10_000, None)],
)  # fmt: skip
def test_numbers_as_fortran_writes_them(text: str, value: float | None) -> None:
    """With D, or without a letter before the exponent, as CalculiX reads them."""
    assert as_float(text) == value


@pytest.mark.parametrize("card", ["*BOUNDARY", "*STATIC", "*NODE, NSET=ALL", "*DLOAD", "*CONTACT PAIR, INTERACTION=I"])
def test_a_comma_after_the_parameters(card: str, tmp_path: Path) -> None:
    """A data line follows all the same, as in CalculiX; a line of parameters goes on with the card."""
    text = DECK.replace("*CONTACT PAIR, INTERACTION=I, TYPE=SURFACE TO SURFACE", "*CONTACT PAIR, INTERACTION=I")
    assert abut.solve(load(tmp_path, text.replace(card, f"{card},", 1)).model).contacts[0].force[2] == pytest.approx(
        10.0
    )


def test_cards_of_several_lines(tmp_path: Path) -> None:
    text = DECK.replace("*NODE, NSET=ALL", "*NODE,\n NSET=ALL").replace(", GENERATE", ",\nGENERATE")
    text = text.replace("*CONTACT PAIR, ", "*CONTACT PAIR,\n** between\n\n").replace(" TYPE=SURF", "\nTYPE=SURF")
    assert abut.solve(load(tmp_path, text).model).contacts[0].force[2] == pytest.approx(10.0)


def parts(text: str) -> tuple[str, str]:
    nodes, _, rest = text.partition("*ELEMENT")
    return nodes, "*ELEMENT" + rest


@pytest.mark.parametrize("where", [".", "mesh"])
def test_included_files_that_include_others(where: str, tmp_path: Path) -> None:
    """They are looked for beside the deck, as CalculiX does it, then beside the file that names them."""
    nodes, rest = parts(DECK)
    (tmp_path / "mesh").mkdir()
    (tmp_path / "mesh" / "outer.inp").write_text("*INCLUDE, INPUT=inner.inp\n")
    (tmp_path / "mesh" / "inner.inp").write_text("*NODE\n1, 0,0,0\n")  # where both exist, that beside the deck counts
    (tmp_path / where / "inner.inp").write_text(nodes)
    assert len(load(tmp_path, '*INCLUDE, INPUT="mesh/outer.inp"\n' + rest).model.mesh.points) == 16


def test_a_byte_order_mark(tmp_path: Path) -> None:
    path = tmp_path / "deck.inp"
    path.write_bytes(b"\xef\xbb\xbf" + DECK.encode())
    assert load_job(path).model.contacts
    nodes, rest = parts(DECK)
    (tmp_path / "nodes.inp").write_bytes(b"\xef\xbb\xbf" + nodes.encode())
    assert load(tmp_path, "*INCLUDE, INPUT=nodes.inp\n" + rest).model.contacts
    job = tmp_path / "job.toml"
    job.write_bytes(b"\xef\xbb\xbfschema = 2\n")
    with pytest.raises(abut.InputError, match="schema: expected 1, got 2"):
        load_job(job)


def test_bytes_of_windows_in_comments(tmp_path: Path) -> None:
    """Three dots are one byte there, which ends lines elsewhere."""
    path = tmp_path / "deck.inp"
    path.write_bytes(b"** bodies \x85 and more\r\n" + DECK.replace("\n", "\r\n").encode())
    assert load_job(path).model.contacts


@pytest.mark.long
@pytest.mark.parametrize(
    "line",
    ["*NODE" + ", X" * 300_000, "*" + "N" * 1_000_000, "BAD," * 250_000, "A" * 1_000_000 + ", 1, 3", '"' * 1_000_000,
     "*NSET, NSET=A,\n" + "B=1,\n" * 200_000, "1" * 1_000_000, "1.+" * 300_000],
    ids=["parameters", "card", "fields", "name", "quotes", "lines", "digits", "signs"],
)  # fmt: skip
def test_lines_of_a_million_characters(line: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    """Refused within seconds, with a message that can be read."""
    path = write(tmp_path, DECK.replace("*BOUNDARY\n", f"*BOUNDARY\n{line}\n"))
    begin = time.perf_counter()
    assert main(["check", str(path)]) == 2
    assert main(["run", str(path), "--output", str(tmp_path / "out")]) == 2
    assert time.perf_counter() - begin < 20.0
    said = capsys.readouterr()
    assert len(said.out + said.err) < 100_000


@pytest.mark.parametrize("steering", ["\x1b[2J\x1b]0;title\x07", "\x9b31m", "\u202e"])
def test_names_do_not_steer_the_terminal(
    steering: str, tmp_path: Path, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    path = tmp_path / "deck.inp"
    for text, status in ((DECK.replace("SLAVE", f"S{steering}E"), 0), (DECK.replace("*STATIC", f"*ST{steering}"), 2)):
        path.write_text(text, encoding="utf-8")
        assert main(["run", str(path), "--output", str(tmp_path / "out")]) == status
        assert main(["check", str(path)]) == status
    job = tmp_path / "job.toml"
    escaped = "".join(f"\\u{ord(letter):04x}" for letter in steering)
    job.write_text(f'schema = 1\n["{escaped}"]\nx = 1\n', encoding="utf-8")
    assert main(["run", str(job)]) == 2
    said = capsys.readouterr()
    words = said.out + said.err
    assert not set(words) & set("\x1b\x07\x9b\u202e")
    assert "\\x" in words or "\\u" in words


@pytest.mark.parametrize(
    ("given", "instead"),
    [
        ("*ELASTIC", "*ELASTIC TYPE=ISO"),  # no comma behind the name
        ("*NODE, NSET=ALL", "*HEADING NL1\n*NODE, NSET=ALL"),
        ("*NODE, NSET=ALL", "*\n*NODE, NSET=ALL"),
        ("*BOUNDARY", "*BOUNDARY, NAME=foot"),
    ],
)
def test_cards_as_people_write_them(given: str, instead: str, tmp_path: Path) -> None:
    wanted, found = (load(tmp_path, text).model for text in (DECK, DECK.replace(given, instead, 1)))
    assert (found.solids, found.supports, found.contacts) == (wanted.solids, wanted.supports, wanted.contacts)


def test_a_parameter_in_place_of_a_card(tmp_path: Path) -> None:
    with pytest.raises(InputError, match="a parameter in place of the name of a card"):
        load(tmp_path, DECK.replace("*ELASTIC", "*TYPE=ISO", 1))

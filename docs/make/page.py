"""Tables in hand-written pages: written by the scripts here, between markers, and read back by a test."""

from __future__ import annotations

import math
import re
from collections.abc import Sequence
from pathlib import Path

DOCS = Path(__file__).resolve().parents[1]


def write_table(page: Path, name: str, header: Sequence[str], rows: Sequence[Sequence[str]]) -> None:
    """Replace what stands between ``<!-- begin table NAME -->`` and ``<!-- end table -->``."""
    lines = [header, ["---"] * len(header), *rows]
    write_marked(page, name, "".join(f"| {' | '.join(line)} |\n" for line in lines))


def write_marked(page: Path, name: str, content: str) -> None:
    """Replace what stands between the same markers by text."""
    text = page.read_text(encoding="utf-8")
    new, count = _marked(name).subn(lambda m: f"{m[1]}\n{content}{m[3]}", text)
    if count != 1:
        raise SystemExit(f"{page}: expected one place marked 'begin table {name}', found {count}")
    page.write_text(new, encoding="utf-8")


def read_table(page: Path, name: str) -> list[dict[str, str]]:
    """Rows of a table by column heading."""
    lines = read_marked(page, name).strip().split("\n")
    header, _, *rows = ([cell.strip() for cell in line.strip("|").split("|")] for line in lines)
    return [dict(zip(header, row)) for row in rows]


def read_marked(page: Path, name: str) -> str:
    """What stands between the markers of that name."""
    found = _marked(name).search(page.read_text(encoding="utf-8"))
    if found is None:
        raise ValueError(f"{page}: no table {name}")
    return found[2]


def _marked(name: str) -> re.Pattern[str]:
    return re.compile(rf"(<!-- begin table {re.escape(name)} -->)\n(.*?)(<!-- end table -->)", re.DOTALL)


ROUNDING = 1e-10  # an error below is that of rounding: its digits depend on the machine


def error(value: float, rounding: float = ROUNDING) -> str:
    """An error to two digits; below ``rounding`` only that."""
    return f"< {rounding:.0e}" if value < rounding else f"{value:.1e}"


def agrees(printed: str, value: float) -> bool:
    """Whether a value is what a page prints, to the printed digits (and a tenth of the last one, for rounding)."""
    if printed.startswith("<"):
        return value < float(printed[1:])
    number = printed.rstrip("%").strip()
    mantissa, _, exponent = number.partition("e")
    digit = 10.0 ** (int(exponent or 0) - len(mantissa.partition(".")[2]))
    return math.isfinite(value) and abs(float(number) - value) <= 0.6 * digit


def plots() -> object:
    """matplotlib, set up for small pictures that come out the same each time."""
    import matplotlib

    matplotlib.use("Agg")
    matplotlib.rcParams.update({"svg.fonttype": "none", "svg.hashsalt": "abut", "font.size": 9, "axes.grid": True})
    matplotlib.rcParams.update({"grid.alpha": 0.3, "axes.axisbelow": True})
    import matplotlib.pyplot as plt

    return plt


def save(figure: object, name: str) -> None:
    figure.savefig(DOCS / "pictures" / name, metadata={"Date": None})  # type: ignore[attr-defined]

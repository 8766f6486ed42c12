"""From records of runs to tables, fitted exponents and pages. A record is a dictionary as in Row."""

from __future__ import annotations

import math
from collections.abc import Iterable, Sequence
from pathlib import Path
from typing import TypedDict

DIFFERENT = 0.01  # relative difference of the contact force to abut's that is called a different answer
BEGIN, END = "<!-- begin table -->", "<!-- end table -->"
HEAD = (
    "case",
    "dofs",
    "cores",
    "code",
    "runs",
    "time s",
    "peak MB",
    "iterations",
    "force N",
    "to abut",
    "/ abut",
    "/ linear",
    "",
)


class Row(TypedDict, total=False):
    """One code on one mesh and so many cores; medians over ``runs``; times in seconds."""

    case: str
    dofs: int
    cores: int
    code: str
    status: str
    runs: int
    seconds: float
    wall: float
    cpu: float
    peak_mb: float
    iterations: int
    force: float
    stages: dict[str, float]
    solver: str


def cores(number: int) -> str:
    """Cores in words."""
    return f"{number} core{'s' * (number > 1)}"


def spaced(number: int) -> str:
    """A whole number with spaces between thousands."""
    return f"{number:,}".replace(",", " ")


def ordered(rows: Iterable[Row], cases: Sequence[str], codes: Sequence[str]) -> list[Row]:
    """The last row of every case, size, number of cores and code, in that order."""
    last = {(cases.index(r["case"]), r["dofs"], r["cores"], codes.index(r["code"])): r for r in rows}
    return [last[key] for key in sorted(last)]


def _partner(rows: Iterable[Row], row: Row, code: str) -> Row | None:
    """The sound run of another code on the same mesh and as many cores."""
    for other in rows:
        same = all(other[key] == row[key] for key in ("case", "dofs", "cores"))
        if same and other["code"] == code and other["status"] == "ok":
            return other
    return None


def difference(rows: Sequence[Row], row: Row) -> float | None:
    """Relative difference of the contact force to abut's; None where there is nothing to compare."""
    reference = _partner(rows, row, "abut")
    if row["code"] in ("abut", "abut-tied") or "force" not in row or reference is None:
        return None
    return row["force"] / reference["force"] - 1.0


def verdict(rows: Sequence[Row], row: Row) -> str:
    """The row's status, or that its answer is another one."""
    off = difference(rows, row)
    if row["status"] == "ok":
        return "" if off is None or abs(off) < DIFFERENT else "different answer"
    return row["status"]


def cells(rows: Sequence[Row], row: Row) -> list[str]:
    """One line of the table as text."""

    def show(value: float | None, form: str) -> str:
        return "-" if value is None else format(value, form)

    def ratio(code: str) -> float | None:
        other = _partner(rows, row, code)
        return row["seconds"] / other["seconds"] if other is not None and sound else None

    sound = row["status"] == "ok"
    return [
        row["case"],
        spaced(row["dofs"]),
        str(row["cores"]),
        row["code"],
        show(row.get("runs") if sound else None, "d"),
        show(row.get("seconds") if sound else None, ".3g"),
        show(row.get("peak_mb"), ".0f"),
        show(row.get("iterations"), "d"),
        show(row.get("force"), ".1f"),
        show(difference(rows, row), "+.2%").replace("-0.00", "+0.00"),
        show(ratio("abut"), ".2f"),
        show(ratio("abut-tied"), ".2f"),
        verdict(rows, row),
    ]


def exponents(rows: Sequence[Row]) -> list[tuple[str, str, int, float]]:
    """(case, code, cores, exponent of time against dofs) by least squares in logarithms, from two sizes on."""
    groups: dict[tuple[str, str, int], list[Row]] = {}
    for row in rows:
        if row["status"] == "ok":
            groups.setdefault((row["case"], row["code"], row["cores"]), []).append(row)
    result = []
    for (case, code, cores), own in groups.items():
        x = [math.log(row["dofs"]) for row in own]
        y = [math.log(row["seconds"]) for row in own]
        mean_x, mean_y = sum(x) / len(x), sum(y) / len(y)
        spread = sum((a - mean_x) ** 2 for a in x)
        if spread > 0.0:
            result.append((case, code, cores, sum((a - mean_x) * (b - mean_y) for a, b in zip(x, y)) / spread))
    return result


def exponent_table(rows: Sequence[Row]) -> list[list[str]]:
    """Exponents as a table: a line for a case and code, a column for each number of cores."""
    every = sorted({row["cores"] for row in rows})
    found = {(case, code, n): value for case, code, n, value in exponents(rows)}
    lines = [["case", "code", *map(cores, every)]]
    for case, code in dict.fromkeys((case, code) for case, code, _ in found):
        values = [found.get((case, code, n)) for n in every]
        lines.append([case, code, *("-" if v is None else f"{v:.2f}" for v in values)])
    return lines


def stage_table(rows: Sequence[Row]) -> list[list[str]]:
    """Seconds of abut's contact runs by stage."""
    own = [row for row in rows if row["code"] == "abut" and row["status"] == "ok" and "stages" in row]
    stages = list(dict.fromkeys(name for row in own for name in row["stages"]))
    lines = [["case", "dofs", "cores", *stages]]
    for row in own:
        values = [f"{row['stages'].get(name, 0.0):.3g}" for name in stages]
        lines.append([row["case"], spaced(row["dofs"]), str(row["cores"]), *values])
    return lines


def markdown(lines: Sequence[Sequence[str]]) -> str:
    """A Markdown table; the first line is its head."""
    text = ["| " + " | ".join(line) + " |" for line in lines]
    return "\n".join([text[0], "|" + "---|" * len(lines[0]), *text[1:]])


def plain(lines: Sequence[Sequence[str]]) -> str:
    """The same for a terminal, columns aligned."""
    widths = [max(len(line[i]) for line in lines) for i in range(len(lines[0]))]
    return "\n".join("  ".join(cell.ljust(width) for cell, width in zip(line, widths)).rstrip() for line in lines)


def table(rows: Sequence[Row]) -> list[list[str]]:
    """Head and all lines."""
    return [list(HEAD), *(cells(rows, row) for row in rows)]


def overview(rows: Sequence[Row]) -> list[list[str]]:
    """A line for a mesh and number of cores: abut's contact in seconds and MB, and the times of the others over it."""
    others = [code for code in dict.fromkeys(row["code"] for row in rows) if code != "abut"]
    lines = [["case", "dofs", "cores", "abut s", "MB", *others]]
    for own in rows:
        if own["code"] == "abut" and own["status"] == "ok":
            times = [_times(rows, own, code) for code in others]
            lines.append([*cells(rows, own)[:3], f"{own['seconds']:.3g}", f"{own['peak_mb']:.0f}", *times])
    return lines


def _times(rows: Iterable[Row], own: Row, code: str) -> str:
    """The time of another code over abut's on the same mesh; at least so much where it ran out of time."""
    for row in rows:
        if row["code"] == code and all(row[key] == own[key] for key in ("case", "dofs", "cores")):
            if row["status"].startswith("time limit"):
                return f"> {row['wall'] / own['seconds']:.0f}"
            if row["status"] == "ok":
                off = difference([own], row)
                return f"{row['seconds'] / own['seconds']:.2f}" + "*" * (off is not None and abs(off) >= DIFFERENT)
            return "memory" if row["status"].startswith("memory limit") else "-"
    return ""


def _where(machine: str, versions: dict[str, str]) -> str:
    return f"{machine}. {', '.join(f'{name} {version}' for name, version in versions.items())}."


def page(rows: Sequence[Row], machine: str, versions: dict[str, str]) -> str:
    """What stands between the markers of the docs page: machine, versions, overview, exponents."""
    return "\n\n".join(
        [
            _where(machine, versions),
            "abut's contact, and how many times as long the others take (-: failed or not run; \\*: another answer):",
            markdown(overview(rows)),
            "Exponents of time against dofs:",
            markdown(exponent_table(rows)),
        ]
    )


def all_runs(rows: Sequence[Row], machine: str, versions: dict[str, str]) -> str:
    """The page with a table of its own for every case, and the stages of abut's runs."""
    parts = ["# Every run", f"{_where(machine, versions)} What is measured says [time and memory](performance.md)."]
    head, *lines = table(rows)
    for case in dict.fromkeys(row["case"] for row in rows):
        parts += [f"## {case}", markdown([head[1:], *(line[1:] for line in lines if line[0] == case)])]
    return "\n\n".join([*parts, "## Seconds of abut's contact runs by stage", markdown(stage_table(rows))]) + "\n"


def put_into(file: Path, text: str) -> None:
    """Replace what stands between the markers of a page. Raises ValueError where they are missing."""
    before, begin, rest = file.read_text(encoding="utf-8").partition(BEGIN)
    _, end, after = rest.partition(END)
    if not begin or not end:
        raise ValueError(f"{file}: no {BEGIN} and {END}")
    file.write_text(f"{before}{BEGIN}\n\n{text}\n\n{END}{after}", encoding="utf-8")

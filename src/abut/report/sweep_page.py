"""Runs of one job with different parameters, as a table (CSV) and a page that compares them."""

from __future__ import annotations

import csv
import io
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from html import escape
from pathlib import Path
from urllib.parse import quote

from abut.report.svg import Series, plot

STATIC = Path(__file__).parent / "static"
COLOURS = ("accent", "second", "third", "bad", "good")
DASHES = ("", "6 3", "2 3")


@dataclass(frozen=True)
class Run:
    """One run: its parameters, its folder beside the page, how it ended in words, the certificate's verdict ("" without one)
    and its results by name."""

    parameters: Mapping[str, float]
    folder: str
    status: str
    verdict: str = ""
    results: Mapping[str, float] = field(default_factory=dict)


def result_names(runs: Sequence[Run]) -> list[str]:
    """Of all runs, in their order."""
    return list(dict.fromkeys(name for run in runs for name in run.results))


def sweep_csv(runs: Sequence[Run]) -> str:
    """A line of names, and one for each run: parameters, status, certificate, folder, results (empty where none is)."""
    names, results = list(runs[0].parameters), result_names(runs)
    text = io.StringIO()
    table = csv.writer(text, lineterminator="\n")
    table.writerow([*names, "status", "certificate", "folder", *results])
    for run in runs:
        values = [repr(run.results[name]) if name in run.results else "" for name in results]
        table.writerow([*(repr(run.parameters[n]) for n in names), run.status, run.verdict, run.folder, *values])
    return text.getvalue()


def sweep_page(title: str, runs: Sequence[Run]) -> str:
    """A page without scripts: every run with its parameters, verdict, results and a link to its report, and a plot of each
    result over the first parameter that has several values, a line for each combination of the others."""
    names, results = list(runs[0].parameters), result_names(runs)
    style = "".join((STATIC / name).read_text(encoding="utf-8") for name in ("report.css", "still.css"))
    head = "".join(f"<th>{escape(text)}</th>" for text in (*names, "status", "certificate", "report", *results))
    rows = "".join(f"<tr>{''.join(f'<td>{cell}</td>' for cell in _cells(run, names, results))}</tr>" for run in runs)
    plots = "".join(_plot(name, runs, names) for name in results)
    return (
        f'<!doctype html><html lang="en"><meta charset="utf-8"><title>{escape(title)}</title><style>{style}</style>'
        f'<main class="still"><h1>{escape(title)}</h1>'
        f'<div style="overflow-x:auto"><table><thead><tr>{head}</tr></thead><tbody>{rows}</tbody></table></div>'
        f'<div class="plots">{plots}</div></main></html>\n'
    )


def _cells(run: Run, names: Sequence[str], results: Sequence[str]) -> list[str]:
    link = f'<a href="{quote(run.folder)}/report.html">{escape(run.folder)}</a>' if run.verdict else ""
    values = [f"{run.results[name]:.6g}" if name in run.results else "" for name in results]
    return [*(f"{run.parameters[n]:.6g}" for n in names), escape(run.status), escape(run.verdict), link, *values]


def _plot(name: str, runs: Sequence[Run], names: Sequence[str]) -> str:
    """Empty where nothing changes or nothing is known."""
    several = [n for n in names if len({run.parameters[n] for run in runs}) > 1]
    if not several or sum(name in run.results for run in runs) < 2:
        return ""
    along, others = several[0], several[1:]
    x = sorted({run.parameters[along] for run in runs})
    lines: dict[tuple[float, ...], dict[float, float]] = {}
    for run in runs:
        if name in run.results:
            lines.setdefault(tuple(run.parameters[n] for n in others), {})[run.parameters[along]] = run.results[name]
    series = [
        Series(
            ", ".join(f"{n} = {value:g}" for n, value in zip(others, key)) or name, [line.get(place) for place in x],
            COLOURS[i % len(COLOURS)], DASHES[i // len(COLOURS) % len(DASHES)],
        )
        for i, (key, line) in enumerate(lines.items())
    ]  # fmt: skip
    return plot(name, along, x, series)

"""Probes in the output directory: a table for each, and its values in summary.json and history.csv."""

from __future__ import annotations

import csv
import io
from collections.abc import Sequence

import numpy as np

from abut.io.names import file_labels
from abut.model.step_choice import StepChoice, chosen
from abut.probing.table import columns, peaks
from abut.solution import ProbeResult, Step
from abut.types import Json


def table_names(probes: Sequence[str]) -> list[str]:
    """The files of a model's probes, by their names."""
    return [f"probe_{label}.csv" for label in file_labels(probes)]


def table(steps: Sequence[Step], number: int, of: StepChoice = "all") -> str:
    """All values of probe ``number`` of the model as CSV: a row for each of the steps ``of`` and each point; empty where
    there is no value."""
    text = io.StringIO()
    rows = csv.writer(text, lineterminator="\n")
    shown = [step for step in steps if chosen(of, step.number, step is steps[-1])]
    for step in shown:
        result = step.probes[number]
        place = _place(result)
        entries = {**place, **columns(result)}
        if step is shown[0]:
            rows.writerow(["step", "factor", "converged", *entries])
        head = [step.number, step.factor, int(step.converged)]
        listed = zip(*(values.tolist() for values in entries.values()))
        rows.writerows([*head, *("" if value != value else value for value in row)] for row in listed)
    return text.getvalue()


def _place(result: ProbeResult) -> Json:
    """Columns that say which point it is."""
    rows: Json = {"point": np.arange(1, len(result.points) + 1)}
    if result.nodes is not None:
        rows["node"] = result.nodes
    if result.distance is not None:
        rows["distance"] = result.distance
    return rows | dict(zip("xyz", result.points.T))


def summary(step: Step) -> list[Json]:
    """Each probe in a few numbers: of one point its values, of several the values farthest from zero, of reactions the
    sum; None where none."""
    files = table_names([result.name for result in step.probes])
    return [
        {"name": result.name, "file": file, "points": len(result.points), **peaks(result)}
        for result, file in zip(step.probes, files)
    ]


def history_columns(steps: Sequence[Step]) -> list[str]:
    """Columns of history.csv that probes need: none without them."""
    names = dict.fromkeys(name for result in steps[0].probes for name in columns(result))
    return ["probe", *names] if names else []


def history_rows(step: Step) -> list[Json]:
    """A row of history.csv for each probe, in the same few numbers as in summary.json."""
    return [{"probe": result.name, **peaks(result)} for result in step.probes]

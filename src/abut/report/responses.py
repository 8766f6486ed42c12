"""Vibrations under loads in the report and on the terminal."""

from __future__ import annotations

import numpy as np

from abut.report.chart import Chart
from abut.solution import ResponseResult, Solution
from abut.solution.responses import AXIS, HARMONIC, labels

LABEL = {"frequency": "frequency [cycles per time]", "time": "time"}
MOST = 6  # probes of which a chart has lines


def response_lines(solution: Solution) -> list[str]:
    """The largest displacement of each, and where the table is."""
    return [_line(result, label) for result, label in zip(solution.responses, labels(solution.responses))]


def _line(result: ResponseResult, label: str) -> str:
    i, axis = int(np.argmax(result.largest)), AXIS[result.kind]
    return (
        f"{result.kind} response: largest displacement {result.largest[i]:.6g} at {axis} {result.at[i]:.6g}; "
        f"{len(result.at)} {'frequencies' if axis == 'frequency' else 'times'} in {label}.csv"
    )


def response_charts(solution: Solution) -> list[Chart]:
    """Of each: displacement of probes, or the largest one, over frequency or time; of what is harmonic also phases."""
    return [chart for number in range(len(solution.responses)) for chart in _charts(solution, number)]


def _charts(solution: Solution, number: int) -> list[Chart]:
    result, dim = solution.responses[number], solution.model.dim
    label, harmonic = LABEL[AXIS[result.kind]], result.kind == HARMONIC
    title = labels(solution.responses)[number].replace("_", " ")
    if not result.probes:
        return [Chart(f"{title}: largest displacement [length]", label, result.at, {"largest": result.largest})]
    size, phase = dict[str, np.ndarray](), dict[str, np.ndarray]()
    for probe in result.probes[:MOST]:
        most = np.abs(probe.displacement).max(axis=(0, 2))
        moved = probe.displacement[:, int(np.argmax(most))]
        for axis, values in zip("xyz"[:dim], moved.T):
            if np.abs(values).max() > 1e-9 * np.abs(moved).max(initial=1e-300):
                size[f"{probe.name} {axis}"] = np.abs(values) if harmonic else values
                phase[f"{probe.name} {axis}"] = np.degrees(np.angle(values))
    what = "amplitude of displacement" if harmonic else "displacement"
    charts = [Chart(f"{title}: {what} [length]", label, result.at, size)]
    return [*charts, Chart(f"{title}: phase [degrees]", label, result.at, phase)] if harmonic else charts

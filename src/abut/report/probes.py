"""Probes in the report: a table of what they read at the end, plots over time and along lines."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from abut.probing.table import columns, peaks
from abut.report.chart import Chart
from abut.report.describe import Table
from abut.report.times import time_label
from abut.solution import ProbeResult, Solution

UNITS = {"displacement": "length", "stress": "force/length²", "pressure": "force/length²", "gap": "length"}
UNITS["reaction"] = "force"
UNITS |= dict.fromkeys(("plastic_strain", "equivalent_plastic_strain", "equivalent plastic strain"), "1")
CHARTS = (  # quantities of one chart: its title, its quantities
    ("displacement", ("displacement",)),
    ("stress", ("stress", "von_mises", "principal_stress", "max_shear")),
    ("reaction", ("reaction",)),
    ("plastic strain", ("plastic_strain", "equivalent_plastic_strain")),
    ("pressure", ("pressure", "gap")),
)
PLANE = ("stress_yz", "stress_zx", "plastic_strain_yz", "plastic_strain_zx")  # zero in two dimensions
NO_GAP = 1e-9  # of a gap, over the length of the line
PEAK = "value farthest from zero"  # of reactions: the sum


def probe_table(solution: Solution) -> Table | None:
    """Name, place and values of each probe at the end of the last step, of several points those farthest from zero; None
    without probes."""
    if not solution.probes:
        return None
    given = dict.fromkeys(name for result in solution.probes for name in result.values)
    rows = []
    for probe, result in zip(solution.model.probes, solution.probes):
        several = f" ({len(result.points)}); {PEAK}" if len(result.points) > 1 and probe.line is None else ""
        several = several.replace(PEAK, f"{PEAK}, of reactions the sum") if "reaction" in result.values else several
        several = several or (f"; {PEAK}" if len(result.points) > 1 else "")
        rows.append([probe.name, probe.place + several, *(_cell(result, name) for name in given)])
    head = ["probe", "where", *(f"{_words(name)} [{_unit(name)}]" for name in given)]
    if "stress" in given:
        at = 2 + list(given).index("stress")
        head[at] = head[at].replace("stress", "stress xx yy zz xy yz zx")
    return {"title": "At the end of the last step", "head": head, "rows": rows}


def charts(solution: Solution) -> list[Chart]:
    """Along lines in the last step; of points and sets over time, where there are several steps."""
    result: list[Chart] = []
    for number, (probe, last) in enumerate(zip(solution.model.probes, solution.probes)):
        results = [step.probes[number] for step in solution.steps]
        if last.distance is not None:
            x, label = last.distance, "distance from the start of the line [length]"
            table = {n: v for n, v in columns(last).items() if n != "gap" or len(last.values) == 1 or _opens(v, x)}
            when = " in the last step" if len(results) > 1 else ""
        elif len(results) > 1:
            x = np.array([step.time for step in solution.steps])
            label = time_label(solution.model)
            table, when = _over_time(results), f", {PEAK}" if len(last.points) > 1 else ""
        else:
            continue
        for title, names in CHARTS:
            series = {
                _words(column): values
                for column, values in table.items()
                if column.startswith(names) and not (solution.model.dim == 2 and column in PLANE)
            }
            if series:
                shown = title if any(column.startswith(title) for column in table) else _words(names[-1])
                of_several = ", sum over the nodes" if shown == "reaction" and when else when
                heading = f"{probe.name}: {shown} [{_unit(shown)}]{of_several}"
                result.append(Chart(heading, label, x, series))
    return result


def _opens(gap: NDArray[np.float64], distance: NDArray[np.float64]) -> bool:
    """Whether a gap is more than rounding anywhere."""
    return bool(np.nanmax(np.abs(gap), initial=0.0) > NO_GAP * np.ptp(distance))


def _over_time(results: Sequence[ProbeResult]) -> dict[str, NDArray[np.float64]]:
    each = [peaks(result) for result in results]
    return {name: np.array([np.nan if p[name] is None else p[name] for p in each], dtype=float) for name in each[0]}


def _cell(result: ProbeResult, name: str) -> str:
    if name not in result.values:
        return ""
    values = [value for column, value in peaks(result).items() if column == name or column.startswith(f"{name}_")]
    words = ["none" if value is None else f"{value:.6g}" for value in values]
    return words[0] if len(words) == 1 else "(" + ", ".join(words) + ")"


def _words(name: str) -> str:
    return name.replace("von_mises", "von Mises").replace("_", " ")


def _unit(name: str) -> str:
    return UNITS.get(name, UNITS["stress"])

"""Force over displacement in the report: what moves a support or a rigid body, against the motion prescribed there."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np
from numpy.typing import NDArray

from abut.model.conditions import weights
from abut.report.chart import Chart
from abut.report.times import time_at
from abut.solution import Solution

Vector = NDArray[np.float64]
TURNS = ("rx", "ry", "rz")


def paths(solution: Solution) -> list[Chart]:
    """Of all supports and rigid bodies that are moved, from the state without loads on; none of a single step."""
    if len(solution.steps) < 2:
        return []
    curves = (*_supports(solution), *_rigid(solution))
    return [_path(title, label, time_at(solution.model, at), x, y) for title, label, at, x, y in curves]


Curve = tuple[str, str, Vector, Vector, Vector]  # title, label of the axis, times, motion, force


def _supports(solution: Solution) -> Iterator[Curve]:
    for support in solution.model.supports:
        if support.axes is not None:  # its forces have no one direction
            continue
        for i, axis in enumerate("xyz"[: solution.model.dim]):
            value = getattr(support, axis)
            if not isinstance(value, (int, float)) or value == 0.0:
                continue
            times = np.array([0.0, *(step.factor for step in solution.steps)])
            x = value * np.array([weights([support.amplitude], time)[0] for time in times])
            y = np.array([0.0, *(step.reactions[support.on][i] for step in solution.steps)])
            title = f"{support.on}: force along {axis} over displacement"
            yield from _moved(title, f"prescribed displacement {axis}", times, x, y)


def _rigid(solution: Solution) -> Iterator[Curve]:
    dim = solution.model.dim
    for body in solution.model.referenced:
        for name in (*"xyz"[:dim], *(TURNS if dim == 3 else TURNS[2:])):
            if not getattr(body, name):
                continue
            turns = name in TURNS
            i = "xyz".index(name[-1]) if dim == 3 or not turns else 0
            results = [step.rigid[body.name] for step in solution.steps]
            x = np.array([0.0, *((r.rotation if turns else r.displacement)[i] for r in results)])
            y = np.array([0.0, *((r.moment if turns else r.force)[i] for r in results)])
            times = np.array([0.0, *(step.factor for step in solution.steps)])
            what = f"moment about {name[-1]} over rotation" if turns else f"force along {name} over displacement"
            label = f"prescribed rotation {name} [radians]" if turns else f"prescribed displacement {name}"
            yield from _moved(f"{body.name}: {what}", label, times, x, y)


def _moved(title: str, label: str, times: Vector, x: Vector, y: Vector) -> Iterator[Curve]:
    """A curve where anything moves; without its beginning if that is not the state of rest."""
    first = 0 if x[0] == 0.0 else 1
    if np.ptp(x[first:]) > 0.0:
        yield title, label, times[first:], x[first:], y[first:]


def _path(title: str, label: str, times: Vector, x: Vector, y: Vector) -> Chart:
    """A curve cut where the motion turns back, so that along each way x rises or falls."""
    way = np.sign(np.diff(x))
    cuts, ahead = [0], 0.0
    for i, sign in enumerate(way):
        if sign and ahead and sign != ahead:
            cuts.append(i)
        ahead = sign or ahead
    ends = [*cuts[1:], len(x) - 1]
    parts = [np.arange(a, b + 1) for a, b in zip(cuts, ends)]
    parts = [part if x[part[-1]] >= x[part[0]] else part[::-1] for part in parts]
    order = np.concatenate(parts)
    of_part = np.repeat(np.arange(len(parts)), [len(part) for part in parts])
    sort = np.argsort(x[order], kind="stable")
    names = [f"time {times[a]:.4g} to {times[b]:.4g}" for a, b in zip(cuts, ends)]
    names = names if len(parts) > 1 else [title.partition(": ")[2].partition(" over ")[0]]
    ways = {name: np.where(of_part[sort] == i, y[order][sort], np.nan) for i, name in enumerate(names)}
    return Chart(title, label, x[order][sort], ways)

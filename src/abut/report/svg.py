"""Plots as SVG: the report where its scripts are not built."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from html import escape

WIDTH, HEIGHT = 620, 290
LEFT, RIGHT, TOP, BOTTOM = 66, 14, 10, 40  # of the axes, pixels
SECOND = 58  # more on the right for an axis there


@dataclass(frozen=True)
class Series:
    """A line: None in ``values`` (n,) breaks it; colour: a name of the page's; right: it has the axis on the right."""

    label: str
    values: Sequence[float | None]
    colour: str = "accent"
    dash: str = ""
    right: bool = False


@dataclass(frozen=True)
class Axis:
    """From data to pixels, and where its marks are."""

    low: float
    high: float
    ticks: tuple[float, ...]
    first: float
    last: float
    log: bool = False

    def at(self, value: float) -> float:
        low, high, value = (math.log10(v) if self.log else v for v in (self.low, self.high, value))
        return self.first + (value - low) / (high - low) * (self.last - self.first)


def plot(
    title: str, label: str, x: Sequence[float | None], series: Sequence[Series], *, log: bool = False,
    marks: Sequence[float] = (),
) -> str:  # fmt: skip
    """A plot with its heading; x (n,), ``label`` of its axis; log: of the values; marks: places of vertical lines."""
    right = [s for s in series if s.right]
    far = WIDTH - RIGHT - (SECOND if right else 0)
    along = _linear(x, LEFT, far)
    up = (_powers if log else _values)([v for s in series if not s.right for v in s.values])
    second = _values([v for s in right for v in s.values]) if right else None
    body = [_grid(along, up, far), *(_mark(along.at(place)) for place in marks)]
    if second is not None:
        body += [_text(far + 6, second.at(t) + 4, _short(t), "start") for t in second.ticks]
    for one in series:
        body.append(_line(one, x, along, second if one.right and second is not None else up))
    body.append(_text(0.5 * (LEFT + far), HEIGHT - 6, escape(label), "middle"))
    names = "".join(
        f'<span><i style="border-top:2px {"dashed" if s.dash else "solid"} var(--{s.colour})"></i>{escape(s.label)}'
        f"{' (right)' if s.right else ''}</span>"
        for s in series
    )
    return (
        f'<div class="plot"><h3>{escape(title)}</h3><svg viewBox="0 0 {WIDTH} {HEIGHT}" role="img">{"".join(body)}</svg>'
        f"<p class=legend>{names}</p></div>"
    )


def _linear(values: Sequence[float | None], first: float, last: float) -> Axis:
    known = [v for v in values if v is not None] or [0.0, 1.0]
    low, high = min(known), max(known)
    if low == high:
        low, high = low - 0.5, high + 0.5
    return Axis(low, high, _ticks(low, high), first, last)


def _values(values: Sequence[float | None]) -> Axis:
    """From zero up, or from below it where there are values that are more than rounding."""
    known = [v for v in values if v is not None] or [0.0]
    low, high = min(*known, 0.0), max(known)
    low = 0.0 if low > -1e-6 * high else low
    high = high if high > low else low + 1.0
    low, high = (low - 0.05 * (high - low) if low < 0.0 else 0.0), high + 0.08 * (high - low)
    return Axis(low, high, _ticks(low, high), HEIGHT - BOTTOM, TOP)


def _powers(values: Sequence[float | None]) -> Axis:
    known = [v for v in values if v is not None and v > 0.0] or [1.0]
    low, high = math.floor(math.log10(min(known)) - 0.2), math.ceil(math.log10(max(known)) + 0.2)
    every = max(1, math.ceil((high - low) / 7))
    ticks = tuple(10.0**power for power in range(high, low - 1, -every))
    return Axis(10.0**low, 10.0**high, ticks, HEIGHT - BOTTOM, TOP, log=True)


def _ticks(low: float, high: float) -> tuple[float, ...]:
    """About five round numbers."""
    power = 10.0 ** math.floor(math.log10((high - low) / 5.0))
    step = next(k * power for k in (1.0, 2.0, 5.0, 10.0) if (high - low) / (k * power) <= 6.0)
    return tuple(i * step for i in range(math.ceil(low / step - 1e-9), math.floor(high / step + 1e-9) + 1))


def _grid(along: Axis, up: Axis, far: float) -> str:
    across = [f"M{LEFT} {up.at(t):.1f}H{far}" for t in up.ticks]
    lines = " ".join([*across, *(f"M{along.at(t):.1f} {TOP}V{HEIGHT - BOTTOM}" for t in along.ticks)])
    texts = [
        _text(LEFT - 7, up.at(t) + 4, f"1e{round(math.log10(t))}" if up.log else _short(t), "end") for t in up.ticks
    ]
    texts += [_text(along.at(t), HEIGHT - BOTTOM + 16, _short(t), "middle") for t in along.ticks]
    return f'<path d="{lines}" stroke="var(--line)" fill="none"/>{"".join(texts)}'


def _mark(x: float) -> str:
    return f'<path d="M{x:.1f} {TOP}V{HEIGHT - BOTTOM}" stroke="var(--soft)" stroke-dasharray="4 4"/>'


def _line(one: Series, x: Sequence[float | None], along: Axis, up: Axis) -> str:
    path, points, pen = [], [], "M"
    for a, b in zip(x, one.values):
        if a is None or b is None or (up.log and b <= 0.0):
            pen = "M"
            continue
        place = along.at(a), up.at(b)
        path.append(f"{pen}{place[0]:.1f} {place[1]:.1f}")
        points.append(f'<circle cx="{place[0]:.1f}" cy="{place[1]:.1f}" r="2.5" fill="var(--{one.colour})"/>')
        pen = "L"
    dash = f' stroke-dasharray="{one.dash}"' if one.dash else ""
    line = f'<path d="{"".join(path)}" fill="none" stroke-width="2" stroke="var(--{one.colour})"{dash}/>'
    return line + ("".join(points) if len(points) < 30 else "")


def _text(x: float, y: float, text: str, anchor: str) -> str:
    return f'<text x="{x:.1f}" y="{y:.1f}" text-anchor="{anchor}">{text}</text>'


def _short(value: float) -> str:
    return f"{value:.4g}".replace("e+0", "e").replace("e-0", "e-").replace("e+", "e")

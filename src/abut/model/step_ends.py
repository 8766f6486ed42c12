"""When load steps end: at the times that a user gives, and where what is prescribed changes its direction."""

from __future__ import annotations

from collections.abc import Sequence

from abut.model.conditions import History

STRAIGHT = 1e-9  # change of slope over the slope that is none
SAME = 1e-9  # times that differ by less are one


def named_times(histories: Sequence[History]) -> tuple[list[float], list[float]]:
    """Times between the ends at which what is prescribed has a point of its table, and those of them where its direction
    changes. Times that differ from an end, or from one another, by rounding alone are no load steps of their own."""
    named, corners = set(), set()
    for history in histories:
        points = () if history is None else history.points
        for i, (time, factor) in enumerate(points):
            if not SAME < time < 1.0 - SAME:
                continue
            named.add(time)
            before = 0.0 if i == 0 else (factor - points[i - 1][1]) / (time - points[i - 1][0])
            after = 0.0 if i == len(points) - 1 else (points[i + 1][1] - factor) / (points[i + 1][0] - time)
            if abs(after - before) > STRAIGHT * max(abs(before), abs(after)):
                corners.add(time)
    return apart(sorted(named)), apart(sorted(corners))


def apart(times: Sequence[float], among: Sequence[float] = ()) -> list[float]:
    """Of increasing times those that are more than rounding after the one before, and away from those ``among`` others."""
    result: list[float] = []
    for time in times:
        if all(abs(time - other) > SAME for other in (*result[-1:], *among)):
            result.append(time)
    return result


def with_corners(ends: Sequence[float], histories: Sequence[History]) -> tuple[float, ...]:
    """Ends of load steps together with the corners of the histories before the last of them, increasing."""
    _, corners = named_times(histories)
    return tuple(sorted([*ends, *apart([corner for corner in corners if corner < ends[-1]], ends)]))

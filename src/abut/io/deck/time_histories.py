"""What is prescribed over the steps: for every node or face, its course on one time axis from 0 to 1."""

from __future__ import annotations

from bisect import bisect_right
from collections.abc import Callable, Iterable

from abut.io.deck.reasons import DeckError
from abut.io.deck.record import Amplitude, Deck, Prescribed, Step

BODY_LOADS = ("gravity", "centrifugal")
ALLOWED = ("interference", "shrink")  # overlap of contact
Course = tuple[tuple[float, float], ...]  # (time, value), linear between, constant outside
Key = tuple[float, ...]

RAMP = 1e-9  # of a step: the time a value takes to jump where an amplitude begins elsewhere than the step before ended


def period(deck: Deck) -> float:
    """Length of all steps together, 1 where they have none."""
    return sum(step.period for step in deck.steps) or 1.0


def ends(deck: Deck) -> tuple[float, ...]:
    """Times at which the steps end, the last of them 1."""
    total = sum(step.period for step in deck.steps)
    times, time = [], 0.0
    for step in deck.steps:
        time += step.period
        times.append(time / total)
    return (*times[:-1], 1.0) if times else ()


def times(deck: Deck) -> tuple[float, ...]:
    """Ends of the steps, and the corners of the amplitudes that act in them."""
    total = sum(step.period for step in deck.steps)
    result, start = set(ends(deck)), 0.0
    going = {value.amplitude for value in deck.fixed}  # those over the total time hold in later steps as well
    for step in deck.steps:
        going = {name for name in going - {""} if deck.amplitudes[name].total or step is deck.steps[0]}
        going |= {value.amplitude for value in step.values} - {""}
        for name in going:
            amplitude = deck.amplitudes[name]
            shift = _shift(amplitude, step, start)
            inside = (shift + t for t, _ in amplitude.points)
            result |= {t / total for t in inside if start + RAMP * total < t < start + step.period - RAMP * total}
        start += step.period
    return tuple(sorted(result))


def courses(deck: Deck, kind: str, base: Callable[[Key], float] = lambda _: 0.0) -> dict[Key, Course]:
    """Courses of one kind ("boundary", "force", "pressure", "gravity", "centrifugal", "temperature", "interference",
    "shrink") by (number, direction), gravity by (number, x, y, z), centrifugal forces by (number, point and direction of
    the axis). ``base``: the value before the first step.

    Values given twice in a step add up where they are loads; the later one holds for supports and temperatures. What has an
    amplitude over the total time follows it in the steps after, too, until another value takes its place or OP=NEW ends it.
    Supports that begin or end between steps are for ``passing_supports``."""
    state: dict[Key, list[tuple[float, float]]] = {}
    last: dict[Key, tuple[Prescribed, float]] = {}
    start = 0.0
    for step in deck.steps:
        first = step is deck.steps[0]
        given = (given_in(deck.fixed, kind) if first else {}) | given_in(step.values, kind)
        end = start + step.period
        ended = state.keys() - given.keys() if _group(kind) in step.new else set()
        for key in ended:
            state[key] = [*state[key], (start, state[key][-1][1]), (end, base(key))]
            last.pop(key, None)
        going = {key: of for key, of in last.items() if key not in given and over_total_time(deck, of[0])}
        for key, (value, size) in {**given, **going}.items():
            before = [p for p in state.get(key, []) if p[0] <= start] or [(start, base(key))]
            state[key] = [*before, *course_within(deck, value, size, before[-1][1], start, step)]
        last |= given
        start = end
    total = start or 1.0
    return {key: tidy([(t / total, v) for t, v in points]) for key, points in state.items()}


def _group(kind: str) -> str:
    return "pressure" if kind in BODY_LOADS else ALLOWED[0] if kind in ALLOWED else kind


def _keys(value: Prescribed) -> Iterable[Key]:
    if value.kind in BODY_LOADS:
        return [(number, *value.vector) for number in value.numbers.tolist()]
    return [(number, direction) for number in value.numbers.tolist() for direction in value.directions]


def over_total_time(deck: Deck, value: Prescribed) -> bool:
    return bool(value.amplitude) and deck.amplitudes[value.amplitude].total


def _shift(amplitude: Amplitude, step: Step, start: float) -> float:
    """What an amplitude's times are less than those on the axis, on which the step begins at ``start``."""
    return start - step.total if amplitude.total else start


def given_in(values: Iterable[Prescribed], kind: str) -> dict[Key, tuple[Prescribed, float]]:
    """The values of one step by key, with sums of loads."""
    result: dict[Key, tuple[Prescribed, float]] = {}
    for value in values:
        if value.kind != kind:
            continue
        for key in _keys(value):
            before = result.get(key)
            if before is None or kind in ("boundary", "temperature"):
                result[key] = (value, value.value)
                continue
            if before[0].amplitude != value.amplitude:
                raise DeckError(
                    value.place,
                    f"{int(key[0])} has a load with another amplitude in the same place ({before[0].place}); "
                    "give both one amplitude, or add them up in one",
                )
            result[key] = (value, before[1] + value.value)
    return result


def course_within(
    deck: Deck, value: Prescribed, size: float, before: float, start: float, step: Step
) -> list[tuple[float, float]]:
    """Points of a course within a step, with the one at its beginning."""
    end = start + step.period
    if value.frozen:
        return [(start, before), (end, before)]
    if not value.amplitude:
        return [(start, before), (end, size)]
    amplitude = deck.amplitudes[value.amplitude]
    shift = _shift(amplitude, step, start)
    inside = [t + shift for t, _ in amplitude.points if start < t + shift < end]
    first = size * at(amplitude.points, start - shift)
    jump = [] if first == before else [(start + RAMP * (end - start), first)]
    return [(start, before), *jump, *((t, size * at(amplitude.points, t - shift)) for t in (*inside, end))]


def at(points: tuple[tuple[float, float], ...], time: float) -> float:
    """Value of a course at a time."""
    i = bisect_right([t for t, _ in points], time)
    if i == 0:
        return points[0][1]
    if i == len(points):
        return points[-1][1]
    (t0, v0), (t1, v1) = points[i - 1], points[i]
    return v0 + (v1 - v0) * (time - t0) / (t1 - t0)


def tidy(points: list[tuple[float, float]]) -> Course:
    """Without repeated times and points on the line between their neighbours."""
    result: list[tuple[float, float]] = []
    for point in points:
        if result and point[0] <= result[-1][0]:
            result[-1] = (result[-1][0], point[1])
            continue
        while len(result) > 1 and _straight(result[-2], result[-1], point):
            result.pop()
        result.append(point)
    if all(value == result[0][1] for _, value in result):
        return ((0.0, result[0][1]),)
    return tuple(result)


def _straight(a: tuple[float, float], b: tuple[float, float], c: tuple[float, float]) -> bool:
    line = a[1] + (c[1] - a[1]) * (b[0] - a[0]) / (c[0] - a[0])
    return abs(line - b[1]) <= 1e-13 * max(abs(a[1]), abs(b[1]), abs(c[1]))


def combine(parts: Iterable[tuple[float, Course]]) -> Course:
    """Sum of courses with their coefficients."""
    parts = [(c, course) for c, course in parts if c != 0.0]
    grid = sorted({t for _, course in parts for t, _ in course} or {0.0})
    return tidy([(t, sum(c * at(course, t) for c, course in parts)) for t in grid])


def zero(course: Course) -> bool:
    return all(value == 0.0 for _, value in course)


def scaled(course: Course) -> tuple[float, Course | None]:
    """The largest value, with sign, and the course over it: None for a plain ramp from 0 at time 0 to 1 at time 1."""
    size = max((value for _, value in course), key=abs)
    if size == 0.0:
        return 0.0, None
    unit = tuple((t, value / size) for t, value in course)
    return size, None if unit == ((0.0, 0.0), (1.0, 1.0)) else unit

"""What acts in each step of a job: supports, loads, bolts, fluids and contacts, in words."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import pairwise
from typing import Any

from abut.model import Hold, Model, Preload, Removal
from abut.model.conditions import History, drives

SAME = 1e-9  # of the time of a run, and of factors


@dataclass(frozen=True)
class Part:
    """A step of a job. begin, end: shares of the run's time; last: the time at its end, in the job's own."""

    name: str
    begin: float
    end: float
    last: float


def parts(steps: Sequence[Any], last: float) -> list[Part]:
    """Of a job's ``steps`` (name, period), whose periods add up to ``last``."""
    result, begin = [], 0.0
    for step in steps:
        end = begin + step.period / last
        result.append(Part(step.name, begin, end, last))
        begin = end
    return result


def acting(model: Model, steps: Sequence[Part]) -> tuple[str, ...]:
    """A line for each step. What is prescribed has its factor at the beginning and at the end, "0 to 1"; what has none at
    any time of the step is left out."""
    return tuple(_line(model, step) for step in steps)


def _line(model: Model, step: Part) -> str:
    loads = [*(_load(load, step) for load in model.loads), *(_fluid(item, step) for item in model.penetrations)]
    groups = {
        "supports": [_support(support, step) for support in model.supports],
        "bodies": [_removal(removal, step) for removal in model.removals],
        "comes or goes": [_hold(hold, step) for hold in model.holds],
        "led": [_led(body, step) for body in (*model.rigid, *model.couplings, *model.rotations) if drives(body)],
        "connectors": [_led(joint, step) for joint in model.connectors if drives(joint)],
        "loads": loads,
        "preloads": [_preload(preload, step) for preload in model.preloads],
        "contacts": [_contact(contact, step, model.opened.get(contact.name)) for contact in model.contacts],
    }
    said = [f"{title} {', '.join(filter(None, texts))}" for title, texts in groups.items() if any(texts)]
    return f"step '{step.name}' (time {step.begin * step.last:g} to {step.end * step.last:g}): {'; '.join(said)}"


def _factors(history: History, step: Part) -> list[float]:
    """At the beginning, at corners, and at the end."""
    corners = [] if history is None else [time for time, _ in history.points if step.begin < time < step.end]
    times = [step.begin, *corners, step.end]
    return [time if history is None else history(time) for time in times]


def _change(history: History, step: Part) -> str:
    """The factor's way, "" where there is none at any time."""
    values = _factors(history, step)
    if max(map(abs, values)) <= SAME:
        return ""
    kept = [values[0], *(b for a, b in pairwise(values) if abs(b - a) > SAME)]
    return " to ".join(f"{value:g}" for value in kept)


def _support(support: Any, step: Part) -> str:
    change = _change(support.amplitude, step) if drives(support) else ""
    return f"'{support.on}'" + (f" ({change})" if change else "")


def _load(load: Any, step: Part) -> str:
    change = _change(load.amplitude, step)
    on = getattr(load, "on", None)
    return f"{type(load).__name__.lower()}{'' if on is None else f' on {on!r}'} ({change})" if change else ""


def _fluid(item: Any, step: Part) -> str:
    change = _change(item.amplitude, step)
    return f"fluid in '{item.contact}' ({change})" if change else ""


def _led(body: Any, step: Part) -> str:
    named = getattr(body, "body", None) or getattr(body, "name", None) or body.on
    histories = [body.amplitude, *getattr(body, "amplitudes", {}).values()]
    changes = list(dict.fromkeys(filter(None, (_change(history, step) for history in histories))))
    return f"'{named}' ({', '.join(changes)})" if changes else ""


def _preload(preload: Preload, step: Part) -> str:
    if preload.lock is not None and preload.lock <= step.begin + SAME:
        return f"'{preload.name}' (locked)"
    change = _change(preload.amplitude, step)
    return f"'{preload.name}' ({change})" if change else ""


def _hold(hold: Hold, step: Part) -> str:
    if hold.since >= step.end - SAME or (hold.until is not None and hold.end_of_release <= step.begin + SAME):
        return ""
    comes, goes = hold.since >= step.begin - SAME, hold.until is not None and hold.until < step.end - SAME
    what = " and ".join(word for word, does in (("put on", comes), ("let go", goes)) if does) or "held"
    return f"'{hold.name}' ({what})"


def _removal(removal: Removal, step: Part) -> str:
    """A body that is away at the beginning or the end of the step: while it is away, and what happens to it."""
    goes = step.begin - SAME <= removal.until < step.end - SAME and removal.until > SAME
    comes = step.begin - SAME <= removal.back < step.end - SAME
    if not (goes or comes or removal.away(step.end)):
        return ""
    what = " and ".join(word for word, does in (("taken out", goes), ("comes back", comes)) if does) or "not there"
    if comes and removal.until <= SAME:
        what = "comes"
    return f"'{removal.body}' ({what})"


def _contact(contact: Any, step: Part, away: History) -> str:
    if away is not None and away(step.end) > 0.0:  # it does not act, or a body of it is not there
        fades = contact.times.left(max(step.begin, contact.times.last) + 0.5 * (step.end - step.begin)) > 0.0
        return f"'{contact.name}' ({'let go' if fades else 'open'})"
    said = [
        f"{name} {change}"
        for name, history, counts in (
            ("offset", contact.amplitude, contact.offset and contact.amplitude is not None),
            ("friction", contact.friction_amplitude, contact.friction_amplitude is not None),
        )
        if counts and (change := _change(history, step))
    ]
    return f"'{contact.name}'" + (f" ({', '.join(said)})" if said else "")

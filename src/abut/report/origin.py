"""Origin of a solution: the name and text of its job, and reference values."""

from __future__ import annotations

import json
import math
from collections.abc import Mapping
from dataclasses import dataclass, field
from pathlib import Path

from abut.probing.table import peaks
from abut.solution import ContactResult, Solution, Step
from abut.types import Json

PROFILE = "contact.profile"


@dataclass(frozen=True)
class Origin:
    """title: the job's name; text: the job file; expected: what is known of the first contact by theory, by quantity
    (``examples/README.md`` says how it is written)."""

    title: str = "abut"
    text: str = ""
    expected: Mapping[str, object] = field(default_factory=dict)


def read_origin(path: Path, text: str) -> Origin:
    """The origin of a job file; theory is read from ``expected.json`` beside it, where that has an entry for the file."""
    try:
        data = json.loads(path.with_name("expected.json").read_text(encoding="utf-8"))
    except (OSError, ValueError):
        data = {}
    entry = data.get(path.stem) if isinstance(data, dict) else None
    folder = path.absolute().parent.name
    title = folder if path.stem == "job" else f"{folder}: {path.stem}"
    return Origin(title, text, entry if isinstance(entry, dict) else {})


OF_FRICTION = (
    "sticking_area", "slipping_area", "force_by_area", "force_limit", "largest_share", "max_traction", "max_slip",
    "max_total_slip", "work", "total_work",
)  # fmt: skip


def quantities(step: Step) -> dict[str, float]:
    """What ``expected.json`` may speak of, by its names there: the first contact, forces, pressures and areas of each
    contact by its name, and the peaks of all probes."""
    known: dict[str, float] = {}
    for result in step.probes:
        largest = peaks(result)
        known |= {f"probe.{result.name}.{name}": value for name, value in largest.items() if value is not None}
    for contact in step.contacts:
        known |= _of_contact(f"contact.{contact.name}", contact)
    for contact in step.contacts[:1]:
        known |= _of_contact("contact", contact)
        turns = "z" if contact.contactor.dim == 2 else "xyz"
        known |= {f"contact.moment.{axis}": float(value) for axis, value in zip(turns, contact.resultant.moment)}
        if contact.friction is not None:
            known |= {f"contact.friction.{name}": float(getattr(contact.friction, name)) for name in OF_FRICTION}
    return known


def _of_contact(name: str, contact: ContactResult) -> dict[str, float]:
    found = {f"{name}.force.{axis}": float(value) for axis, value in zip("xyz", contact.force)}
    return {f"{name}.max_pressure": contact.max_pressure, f"{name}.area": contact.area, **found}


def comparison(solution: Solution, expected: Mapping[str, object]) -> list[Json]:
    """Rows quantity, value, expected (words), deviation (relative, or None), passed, source; what cannot be read is left
    out: the file may be somebody else's."""
    known, rows = quantities(solution.steps[-1]), []
    for name, wanted in expected.items():
        if name not in known or not isinstance(wanted, dict):
            continue
        value, low, high = known[name], _number(wanted, "at_least"), _number(wanted, "at_most")
        exact, tolerance = _number(wanted, "value"), _number(wanted, "tolerance")
        words, deviation, passed = [], None, True
        if exact is not None and tolerance is not None:
            deviation = (value - exact) / abs(exact) if exact else value
            passed = abs(deviation) <= tolerance
            words.append(f"{exact:.7g} within {100 * tolerance:.3g} %")
        if low is not None:
            passed = passed and value >= low
            words.append(f"at least {low:.7g}")
        if high is not None:
            passed = passed and value <= high
            words.append(f"at most {high:.7g}")
        if words:
            rows.append(
                {
                    "quantity": name.removeprefix("contact.").replace("_", " ").replace(".", " "),
                    "value": value,
                    "expected": ", ".join(words),
                    "deviation": deviation,
                    "passed": passed,
                    "source": str(wanted.get("source", "")),
                }
            )
    return rows


def ellipse(expected: Mapping[str, object]) -> tuple[float, float, tuple[float, ...]] | None:
    """Peak, half width and centre of the elliptic pressure (Hertz) that theory gives along a line, if it does."""
    wanted = expected.get(PROFILE)
    if not isinstance(wanted, dict):
        return None
    peak, half, centre = _number(wanted, "peak"), _number(wanted, "half_width"), wanted.get("centre")
    if peak is None or half is None or not half > 0.0 or not isinstance(centre, list):
        return None
    if not all(isinstance(c, (int, float)) and math.isfinite(c) for c in centre):
        return None
    return peak, half, tuple(float(c) for c in centre)


def _number(table: Mapping[str, object], key: str) -> float | None:
    value = table.get(key)
    return float(value) if isinstance(value, (int, float)) and math.isfinite(value) else None

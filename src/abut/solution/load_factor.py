"""Load factors of preloads: what share of an external load the bolts take, after VDI 2230."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from typing import Any

from abut import checks
from abut.errors import InputError
from abut.model import Model, Preload, Temperature
from abut.model.conditions import History, drives
from abut.model.preload import sections
from abut.model.step_ends import SAME
from abut.solution.records import Solution, Step

NONE = 1e-6  # of the largest force: resultants along a bolt that are rounding


@dataclass(frozen=True)
class LoadFactor:
    """Of a preload, since all preloads are tightened.

    Parameters
    ----------
    value : float or None
        ``tension`` over ``load``, negative where the load takes tension from the bolt; None where there is none.
    tension : float
        Change of tension [force].
    load : float
        Size of the change of the resultant of all loads along the section's normal [force].
    why : str
        Why there is no value.
    """

    value: float | None
    tension: float
    load: float
    why: str = ""


def load_factors(solution: Solution, step: int = -1) -> Mapping[str, LoadFactor]:
    """Load factor of each preload: change of its tension over the change of the external load along it.

    Both from the first load step in which all preloads are tightened (locked, or of constant shortening) to another one. Of
    several bolts each has its share of the same load.

    Parameters
    ----------
    solution : Solution
        Of a model with preloads.
    step : int
        Index of the other step; the last one where left out.

    Returns
    -------
    mapping of str to LoadFactor
        By the preload's name; empty without preloads. Where loads have no resultant along the bolt, or more than loads has
        changed, ``value`` is None and ``why`` says so.

    Raises
    ------
    InputError
        Where there is no such step.
    """
    checks.instance(solution, Solution, "load_factors: solution", "a solution (abut.Solution)")
    if not -len(solution.steps) <= step < len(solution.steps):
        raise InputError(f"load_factors: step: expected the index of one of {len(solution.steps)} steps, got {step!r}")
    model, now = solution.model, solution.steps[step]
    since = max(map(_tightened, model.preloads), default=0.0)
    tight = next((one for one in solution.steps if one.factor > since - SAME and one.converged), None)
    why = "; ".join(_other_changes(model, since))
    found = {}
    for section in sections(model.mesh, model.preloads):
        name = section.preload.name
        if tight is None or now.factor <= tight.factor:
            none = _given(section.preload) or "nothing follows after all preloads are tightened"
            found[name] = LoadFactor(None, 0.0, 0.0, none)
            continue
        tension = now.preloads[name].tension - tight.preloads[name].tension
        load = abs(float((now.load - tight.load) @ section.normal))
        reason = _given(section.preload) or why or _no_resultant(load, (tight, now))
        found[name] = LoadFactor(None if reason else tension / load, tension, load, reason)
    return found


def factor_line(name: str, factor: LoadFactor) -> str:
    """In words."""
    if factor.value is None:
        return f"load factor of '{name}': none, {factor.why}"
    return (
        f"load factor of '{name}': {factor.value:.6g} (its tension has changed by {factor.tension:.6g}, loads along it by "
        f"{factor.load:.6g})"
    )


def _tightened(preload: Preload) -> float:
    """Time from which on it is."""
    return preload.lock if preload.lock is not None else _still(preload.amplitude)


def _still(history: History) -> float:
    """Time from which on a history is constant."""
    if history is None:
        return 1.0
    still = history.points[-1][0]
    for (time, factor), (_, after) in reversed(list(zip(history.points, history.points[1:]))):
        if factor != after:
            break
        still = time
    return still if len({factor for _, factor in history.points}) > 1 else 0.0


def _given(preload: Preload) -> str:
    if preload.force is None or preload.lock is not None:
        return ""
    return "its force is prescribed to the end; lock it at a time"


def _other_changes(model: Model, since: float) -> Iterator[str]:
    """What but loads changes after a time."""
    given: Sequence[Any] = [*model.supports, *model.equations, *model.rigid, *model.couplings, *model.rotations]
    moved = [item for item in given if drives(item) and _changes(_histories(item), since)]
    if moved:
        names = [getattr(moved[0], key, None) for key in ("on", "body", "name")]
        what = next((f"'{name}'" for name in names if name), "an equation")
        yield f"{what} is moved, not loaded, after it is tightened"
    heated = [load for load in model.loads if isinstance(load, Temperature) and _changes([load.amplitude], since)]
    if heated or any(solid.temperature for solid in model.solids):
        yield "temperatures change after it is tightened"
    if any(contact.offset and _changes([contact.amplitude], since) for contact in model.contacts if contact.amplitude):
        yield "the offset of a contact changes after it is tightened"
    if any(max(hold.since, 0.0 if hold.until is None else hold.end_of_release) > since + SAME for hold in model.holds):
        yield "supports come or go after it is tightened"
    if model.removals:
        yield "bodies go or come"


def _histories(item: Any) -> list[History]:
    return [item.amplitude, *getattr(item, "amplitudes", {}).values()]


def _changes(histories: Sequence[History], since: float) -> bool:
    return any(_still(history) > since + SAME for history in histories)


def _no_resultant(load: float, steps: Sequence[Step]) -> str:
    if load > NONE * max(step.largest_force for step in steps):
        return ""
    return "loads have no resultant along it that changes; support one side of the joint and load the other"

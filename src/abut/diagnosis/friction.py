"""Checks of friction: bodies that it alone holds, coefficients so large that solutions may be many, axisymmetric models."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import replace

import numpy as np

from abut.diagnosis.all_restraint import all_restraint
from abut.diagnosis.finding import Finding
from abut.diagnosis.uniqueness import uniqueness
from abut.errors import AbutError
from abut.model import Model
from abut.model.conditions import weights
from abut.model.friction import FrictionValues
from abut.problem.constraints import Constraints
from abut.problem.loads import loads
from abut.problem.pair import Pair
from abut.problem.restraint import Restraint

HALVINGS = 10  # of the range in which a coefficient is looked for: to a thousandth
LARGEST = 1e3  # coefficient that is as good as any
CLOSE = 0.9  # share of the given coefficient that loads take from which on a body is close to sliding
FAR = 3.0  # times the coefficient, beyond which nobody needs to be told of what may happen


def friction(model: Model, constraints: Constraints, pairs: Sequence[Pair]) -> list[Finding]:
    """Findings on all contacts with friction; none where there is none. ``pairs``: all that could be built."""
    rubs = [pair for pair in pairs if pair.frictional]
    if not rubs:
        return []
    findings = _axisymmetric(model, rubs)
    if len(pairs) == len(model.contacts):
        findings += [*_alone(model, constraints, pairs), *_several(model, constraints, pairs)]
    return findings


def _axisymmetric(model: Model, pairs: Sequence[Pair]) -> list[Finding]:
    if not model.mesh.axisymmetric:
        return []
    what = "friction acts in the plane of the section; nothing turns about the axis, and no torque is carried"
    return [Finding("info", f"contact '{pair.contact.name}'", what) for pair in pairs]


def _alone(model: Model, constraints: Constraints, pairs: Sequence[Pair]) -> list[Finding]:
    """Bodies that slide without friction, and the coefficient that holds them, in the step that takes most of it."""
    worst: tuple[float, str] | None = None
    try:
        ends = loads(model).at_ends(model)
    except AbutError:  # said elsewhere
        return []
    for number, (load, time) in enumerate(zip(ends, model.ends), start=1):
        at, force = weights(model.histories, time), constraints.free.T @ load
        motion = all_restraint(model, constraints, [_with(pair, at, 0.0) for pair in pairs]).unbalanced(force)
        given = _given(pairs, at)
        needed = _needed(all_restraint(model, constraints, pairs), at, force) if motion and given > 0.0 else None
        if needed is not None and (worst is None or needed / given > worst[0]):
            when = f" in step {number}" if len(ends) > 1 else ""
            least = f"it takes a coefficient of {needed:.3g} at least, {_words(pairs, at)}"
            worst = (
                needed / given,
                f"{motion} but for friction, which alone holds it against the loads{when}: {least}",
            )
    if worst is None:
        return []
    if worst[0] > CLOSE:
        return [Finding("advice", "bodies", worst[1], "it is close to sliding: a support would hold it for certain")]
    return [Finding("info", "bodies", worst[1])]


def _needed(restrained: Restraint, at: np.ndarray, force: np.ndarray) -> float | None:
    """The smallest coefficient, of all contacts in the proportion given, by which pressures and tractions can balance forces
    (n_free,); None where what is given cannot."""
    given = _given(restrained.pairs, at)

    def holds(coefficient: float) -> bool:
        pairs = [_with(pair, at, coefficient / given) for pair in restrained.pairs]
        return not replace(restrained, pairs=pairs).unbalanced(force)

    if not holds(given):
        return None
    low, high = 0.0, given
    if given == LARGEST:
        low, high = _bracket(holds)
    for _ in range(HALVINGS):
        middle = 0.5 * (low + high)
        low, high = (low, middle) if holds(middle) else (middle, high)
    return high


def _bracket(holds: Callable[[float], bool]) -> tuple[float, float]:
    """Coefficients that do not hold and that do, a factor of two apart."""
    low, high = 0.0, 1.0 / 64.0
    while not holds(high) and high < LARGEST:
        low, high = high, 2.0 * high
    return low, high


def _with(pair: Pair, at: np.ndarray, factor: float) -> Pair:
    """The pair with all coefficients, those of the moment, times a factor."""
    if pair.values is None:
        return pair
    now = np.minimum(_now(pair, at), LARGEST)
    return replace(pair, values=FrictionValues(factor * now))


def _now(pair: Pair, at: np.ndarray) -> np.ndarray:
    """The largest coefficient at any pressure, with the histories at ``at``, (n_functions,)."""
    return pair.at(at).steepest


def _given(pairs: Sequence[Pair], at: np.ndarray) -> float:
    """The largest coefficient of all at a moment."""
    every = [float(_now(pair, at).max(initial=0.0)) for pair in pairs if pair.frictional]
    return min(max(every), LARGEST)


def _words(pairs: Sequence[Pair], at: np.ndarray) -> str:
    given = _given(pairs, at)
    if given == LARGEST:
        return "and the surfaces are rough"
    alike = all(np.ptp(_now(pair, at)) == 0.0 and _now(pair, at)[0] == given for pair in pairs if pair.frictional)
    return f"given is {given:.3g}" if alike else f"where {given:.3g} is given, and others in proportion"


def _several(model: Model, constraints: Constraints, pairs: Sequence[Pair]) -> list[Finding]:
    """A coefficient at which a load step can have several solutions."""
    try:
        found = uniqueness(model, constraints, pairs)
    except (AbutError, np.linalg.LinAlgError):  # what is singular is said elsewhere
        return []
    if found is None:
        return []
    steepest = max(float(pair.steepest.max(initial=0.0)) for pair in pairs if pair.frictional)
    if steepest >= found.critical:
        return [
            Finding(
                "warning",
                "friction",
                f"coefficient {steepest:.3g}: from {found.critical:.3g} on, a load step can have several solutions, or "
                "none; which one is found depends on the way of the loads",
                "if such a coefficient is meant, take more and smaller load steps, and compare",
            )
        ]
    if steepest >= found.certain > 0.0 or found.critical < FAR * steepest:
        known = f"one solution is certain below {found.certain:.2g}" if found.certain > 0.0 else ""
        many = f"several or none are possible from {found.critical:.3g} on" if found.critical < FAR * steepest else ""
        both = " and ".join(text for text in (known, many) if text)
        return [Finding("info", "friction", f"coefficient {steepest:.3g}; {both}")]
    return []

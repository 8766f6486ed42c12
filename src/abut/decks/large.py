"""NLGEOM of a deck: kinematics, what does not go with it, load steps from increments."""

from __future__ import annotations

import math
from collections.abc import Iterator

from abut.io.deck.reasons import DeckError
from abut.io.deck.record import Deck, Step
from abut.io.deck.time_histories import ALLOWED, BODY_LOADS, courses, ends, times
from abut.model import SolveOptions
from abut.model.step_ends import SAME

SHARE = 0.1  # of an automatic step: its increments where the time of each must be said beforehand, at most as many
DRAG = (
    "abut adds a drag of its own where no increment is short enough, until bodies are at rest; the deck's are not read"
)
NO_DRAG = "no effect without NLGEOM; abut says which body is loose"
KINDS = ("boundary", "force", "pressure", *BODY_LOADS, *ALLOWED)
FLOWING = 10  # load steps of plastic bodies where the deck leaves them open


def is_finite(deck: Deck) -> bool:
    """Whether any step has NLGEOM."""
    return any(step.finite for step in deck.steps)


def finite_notes(deck: Deck) -> list[str]:
    """What is solved otherwise than the deck says where displacements are large."""
    notes = []
    if any(step.increments.stabilized for step in deck.steps):
        notes.append("*STATIC, STABILIZE: " + (DRAG if is_finite(deck) else NO_DRAG))
    if not is_finite(deck):
        return notes
    if any(value.kind == "centrifugal" for step in deck.steps for value in step.values):
        notes.append(
            "NLGEOM: CENTRIF with distances from the axis of the undeformed bodies; CalculiX takes those of deformed ones"
        )
    if deck.small_sliding:
        notes.append("NLGEOM: SMALL SLIDING is solved as large sliding")
    if any(step.increments.fixed for step in deck.steps):
        notes.append("*STATIC, DIRECT: an increment that does not converge is halved all the same")
    if not all(step.increments.fixed for step in deck.steps):
        notes.append(
            "NLGEOM: of automatic increments the longest is taken from *STATIC; first and smallest ones, INC and *CONTROLS "
            "are abut's own"
        )
    return notes


def unsupported(deck: Deck) -> Iterator[DeckError]:
    """What a deck asks for that does not go with its kinematics."""
    finite = is_finite(deck)
    small = next((step for step in deck.steps if not step.finite), None)
    if finite and small is not None:
        large = next(step for step in deck.steps if step.finite)
        yield DeckError(
            small.place,
            f"*STEP {small.number} has small displacements, and *STEP {large.number} NLGEOM: abut takes all steps of a deck "
            f"alike; write *STEP, NLGEOM in step {small.number} too, where displacements then are large as well",
            "NLGEOM",
        )
    for material in {section.material.name: section.material for section in deck.sections}.values():
        if material.rubber and not finite:
            yield DeckError(
                material.place, f"*MATERIAL '{material.name}': *HYPERELASTIC needs large strains; write *STEP, NLGEOM"
            )


def yields(deck: Deck) -> bool:
    """Whether a material of the deck is plastic."""
    return any(section.material.hardening for section in deck.sections)


def plastic_steps(deck: Deck) -> SolveOptions:
    """Load steps of plastic bodies under small displacements: those of the deck's increments, or ``FLOWING``."""
    given = load_steps(deck)
    return SolveOptions(steps=FLOWING) if given == SolveOptions() else given


def load_steps(deck: Deck) -> SolveOptions:
    """Load steps with NLGEOM: as long as they can be up to the longest increment, or at the times of fixed increments. Where
    nothing turns at the end of a step, which then would be passed over, times are given for automatic steps as well; so they
    are without contact, where "auto" is one load step."""
    total = sum(step.period for step in deck.steps)
    contact = bool(deck.pairs) or deck.general is not None
    turns = {time for kind in KINDS for course in courses(deck, kind).values() for time, _ in course} | {1.0}
    met = all(any(abs(end - time) < SAME for time in turns) for end in ends(deck))
    if met and contact and all(_automatic(step) for step in deck.steps):
        longest = min(step.increments.longest for step in deck.steps)
        if longest >= max(step.period for step in deck.steps):
            return SolveOptions()
        return SolveOptions(steps=math.ceil(total / longest * (1.0 - SAME)))
    result, start = list(times(deck)), 0.0
    for step in deck.steps:
        result += [(start + time) / total for time in _increments(step, contact)]
        start += step.period
    kept: list[float] = []
    for time in sorted(result):
        if not kept or time > kept[-1] + SAME:
            kept.append(time)
    return SolveOptions(times=(*kept[:-1], 1.0))


def _automatic(step: Step) -> bool:
    """Whether increments are chosen on the way: not where the first is the whole step."""
    return not step.increments.fixed and step.increments.first < step.period


def _increments(step: Step, contact: bool) -> list[float]:
    """Their ends within a step, from its beginning. Without contact automatic ones are as long as they may be: nothing
    depends on the way, and a step that fails is halved."""
    increments = step.increments
    length = increments.first
    if _automatic(step):
        length = max(length, SHARE * step.period) if contact else step.period
    count = math.ceil(step.period / min(length, increments.longest) * (1.0 - SAME))
    if increments.fixed:
        return [*(i * increments.first for i in range(1, count)), step.period]
    return [i / count * step.period for i in range(1, count + 1)]

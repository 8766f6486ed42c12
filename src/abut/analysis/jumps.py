"""Jumps that Newton's method makes by itself: load steps whose energy no way of equilibria explains, theory (G25)."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from abut.model import Model, Temperature
from abut.model.conditions import weights
from abut.model.contact import LAWS
from abut.problem.body_terms import DeadLoads, LinearBodies, SolidBodies
from abut.problem.problem import ContactProblem

Vector = NDArray[np.float64]


def has_potential(problem: ContactProblem, before: float, now: float) -> bool:
    """Whether between two times only forces of fixed direction act, on bodies that nothing else moves: a state of rest
    then is one of least potential energy. Load steps end at corners of histories, so that forces grow in proportion."""
    model = problem.model
    bodies_and_loads = all(isinstance(term, (SolidBodies, LinearBodies, DeadLoads)) for term in problem.terms)
    if not bodies_and_loads or problem.integration is not None or model.preloads or model.opened:
        return False
    if any(isinstance(load, Temperature) for load in model.loads):
        return False
    if any(how == "b-bar" for how in model.integrations.by_body.values()):  # forces that are no derivative of an energy
        return False
    if any(contact.law != LAWS[0] for contact in model.contacts):  # which may store energy
        return False
    return not _moves(problem, weights(model.histories, now) - weights(model.histories, before), model)


def _moves(problem: ContactProblem, change: Vector, model: Model) -> bool:
    """Whether anything prescribed changes with the factors of the histories: motions, turns, offsets of contacts."""
    constraints, histories = problem.constraints, model.histories
    turns = () if constraints.turns is None else constraints.turns.turns
    offset = [change[histories.index(contact.amplitude)] for contact in model.contacts if contact.amplitude is not None]
    moved = (constraints.prescribed @ change).any() or any((turn.given @ change).any() for turn in turns)
    return bool(moved or np.any(offset))


def unexplained(before: Vector, now: Vector, moved: Vector, kept: float) -> float:
    """Energy that no stable way of equilibria explains, positive, theory (G25). before, now: loads (dim n_points,) at the
    step's ends; moved: the displacement in it; kept: energy stored in the step, and taken by flow."""
    return max(float(before @ moved) - kept, kept - float(now @ moved))

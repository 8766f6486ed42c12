"""Progress records of a solution: iterations, and stages that begin."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass


@dataclass(frozen=True)
class Iteration:
    """One Newton iteration: one row of the live table, one line of run.jsonl.

    active: multipliers in contact, over all pairs, with friction points; changed: how many did since the iteration before;
    residual: equilibrium residual over the reference force; contact_residual: largest violation of the contact law over
    the reference pressure; penetration: largest penetration over the contactor's facet size; sticking, slipping: how many of
    the active ones of pairs with friction do, None where there is none.
    """

    step: int
    iteration: int
    active: int
    changed: int
    residual: float
    contact_residual: float
    penetration: float
    seconds: float
    sticking: int | None = None
    slipping: int | None = None

    @property
    def row(self) -> dict[str, int | float]:
        """By name, without what does not exist: a line of run.jsonl."""
        return {name: value for name, value in vars(self).items() if value is not None}


@dataclass(frozen=True)
class Phase:
    """A stage of the run begins. ``seconds``: how long it will take, from its size (None: not known); ``done`` of
    ``total`` load steps lie behind; share: of the time from 0 to 1 that lies behind, where nobody knows how many steps there
    will be."""

    name: str
    seconds: float | None = None
    done: int = 0
    total: int = 0
    share: float | None = None

    def __str__(self) -> str:
        return self.name if self.seconds is None else f"{self.name}: about {max(self.seconds, 1.0):.2g} s"


Observer = Callable[[Iteration | Phase | str], None]  # gets each iteration, stages that begin, and notes as text

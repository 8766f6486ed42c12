"""A load step solved once more in the frame that belongs to its end: the one loop, whatever the kinematics."""

from __future__ import annotations

from abc import ABC, abstractmethod
from typing import Self, TypeVar

from abut.problem.edge_trials import on_trial, refuses, with_refused
from abut.problem.frame import Frame
from abut.problem.problem import ContactProblem
from abut.solution.state import State


class Solved(ABC):
    """A load step as it was solved in a frame."""

    @property
    @abstractmethod
    def before(self) -> State:
        """The converged state that it begins with, by the functions of ``frame``."""

    @property
    @abstractmethod
    def frame(self) -> Frame:
        """In which it was solved."""

    @property
    @abstractmethod
    def end(self) -> State:
        """What it ends with, at its time."""

    @property
    @abstractmethod
    def converged(self) -> bool:
        """Whether ``end`` is a solution."""

    @abstractmethod
    def again(self, before: State, frame: Frame, guess: State) -> Self:
        """The step in another frame; guess: near its end."""

    @abstractmethod
    def unsteady(self) -> Self:
        """The step as one that has failed: a fluid spreads on with every solution."""


Step = TypeVar("Step", bound=Solved)


def in_frame_of_end(problem: ContactProblem, here: Step, solutions: int) -> Step:
    """The step ``here`` in the frame that belongs to its end: solved once more where that is another one, and up to
    ``solutions`` times where fluids get on, or functions at edges are on trial."""
    earlier = here
    for done in range(1 + solutions):
        frame = _following(problem, here) if done else _of_end(problem, here)
        if frame is here.frame:
            return here
        refused = refuses(here.frame, frame)
        known = earlier if refused else here  # what was refused has moved all off
        begin = problem.handed(here.before, here.frame, frame)
        there = here.again(begin, frame, problem.handed(known.end, known.frame, frame))
        if not (there.converged or refused) and frame.wet is here.frame.wet:
            return here
        here, earlier = there, here
    spreads = here.frame.wet and _of_end(problem, here).wet is not here.frame.wet
    return here.unsteady() if spreads else here


def _of_end(problem: ContactProblem, here: Solved) -> Frame:
    """That which belongs to the end; the same object where that one serves, or there is no solution."""
    return problem.settled(here.before, here.frame, here.end) if here.converged else here.frame


def _following(problem: ContactProblem, here: Solved) -> Frame:
    """The same of a step that has been solved again: only fluids, and what edges refuse, go on."""
    if not (here.frame.wet or on_trial(here.frame)):
        return here.frame
    end = _of_end(problem, here)
    return with_refused(here.frame, end).with_wet(end.wet)

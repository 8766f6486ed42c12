"""The errors that abut raises, each with the exit status of the command line."""

from __future__ import annotations

import difflib
from collections.abc import Iterable

LONGEST_NAME = 200  # characters, above which no name is meant


class AbutError(Exception):
    """Base of abut's errors: the message says what is wrong, where, and how to correct it."""

    exit_status = 2


class InputError(AbutError, ValueError):
    """A job, mesh or argument that cannot be used as given.

    >>> import abut
    >>> abut.LinearElastic(young=-1.0, poisson=0.3)
    Traceback (most recent call last):
    abut.errors.InputError: young: expected a number > 0, got -1.0
    """

    exit_status = 2


class ConvergenceError(AbutError, RuntimeError):
    """The iteration stopped before the residual met its tolerance."""

    exit_status = 3


class Unsound(ConvergenceError):
    """A trial state that no body can take, as where a cell turns inside out; a smaller load step may get by."""


class SingularModelError(AbutError, RuntimeError):
    """The model has no unique solution: free rigid-body mode or over-constraint."""

    exit_status = 4


class Stopped(AbutError):
    """The user asked a run to stop. Raised by an observer, it passes through ``solve`` unchanged."""

    exit_status = 130  # 128 + SIGINT, as shells have it


class OutOfTime(Stopped):
    """A run has taken as long as it may (``SolveOptions.seconds``) before its first step converged."""

    exit_status = 124  # as of timeout(1)


def closest(name: str, known: Iterable[str]) -> str:
    """Return ``"; did you mean 'x'?"`` for the closest known name, nothing where none is close."""
    match = difflib.get_close_matches(name, sorted(known), n=1) if len(name) <= LONGEST_NAME else []
    return f"; did you mean '{match[0]}'?" if match else ""


def nearest(name: str, known: Iterable[str]) -> str:
    """The closest known name as of ``closest``, else the list of what exists."""
    known = sorted(known)
    return closest(name, known) or (f"; known: {', '.join(known)}" if known else "; there are none")

"""Newton's method: the one loop of the nonlinear solution.

What it iterates on, and how, is a ``Method``:

============================  ===================================  ==============================  =====================
method                        linearised anew                      contact status                  globalised by
============================  ===================================  ==============================  =====================
``semismooth.LargeMotion``    geometry, material, contact          as laws ask at each state       line search, if asked
``load_step.Bodies``          material                             a search of its own: one below  whole steps
``active_set.ActiveSet``      the active set                       asked for, foreseen             ``search`` takes over
``search.Polish``             the active set                       asked for                       gives up
``search.InteriorContact``         products of pressures and gaps       where pressures win             inside their bounds
``friction_newton.Sliding``   the status with friction             asked for, foreseen             ``friction`` takes over
``friction.InteriorSliding``  products in second-order cones       where tractions win             inside their cones
``smooth_laws.SmoothLaws``    laws that are functions of gaps      asked for of all other pairs    line search
============================  ===================================  ==============================  =====================
"""

from __future__ import annotations

from enum import Enum
from typing import Generic, TypeVar

Trial = TypeVar("Trial")


class End(Enum):
    """Why iterations have ended."""

    SOLVED = "forces and laws are met"
    STALLED = "they go round in a circle, or no longer get better"
    EXHAUSTED = "as many as were allowed have been made"


class Method(Generic[Trial]):
    """How an iteration is made, the contact status chosen, a step globalised, and when it has all come to an end. ``Trial``
    is what an iteration leaves: a state, the status that laws ask for there, and what is left open."""

    def advanced(self, here: Trial) -> Trial:
        """The linear system near a trial, solved with the status to go on with; and what its solution leaves open."""
        raise NotImplementedError

    def globalised(self, here: Trial, there: Trial) -> Trial:
        """The whole step from ``here`` to ``there``, unless a method takes a part of it that leaves less."""
        return there

    def ended(self, there: Trial) -> End | None:
        """Why iterations end with a trial; None: they go on."""
        raise NotImplementedError

    def followed(self, there: Trial) -> Trial | None:
        """The trial with the status to go on with; None where no status is worth another iteration."""
        return there


def newton(method: Method[Trial], begin: Trial, limit: int) -> tuple[Trial, End]:
    """The last trial of at most ``limit`` iterations from ``begin`` on, and why they end there."""
    here = there = begin
    for _ in range(limit):
        there = method.globalised(here, method.advanced(here))
        end = method.ended(there)
        if end is not None:
            return there, end
        following = method.followed(there)
        if following is None:
            return there, End.STALLED
        here = following
    return there, End.EXHAUSTED

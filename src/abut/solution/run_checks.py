"""Lines of the certificate about a run as a whole."""

from __future__ import annotations

from collections.abc import Sequence

from abut.solution.contacts import Check
from abut.solution.energy import Energy

STABILISED = 0.05  # of the work done that drags may take
LANDED = 0.05  # what results depend on load steps by, about


def run_checks(steps: Sequence[tuple[tuple[float, float] | None, Energy | None]]) -> list[Check]:
    """Of what friction leaves unsure and its limit (as ``Step.landed``), and the energy of all steps."""
    found = _load_steps([landed for landed, _ in steps if landed is not None])
    taken = _stabilisation([energy for _, energy in steps if energy is not None])
    return [check for check in (found, taken) if check is not None]


def _load_steps(forces: Sequence[tuple[float, float]]) -> Check | None:
    """How much friction depends on the load steps, over all of them; None without friction at large sliding."""
    if not forces:
        return None
    unsure, limit = (sum(part) for part in zip(*forces))
    return Check("", "load steps", unsure / max(limit, 1e-300), LANDED,
                 "friction of points that touched and stuck in one step, where they did is known roughly, over all that "
                 "friction carries at most")  # fmt: skip


def _stabilisation(energies: Sequence[Energy]) -> Check | None:
    """What drags have taken, of all work that was done; None where none led a step."""
    taken = sum(abs(energy.stabilisation) for energy in energies)
    if taken == 0.0:
        return None
    work = sum(abs(energy.loads + energy.supports + energy.contact) for energy in energies)
    return Check("", "stabilisation", taken / max(work, 1e-300), STABILISED,
                 "energy that a drag took, where bodies jumped or hardly anything held them, over the work "
                 "done on them")  # fmt: skip

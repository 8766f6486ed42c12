"""Lines of the certificate about a run as a whole."""

from __future__ import annotations

from collections.abc import Sequence

from abut.solution.contacts import Check
from abut.solution.energy import Energy

STABILISED = 0.05  # of the work done that drags may take
JUMPED = 0.01  # of the work of a step that no way of equilibria explains
LANDED = 0.05  # what results depend on load steps by, about


def run_checks(steps: Sequence[tuple[float, tuple[float, float] | None, Energy | None]]) -> list[Check]:
    """Of all steps, by time, what friction leaves unsure and its limit (as ``Step.landed``), and their energy."""
    found = _load_steps([landed for _, landed, _ in steps if landed is not None])
    taken = _stabilisation([energy for _, _, energy in steps if energy is not None])
    jumped = _jumps([(time, energy) for time, _, energy in steps if energy is not None])
    return [check for check in (found, taken, jumped) if check is not None]


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


def _jumps(steps: Sequence[tuple[float, Energy]]) -> Check | None:
    """Of the steps, by the times at their ends, that Newton's method left the way of equilibria in; None for none."""
    jumps = [(time, energy.jumped) for time, energy in steps if energy.jumped > JUMPED]
    if not jumps:
        return None
    times = ", ".join(f"{time:.6g}" for time, _ in jumps)
    return Check("", "jumps", max(share for _, share in jumps), JUMPED,
                 "energy that no way of stable states from the step's beginning explains, over the work of the step; "
                 f"steps to time {times}")  # fmt: skip

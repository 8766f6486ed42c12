"""What is kept of a converged step, and the way back to it."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from abut.contact.laws import Linearisation
from abut.errors import InputError
from abut.problem.system import Outcome, Stage, System, Unknowns
from abut.solution import Saved


def saved_step(
    outcome: Outcome, own: Unknowns, after: Stage, time: float, linear: str, inside: NDArray[np.bool_]
) -> Saved:
    """outcome: of the step in all free displacements; own: its state in the unknowns of the linear solver; after: the stage
    that follows; inside: as in ``abut.nonlinear.load_step.Reached``."""
    u = outcome.unknowns
    return Saved(
        number=after.number - 1, factor=time, linear=linear, largest_force=after.force, largest_pressure=after.pressure,
        displacement=u.displacement, pressure=u.pressure, active=u.active, inside=inside,
        own_displacement=own.displacement, own_pressure=own.pressure, iterations=outcome.iterations,
    )  # fmt: skip


def check_order(resume: Sequence[Saved], n_free: int, n_multipliers: int) -> None:
    """Raise InputError unless the records are those of steps 1, 2, ... of a model of this size."""
    for number, saved in enumerate(resume, start=1):
        sizes = len(saved.displacement), len(saved.pressure)
        if saved.number != number or sizes != (n_free, n_multipliers):
            raise InputError(
                f"resume: expected step {number} with {n_free} displacements and {n_multipliers} multipliers, got step "
                f"{saved.number} with {sizes[0]} and {sizes[1]}; give all steps done before, of the same model, in order"
            )


def restored(saved: Saved) -> Outcome:
    """The outcome of a step as it was when it converged."""
    state = Unknowns(saved.displacement, saved.pressure, saved.active)
    return Outcome(state, saved.iterations, True, np.zeros(len(saved.active), dtype=bool), _no_laws)


def _no_laws(system: System, state: Unknowns) -> Sequence[Linearisation]:
    raise AssertionError("a step that has been restored is not solved again")


def begin_after(saved: Saved, fresh: Unknowns, note: Callable[[str], None]) -> Unknowns:
    """The state from which the next step starts; ``fresh``: at rest, in the unknowns of the linear solver now in use.

    The solver may keep other displacements than the one that saved (another library on another machine): then the step
    starts from the saved active set, and the note says so; the solution is the same but for rounding."""
    own = saved.own_displacement
    if own.shape == fresh.displacement.shape and saved.own_pressure.shape == fresh.pressure.shape:
        return Unknowns(own, saved.own_pressure, saved.active)
    note("restart: another linear solver than before; the first step starts from the active set alone")
    return replace(fresh, active=saved.active)

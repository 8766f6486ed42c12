"""What stays the same over all load steps of a model: supports, stiffness, loads, pairs, the system to solve."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import partial
from typing import TYPE_CHECKING

import numpy as np
import scipy.sparse as sp
from numpy.typing import NDArray

from abut.errors import InputError
from abut.linear.saddle_point import factorise, newton_step
from abut.model import Model
from abut.problem.backend import Volume, whole
from abut.problem.clock import Clock
from abut.problem.constraints import Supports, supports
from abut.problem.contact_pairs import Pair, pairs
from abut.problem.free_modes import Regularisation, regularise
from abut.problem.loads import Loads, loads
from abut.problem.restraint import Holding, holding, require_balance, require_unmoved
from abut.problem.system import System
from abut.solution import Observer, Phase

if TYPE_CHECKING:
    from abut.parallel.team import Team


@dataclass(frozen=True)
class Problem:
    """volume: the bodies, assembled; idle: motions that nothing resists nor drives; system: in the
    free displacements, without a linear solver yet."""

    held: Supports
    volume: Volume
    loaded: Loads
    held_by: Holding
    idle: Regularisation
    system: System

    @property
    def n_free(self) -> int:
        return len(self.system.load)


def problem(
    model: Model, observe: Observer, note: Callable[[str], None], clock: Clock, team: Team | None = None
) -> Problem:
    """Assemble a model, by a team of processes where there is one. Raises InputError and SingularModelError for one that
    cannot be solved."""
    held, loaded = supports(model), loads(model)
    clock.mark("set-up")
    volume = _volume(model, observe, note, clock, team)
    load = held.free.T @ (loaded.forces - volume.internal(held.prescribed))  # theory (F9)
    reduced = volume.reduce(held)
    clock.mark("assembly")
    observe(Phase("cutting and integrating the interface"))
    every = pairs(model, held, volume.couple)
    _describe(every, note)
    clock.mark("interface")
    observe(Phase("looking for motions that nothing holds"))
    held_by = holding(model.mesh, held, every)
    idle = regularise(held_by.rigid, held_by.everything, held, reduced, loaded.at_ends(model))
    for text in idle.notes:
        note(text)
    held_by, reduced = held_by.helped_by(idle.gram), idle.added_to(reduced)
    forces = [held.free.T @ force for force in loaded.at_ends(model)]
    require_balance(held_by, held, forces[0], " in step 1" if len(forces) > 1 else "")
    require_unmoved(held_by, held, forces)
    n_free = reduced.shape[0]
    operator = sp.vstack([p.operator for p in every]).tocsr() if every else sp.csr_matrix((0, n_free))
    _check_finite(reduced.diagonal(), loaded.forces)
    system = System(
        stiffness=reduced,
        load=load,
        pairs=every,
        operator=operator,
        complete=partial(held_by.complete, held, load),
        pulled_off=partial(held_by.pulled_off, held, load),
        step=partial(newton_step, reduced, operator),
        motions=held.coordinates(held_by.free),
        factorise=partial(factorise, reduced, operator),
    )
    note(f"{n_free} free displacements, {sum(map(len, every))} multipliers")
    clock.mark("set-up")
    return Problem(held, volume, loaded, held_by, idle, system)


def _volume(model: Model, observe: Observer, note: Callable[[str], None], clock: Clock, team: Team | None) -> Volume:
    if team is None:
        observe(Phase("assembling the stiffness"))
        result: Volume = whole(model)
    else:
        from abut.parallel.backend import deal_out

        observe(Phase(f"dealing the cells out to {team.size} processes"))
        parts = deal_out(model, team)
        note(parts.summary)
        clock.mark("partition")
        observe(Phase("assembling the stiffness"))
        result = parts.assembled()
    return result


def _describe(pairs: Sequence[Pair], note: Callable[[str], None]) -> None:
    for p in pairs:
        facets = len(p.contactor)
        covered = int((p.coupling.segments > 0).sum())
        note(
            f"contact '{p.contact.name}': {p.coupling.segments.sum()} segments on {covered} of {facets} facets, "
            f"pressure {p.space.name}, {len(p)} multipliers, {p.space.removed} removed (without support or fixed)"
        )
        if p.repeated:
            note(
                f"contact '{p.contact.name}': equations tie displacements of its surfaces together, so that its pressure is "
                "one of many; the smallest is taken"
            )


def _check_finite(*numbers: NDArray[np.float64]) -> None:
    """Every number may be sound by itself, and still a product too large for a computer. No entry of a stiffness is larger
    than the largest on its diagonal."""
    if not all(np.isfinite(values).all() for values in numbers):
        raise InputError(
            "stiffnesses or forces are too large to compute with; check the units of materials, loads, mesh"
        )

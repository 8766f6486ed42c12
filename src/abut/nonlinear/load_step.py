"""One load step: the search for the active set, and with "dual-P1" a second one with ordinary functions inside."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from functools import partial

import numpy as np
import scipy.sparse as sp
from numpy.typing import NDArray

from abut.contact.coupling import surface_degree
from abut.contact.pressure_space import DUAL_P1
from abut.linear.choice import Prepared
from abut.linear.saddle_point import factorise, newton_step
from abut.model import Model
from abut.nonlinear.active_set import solve_step
from abut.problem.constraints import Supports
from abut.problem.contact_pairs import with_plain_functions
from abut.problem.system import Outcome, Stage, System, Unknowns
from abut.solution import Iteration


@dataclass(frozen=True)
class Reached:
    """The end of a load step. outcome: in the unknowns of ``solver``; system: in the free displacements; inside: (n,) bool,
    the multipliers in contact that tell where the functions of "dual-P1" are the ordinary ones."""

    outcome: Outcome
    solver: Prepared
    system: System
    inside: NDArray[np.bool_]


def load_step(
    model: Model,
    held: Supports,
    system: System,
    solver: Prepared,
    begin: Unknowns,
    stage: Stage,
    observe: Callable[[Iteration], None],
) -> Reached:
    """Solve one load step from the state ``begin``, theory (P9).

    system, solver: with dual functions wherever the space has them. What is closed all over at the outset may stay so:
    that is tried first. Else dual functions tell where contact is closed, and there the ordinary ones take their place."""
    limit, none = model.solve.max_iterations, np.zeros(len(begin.active), dtype=bool)
    search = any(p.space.name == DUAL_P1 and surface_degree(p.contactor) == 2 for p in system.pairs)
    smooth = any(p.smooth for p in system.pairs)
    earlier: tuple[Iteration, ...] = ()
    inner = with_plain(model, held, system, begin.active) if begin.active.all() and not smooth else system
    if inner is not system:
        renewed = solver.renew(inner)
        outcome = solve_step(renewed.system, begin, stage, limit, observe, aim="this set")
        if outcome.converged:
            return Reached(outcome, renewed, inner, begin.active)
        earlier = outcome.iterations
        begin = replace(outcome.unknowns, active=begin.active & ~outcome.cycling)
    found = solve_step(solver.system, begin, stage, limit, observe, earlier, "set" if search else "solution")
    inside = found.unknowns.active
    inner = with_plain(model, held, system, inside) if found.converged else system
    if inner is not system:
        solver = solver.renew(inner)
    elif not (found.converged and search) or (solver.system.exact and not smooth):
        return Reached(found, solver, system, none)
    outcome = solve_step(solver.system, found.unknowns, stage, limit, observe, found.iterations, settle=True)
    return Reached(outcome, solver, inner, none if inner is system else inside)


def with_plain(model: Model, held: Supports, system: System, inside: NDArray[np.bool_]) -> System:
    """The system with the ordinary functions of "dual-P1" where the multipliers ``inside`` (n,) let them be; the same one
    where they are nowhere."""
    pairs = [with_plain_functions(model, p, held, own) for p, own in zip(system.pairs, system.split(inside))]
    if all(new is old for new, old in zip(pairs, system.pairs)):
        return system
    operator = sp.vstack([p.operator for p in pairs]).tocsr()
    return replace(
        system, pairs=pairs, operator=operator, step=partial(newton_step, system.stiffness, operator),
        factorise=partial(factorise, system.stiffness, operator),
    )  # fmt: skip

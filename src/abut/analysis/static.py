"""solve(model): supports, stiffness, contact pairs, load steps, results; the whole way on one page."""

from __future__ import annotations

import time
from collections.abc import Callable, Sequence
from functools import partial

import numpy as np
import scipy.sparse as sp
from numpy.typing import NDArray

from abut.analysis.holding import Holding, holding
from abut.analysis.loads import loads
from abut.analysis.results import step_result
from abut.conditions import weights
from abut.discretization.pairs import Pair, pairs
from abut.discretization.supports import supports
from abut.errors import SingularModelError
from abut.model import Model
from abut.solids.elements import stiffness
from abut.solvers.active_set import Stage, System, following, solve_step, start
from abut.solvers.blocks import newton_step
from abut.solvers.iterative import NotConverged
from abut.solvers.linear import Prepared, choose, prepare
from abut.state import Observer, Solution, Step

ABSURD = 1e6  # displacement over model size that no units explain


def _silent(_: object) -> None:
    return None


def solve(model: Model, observer: Observer | None = None) -> Solution:
    """Solve a model step by step.

    ``observer`` is called with every iteration (``abut.state.Iteration``) and with notes as text while it runs.
    A run that does not converge is returned with its last state (``solution.converged`` is False).
    Raises InputError for a model that cannot be used, SingularModelError for one without a unique solution.
    """
    observe: Observer = observer or _silent
    notes: list[str] = []

    def note(text: str) -> None:
        notes.append(text)
        observe(text)

    clock = _Clock()
    materials = {solid.body: solid.material for solid in model.solids}
    held = supports(model)
    full_stiffness = stiffness(model.mesh, materials, model.plane, model.integration)
    loaded = loads(model)
    clock.mark("assembly")
    every = pairs(model, held)
    _describe(every, note)
    clock.mark("interface")
    held_by: Holding = holding(model.mesh, held, every)
    held_by.check()
    reduced = held.reduce(full_stiffness)
    n_free = reduced.shape[0]
    operator = sp.vstack([p.operator for p in every]).tocsr() if every else sp.csr_matrix((0, n_free))
    system = System(
        stiffness=reduced,
        load=held.free.T @ (loaded.forces - full_stiffness @ held.prescribed),  # theory (F9)
        pairs=every,
        operator=operator,
        complete=held_by.complete,
        freed=held_by.freed,
        step=partial(newton_step, reduced, operator),
    )
    note(f"{n_free} free displacements, {sum(map(len, every))} multipliers")
    clock.mark("set-up")

    loose = held.coordinates(held_by.free)

    def linear_solver(kind: str) -> Prepared:
        result = prepare(kind, system, held.free, held_by.rigid.together, loose, model.dim)
        note(result.note)
        return result

    solver = linear_solver(choose(model.solve.linear, system, model.mesh, held.coupled))
    state = start(solver.system)
    steps: list[Step] = []
    times = model.solve.ends
    stage = Stage(1, weights(model.histories, times[0]))
    for time_, then in zip(times, [*times[1:], times[-1]]):
        try:
            outcome = solve_step(solver.system, state, stage, model.solve.max_iterations, observe)
        except NotConverged as reason:
            note(f"step {stage.number}: {reason}: going on with the direct solver")
            solver = linear_solver("direct")
            outcome = solve_step(solver.system, start(solver.system), stage, model.solve.max_iterations, observe)
        state = outcome.unknowns
        after = following(solver.system, stage, outcome, weights(model.histories, then))
        outcome = solver.finish(outcome, stage.weights)
        displacement = held.free @ outcome.unknowns.displacement + held.prescribed @ stage.weights
        clock.mark("solve")
        _check_size(model, displacement, note)
        steps.append(
            step_result(model, full_stiffness, loaded, displacement, system, outcome, stage, time_, steps, held)
        )
        clock.mark("results")
        if not outcome.converged:
            note(f"step {stage.number} did not converge in {len(outcome.iterations)} iterations")
            break
        stage = after
    if solver.count is not None:
        note(f"{solver.count.iterations} linear iterations in all")
    return Solution(model, tuple(steps), n_free, solver.name, tuple(notes), clock.timings)


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


def _check_size(model: Model, displacement: NDArray[np.float64], note: Callable[[str], None]) -> None:
    """Displacements beyond the size of the model mean wrong units, or a matrix that is singular in all but name."""
    extent = float(np.ptp(model.mesh.points, axis=0).max())
    largest = float(np.abs(displacement).max(initial=0.0))
    if not largest < ABSURD * extent:
        raise SingularModelError(
            f"displacements of {largest:.2g} in a model of size {extent:.2g} make no sense: check the units of Young's "
            "moduli, loads and mesh, and that supports hold every body"
        )
    if largest > extent:
        note(
            f"displacements of {largest:.2g} exceed the model's size {extent:.2g}: check units (displacements must be small)"
        )


class _Clock:
    """Seconds spent since the last mark, by stage."""

    def __init__(self) -> None:
        self.timings: dict[str, float] = {}
        self._last = time.perf_counter()

    def mark(self, stage: str) -> None:
        now = time.perf_counter()
        self.timings[stage] = self.timings.get(stage, 0.0) + now - self._last
        self._last = now

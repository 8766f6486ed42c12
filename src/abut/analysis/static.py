"""solve(model): supports, stiffness, contact pairs, load steps, results; the whole way on one page."""

from __future__ import annotations

import time
from collections.abc import Callable, Sequence
from dataclasses import replace
from functools import partial

import numpy as np
import scipy.sparse as sp
from numpy.typing import NDArray

from abut.analysis.holding import Holding, holding
from abut.analysis.loads import loads
from abut.analysis.regularisation import regularise
from abut.analysis.results import step_result
from abut.analysis.resume import begin_after, check_order, restored, saved_step
from abut.conditions import weights
from abut.discretization.pairs import Pair, pairs
from abut.discretization.supports import supports
from abut.errors import InputError, SingularModelError
from abut.model import Model
from abut.solids.elements import stiffness
from abut.solvers.active_set import Outcome, Stage, System, following, solve_step, start
from abut.solvers.blocks import newton_step
from abut.solvers.iterative import NotConverged
from abut.solvers.linear import Prepared, choose, expected_seconds, prepare
from abut.state import Observer, OnStep, Phase, Saved, Solution, Step

ABSURD = 1e6  # displacement over model size that no units explain


def _silent(*_: object) -> None:
    return None


def solve(
    model: Model, observer: Observer | None = None, on_step: OnStep | None = None, resume: Sequence[Saved] = ()
) -> Solution:
    """Solve a model step by step.

    ``observer`` is called with every iteration (``abut.state.Iteration``), with stages that begin (``abut.state.Phase``)
    and with notes as text while it runs; what it raises ends the run. ``on_step`` gets the solution so far after each
    converged step, and what it takes to go on from there; ``resume``: such records of all steps done before, in order,
    of the same model: the run goes on after the last of them.
    A run that does not converge is returned with its last state (``solution.converged`` is False).
    Raises InputError for a model that cannot be used, SingularModelError for one without a unique solution.
    """
    observe: Observer = observer or _silent
    keep: OnStep = on_step or _silent
    notes: list[str] = []

    def note(text: str) -> None:
        notes.append(text)
        observe(text)

    clock = _Clock()
    observe(Phase("assembling the stiffness"))
    materials = {solid.body: solid.material for solid in model.solids}
    held = supports(model)
    full_stiffness = stiffness(model.mesh, materials, model.plane, model.integration)
    loaded = loads(model)
    clock.mark("assembly")
    observe(Phase("cutting and integrating the interface"))
    every = pairs(model, held)
    _describe(every, note)
    clock.mark("interface")
    observe(Phase("looking for motions that nothing holds"))
    held_by: Holding = holding(model.mesh, held, every)
    reduced = held.reduce(full_stiffness)
    idle = regularise(held_by.rigid, held_by.everything, held, reduced, loaded.at_ends(model))
    for text in idle.notes:
        note(text)
    held_by, reduced = held_by.helped_by(idle.gram), idle.added_to(reduced)
    n_free = reduced.shape[0]
    operator = sp.vstack([p.operator for p in every]).tocsr() if every else sp.csr_matrix((0, n_free))
    _check_finite(reduced.data, loaded.forces)
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
        what = "factorising" if kind == "direct" else "setting up multigrid for"
        size = f"{n_free:,}".replace(",", " ")
        observe(Phase(f"{what} {size} displacements", expected_seconds(kind, n_free, model.dim)))
        result = prepare(kind, system, held.free, held_by.rigid.together, loose, model.dim)
        note(result.note)
        return result

    def result(outcome: Outcome, stage: Stage, time_: float) -> Step:
        displacement = held.free @ outcome.unknowns.displacement + held.prescribed @ stage.weights
        spring = idle.force(outcome.unknowns.displacement) if len(idle) else None
        displacement = idle.without_motions(displacement)
        _check_size(model, displacement, note)
        step = step_result(model, full_stiffness, loaded, displacement, system, outcome, stage, time_, steps, held)
        return replace(step, spring=spring)

    def so_far(complete: bool) -> Solution:
        return Solution(model, tuple(steps), n_free, solver.name, tuple(notes), dict(clock.timings), complete)

    times = [t for t in model.solve.ends if not resume or t > resume[-1].factor * (1.0 + 1e-12)]
    check_order(resume, n_free, operator.shape[0])
    kind = choose(model.solve.linear, system, model.mesh, held.coupled)
    if resume and model.solve.linear == "auto":
        kind = resume[-1].linear
    solver = linear_solver(kind)
    state = start(solver.system)
    steps: list[Step] = []
    force = pressure = 0.0
    if resume:
        observe(Phase("restoring the steps done before"))
        for saved in resume:
            stage = Stage(saved.number, weights(model.histories, saved.factor), force, pressure)
            steps.append(result(restored(saved), stage, saved.factor))
            force, pressure = saved.largest_force, saved.largest_pressure
        state = begin_after(resume[-1], state, note)
        clock.mark("results")
    count = len(steps) + len(times)
    for number, time_ in enumerate(times, start=len(steps) + 1):
        observe(Phase(f"step {number} of {count}", None, number - 1, count))
        stage = Stage(number, weights(model.histories, time_), force, pressure)
        try:
            outcome = solve_step(solver.system, state, stage, model.solve.max_iterations, observe)
        except NotConverged as reason:
            note(f"step {number}: {reason}: going on with the direct solver")
            kind = "direct"
            solver = linear_solver(kind)
            outcome = solve_step(solver.system, start(solver.system), stage, model.solve.max_iterations, observe)
        state = outcome.unknowns
        after = following(solver.system, stage, outcome, stage.weights)
        force, pressure = after.force, after.pressure
        outcome = solver.finish(outcome, stage.weights)
        clock.mark("solve")
        observe(Phase(f"stresses and checks of step {number}", None, number - 1, count))
        steps.append(result(outcome, stage, time_))
        clock.mark("results")
        if not outcome.converged:
            note(f"step {number} did not converge in {len(outcome.iterations)} iterations")
            break
        keep(so_far(complete=False), saved_step(outcome, state, after, time_, kind))
        clock.mark("writing")
    if solver.count is not None:
        note(f"{solver.count.iterations} linear iterations in all")
    return so_far(complete=True)


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


def _check_finite(*numbers: NDArray[np.float64]) -> None:
    """Every number may be sound by itself, and still a product too large for a computer."""
    if not all(np.isfinite(values).all() for values in numbers):
        raise InputError(
            "stiffnesses or forces are too large to compute with; check the units of materials, loads, mesh"
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

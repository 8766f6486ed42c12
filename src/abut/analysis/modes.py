"""Frequencies and buckling loads about the state that a run ends with."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

from abut.bodies.stress_stiffness import stress_stiffness
from abut.errors import InputError, nearest
from abut.model import Buckling, Frequencies, Model
from abut.modes.buckling import buckling
from abut.modes.complex_frequencies import complex_frequencies
from abut.modes.cyclic import cyclic_frequencies, sides
from abut.modes.frequencies import densities, frequencies
from abut.modes.held import Held, held
from abut.modes.sliding import sliding
from abut.modes.spinning import spin_softening
from abut.nonlinear.attempt import Attempt
from abut.problem.assembly import Assembled
from abut.problem.problem import ContactProblem
from abut.solution import ModesResult
from abut.solution.state import State
from abut.types import Sparse


def check_modes(model: Model, team: bool) -> None:
    """Raise InputError for what is asked for and cannot be found. team: whether processes, or PETSc on one, solve it."""
    if not model.modes:
        return
    if team:
        raise InputError("modes: frequencies and buckling loads are found on one process without PETSc (solve.linear)")
    for wanted in model.modes:
        if isinstance(wanted, Frequencies) and wanted.side and wanted.side not in model.mesh.node_sets:
            raise InputError(
                f"frequencies: side: no node set named '{wanted.side}'{nearest(wanted.side, model.mesh.node_sets)}"
            )
        if isinstance(wanted, Frequencies):
            densities(model)
    if model.connectors:
        raise InputError(
            "modes: frequencies and buckling loads of assemblies with connectors are not known; leave one out"
        )
    if model.physics:
        raise InputError("modes: frequencies and buckling loads are those of displacements alone; leave physics out")
    if model.finite and any(isinstance(wanted, Buckling) for wanted in model.modes):
        raise InputError(
            f'buckling: linear buckling is about bodies at small displacements, and kinematics is "{model.kinematics}"; '
            "with it the load steps themselves lead to the load at which the assembly gives way"
        )


def modes(assembled: Assembled, before: State, attempt: Attempt) -> tuple[ModesResult, ...]:
    """All that the model asks for. before: the state that the last attempt, which converged, began with.

    Raises InputError, ConvergenceError and SingularModelError."""
    state, problem = attempt.state, assembled.problem
    if not problem.model.modes:
        return ()
    own = problem.with_ordinary(attempt.inside) if attempt.inside.any() else problem
    system = own.again(before, state)
    near = problem.constraints.near(state.unknowns, system.factors)
    there = held(own, system, state)
    stressed = _stressed(assembled, state) if problem.model.small_strains else None
    spins = spin_softening(problem.model, state.time)

    def added(wanted: Frequencies) -> Sparse | None:
        """What the state adds to the stiffness of a linear body, or to the tangent of one at large displacements."""
        if stressed is None:
            return spins
        return (stressed + spins).tocsr() if wanted.stiffening else None

    def found(wanted: Frequencies | Buckling) -> tuple[ModesResult, ...]:
        if isinstance(wanted, Buckling):
            assert stressed is not None  # as checked at the outset
            return (buckling(problem.model, near, there, stressed, wanted),)
        around = tuple(diameter for diameter in wanted.diameters if diameter)
        alike = (one(wanted),) if len(around) < len(wanted.diameters) else ()
        return alike + (_around(own, before, state, added(wanted), wanted, around) if around else ())

    def one(wanted: Frequencies) -> ModesResult:
        more = added(wanted)
        tight = there if more is None else _stiffened(there, near.reduce(more))
        if wanted.complex:
            return complex_frequencies(problem.model, near, tight, sliding(system, state, there), wanted)
        return frequencies(problem.model, near, tight, wanted)

    return tuple(result for wanted in problem.model.modes for result in found(wanted))


def _around(
    problem: ContactProblem, before: State, state: State, added: Sparse | None, wanted: Frequencies,
    diameters: Sequence[int],
) -> tuple[ModesResult, ...]:  # fmt: skip
    """Frequencies with nodal diameters."""
    apart = sides(problem.model, problem.constraints, wanted.side)
    wide = apart.problem(problem)
    there = apart.state(state)
    tight = held(wide, wide.again(apart.state(before), there), there)
    if added is not None:
        tight = _stiffened(tight, apart.constraints.reduce(added))
    return cyclic_frequencies(problem.model, apart, tight, wanted, diameters)


def _stiffened(there: Held, added: Sparse) -> Held:
    return replace(there, stiffness=(there.stiffness + added).tocsr()) if added.nnz else there


def _stressed(assembled: Assembled, state: State) -> Sparse:
    """The stiffness that stresses add, over all points."""
    problem, bodies = assembled.problem, assembled.bodies
    motion = replace(problem.motion(state.time, problem.values(state)), history=state.history.of(bodies.name))
    return stress_stiffness(problem.model.deformable, bodies.stress(motion))

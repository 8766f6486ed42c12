"""Frequencies, buckling loads and vibrations about the states that load steps end with."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np

from abut.bodies.stress_stiffness import stress_stiffness
from abut.errors import InputError, nearest
from abut.model import Buckling, Centrifugal, Frequencies, Harmonic, Model, Transient
from abut.model.response import basis_of
from abut.modes.buckling import buckling
from abut.modes.complex_frequencies import complex_frequencies
from abut.modes.cyclic import cyclic_frequencies, sides
from abut.modes.frequencies import densities, frequencies
from abut.modes.held import Held, held
from abut.modes.response import respond
from abut.modes.sliding import sliding
from abut.modes.spinning import spin_softening
from abut.modes.whirling import whirling_frequencies
from abut.nonlinear.attempt import Attempt
from abut.probing import Place
from abut.problem.assembly import Assembled
from abut.problem.constraints import Constraints
from abut.problem.linearised import Linearised
from abut.problem.problem import ContactProblem
from abut.solution import ModesResult, ResponseResult
from abut.solution.state import OPEN, State
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
            if wanted.coriolis and any(rigid.density for rigid in model.rigid):
                raise InputError(
                    "frequencies: coriolis: rigid bodies with a mass do not turn; make them solids of a stiff material"
                )
            _check_open(model, wanted)
            _check_turning(model, wanted)
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


def _check_turning(model: Model, wanted: Frequencies) -> None:
    if wanted.coriolis and not any(isinstance(load, Centrifugal) for load in model.loads):
        raise InputError("frequencies: coriolis: nothing turns; give a load of kind centrifugal, with its speed")
    if wanted.coriolis and model.mesh.axisymmetric:
        raise InputError(
            "frequencies: coriolis: these forces twist what moves away from the axis, and axisymmetric models have no "
            "twist; model the whole in 3D"
        )


def _check_open(model: Model, wanted: Frequencies) -> None:
    known = [contact.name for contact in model.contacts]
    for name in wanted.open:
        if name not in known:
            raise InputError(f"frequencies: open: no contact named '{name}'{nearest(str(name), known)}")


def massless(model: Model) -> list[str]:
    """What to say of rigid bodies that may move and have no mass."""
    free = [
        rigid for rigid in model.rigid if not rigid.density and None in (getattr(rigid, a) for a in "xyz"[: model.dim])
    ]
    if not any(isinstance(wanted, Frequencies) for wanted in model.modes):
        return []
    return [f"frequencies: rigid body '{rigid.body}' has no mass; give it a density where it counts" for rigid in free]


@dataclass(frozen=True)
class Reached:
    """A converged state as vibrations see it. before, state: at the begin and the end of its step; problem, system: there;
    near: the linear change of variables; stressed: stiffness that stresses add, (dim n_points, dim n_points), None where the
    tangent has it; spins: of rotation; apart: contacts that hold nothing."""

    problem: ContactProblem
    before: State
    state: State
    system: Linearised
    near: Constraints
    stressed: Sparse | None
    spins: Sparse
    apart: frozenset[str] = frozenset()

    @classmethod
    def of(cls, assembled: Assembled, before: State, attempt: Attempt) -> Reached:
        """before: the state that the attempt, which converged, began with."""
        problem = assembled.problem
        own = problem.with_ordinary(attempt.inside) if attempt.inside.any() else problem
        return cls._of(assembled, own, before, attempt.state)

    @classmethod
    def at_start(cls, assembled: Assembled) -> Reached:
        """Before anything acts."""
        start = assembled.problem.start()
        return cls._of(assembled, assembled.problem, start, start)

    @classmethod
    def _of(cls, assembled: Assembled, own: ContactProblem, before: State, state: State) -> Reached:
        problem, system = assembled.problem, own.again(before, state)
        near = problem.constraints.near(state.unknowns, system.factors)
        stressed = _stressed(assembled, state) if problem.model.small_strains else None
        return cls(own, before, state, system, near, stressed, spin_softening(problem.model, state.time))

    def as_in(self, wanted: Frequencies | Buckling) -> Reached:
        """With the contacts open that hold nothing in these modes, which before anything acts are all but ties. Where bodies
        have moved, what presses them is gone from the stiffness, too, which it changes as it turns with them."""
        idle = (pair.contact.name for pair in self.problem.pairs if not (self.state.time or pair.two_way))
        apart = frozenset(wanted.open if isinstance(wanted, Frequencies) else ()).union(idle)
        if not apart:
            return self
        every = [np.full(len(pair), pair.contact.name in apart) for pair in self.problem.pairs]
        gone = np.concatenate(every)
        pressed, status = np.where(gone, 0.0, self.state.multipliers), np.where(gone, OPEN, self.state.status)
        state = replace(self.state, multipliers=pressed, status=status)
        return replace(self, state=state, system=self.problem.again(self.before, state), apart=apart)

    @property
    def there(self) -> Held:
        """Stiffness and contact, but for what the state adds."""
        return held(self.problem, self.system, self.state, self.apart)

    def added(self, wanted: Frequencies) -> Sparse | None:
        """What the state adds to the stiffness of a linear body, or to the tangent of one at large displacements."""
        if self.stressed is None:
            return self.spins
        return (self.stressed + self.spins).tocsr() if wanted.stiffening else None

    def tight(self, wanted: Frequencies) -> Held:
        """Stiffness and contact that these modes have."""
        more = self.added(wanted)
        return self.there if more is None else _stiffened(self.there, self.near.reduce(more))


def modes(
    assembled: Assembled, ends: Mapping[float, tuple[State, Attempt]], places: Sequence[Place]
) -> tuple[tuple[ModesResult, ...], tuple[ResponseResult, ...]]:
    """All that the model asks for, at the times of ``ends``: the state that the attempt, which converged, began with, and
    that. places: of probes.

    Raises InputError, ConvergenceError and SingularModelError."""
    model = assembled.problem.model
    there = {time: Reached.of(assembled, *end) for time, end in ends.items()}
    if any(wanted.time == 0.0 for wanted in model.modes):
        there[0.0] = Reached.at_start(assembled)
    found: list[tuple[Frequencies | Buckling, ModesResult]] = []
    for wanted in model.modes:
        if isinstance(wanted, (Frequencies, Buckling)) and wanted.time in there:
            found += [(wanted, result) for result in _found(there[wanted.time].as_in(wanted), wanted)]
    answers = []
    for wanted in model.modes:
        if isinstance(wanted, (Harmonic, Transient)) and wanted.time in there:
            made_of, result = next((w, r) for w, r in found if basis_of(w, wanted) and not r.diameter)
            assert isinstance(made_of, Frequencies)
            at = there[wanted.time].as_in(made_of)
            answers.append(respond(model, at.near, at.tight(made_of), result, places, wanted))
    return tuple(result for _, result in found), tuple(answers)


def _found(at: Reached, wanted: Frequencies | Buckling) -> tuple[ModesResult, ...]:
    if isinstance(wanted, Buckling):
        assert at.stressed is not None  # as checked at the outset
        return (buckling(at.problem.model, at.near, at.there, at.stressed, wanted),)
    around = tuple(diameter for diameter in wanted.diameters if diameter)
    alike = (_one(at, wanted),) if len(around) < len(wanted.diameters) else ()
    return alike + (_around(at, wanted, around) if around else ())


def _one(at: Reached, wanted: Frequencies) -> ModesResult:
    tight = at.tight(wanted)
    slides = sliding(at.system, at.state, tight) if wanted.complex else None
    if wanted.coriolis:
        return whirling_frequencies(at.problem.model, at.near, tight, slides, at.state.time, wanted)
    if slides is not None:
        return complex_frequencies(at.problem.model, at.near, tight, slides, wanted)
    return frequencies(at.problem.model, at.near, tight, wanted)


def _around(at: Reached, wanted: Frequencies, diameters: Sequence[int]) -> tuple[ModesResult, ...]:
    """Frequencies with nodal diameters."""
    problem, added = at.problem, at.added(wanted)
    apart = sides(problem.model, problem.constraints, wanted.side)
    wide = apart.problem(problem)
    there = apart.state(at.state)
    tight = held(wide, wide.again(apart.state(at.before), there), there, at.apart)
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

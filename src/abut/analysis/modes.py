"""Frequencies, buckling loads and vibrations about the states that load steps end with."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

import numpy as np

from abut.errors import InputError, nearest
from abut.model import Buckling, Centrifugal, Frequencies, Harmonic, Model, Transient
from abut.model.response import basis_of
from abut.modes.buckling import buckling
from abut.modes.complex_frequencies import complex_frequencies
from abut.modes.cyclic import cyclic_frequencies, sides
from abut.modes.factors import Alone
from abut.modes.frequencies import densities, frequencies
from abut.modes.held import Eigensolver, Held, held
from abut.modes.response import respond
from abut.modes.sliding import sliding
from abut.modes.spinning import spin_softening
from abut.modes.whirling import whirling_frequencies
from abut.nonlinear.attempt import Attempt
from abut.probing import Place
from abut.problem.assembly import Assembled
from abut.problem.backend import Backend
from abut.problem.constraints import Constraints
from abut.problem.linearised import Linearised
from abut.problem.problem import ContactProblem
from abut.problem.terms import Tangent
from abut.solution import ModesResult, ResponseResult
from abut.solution.state import OPEN, State

if TYPE_CHECKING:
    from abut.parallel.team import Team


def eigensolver(team: Team | None) -> Eigensolver:
    """What finds modes, of one process or of a team."""
    if team is None:
        return Alone()
    from abut.modes.together import Together

    return Together(team)


def check_modes(model: Model, team: bool) -> None:
    """Raise InputError for what is asked for and cannot be found. team: whether processes, or PETSc on one, solve it."""
    if not model.modes:
        return
    if team:
        _check_team(model)
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
        _check_joined(model, team)
    if model.physics:
        raise InputError("modes: frequencies and buckling loads are those of displacements alone; leave physics out")
    if model.finite and any(isinstance(wanted, Buckling) for wanted in model.modes):
        raise InputError(
            f'buckling: linear buckling is about bodies at small displacements, and kinematics is "{model.kinematics}"; '
            "with it the load steps themselves lead to the load at which the assembly gives way"
        )


def _check_joined(model: Model, team: bool) -> None:
    """Raise InputError for what cannot be found of assemblies with connectors."""
    if team:
        raise InputError(
            "frequencies: of assemblies with connectors on one process without PETSc (solve.linear); start one"
        )
    for wanted in model.modes:
        if isinstance(wanted, Buckling):
            raise InputError(
                "buckling: joints let bodies turn, which linear buckling takes for small; leave connectors out, or let load "
                'steps with kinematics "finite" lead to the load at which the mechanism gives way'
            )
        if isinstance(wanted, Frequencies) and (wanted.complex or wanted.coriolis or any(wanted.diameters)):
            what = "complex" if wanted.complex else "coriolis" if wanted.coriolis else "diameters"
            raise InputError(f"frequencies: {what}: not known of assemblies with connectors; leave one of both out")


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


def _check_team(model: Model) -> None:
    """Raise InputError for what processes, or PETSc on one, cannot find."""
    for wanted in model.modes:
        if isinstance(wanted, Frequencies) and (wanted.complex or wanted.coriolis or any(wanted.diameters)):
            named = "complex = true" if wanted.complex else "coriolis = true" if wanted.coriolis else ""
            what = named or "nodal diameters other than 0"
            raise InputError(f"frequencies: {what}: found on one process without PETSc (solve.linear); start one only")
    from abut.parallel.launch import require_slepc

    require_slepc()


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
    near: the linear change of variables; stressed: stiffness that stresses add, over all points, None where the tangent has
    it; bodies: assembled; by: what finds modes; apart: contacts that hold nothing."""

    problem: ContactProblem
    before: State
    state: State
    system: Linearised
    near: Constraints
    stressed: Tangent | None
    bodies: Backend
    by: Eigensolver
    apart: frozenset[str] = frozenset()

    @classmethod
    def of(cls, assembled: Assembled, before: State, attempt: Attempt, by: Eigensolver) -> Reached:
        """before: the state that the attempt, which converged, began with; by: what finds modes."""
        problem = assembled.problem
        own = problem.with_ordinary(attempt.inside) if attempt.inside.any() else problem
        return cls._of(assembled, own, before, attempt.state, by)

    @classmethod
    def at_start(cls, assembled: Assembled, by: Eigensolver) -> Reached:
        """Before anything acts."""
        start = assembled.problem.start()
        return cls._of(assembled, assembled.problem, start, start, by)

    @classmethod
    def _of(cls, assembled: Assembled, own: ContactProblem, before: State, state: State, by: Eigensolver) -> Reached:
        problem, system = assembled.problem, own.again(before, state)
        near = problem.constraints.near(state.unknowns, system.factors).moving
        stressed = _stressed(assembled, state) if problem.model.small_strains else None
        return cls(own, before, state, system, near, stressed, assembled.backend, by)

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
        return held(self.problem, self.system, self.state, self.by, self.apart)

    def stiffened(self, there: Held, constraints: Constraints, wanted: Frequencies) -> Held:
        """With what the state adds to the stiffness of a linear body, or to the tangent of one at large displacements."""
        if self.stressed is not None and not wanted.stiffening:
            return there
        more = spin_softening(self.problem.model, self.bodies, constraints, self.state.time)
        if self.stressed is not None:  # both are small beside the stiffness: together first
            stressed = self.stressed.reduce(constraints)
            more = stressed if more is None else stressed + more
        return there if more is None else replace(there, stiffness=there.stiffness + more)

    def tight(self, wanted: Frequencies) -> Held:
        """Stiffness and contact that these modes have."""
        return self.stiffened(self.there, self.near, wanted)


def modes(
    assembled: Assembled, ends: Mapping[float, tuple[State, Attempt]], places: Sequence[Place], by: Eigensolver
) -> tuple[tuple[ModesResult, ...], tuple[ResponseResult, ...]]:
    """All that the model asks for, at the times of ``ends``: the state that the attempt, which converged, began with, and
    that. places: of probes; by: what finds modes.

    Raises InputError, ConvergenceError and SingularModelError."""
    model = assembled.problem.model
    there = {time: Reached.of(assembled, *end, by) for time, end in ends.items()}
    if any(wanted.share == 0.0 for wanted in model.modes):
        there[0.0] = Reached.at_start(assembled, by)
    found: list[tuple[Frequencies | Buckling, ModesResult]] = []
    for wanted in model.modes:
        if isinstance(wanted, (Frequencies, Buckling)) and wanted.share in there:
            found += [(wanted, result) for result in _found(there[wanted.share].as_in(wanted), wanted)]
    answers = []
    for wanted in model.modes:
        if isinstance(wanted, (Harmonic, Transient)) and wanted.share in there:
            made_of, result = next((w, r) for w, r in found if basis_of(w, wanted) and not r.diameter)
            assert isinstance(made_of, Frequencies)
            at = there[wanted.share].as_in(made_of)
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
    model = at.problem.model
    return frequencies(model, at.near, tight, at.bodies.mass(densities(model)), wanted)


def _around(at: Reached, wanted: Frequencies, diameters: Sequence[int]) -> tuple[ModesResult, ...]:
    """Frequencies with nodal diameters."""
    model = at.problem.model
    apart = sides(model, at.problem.constraints, wanted.side)
    wide, there = apart.problem(at.problem), apart.state(at.state)
    loose = held(wide, wide.again(apart.state(at.before), there), there, at.by, at.apart)
    return cyclic_frequencies(model, apart, at.stiffened(loose, apart.constraints, wanted), wanted, diameters)


def _stressed(assembled: Assembled, state: State) -> Tangent:
    """The stiffness that stresses add, over all points."""
    problem, bodies = assembled.problem, assembled.bodies
    motion = replace(problem.motion(state.time, problem.values(state)), history=state.history.of(bodies.name))
    return assembled.backend.stress_stiffness(bodies.stress(motion))

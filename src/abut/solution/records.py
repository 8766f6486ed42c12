"""Results: iterations, steps and the solution, as frozen records."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from functools import cached_property
from typing import Any

import numpy as np
from numpy.typing import NDArray

from abut.brief import NAMED, brief, listed, vector
from abut.materials.invariants import von_mises
from abut.model import Model
from abut.model.locking import LOCKED, STIFF, locking
from abut.solution.apart import bodies_apart
from abut.solution.connectors import ConnectorResult
from abut.solution.contacts import Check, ContactResult, worst
from abut.solution.driven import driven, forces_act
from abut.solution.energy import Energy
from abut.solution.flow import Flow
from abut.solution.hourglass import hourglass
from abut.solution.idle import idle_contacts
from abut.solution.modes import ModesResult
from abut.solution.penetrations import PenetrationResult
from abut.solution.preloads import PreloadResult, preload_checks, weak_checks
from abut.solution.progress import Iteration
from abut.solution.responses import ResponseResult
from abut.solution.run_checks import run_checks
from abut.solution.state import State
from abut.solution.stress_error import StressError
from abut.solution.volume_change import VolumeChange

BALANCE = 1e-9  # limit of the model's balance of forces
ROUNDED = 1e-6  # the same at most, where a stiff part that moves with a soft one leaves no more digits
STRAIN = 0.3  # about the largest that linear elasticity takes for small; wrong units miss it by powers of ten
TURN, TURN_NOTICED = 0.2, 0.1  # radians: lengths are wrong by half its square, 2 % and 0.5 %
RESPONSE = 0.5  # nothing between 0 and 1
STRESS_ERROR = 1.0  # then what elements and nodes differ by is as large as the stresses that nodes show
STRESS_NOTICED = 0.25  # from which on recovered stresses of linear cells were seen to be off by 5 % at contact nodes
REGULARISATION = 1e-9  # limit of the force that constrains free rigid-body modes: zero but for rounding


@dataclass(frozen=True)
class RigidResult:
    """A rigid body at the end of a step: displacement (dim,) of its reference and rotation (1,) or (3,), radians; force
    (dim,) and moment (1,) or (3,) about the reference that move it, zero where a component is free."""

    displacement: NDArray[np.float64]
    rotation: NDArray[np.float64]
    force: NDArray[np.float64]
    moment: NDArray[np.float64]


@dataclass(frozen=True)
class ProbeResult:
    """What a probe reads at the end of a step.

    points: (n, dim) coordinates in the undeformed mesh, length; distance: (n,) along the line from its start, length, and
    nodes: (n,) numbers of the mesh's points, each None where the probe is no line or no set.
    values: by name displacement and reaction (n, dim), stress (n, 6) xx yy zz xy yz zx, von_mises (n,), principal_stress
    (n, 3), max_shear (n,), plastic_strain (n, 6), equivalent_plastic_strain, pressure, gap (n,), as far as asked for; NaN
    where a quantity does not exist at a point.
    """

    name: str
    points: NDArray[np.float64]
    distance: NDArray[np.float64] | None
    nodes: NDArray[np.int64] | None
    values: Mapping[str, NDArray[np.float64]]

    __repr__ = brief


@dataclass(frozen=True)
class Flips:
    """Nodes of a contact with friction whose status keeps changing. nodes: (n,) point numbers of the mesh; between: (n, 3)
    bool, among open, sticking and slipping."""

    nodes: NDArray[np.int64]
    between: NDArray[np.bool_]


@dataclass(frozen=True)
class Step:
    """The state at the end of a load step, at ``time``; ``factor`` in (0, 1] is its share of the end of the run: that of
    loads and displacements applied, where no amplitude says otherwise.

    displacement: (n_points, dim); stress: (n_points, 6) recovered at the points, xx yy zz xy yz zx;
    reaction: (dim,) resultant of all supports, equations and prescribed motions of rigid bodies; reactions: the same for
    each supported surface or node set without the share of equations that join points (points that lie on several count for
    each of them, those of a rigid body for the whole body); moments: (1,) or (3,) of these about the mean of their points;
    load: (dim,) resultant of all loads; rigid: by the name of the body.
    """

    number: int
    factor: float
    converged: bool
    iterations: tuple[Iteration, ...]
    displacement: NDArray[np.float64]
    stress: NDArray[np.float64]
    reaction: NDArray[np.float64]
    reactions: Mapping[str, NDArray[np.float64]]
    load: NDArray[np.float64]
    contacts: tuple[ContactResult, ...]
    moments: Mapping[str, NDArray[np.float64]] = field(default_factory=dict)
    axisymmetric: bool = False  # then x is radial: its sums run round the axis, and hoop stress takes part
    cycling: Mapping[str, NDArray[np.int64]] = field(default_factory=dict)  # contact name -> facets that cycle
    flips: Mapping[str, Flips] = field(default_factory=dict)  # contact name -> nodes that do, with friction
    spring: float | None = None  # largest force that constrains free rigid-body modes; None where there are none
    neutral: float = 0.0  # share of the forces that facets put on those that contact resists by its facets alone
    internal: float = 0.0  # sum of the sizes of the nodal forces of stresses
    pressed: float = 0.0  # largest force between two surfaces by area: pressures that cancel around a fit add up
    strain: float = 0.0  # largest contact pressure over the stiffness of the two bodies
    rounding: float = 0.0  # force that displacements in double precision cannot tell from none, over the whole model
    strained: bool = True  # whether anything gives way, beyond rounding
    grown: bool = False  # whether temperatures alone change the size of bodies, with no stress
    rigid: Mapping[str, RigidResult] = field(default_factory=dict)
    earlier: float = 0.0  # largest force of the steps before, beside which what is left after unloading is rounding
    probes: tuple[ProbeResult, ...] = ()  # in the order of the model's
    reason: str = ""  # why it did not converge, where more can be said
    turn: float = 0.0  # largest of a body as a whole, radians, where they are taken for small
    landed: tuple[float, float] | None = None  # friction that touched and stuck in the step, and all that it may carry
    energy: Energy | None = None  # of a converged step of a model with friction
    stress_error: StressError | None = None  # None where nothing gives way
    # by materials, at points: (n_points, ...); and fields beside displacements
    remembered: Mapping[str, NDArray[np.float64]] = field(default_factory=dict)
    own_stress: Mapping[str, NDArray[np.float64]] = field(default_factory=dict)  # at points of shells that share
    flow: Flow | None = None  # None where no material yields
    volume_change: VolumeChange | None = None  # None where no body keeps its volume
    preloads: Mapping[str, PreloadResult] = field(default_factory=dict)
    springs: Mapping[str, NDArray[np.float64]] = field(default_factory=dict)  # force (dim,) on what each is on
    penetrations: Mapping[str, PenetrationResult] = field(default_factory=dict)
    connectors: Mapping[str, ConnectorResult] = field(default_factory=dict)
    nodal_reaction: NDArray[np.float64] | None = None  # (n_points, dim) of supports and links
    run_end: float = 1.0  # time at which the run ends

    @property
    def time(self) -> float:
        """At which the step ends, as the job, or ``SolveOptions.end``, counts it."""
        return self.factor * self.run_end

    @property
    def joined(self) -> bool:
        """Whether connectors move: mechanisms of rigid bodies strain nothing."""
        far = float(np.abs(self.displacement).max(initial=0.0))
        return any(joint.moves(far) for joint in self.connectors.values())

    def __repr__(self) -> str:
        """The main numbers, in some lines."""
        state = "converged" if self.converged else f"NOT CONVERGED {self.reason}".rstrip()
        far, largest = (
            float(np.abs(values).max(initial=0.0)) for values in (self.displacement, von_mises(self.stress))
        )
        lines = [
            f"Step {self.number} at time {self.time:.6g}: {state} in {len(self.iterations)} iterations",
            f"  largest displacement {far:.6g}, largest von Mises stress {largest:.6g}",
            f"  loads {vector(self.load)}, reactions {vector(self.reaction)}",
        ]
        lines += [
            f"  contact '{c.name}': force {vector(c.force)}, largest pressure {c.max_pressure:.6g}"
            for c in self.contacts[:NAMED]
        ]
        return "\n".join(
            [*lines, *([f"  and {len(self.contacts) - NAMED} more contacts"] if self.contacts[NAMED:] else [])]
        )

    @property
    def balance_error(self) -> float:
        """Largest component of loads and reactions together, over the reference force. Radial sums of an axisymmetric
        model balance only together with the hoop stress and are left out."""
        if not (self.strained or self.load.any()):  # bodies that move without touching: rounding over rounding
            return 0.0
        return float(np.abs(self.load + self.reaction)[1 if self.axisymmetric else 0 :].max() / self.reference_force)

    @property
    def balance_limit(self) -> float:
        """Of ``balance_error``: what rounding of the displacements alone may leave, theory (V14), at least and at most fixed
        shares of the reference force."""
        return min(max(BALANCE, self.rounding / self.reference_force), ROUNDED)

    @property
    def regularisation(self) -> float | None:
        """Force that constrains free rigid-body modes, over the reference force."""
        return None if self.spring is None else self.spring / self.reference_force

    @property
    def regularisation_limit(self) -> float:
        """Of ``regularisation``: the resultant of what the solver leaves of the balance of forces at all points together, at
        least and at most fixed shares of the reference force."""
        left = self.iterations[-1].residual * float(np.sqrt(self.displacement.size)) if self.iterations else 0.0
        return max(min(max(REGULARISATION, left), ROUNDED), self.neutral)

    @property
    def reference_force(self) -> float:
        """What rounding is judged against, theory (V14): the largest of all resultants, of the forces between surfaces by
        area, and of the sizes of all nodal forces of stresses together; loads and pressures may cancel, these do not."""
        return max(self.largest_force, self.pressed, self.internal)

    @property
    def largest_force(self) -> float:
        """Largest component of any resultant, now or in a step before."""
        forces = [self.load, self.reaction, *(c.force for c in self.contacts), *self.reactions.values()]
        forces += [body.force for body in self.rigid.values()]
        forces += [section.force for section in self.preloads.values()]
        return max(*(float(np.abs(f).max(initial=0.0)) for f in forces), self.earlier, 1e-300)


@dataclass(frozen=True)
class SavedPart:
    """State at the end of a part of a step, where ``inside`` of it "dual-P1" has ordinary functions, how many of the step's
    iterations it took, and ``displacement`` as in ``Saved``."""

    state: State
    inside: NDArray[np.bool_]
    iterations: int
    displacement: NDArray[np.float64] | None = None


@dataclass(frozen=True)
class Saved:
    """Record of a converged step for a restart.

    state: at its end; inside: (n,) where "dual-P1" has ordinary functions; linear: the linear solver, "direct" or "amg";
    iterations: for the log; parts: those before the last, of a step that was halved; taken: whether it is that of another
    job, whose balance is compared before the run goes on; displacement: (dim n_points,) of all points, which does not depend
    on what supports leave free; of rigid bodies that turn far that by their turns as small ones.
    """

    number: int
    state: State
    inside: NDArray[np.bool_]
    linear: str
    iterations: tuple[Iteration, ...]
    parts: tuple[SavedPart, ...] = ()
    taken: bool = False
    displacement: NDArray[np.float64] | None = None


@dataclass(frozen=True)
class Solution:
    """All steps of a run.

    Parameters
    ----------
    model : Model
        What was solved.
    steps : tuple of Step
        Each with displacements, stresses, reactions and contacts at its end; the last one may not have converged.
    dofs : int
        Number of unknown displacements.
    solver : str
        The linear solver, in words.
    notes : tuple of str
        What a user should know.
    timings : mapping of str to float
        Seconds by stage.
    complete : bool
        False while steps are still to come, or where the run was stopped before them.
    ignored : tuple of str
        What a deck asked for and the user left out.
    processes : int
        How many solved it together.
    modes, responses : tuples of ModesResult, of ResponseResult
        What ``model.modes`` asks for, in its order; empty before the end of the run.
    """

    model: Model
    steps: tuple[Step, ...]
    dofs: int
    solver: str
    notes: tuple[str, ...]
    timings: Mapping[str, float]
    complete: bool = True
    ignored: tuple[str, ...] = ()  # what a deck asked for and the user left out
    processes: int = 1
    modes: tuple[ModesResult, ...] = ()
    responses: tuple[ResponseResult, ...] = ()

    def __repr__(self) -> str:
        """The state of the run, the last step and the certificate, in at most ten lines."""
        done = "" if self.complete else ", incomplete"
        certificate = self.certificate
        warned = [f"{check.contact} {check.name}".strip() for check in certificate if check.warns]
        failed = [f"{check.contact} {check.name}".strip() for check in certificate if not check.passed]
        verdict = f"{len(failed)} of {len(certificate)} checks FAIL: {listed(failed)}" if failed else (
            f"all {len(certificate)} checks pass" + (f", with warnings of {listed(warned)}" if warned else ""))  # fmt: skip
        return "\n".join(
            [
                f"Solution: {'converged' if self.converged else 'not converged'}{done}, {len(self.steps)} steps, "
                f"{self.dofs} unknowns, {self.solver}",
                repr(self.steps[-1]) if self.steps else "no step",
                f"certificate: {verdict}",
            ]
        )

    @property
    def converged(self) -> bool:
        """Whether every step met its tolerances."""
        return all(step.converged for step in self.steps)

    @property
    def contacts(self) -> tuple[ContactResult, ...]:
        """The contact results of the last step."""
        return self.steps[-1].contacts

    @property
    def probes(self) -> tuple[ProbeResult, ...]:
        """What the probes read in the last step."""
        return self.steps[-1].probes

    @property
    def certificate(self) -> tuple[Check, ...]:
        """Every check of every contact, each at its worst over the steps, and the balance of the whole model."""
        lines: dict[tuple[str, str], list[Check]] = {}
        idle = driven(self.model) and not any(step.strained or step.grown or step.joined for step in self.steps)
        response = Check("", "response", float(idle), RESPONSE, "1 where something is prescribed and nothing deforms")
        loaded = forces_act(self.model)
        most = max((step.energy.size for step in self.steps if step.energy is not None), default=0.0)
        for step in self.steps:
            balance = Check("", "model balance", step.balance_error, step.balance_limit,
                            "loads plus reactions, over the size of the forces")  # fmt: skip
            strain = Check("", "strain", step.strain, STRAIN, "largest pressure over the stiffness of the two bodies")
            turn = Check("", "rotation", step.turn, TURN,
                         "largest turn of a body, radians, which this kinematics takes for small",
                         notice=TURN_NOTICED)  # fmt: skip
            model = [balance, response, *((strain, turn) if self.model.small_strains else ())]
            if step.regularisation is not None:
                model.append(Check("", "free rigid-body modes", step.regularisation, step.regularisation_limit,
                                   "force that constrains free rigid-body modes, over the size of the forces"))  # fmt: skip
            if step.energy is not None:
                model.append(Check("", "energy balance", step.energy.error, step.energy.limit_beside(most),
                                   "work of loads and supports less what is stored and what friction and flow take, over "
                                   "the work of all nodal forces by size"))  # fmt: skip
            if step.flow is not None:
                model += step.flow.checks(self.model.finite, bool(self.model.loads))
            if step.volume_change is not None:
                model.append(step.volume_change.check)
            if step.stress_error is not None:
                model.append(Check("", "stress error", step.stress_error.largest, STRESS_ERROR,
                                   step.stress_error.meaning(loaded),
                                   pressure=float(np.sqrt(step.stress_error.energy)), highest=True,
                                   notice=STRESS_NOTICED))  # fmt: skip
            weak = [step.springs[spring.name] for spring in self.model.springs if spring.weak]
            model += weak_checks(weak, step.reference_force)
            for check in (*model, *(c for contact in step.contacts for c in contact.checks)):
                lines.setdefault((check.contact, check.name), []).append(check)
        checks = [worst(checks) for checks in lines.values()]
        return (
            *checks,
            *preload_checks([step.preloads for step in self.steps]),
            *self._locking,
            *idle_contacts(self.model, [s.contacts for s in self.steps]),
            *self._apart,
            *run_checks([(step.time, step.landed, step.energy) for step in self.steps]),
            *(check for result in self.modes for check in result.certificate),
            *(check for result in self.responses for check in result.certificate),
        )

    @property
    def _locking(self) -> tuple[Check, ...]:
        """Whether cells are too stiff for their materials; none where nothing comes near it."""
        found = locking(self.model)
        if not found:
            return ()
        bodies = ", ".join(f"'{one.body}' of {one.kind}, {one.poisson:g}" for one in found)
        return (
            Check("", "locking", found[0].stiffness, LOCKED,
                  f"bulk over shear modulus of fully integrated cells (second order: a fiftieth, tet10: a tenth): {bodies}",
                  notice=STIFF),
        )  # fmt: skip

    @cached_property
    def _apart(self) -> tuple[Check, ...]:
        """Of bodies that lie in each other, and of motions without stiffness, at the end of the run."""
        if not self.complete:
            return ()
        return (*bodies_apart(self.model, self.displacement), *hourglass(self.model, self.displacement))

    @property
    def displacement(self) -> NDArray[np.float64]:
        """Displacement at the end of the last step, (n_points, dim)."""
        return self.steps[-1].displacement

    def to_pyvista(self, step: int = -1) -> Any:
        """Bodies and contacts as a ``pyvista.MultiBlock``: ``abut.to_pyvista(solution, step)``."""
        import abut

        return abut.to_pyvista(self, step)

    def plot(self, what: str = "pressure", **options: Any) -> Any:
        """A quick picture of pressure, gap, von Mises or displacement: ``abut.plot(solution, what, ...)``."""
        import abut

        return abut.plot(self, what, **options)


OnStep = Callable[[Solution, Saved], None]  # gets the solution so far after each converged step, and what restarts it

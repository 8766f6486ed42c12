"""What solving yields: iterations, steps and the solution, as frozen records."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from math import isnan
from typing import Any

import numpy as np
from numpy.typing import NDArray

from abut.conditions import drives
from abut.mesh.surface import Surface
from abut.model import Model

BALANCE = 1e-9  # limit of the model's balance of forces
ROUNDED = 1e-6  # the same at most, where a stiff part that moves with a soft one leaves no more digits
STRAIN = 0.3  # about the largest that linear elasticity takes for small; wrong units miss it by powers of ten
RESPONSE = 0.5  # nothing between 0 and 1
REGULARISATION = 1e-9  # limit of the force that holds motions without resistance: none at all but for rounding


@dataclass(frozen=True)
class Iteration:
    """One Newton iteration: one row of the live table, one line of run.jsonl.

    active: multipliers in contact, over all pairs; changed: how many changed since the iteration before;
    residual: equilibrium residual over the reference force; contact_residual: largest violation of the contact law over
    the reference pressure; penetration: largest penetration over the contactor's facet size.
    """

    step: int
    iteration: int
    active: int
    changed: int
    residual: float
    contact_residual: float
    penetration: float
    seconds: float


@dataclass(frozen=True)
class Phase:
    """A stage of the run begins. ``seconds``: how long it will take, from its size (None: not known); ``done`` of
    ``total`` load steps lie behind."""

    name: str
    seconds: float | None = None
    done: int = 0
    total: int = 0

    def __str__(self) -> str:
        return self.name if self.seconds is None else f"{self.name}: about {max(self.seconds, 1.0):.2g} s"


@dataclass(frozen=True)
class Check:
    """One line of the certificate: a dimensionless error of a contact, its limit, and what it says in words.
    last: it counts in the last step only, since it is bound to fail while loads are still small."""

    contact: str
    name: str
    value: float
    limit: float
    meaning: str
    last: bool = False

    @property
    def passed(self) -> bool:
        """Whether the value is within its limit; what is no number is not."""
        return self.value <= self.limit


@dataclass(frozen=True)
class PressureStatistics:
    """The pressure of a contact over its loaded area, at points at least half of whose support is covered.

    largest: of the reported pressure, force per area; place: (dim,) where, undeformed coordinates; partly_covered: the
    largest at points with less of their support covered, which count nowhere else, NaN where none of these is loaded;
    area: the loaded one, of multipliers in contact above a thousandth of the largest (2D: a length; axisymmetric: of the
    whole turn); mean: normal force over it; percentile_95: the pressure that 95 % of it stays below. Where nothing is in
    contact place, mean and percentile are NaN.
    """

    largest: float
    place: NDArray[np.float64]
    partly_covered: float
    mean: float
    percentile_95: float
    area: float


@dataclass(frozen=True)
class Resultant:
    """What the nodal forces of a contact on its contactor amount to, in undeformed coordinates.

    force: (dim,), in 2D per unit thickness, axisymmetric (radial sum, axial force) of the whole turn; moment: (1,) or (3,)
    about the origin of coordinates, zero in axisymmetric models; centre: (dim,) of pressure, the point of the force's line
    of action nearest to the mean of the nodes (weighted by their forces along the resultant); on a plane contact it lies in
    that plane, in axisymmetric models on the axis; NaN where forces cancel or there are none.
    """

    force: NDArray[np.float64]
    moment: NDArray[np.float64]
    centre: NDArray[np.float64]


@dataclass(frozen=True)
class ContactResult:
    """One contact pair at the end of a step.

    force: (dim,) resultant on the contactor, force (2D: per unit thickness); the target gets its opposite.
    pressure, gap: (n_contactor_facets, 9) at the facets' own nodes, NaN where padded; force per area and length. The
    pressure is the multiplier's average over each corner's function, linear between corners: theory (P10).
    multiplier: (n_contactor_facets, 9) the multiplier itself, which may jump between facets and swing; share:
    (n_contactor_facets, 9) covered share of each point's support. max_pressure: the largest where that is at least a half.
    covered: (n_contactor_facets,) bool, whether any part of the facet faces the target.
    target_pressure: (n_target_facets, 9), the pressure carried over, 0 where the target is not touched.
    covered_share: covered area over the contactor's area; checks: the certificate of this step.
    statistics: of the pressure over the loaded area; resultant: force, moment and centre of the contactor's nodal forces.
    contactor_forces, target_forces: (n_nodes, dim) of the multiplier, at ``contactor.node_ids`` and ``target.node_ids``;
    body_forces: body of the target -> (dim,) its part of their resultant.
    For tied pairs ``pressure`` is the normal part of the tie traction (compression positive), the forces are all of it.
    """

    name: str
    contactor: Surface
    target: Surface
    force: NDArray[np.float64]
    max_pressure: float
    area: float
    max_penetration: float
    active: int
    multipliers: int
    removed: int
    segments: int
    pressure: NDArray[np.float64]
    multiplier: NDArray[np.float64]
    share: NDArray[np.float64]
    gap: NDArray[np.float64]
    covered: NDArray[np.bool_]
    covered_share: float
    target_pressure: NDArray[np.float64]
    checks: tuple[Check, ...]
    statistics: PressureStatistics
    resultant: Resultant
    contactor_forces: NDArray[np.float64]
    target_forces: NDArray[np.float64]
    body_forces: Mapping[str, NDArray[np.float64]]


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
    values: by name displacement (n, dim), stress (n, 6) xx yy zz xy yz zx, von_mises, pressure, gap (n,), as far as asked
    for; NaN where a quantity does not exist at a point.
    """

    name: str
    points: NDArray[np.float64]
    distance: NDArray[np.float64] | None
    nodes: NDArray[np.int64] | None
    values: Mapping[str, NDArray[np.float64]]


@dataclass(frozen=True)
class Step:
    """The state at the end of a load step. ``factor`` in (0, 1] is the time: the share of loads and
    displacements applied, where no amplitude says otherwise.

    displacement: (n_points, dim); stress: (n_points, 6) nodal averages xx yy zz xy yz zx;
    reaction: (dim,) resultant of all supports, equations and what moves rigid bodies; reactions: the same for each
    supported surface or node set without the share of equations (points that lie on several count for each of them, those
    of a rigid body for the whole body); load: (dim,) resultant of all
    loads; rigid: by the name of the body.
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
    axisymmetric: bool = False  # then x is radial: its sums run round the axis, and hoop stress takes part
    cycling: Mapping[str, NDArray[np.int64]] = field(default_factory=dict)  # contact name -> facets that cycle
    spring: float | None = None  # largest force that holds motions without resistance; None where there are none
    internal: float = 0.0  # sum of the sizes of the nodal forces of stresses
    pressed: float = 0.0  # largest force between two surfaces by area: pressures that cancel around a fit add up
    strain: float = (
        0.0  # largest contact pressure over the stiffness of the two bodies, about that over Young's modulus
    )
    rounding: float = 0.0  # force that displacements in double precision cannot tell from none, over the whole model
    strained: bool = True  # whether anything gives way, beyond rounding
    rigid: Mapping[str, RigidResult] = field(default_factory=dict)
    earlier: float = 0.0  # largest force of the steps before, beside which what is left after unloading is rounding
    probes: tuple[ProbeResult, ...] = ()  # in the order of the model's

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
        """Force that holds motions without resistance over the reference force."""
        return None if self.spring is None else self.spring / self.reference_force

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
        return max(*(float(np.abs(f).max(initial=0.0)) for f in forces), self.earlier, 1e-300)


@dataclass(frozen=True)
class Saved:
    """What it takes to go on after a converged step, and to have its results again.

    displacement: (n_free,), pressure, active: (n,) the state; inside: (n,) where "dual-P1" has ordinary functions;
    own_displacement, own_pressure: the same in the unknowns of
    the linear solver, ``linear``, from which the next step starts; iterations: for the log; largest_force,
    largest_pressure: up to here, against which rounding is judged later.
    """

    number: int
    factor: float
    linear: str
    largest_force: float
    largest_pressure: float
    displacement: NDArray[np.float64]
    pressure: NDArray[np.float64]
    active: NDArray[np.bool_]
    inside: NDArray[np.bool_]
    own_displacement: NDArray[np.float64]
    own_pressure: NDArray[np.float64]
    iterations: tuple[Iteration, ...]


@dataclass(frozen=True)
class Solution:
    """All steps of a run; ``converged`` is False when the last of them is not (then it holds the last state).

    ``complete`` is False while steps are still to come, or where the run was stopped before them; ``processes``: how many
    solved it together."""

    model: Model
    steps: tuple[Step, ...]
    dofs: int
    solver: str
    notes: tuple[str, ...]
    timings: Mapping[str, float]
    complete: bool = True
    ignored: tuple[str, ...] = ()  # what a deck asked for and the user left out
    processes: int = 1

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
        worst: dict[tuple[str, str], Check] = {}
        idle = _driven(self.model) and not any(step.strained for step in self.steps)
        response = Check("", "response", float(idle), RESPONSE, "1 where something is prescribed and nothing gives way")
        for step in self.steps:
            balance = Check(
                "",
                "model balance",
                step.balance_error,
                step.balance_limit,
                "loads plus reactions, over the forces' size",
            )
            strain = Check("", "strain", step.strain, STRAIN, "largest pressure over the stiffness of the two bodies")
            model = [balance, response, strain]
            if step.regularisation is not None:
                model.append(Check("", "regularisation", step.regularisation, REGULARISATION,
                                   "force that holds motions without resistance, over the forces' size"))  # fmt: skip
            for check in (*model, *(c for contact in step.contacts for c in contact.checks)):
                key = check.contact, check.name
                if check.last or key not in worst or _worse(check, worst[key]):
                    worst[key] = check
        return tuple(worst.values())

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


def _worse(check: Check, other: Check) -> bool:
    """Whether a line is further beyond its limit than one of another step; what is no number is worst."""
    return not isnan(other.value) and not check.value / check.limit <= other.value / other.limit


def _driven(model: Model) -> bool:
    """Whether anything is prescribed that should have an effect: loads, motions, heat, interference."""
    given = (*model.supports, *model.loads, *model.equations, *model.rigid)
    hot = any(solid.temperature for solid in model.solids)
    return hot or any(map(drives, given)) or any(contact.offset < 0.0 for contact in model.contacts)


Observer = Callable[[Iteration | Phase | str], None]  # gets each iteration, stages that begin, and notes as text
OnStep = Callable[[Solution, Saved], None]  # gets the solution so far after each converged step, and what restarts it

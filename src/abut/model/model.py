"""The model: what the user states, as frozen records that check themselves and each other."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field, replace
from functools import cached_property
from itertools import pairwise

import numpy as np

from abut import checks
from abut.bodies.integration import INTEGRATIONS, check_integration
from abut.bodies.solids import Solids
from abut.contact.laws import Law
from abut.contact.sides import (
    Names,
    Sides,
    bodies_of,
    check_names,
    check_own,
    check_twice,
    find_sides,
    label,
    listed,
    normalised,
    words,
)
from abut.errors import InputError
from abut.materials.elastic import LinearElastic
from abut.mesh.mesh import Mesh
from abut.model.conditions import (
    COMPONENTS,
    Amplitude,
    BodyForce,
    Equation,
    Force,
    Gravity,
    History,
    Load,
    NodalForce,
    Pressure,
    Rigid,
    Support,
    Temperature,
    Term,
    Traction,
)
from abut.model.consistency import check_equations, check_loads, check_rigid, check_supports
from abut.model.probe import Probe, check_probes

__all__ = [
    "Amplitude", "BodyForce", "Contact", "Equation", "Force", "Gravity", "History", "Integration", "Load", "Model",
    "NodalForce", "Pressure", "Probe", "Rigid", "Solid", "SolveOptions", "Support", "Temperature", "Term", "Traction",
]  # fmt: skip

PLANES = ("strain", "stress", "axisymmetric")
PRESSURES = ("auto", "P0", "P1", "P1-discontinuous", "P2", "P2-discontinuous", "dual", "dual-P1")
LAWS = ("complementarity", "constraint-function")
METHODS = ("segment-to-segment", "node-to-segment", "node-to-segment-two-pass")
RULES = ("gauss", "newton-cotes")
MOST_STEPS = 1_000_000  # load steps, and iterations in one
LINEAR = ("auto", "direct", "amg", "petsc")


@dataclass(frozen=True)
class Solid:
    """A body of the mesh with its material; ``temperature`` is a uniform change that strains it (degrees).

    ``integration`` of its cells: "full"; "reduced" (fewer points: softer in bending, for tri6, quad8, tet10, hex20 and
    wedge15); "b-bar" (volume change averaged over each quad4 or hex8: no locking near Poisson's ratio 0.5)."""

    body: str
    material: LinearElastic
    temperature: float = 0.0
    integration: str = "full"

    def __post_init__(self) -> None:
        checks.choice(self.integration, f"solid '{self.body}': integration", INTEGRATIONS)
        checks.finite(self.temperature, f"solid '{self.body}': temperature")


@dataclass(frozen=True)
class Integration:
    """Quadrature on segments: ``points`` per direction, or "auto" (exact on straight facets)."""

    rule: str = "gauss"
    points: int | str = "auto"

    def __post_init__(self) -> None:
        checks.choice(self.rule, "integration.rule", RULES)
        if self.points == "auto":
            return
        low, high = (2, 9) if self.rule == "newton-cotes" else (1, 16)
        if isinstance(self.points, bool) or not isinstance(self.points, int) or not low <= self.points <= high:
            raise InputError(
                f"integration.points: expected 'auto' or {low}..{high} for {self.rule}, got {self.points!r}"
            )


@dataclass(frozen=True)
class Contact:
    """A contact pair. The contactor carries the pressure. ``contactor`` and ``target`` are names of surfaces or bodies, or
    lists of them, which have one pressure: every point of the contactor faces the nearest target along its normal; of a
    body, the part of its boundary that can meet the other side.

    ``offset`` is added to the geometric gap (negative: interference), in the mesh's length unit, in full from the start or
    times ``amplitude``; ``adjust`` (length): initial gaps and overlaps up to this size count as zero, before the offset is
    added; ``epsilon`` smooths the constraint function (dimensionless, relative to the square of a reference pressure);
    ``method``: the node-to-segment ones are for comparison only. ``law``: "complementarity", "constraint-function" or
    a law of your own (``abut.contact.laws.Law``).

    >>> import abut
    >>> press_fit = abut.Contact("shaft.side", "hub.bore", offset=-0.02)  # 0.02 of interference on the radius
    >>> press_fit.name
    'shaft.side-hub.bore'
    """

    contactor: Names
    target: Names
    name: str = ""
    kind: str = "contact"
    pressure: str = "auto"
    law: str | Law = "complementarity"
    epsilon: float = 1e-12
    method: str = "segment-to-segment"
    integration: Integration = field(default_factory=Integration)
    offset: float = 0.0
    adjust: float = 0.0
    amplitude: History = None

    def __post_init__(self) -> None:
        for side in ("contactor", "target"):
            object.__setattr__(self, side, normalised(getattr(self, side), f"contact '{self.name}': {side}"))
        if not self.name:
            object.__setattr__(self, "name", f"{label(self.contactor)}-{label(self.target)}")
        where = f"contact '{self.name}'"
        checks.choice(self.kind, f"{where}: kind", ("contact", "tied"))
        checks.choice(self.pressure, f"{where}: pressure", PRESSURES)
        if isinstance(self.law, str) or not isinstance(self.law, Law):
            checks.choice(self.law, f"{where}: law", LAWS)
        checks.choice(self.method, f"{where}: method", METHODS)
        if self.method != METHODS[0] and (self.kind, self.law, self.pressure) != ("contact", LAWS[0], "auto"):
            raise InputError(
                f"{where}: method {self.method} is a reference for comparison: it knows only kind contact, law "
                "complementarity and pressure auto; leave them out, or use segment-to-segment"
            )
        if self.law == LAWS[1] and self.pressure.startswith("dual"):
            raise InputError(
                f"{where}: pressure {self.pressure} with law {self.law}: that law looks at the pressure point by point, "
                "where dual functions are negative; leave pressure out, or the law"
            )
        checks.positive(self.epsilon, f"{where}: epsilon")
        checks.finite(self.offset, f"{where}: offset")
        if checks.finite(self.adjust, f"{where}: adjust") < 0.0:
            raise InputError(f"{where}: adjust: expected a length >= 0, got {self.adjust!r}")
        if self.amplitude is not None and not isinstance(self.amplitude, Amplitude):
            raise InputError(f"{where}: amplitude: expected an Amplitude, got {type(self.amplitude).__name__}")
        both = [name for name in listed(self.contactor) if name in listed(self.target)]
        if both:
            raise InputError(f"{where}: contactor and target are the same surface {words(both)}")


@dataclass(frozen=True)
class SolveOptions:
    """How to solve: load steps of equal length, or ending at ``times`` (increasing, over 0 up to 1; the ramp's factor is the
    time), linear solver, iterations allowed in a step.

    >>> import abut
    >>> abut.SolveOptions(steps=4).ends
    (0.25, 0.5, 0.75, 1.0)
    """

    steps: int = 1
    linear: str = "auto"
    max_iterations: int = 50
    times: tuple[float, ...] | None = None

    def __post_init__(self) -> None:
        for name in ("steps", "max_iterations"):
            value = getattr(self, name)
            if isinstance(value, bool) or not isinstance(value, int) or not 1 <= value <= MOST_STEPS:
                raise InputError(f"solve.{name}: expected a whole number from 1 to {MOST_STEPS}, got {value!r}")
        checks.choice(self.linear, "solve.linear", LINEAR)
        if self.times is not None:
            self._check_times()

    @property
    def ends(self) -> tuple[float, ...]:
        """Time at the end of each load step."""
        return self.times or tuple(number / self.steps for number in range(1, self.steps + 1))

    def _check_times(self) -> None:
        try:
            times = tuple(checks.finite(time, "solve.times") for time in self.times or ())
        except TypeError:
            raise InputError(f"solve.times: expected numbers, got {self.times!r}") from None
        if not times or times[0] <= 0.0 or times[-1] > 1.0 or any(a >= b for a, b in pairwise(times)):
            raise InputError(f"solve.times: expected increasing numbers over 0 up to 1, got {list(times)}")
        if self.steps not in (1, len(times)):
            raise InputError(f"solve: {self.steps} steps, but {len(times)} times; give one of them")
        object.__setattr__(self, "times", times)


@dataclass(frozen=True)
class Model:
    """The complete description of a problem, checked as a whole: names against the mesh, dimensions, materials.

    ``plane`` is "strain", "stress" or "axisymmetric" in 2D and left out in 3D. Axisymmetric: x is the radius, y the axis;
    forces are those of the full circumference; points on the axis stay on it without a support of their own. Every body is
    one of ``solids`` or ``rigid``.

    >>> import abut
    >>> from abut.mesh import make
    >>> mesh = make.join({"block": make.box([0, 1], [0, 1], [0, 1], cells=[2, 2, 2])})
    >>> steel = abut.LinearElastic(210e3, 0.3)
    >>> model = abut.Model(
    ...     mesh,
    ...     solids=[abut.Solid("block", steel)],
    ...     supports=[abut.Support("block.bottom", x=0, y=0, z=0)],
    ...     loads=[abut.Pressure("block.top", 10.0)],
    ... )
    >>> model.dim
    3
    >>> abut.Model(mesh, solids=[abut.Solid("blok", steel)])
    Traceback (most recent call last):
    abut.errors.InputError: solids[0].body: no body named 'blok' in the mesh; did you mean 'block'?
    """

    mesh: Mesh
    solids: Sequence[Solid]
    supports: Sequence[Support] = ()
    loads: Sequence[Load] = ()
    contacts: Sequence[Contact] = ()
    plane: str | None = None
    solve: SolveOptions = field(default_factory=SolveOptions)
    equations: Sequence[Equation] = ()
    rigid: Sequence[Rigid] = ()
    probes: Sequence[Probe] = ()

    def __post_init__(self) -> None:
        for name in ("solids", "supports", "loads", "contacts", "equations", "rigid", "probes"):
            object.__setattr__(self, name, tuple(getattr(self, name)))
        self._check_plane()
        check_rigid(self.mesh, self.rigid)
        self._check_solids()
        check_supports(self.mesh, self.supports)
        check_loads(self.mesh, self.loads, {body.body for body in self.rigid})
        self._check_contacts()
        check_equations(self.mesh, self.equations)
        check_probes(self.probes, self.mesh, [contact.name for contact in self.contacts])

    @cached_property
    def deformable(self) -> Solids:
        """The solids as their kernels see them."""
        materials = {solid.body: solid.material for solid in self.solids}
        return Solids(self.mesh, materials, self.plane, {solid.body: solid.integration for solid in self.solids})

    @property
    def dim(self) -> int:
        """2 or 3, the mesh's."""
        return int(self.mesh.points.shape[1])

    @property
    def histories(self) -> tuple[History, ...]:
        """The different histories of everything prescribed, the ramp first."""
        given = (*self.supports, *self.loads, *self.equations, *self.rigid, *self.contacts)
        return tuple(dict.fromkeys([None, *(item.amplitude for item in given)]))

    def sides(self, contact: Contact) -> Sides:
        """Contactor and target of one of the contacts as surfaces; bodies as far as they can meet the other side."""
        return self._sides[contact.name]

    @cached_property
    def _sides(self) -> dict[str, Sides]:
        return {c.name: find_sides(self.mesh, c.contactor, c.target, self._moved) for c in self.contacts}

    @property
    def _moved(self) -> float:
        """The largest displacement that is prescribed as a number."""
        given: list[Support | Rigid] = [*self.supports, *self.rigid]
        values = [
            (getattr(own, name, None), 1.0 if own.amplitude is None else own.amplitude.largest)
            for own in given
            for name in (*COMPONENTS, "normal")
        ]
        return max((abs(float(v)) * f for v, f in values if v is not None and not callable(v)), default=0.0)

    def temperatures(self, time: float) -> dict[str, float]:
        """Change of temperature of each solid body as a whole, which follows the ramp (degrees)."""
        return {solid.body: time * solid.temperature for solid in self.solids}

    def _check_plane(self) -> None:
        if self.dim == 2:
            if self.plane is None:
                raise InputError('model.plane: a 2D mesh needs plane = "strain", "stress" or "axisymmetric"')
            checks.choice(self.plane, "model.plane", PLANES)
            self._check_axis()
        elif self.plane is not None:
            raise InputError(f"model.plane: the mesh is 3D; leave plane out (got {self.plane!r})")

    def _check_axis(self) -> None:
        axisymmetric = self.plane == "axisymmetric"
        object.__setattr__(self, "mesh", replace(self.mesh, axisymmetric=axisymmetric))
        if not axisymmetric:
            return
        radius = self.mesh.points[:, 0]
        bad = np.flatnonzero(radius < -1e-9 * np.ptp(self.mesh.points, axis=0).max())
        if len(bad):
            raise InputError(
                f"model.plane: axisymmetric needs radii x >= 0, but {len(bad)} points lie at x < 0 (point {bad[0]} at "
                f"{self.mesh.points[bad[0]].tolist()}); mesh one half of the section only"
            )

    def _check_solids(self) -> None:
        seen: set[str] = set()
        for i, solid in enumerate(self.solids):
            checks.known(solid.body, self.mesh.bodies, f"solids[{i}].body", "body")
            if solid.body in seen:
                raise InputError(f"solids[{i}].body: body '{solid.body}' has two materials; keep one of them")
            seen.add(solid.body)
            check_integration(solid.integration, self._kinds(solid.body), self.plane, f"solids[{i}].integration")
        for i, rigid in enumerate(self.rigid):
            if rigid.body in seen:
                raise InputError(
                    f"rigid[{i}].body: body '{rigid.body}' is rigid and has a material (solids); take one of them out"
                )
        missing = sorted(set(self.mesh.bodies) - seen - {rigid.body for rigid in self.rigid})
        if missing:
            raise InputError(f"solids: no material for body {', '.join(map(repr, missing))}; add a solid for it")
        if not self.solids:
            raise InputError("solids: every body is rigid; at least one must deform")

    def _kinds(self, body: str) -> list[str]:
        return sorted({kind for kind, _, _ in self.mesh.cells_of(body)})

    def _check_contacts(self) -> None:
        mesh, rigid = self.mesh, {body.body for body in self.rigid}
        names: set[str] = set()
        for i, contact in enumerate(self.contacts):
            check_names(mesh, contact.contactor, f"contacts[{i}].contactor")
            check_names(mesh, contact.target, f"contacts[{i}].target")
            if contact.name in names:
                raise InputError(f"contacts[{i}].name: '{contact.name}' is used twice; give each contact its own name")
            names.add(contact.name)
            if rigid >= bodies_of(mesh, contact.contactor):
                self._refuse_rigid(i, contact, rigid)
        self._check_sides()

    def _check_sides(self) -> None:
        every = [self.sides(contact) for contact in self.contacts]
        for i, (contact, own) in enumerate(zip(self.contacts, every)):
            check_own(own, contact.contactor, contact.target, f"contacts[{i}]")
        check_twice([contact.name for contact in self.contacts], every)

    def _refuse_rigid(self, i: int, contact: Contact, rigid: set[str]) -> None:
        if rigid >= bodies_of(self.mesh, contact.target):
            raise InputError(f"contacts[{i}]: both sides of '{contact.name}' are rigid; one of them must deform")
        raise InputError(
            f"contacts[{i}].contactor: {words(contact.contactor)} is rigid; the pressure needs the displacements of its own "
            "side to be unique: swap contactor and target"
        )

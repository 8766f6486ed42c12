"""The model: everything that defines a problem, checked as a whole."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field, replace
from functools import cached_property
from itertools import chain
from typing import Any

import numpy as np
from numpy.typing import NDArray

from abut import checks
from abut.bodies.solids import Solids
from abut.contact.contactor_choice import Side
from abut.contact.sides import (
    Names,
    Sides,
    bodies_of,
    check_names,
    check_own,
    check_twice,
    find_sides,
    listed,
    moving_sides,
    words,
)
from abut.dofs import Dofs
from abut.errors import InputError
from abut.materials.material import Material, check_model
from abut.mesh.check import check_entries
from abut.mesh.mesh import Mesh
from abut.mesh.record import MeshRecord
from abut.model.body_forces import Load
from abut.model.conditions import Equation, History, Rigid, Support
from abut.model.connector import Connector, Multipliers, check_connectors
from abut.model.consistency import check_axis, check_equations, check_filled, check_loads, check_rigid, check_supports
from abut.model.contact import Contact
from abut.model.coupling import Coupling, check_couplings, moving_points
from abut.model.hold import Hold, check_holds
from abut.model.integrations import Integrations
from abut.model.kinematics import check_finite, check_kinematics
from abut.model.lists import LISTS
from abut.model.penetration import Penetration, check_penetrations
from abut.model.physics import TEMPERATURE, Physics, dofs_of
from abut.model.preload import Preload, cut_sections
from abut.model.prescribed import largest_prescribed
from abut.model.probe import Probe, check_probes
from abut.model.removal import Away, Removal, check_removals, loads_while_there, opened
from abut.model.response import Wanted, check_responses
from abut.model.rotation import Rotation, check_rotations
from abut.model.side_choice import SAME, decided, held_points, measured, square_at_edges
from abut.model.solid import Solid
from abut.model.solve_options import SolveOptions
from abut.model.spring import Spring, check_springs
from abut.model.step_ends import with_corners
from abut.model.symmetry import held_directions
from abut.model.times import in_shares, of_ends
from abut.model.turned_sides import smooth_sides, turned_sides

PLANES = ("strain", "stress", "axisymmetric")


@dataclass(frozen=True)
class Model:
    """The complete description of a problem, checked as a whole: names against the mesh, dimensions, materials.

    Axisymmetric: x is the radius, y the axis; forces are those of the full circumference; points on the axis stay on it
    without a support of their own.

    Parameters
    ----------
    mesh : Mesh
        Points, cells and names.
    solids : sequence of Solid
        Bodies with their materials. Every body is one of these, or ``rigid``.
    supports : sequence of Support
        Prescribed displacements.
    loads : sequence of loads
        ``Pressure``, ``Traction``, ``Force``, ``Moment``, ``NodalForce``, ``Gravity``, ``BodyForce``, ``Centrifugal``,
        ``Temperature``.
    contacts : sequence of Contact
        Pairs of sides that may touch, or are tied.
    plane : str, optional
        "strain", "stress" or "axisymmetric" in 2D; left out in 3D.
    solve : SolveOptions
        Load steps and linear solver.
    equations : sequence of Equation
        Linear constraints.
    rigid : sequence of Rigid
        Bodies that move as a whole.
    probes : sequence of Probe
        Where results are read.
    kinematics : str
        "small" (displacements and strains are small); "finite" (large displacements and strains; balance of forces and
        pressures in the deformed configuration; theory (D1)); or "small-strain" (bodies as with "small"; contact, loads
        and rigid bodies as with "finite", where bodies have moved to; theory (D17)).
    rotations : sequence of Rotation
        Prescribed turns, for kinematics "finite".
    couplings : sequence of Coupling
        Points that move with a reference.
    preloads : sequence of Preload
        Bolts that are tightened; the mesh is cut open at their sections.
    springs, holds, penetrations : sequences of Spring, of Hold and of Penetration
        Springs to ground, between points, beds; supports that come or go; fluids that enter contacts.
    physics : sequence of abut.model.physics.Physics
        Terms of one's own in the balance, with rates if wanted; fields beside displacements, on one process. By direct
        solvers.
    modes, removals, connectors : sequences of Frequencies, Buckling, Harmonic and Transient, of Removal, of Connector
        What is found about loaded states; bodies that go, and may come back; joints of rigid bodies and couplings.
    times_in_shares : bool
        Whether times are shares of ``solve.end``, from 0 to 1, as a model keeps them; else they run from 0 to that.

    Raises
    ------
    InputError
        With place and remedy, for whatever does not fit together.

    Examples
    --------
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
    kinematics: str = "small"
    rotations: Sequence[Rotation] = ()
    couplings: Sequence[Coupling] = ()
    preloads: Sequence[Preload] = ()
    springs: Sequence[Spring] = ()
    holds: Sequence[Hold] = ()
    penetrations: Sequence[Penetration] = ()
    physics: Sequence[Physics] = ()
    modes: Sequence[Wanted] = ()
    removals: Sequence[Removal] = ()
    connectors: Sequence[Connector] = ()
    times_in_shares: bool = False

    def __post_init__(self) -> None:
        checks.instance(self.mesh, MeshRecord, "model: mesh", "a mesh (abut.Mesh)")
        checks.instance(self.solve, SolveOptions, "model: solve", "options (abut.SolveOptions)")
        for name, kinds in LISTS.items():
            records = checks.records(getattr(self, name), name, kinds)
            object.__setattr__(self, name, in_shares(records, name, self.solve.end, self.times_in_shares))
        object.__setattr__(self, "solve", of_ends(self.solve, self.times_in_shares))
        object.__setattr__(self, "times_in_shares", True)
        object.__setattr__(self, "physics", checks.listed(self.physics, "physics"))
        check_entries(self.mesh)
        check_filled(self.mesh, self._named())
        self._check_plane()
        self._cut()
        check_rigid(self.mesh, self.rigid)
        check_couplings(self.mesh, self.couplings, self.rigid, self.finite)
        self._check_solids()
        check_supports(self.mesh, self.supports)
        check_loads(self.mesh, self.loads, {body.body for body in self.rigid}, {c.name for c in self.couplings})
        check_responses(self.mesh, self.modes, {body.body for body in self.rigid}, {c.name for c in self.couplings})
        self._check_contacts()
        check_springs(self.mesh, self.springs, self.modes)
        object.__setattr__(self, "holds", check_holds(self.mesh, self.holds))
        object.__setattr__(self, "penetrations", check_penetrations(self.mesh, self.penetrations, self.contacts))
        check_connectors(self.mesh, self.connectors, self.referenced, self.finite)
        others = (*self.physics, *self.modes, *self.connectors)
        check_removals(self.mesh, self.removals, self.materials, self.preloads, others)
        object.__setattr__(
            self, "loads", loads_while_there(self.mesh, self.loads, self.removals, self.materials, self.equations)
        )
        self.opened, self.dofs  # noqa: B018 - sides of contacts go as a whole, names are there once
        check_kinematics(self.kinematics, self.solids)
        moving = moving_points(self.mesh, self.rigid, self.couplings)
        check_rotations(self.mesh, self.rotations, self.supports, moving, self.kinematics)
        if self.finite:
            check_finite(self.mesh, self.contacts, self.equations, moving, self.supports)
        check_equations(self.mesh, self.equations)
        check_probes(self.probes, self.mesh, [contact.name for contact in self.contacts])

    @property
    def materials(self) -> dict[str, Material]:
        """Of each body that deforms."""
        return {solid.body: solid.law for solid in self.solids}

    @cached_property
    def deformable(self) -> Solids:
        """The solids as their kernels see them."""
        return Solids(self.mesh, self.materials, self.plane, self.integrations.by_body, self.integrations.kinematics)

    def integration(self, solid: Solid) -> str:
        """Of one of the solids, "auto" resolved."""
        return self.integrations.of(solid)

    @cached_property
    def integrations(self) -> Integrations:
        """Of all."""
        return Integrations(self.mesh, self.solids, self.plane, not self.small_strains)

    @property
    def finite(self) -> bool:
        """Whether displacements may be: contact, loads and rigid bodies are where bodies have moved to."""
        return self.kinematics != "small"

    @property
    def small_strains(self) -> bool:
        """Whether strains and turns of deforming bodies are taken for small, theory (D17) if they slide far."""
        return self.kinematics != "finite"

    @property
    def dim(self) -> int:
        """2 or 3, the mesh's."""
        return self.mesh.dim

    @cached_property
    def dofs(self) -> Dofs:
        """Where the values of all fields stand."""
        return dofs_of(self.mesh, [*self.physics, Multipliers(self.connectors)])

    @property
    def linear_bodies(self) -> bool:
        """Whether forces of bodies are affine in the displacements, and depend on nothing else that is unknown."""
        heated = TEMPERATURE in [item.name for item in self.dofs.fields]
        return self.deformable.constant and not (heated or self.removals)

    @property
    def referenced(self) -> tuple[Rigid | Coupling, ...]:
        """What has a reference point: rigid bodies, then couplings."""
        return (*self.rigid, *self.couplings)

    @property
    def histories(self) -> tuple[History, ...]:
        """The different histories of everything prescribed, the ramp first."""
        given = (*self.supports, *self.loads, *self.equations, *self.rigid, *self.contacts, *self.rotations)
        others: tuple[Any, ...] = (*self.preloads, *self.couplings, *self.penetrations, *self.connectors)
        amplitudes = [item.amplitude for item in (*given, *others)]
        friction = [contact.friction_amplitude for contact in self.contacts]
        of_rigid = (history for body in self.referenced for history in body.amplitudes.values())
        own = (history for item in self.physics for history in item.amplitudes)
        return tuple(dict.fromkeys([None, *amplitudes, *friction, *of_rigid, *own, *self.opened.values()]))

    @cached_property
    def opened(self) -> dict[str, Away]:
        """When contacts, by name, are open since they do not act then, or a body of theirs is away."""
        return opened(self.mesh, self.contacts, self.removals, self.penetrations)

    @cached_property
    def ends(self) -> tuple[float, ...]:
        """Time at the end of each load step: those of ``solve``, and where the way matters (friction, fluids, large
        displacements, materials that are not linear) the corners of all histories, which a step across would never see."""
        rubs = any(contact.frictional for contact in self.contacts) or bool(self.penetrations)
        if not (rubs or self.finite) and all(material.constant for material in self.materials.values()):
            return with_corners(self.solve.ends, self.locking)
        return with_corners(self.solve.ends, (*self.histories, *self.locking))

    @property
    def locking(self) -> tuple[History, ...]:
        """With a corner where a preload is locked, something comes or goes, modes are found: load steps end there."""
        changing: tuple[Any, ...] = (*self.preloads, *self.holds, *self.contacts, *self.removals, *self.modes)
        return tuple(chain.from_iterable(item.locking for item in changing))

    def sides(self, contact: Contact) -> Sides:
        """Contactor and target of one of the contacts as surfaces; bodies as far as they can meet the other side."""
        return self._sides[contact.name]

    def measured(self, contact: Contact) -> tuple[Side, Side]:
        """Contactor and target of one of the contacts as the choice between them sees them."""
        return self._measured[contact.name]

    @cached_property
    def _measured(self) -> dict[str, tuple[Side, Side]]:
        return {c.name: self._measure(c, self.sides(c)) for c in self.contacts}

    def _measure(self, contact: Contact, sides: Sides) -> tuple[Side, Side]:
        return measured(self.mesh, self.materials, self._held, sides, square_at_edges(contact, self.finite))

    @cached_property
    def _held(self) -> NDArray[np.bool_]:
        return held_points(self.mesh, self.supports)

    @cached_property
    def _sides(self) -> dict[str, Sides]:
        held = held_directions(self.mesh, self.supports)
        made = {c.name: self._surfaces(c, c.contactor, c.target) for c in self.contacts}
        return smooth_sides(self.contacts, made, turned_sides(self.mesh, self.equations), held)

    def _surfaces(self, contact: Contact, contactor: Names, target: Names) -> Sides:
        if self.finite and contact.kind != "tied":
            return moving_sides(self.mesh, contactor, target)
        moved = largest_prescribed(self.supports, self.referenced, self.holds)
        return find_sides(self.mesh, contactor, target, moved)

    def _decided(self, contact: Contact) -> Contact:
        """With contactor and target, where the user leaves them to abut."""
        if not contact.first or contact.first == contact.second:
            return contact.with_choice(0, SAME) if contact.first else contact
        surfaces = self._surfaces(contact, contact.first, contact.second)
        return decided(contact, self._measure(contact, surfaces), self.finite)

    def temperatures(self, time: float) -> dict[str, float]:
        """Change of temperature of each solid body as a whole, which follows the ramp (degrees)."""
        return {solid.body: time * solid.temperature for solid in self.solids}

    def _cut(self) -> None:
        """Open the mesh at the sections of preloads."""
        solid = {solid.body for solid in self.solids}
        for i, preload in enumerate(self.preloads):
            if preload.body in self.mesh.bodies and preload.body not in solid:
                raise InputError(f"preloads[{i}].body: body '{preload.body}' is rigid and cannot be tightened")
        sides = [name for contact in self.contacts for side in contact.named for name in listed(side)]
        mesh, preloads = cut_sections(self.mesh, self.preloads, sides, self.loads)
        object.__setattr__(self, "mesh", mesh)
        object.__setattr__(self, "preloads", preloads)

    def _named(self) -> list[tuple[str, str | None]]:
        """Places in the mesh that entries name, and where."""
        lists = {name: getattr(self, name) for name in ("supports", "loads", "couplings", "rotations")}
        named = [(f"{kind}[{i}].on", entry.on) for kind, entries in lists.items() for i, entry in enumerate(entries)]
        for i, contact in enumerate(self.contacts):
            named += [(f"contacts[{i}]", name) for side in contact.named for name in listed(side)]
        return named

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
        if axisymmetric:
            check_axis(self.mesh)

    def _check_solids(self) -> None:
        seen: set[str] = set()
        for i, solid in enumerate(self.solids):
            checks.known(solid.body, self.mesh.bodies, f"solids[{i}].body", "body")
            if solid.body in seen:
                raise InputError(f"solids[{i}].body: body '{solid.body}' has two materials; keep one of them")
            seen.add(solid.body)
            check_model(solid.law, self.dim, self.plane, f"solids[{i}].material")
            self.integrations.check(solid, f"solids[{i}].integration")
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

    def _check_contacts(self) -> None:
        mesh, rigid = self.mesh, {body.body for body in self.rigid}
        names: set[str] = set()
        for i, contact in enumerate(self.contacts):
            places = ("surfaces[0]", "surfaces[1]") if contact.first else ("contactor", "target")
            for side, place in zip(contact.named, places):
                check_names(mesh, side, f"contacts[{i}].{place}")
            if contact.name in names:
                raise InputError(f"contacts[{i}].name: '{contact.name}' is used twice; give each contact its own name")
            names.add(contact.name)
            if all(rigid >= bodies_of(mesh, side) for side in contact.named):
                raise InputError(f"contacts[{i}]: both sides of '{contact.name}' are rigid; one of them must deform")
            if contact.contactor and not contact.first and rigid >= bodies_of(mesh, contact.contactor):
                raise InputError(
                    f"contacts[{i}].contactor: {words(contact.contactor)} is rigid; the pressure needs the displacements of "
                    "its own side to be unique: swap contactor and target"
                )
        object.__setattr__(self, "contacts", tuple(map(self._decided, self.contacts)))
        every = [self.sides(contact) for contact in self.contacts]
        for i, (contact, surfaces) in enumerate(zip(self.contacts, every)):
            if not self.finite or contact.kind == "tied":
                check_own(surfaces, contact.contactor, contact.target, f"contacts[{i}]")
        times = [contact.times for contact in self.contacts]
        check_twice([contact.name for contact in self.contacts], every, lambda i, j: times[i].meets(times[j]))

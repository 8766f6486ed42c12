"""Removals: bodies that go on the way, and may come back without stress; a record that checks itself."""

from __future__ import annotations

import math
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any, Protocol

import numpy as np
from numpy.typing import NDArray

from abut import checks
from abut.contact.sides import bodies_of
from abut.errors import InputError
from abut.materials.temperature import OverTemperature
from abut.mesh.mesh import Mesh
from abut.model.body_forces import BodyForce, Centrifugal, Gravity, Load
from abut.model.conditions import Amplitude, Equation, History
from abut.model.contact import SECOND, Contact
from abut.model.hold import END
from abut.model.loads import Force, NodalForce, Pressure, Traction
from abut.model.penetration import Penetration
from abut.model.preload import Preload
from abut.model.step_ends import SAME

Indices = NDArray[np.int64]
RAMP = ((0.0, 0.0), (END, 1.0))


@dataclass(frozen=True)
class Removal:
    """A body that is taken out, and may come back; theory (F20).

    It is there up to ``until``. Then the forces that it exerts on what it shares nodes with, or is tied to, go down in a
    straight line, to none at ``released``; its contacts and the loads on it are gone at once. From ``since`` on it is there
    again, without history, and without strain and stress where its nodes are then, or ``strained``.

    Parameters
    ----------
    body : str
        A body that deforms.
    until : float
        Time up to which it is there; 0: it is not there at the start.
    released : float, optional
        When its forces are gone; at once where left out.
    since : float, optional
        Time from which on it is there again; it does not come back where left out.
    strained : bool
        Whether it comes back as it was laid out: with the strain of all the displacement that its nodes have.

    Raises
    ------
    InputError
        For values that are no such things, or do not go together.

    Examples
    --------
    >>> import abut
    >>> prop = abut.Removal("prop", until=0.5, released=0.75)  # taken out from 0.5 to 0.75
    >>> layer = abut.Removal("second layer", since=0.5)  # comes at 0.5
    """

    body: str
    until: float = 0.0
    released: float | None = None
    since: float | None = None
    strained: bool = False

    def __post_init__(self) -> None:
        checks.text(self.body, "removal: body")
        where = f"removal of '{self.body}'"
        for name in ("until", "released", "since"):
            if name == "until" or getattr(self, name) is not None:
                checks.finite(getattr(self, name), f"{where}: {name}")
        checks.instance(self.strained, bool, f"{where}: strained", "true or false")
        if self.until <= SAME and self.since is None:
            raise InputError(f"{where}: it is not there at any time; give until or since, or leave the body out")
        back = math.inf if self.since is None else self.since
        if not (0.0 <= self.until <= self.gone <= back and self.until < back):
            raise InputError(
                f"{where}: expected times 0 <= until <= released <= since, until < since; got until "
                f"{self.until:g}, released {self.gone:g}, since {'none' if self.since is None else f'{self.since:g}'}"
            )

    @property
    def gone(self) -> float:
        """Time from which on it exerts no force."""
        return self.until if self.released is None else self.released

    @property
    def back(self) -> float:
        """Time up to which it is away; beyond the end where it does not come back."""
        return 2.0 * END if self.since is None else self.since

    def away(self, time: float) -> bool:
        """Whether it is not there in the step that ends at a time; at the start, whether it is not there from the outset."""
        return (self.until + SAME < time or self.until <= SAME) and time <= self.back + SAME

    @property
    def locking(self) -> tuple[Amplitude, ...]:
        """Histories with corners where it goes, is gone, and comes: load steps must end there."""
        inside = sorted({turn for turn in (self.until, self.gone, self.back) if SAME < turn < END - SAME})
        return tuple(Amplitude(((0.0, 0.0), (turn, 0.0), (END, 1.0))) for turn in inside)


class Goes(Protocol):
    """What is there for a part of the time."""

    def away(self, time: float) -> bool:
        """Whether it is not there in the step that ends at a time."""
        ...


@dataclass(frozen=True)
class Away(Amplitude):
    """1 while one of some things is not there, else 0."""

    points: tuple[tuple[float, float], ...] = RAMP
    parts: tuple[Goes, ...] = ()

    def __call__(self, time: float) -> float:
        """The factor in the step that ends at a time."""
        return float(any(part.away(time) for part in self.parts))


@dataclass(frozen=True)
class While(Amplitude):
    """Another history (None: the ramp) while a body is there, else 0."""

    points: tuple[tuple[float, float], ...] = RAMP
    removals: tuple[Removal, ...] = ()
    given: History = None

    def __call__(self, time: float) -> float:
        """The factor in the step that ends at a time."""
        if any(removal.away(time) for removal in self.removals):
            return 0.0
        return time if self.given is None else self.given(time)


def as_given(history: History) -> History:
    """The history that the user gave."""
    return history.given if isinstance(history, While) else history


def check_removals(
    mesh: Mesh,
    removals: Sequence[Removal],
    materials: Mapping[str, Any],
    preloads: Sequence[Preload],
    others: Sequence[Any],
) -> None:
    """Raise InputError for bodies that cannot go, and times at which one goes twice. materials: by body; others: physics,
    modes and connectors, which know of no removals."""
    for i, removal in enumerate(removals):
        where = f"removals[{i}]"
        checks.known(removal.body, mesh.bodies, f"{where}.body", "body")
        if removal.body not in materials:
            raise InputError(f"{where}.body: '{removal.body}' is rigid; give its contacts an amplitude of the offset")
        if removal.since is not None and isinstance(materials[removal.body], OverTemperature):
            raise InputError(
                f"{where}.since: '{removal.body}' has a material over the temperature and cannot come back"
            )
        for other in removals[:i]:
            if other.body == removal.body and other.until <= removal.back and removal.until <= other.back:
                raise InputError(f"{where}: '{removal.body}' is away twice at once; let the times follow each other")
        if any(removal.body in _tightened(mesh, preload) for preload in preloads):
            raise InputError(f"{where}.body: '{removal.body}' has a preload; bolts that are tightened stay")
    if removals and others:
        raise InputError(
            "removals: bodies go and come with displacements alone; leave physics, connectors, frequencies and buckling out"
        )


def _tightened(mesh: Mesh, preload: Preload) -> set[str]:
    return {str(preload.body), *(bodies_of(mesh, preload.surface) if preload.surface in mesh.surfaces else ())}


def loads_while_there(
    mesh: Mesh,
    loads: Sequence[Load],
    removals: Sequence[Removal],
    solids: Iterable[str],
    equations: Sequence[Equation] = (),
) -> tuple[Load, ...]:
    """Loads, of which those on bodies that go act while these are there, but for forces at nodes in ``equations``; solids:
    bodies that deform. Raises InputError for surfaces that lie on bodies that go and on others."""
    terms = [term.on for equation in equations for term in equation.terms] if removals else []
    at = [np.array([on]) if isinstance(on, int) else mesh.nodes_of(on) for on in dict.fromkeys(terms)]
    joined = np.concatenate([np.empty(0, np.int64), *at])
    every = (_split(mesh, load, removals, solids, joined, f"loads[{i}]") for i, load in enumerate(loads))
    return tuple(load for parts in every for load in parts)


def _split(
    mesh: Mesh, load: Any, removals: Sequence[Removal], solids: Iterable[str], joined: Indices, where: str
) -> Iterator[Load]:
    load = replace(load, amplitude=as_given(load.amplitude)) if isinstance(load.amplitude, While) else load
    passing = {removal.body for removal in removals}
    if isinstance(load, (Gravity, Centrifugal, BodyForce)) and load.on is None and passing:
        yield from (_gated(replace(load, on=body), {body}, removals) for body in solids)
        return
    yield _gated(load, _bodies(mesh, load, passing, joined, where), removals)


def _bodies(mesh: Mesh, load: Any, passing: set[str], joined: Indices, where: str) -> set[str]:
    """Of a load, those that it goes with. joined: nodes that equations join with others."""
    if isinstance(load, (Gravity, Centrifugal, BodyForce)):
        return {str(load.on)}
    if isinstance(load, (Pressure, Traction, Force)) and load.on in mesh.surfaces:
        return _alone(bodies_of(mesh, load.on), passing, f"{where}.on: '{load.on}'")
    if isinstance(load, NodalForce) and passing:
        nodes = mesh.nodes_of(load.on)
        others = np.concatenate([joined, *(mesh.nodes_of(body) for body in mesh.bodies if body not in passing)])
        if not np.isin(nodes, others).any():
            return _alone({b for b in passing if np.isin(nodes, mesh.nodes_of(b)).any()}, passing, f"{where}.on")
    return set()


def _alone(bodies: set[str], passing: set[str], where: str) -> set[str]:
    if len(bodies) > 1 and bodies & passing:
        raise InputError(
            f"{where}: lies on bodies that go and on others ({', '.join(sorted(bodies))}); name a part for each body"
        )
    return bodies


def _gated(load: Any, bodies: set[str], removals: Sequence[Removal]) -> Load:
    own = tuple(removal for removal in removals if removal.body in bodies)
    if not own:
        return load
    points = RAMP if load.amplitude is None else load.amplitude.points
    return replace(load, amplitude=While(points, own, load.amplitude))


def opened(
    mesh: Mesh, contacts: Sequence[Contact], removals: Sequence[Removal], penetrations: Sequence[Penetration]
) -> dict[str, Away]:
    """Of each contact (and its second pass) that acts for a part of the time, or (ties stay) whose bodies go: when it is
    open. Raises InputError for sides of several bodies, and for fluids in such contacts."""
    result: dict[str, Away] = {}
    passing = {removal.body for removal in removals}
    for i, contact in enumerate(contacts):
        own: tuple[Goes, ...] = () if contact.times.always else (contact.times,)
        if passing and contact.kind != "tied":
            bodies = [_alone(bodies_of(mesh, side), passing, f"contacts[{i}]: a side") for side in contact.named]
            own += tuple(removal for removal in removals if removal.body in set[str]().union(*bodies))
        if own and any(item.contact == contact.name for item in penetrations):
            raise InputError(
                f"contacts[{i}]: '{contact.name}', which a fluid enters, or a body of it, goes; leave one of both out"
            )
        if own:
            result[contact.name] = result[contact.name + SECOND] = Away(RAMP, own)
    return result

"""Holds: supports that come or go on the way, as a clamp that is put on and taken off; a record that checks itself."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace

from abut import checks
from abut.errors import InputError
from abut.mesh.mesh import Mesh
from abut.model.conditions import COMPONENTS, Amplitude, History, check_amplitude

STAY = "stay"
END = 1.0  # of time


@dataclass(frozen=True)
class Hold:
    """A support that acts for a part of the time; theory (F18).

    Up to ``since`` the nodes are free. Then they are led from where they are to what is prescribed, in a straight line
    until ``reached``; from ``until`` on the force that held them goes down in a straight line, to none at ``released``.

    Parameters
    ----------
    on : str
        The surface, node set or body.
    x, y, z : float or str, optional
        Displacement [length], from the undeformed mesh as that of supports; or "stay": wherever it is at ``since``; free
        where left out.
    since : float
        Time from which on it acts.
    reached : float, optional
        When displacements are what is prescribed; ``until``, or the end, where left out.
    until : float, optional
        Time up to which it acts; to the end where left out.
    released : float, optional
        When its force is gone; the end where left out.
    amplitude : Amplitude, optional
        Factor of x, y, z over time; one that grows from 0 at ``since`` to 1 at ``reached``, and stays, where left out.
    name : str
        For results; that of ``on`` where left out.

    Raises
    ------
    InputError
        For values that are no such things, or do not go together.

    Examples
    --------
    >>> import abut
    >>> clamp = abut.Hold("part.top", y=-0.1, reached=0.25, until=0.5)  # pressed down, held, and let go from 0.5 on
    >>> weld = abut.Hold("tab", x="stay", y="stay", since=0.5)  # from 0.5 on where it is then
    """

    on: str
    x: float | str | None = None
    y: float | str | None = None
    z: float | str | None = None
    since: float = 0.0
    reached: float | None = None
    until: float | None = None
    released: float | None = None
    amplitude: History = None
    name: str = ""

    def __post_init__(self) -> None:
        checks.text(self.on, "hold: on")
        where = f"hold on '{self.on}'"
        if not self.name:
            object.__setattr__(self, "name", self.on)
        checks.text(self.name, f"{where}: name")
        if not self.components:
            raise InputError(f"{where}: no component is held; give x, y or z")
        for component, value in self.components.items():
            if isinstance(value, str) and value != STAY:
                raise InputError(f'{where}: {component}: expected a displacement or "{STAY}", got {value!r}')
            if not isinstance(value, str):
                checks.finite(value, f"{where}: {component}")
        check_amplitude(self.amplitude, where)
        for name in ("since", "reached", "until", "released"):
            if name == "since" or getattr(self, name) is not None:
                checks.finite(getattr(self, name), f"{where}: {name}")
        if self.released is not None and self.until is None:
            raise InputError(f"{where}: released goes with until; give the time up to which it acts")
        last, gone = (math.inf if time is None else time for time in (self.until, self.released))
        reached = last if self.reached is None else self.reached
        if not (0.0 <= self.since < reached <= last and (self.until is None or last < gone)):
            times = ("the end" if time == math.inf else f"{time:g}" for time in (reached, last, gone))
            raise InputError(
                f"{where}: expected times 0 <= since < reached <= until < released, got since {self.since:g}, "
                "reached {}, until {}, released {}".format(*times)
            )

    @property
    def components(self) -> dict[str, float | str]:
        """What is held, by the name of the component."""
        every = {name: getattr(self, name) for name in COMPONENTS}
        return {name: value for name, value in every.items() if value is not None}

    @property
    def arrival(self) -> float:
        """Time from which on displacements are what is prescribed."""
        if self.reached is not None:
            return self.reached
        return END if self.until is None else self.until

    @property
    def end_of_release(self) -> float:
        """Time from which on it exerts no force."""
        return END if self.released is None else self.released

    def way(self, time: float) -> float:
        """Share of the way from where it was to what is prescribed, 0 to 1."""
        return min(max((time - self.since) / (self.arrival - self.since), 0.0), 1.0)

    def factor(self, time: float) -> float:
        """Of x, y, z at a time."""
        return self.way(time) if self.amplitude is None else self.amplitude(time)

    @property
    def locking(self) -> tuple[Amplitude, ...]:
        """Histories with corners where it comes and goes, or turns: load steps must end there."""
        turns = [self.since, self.arrival, *([] if self.until is None else [self.until, self.end_of_release])]
        inside = sorted({turn for turn in turns if 0.0 < turn < END})
        made = (Amplitude(((0.0, 0.0), (turn, 0.0), (END, 1.0))) for turn in inside)
        return (*made, *([] if self.amplitude is None else [self.amplitude]))


def check_holds(mesh: Mesh, holds: Sequence[Hold]) -> tuple[Hold, ...]:
    """Holds with names of their own. Raises InputError for places and components that the mesh does not have."""
    result: list[Hold] = []
    for i, hold in enumerate(holds):
        checks.known(
            hold.on, [*mesh.surfaces, *mesh.node_sets, *mesh.bodies], f"holds[{i}].on", "surface, node set or body"
        )
        if not len(mesh.nodes_of(hold.on)):
            raise InputError(f"holds[{i}].on: '{hold.on}' is empty")
        if mesh.dim == 2 and hold.z is not None:
            raise InputError(f"holds[{i}].z: the model is 2D; leave z out")
        names = [other.name for other in result]
        count = 2
        name = hold.name
        while name in names:
            name, count = f"{hold.name} {count}", count + 1
        result.append(hold if name == hold.name else replace(hold, name=name))
    return tuple(result)

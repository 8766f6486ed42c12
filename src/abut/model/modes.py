"""What is asked for about the state at the end of a load step: frequencies and buckling loads."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

from abut import checks
from abut.errors import InputError
from abut.model.conditions import Amplitude, History

MOST_MODES = 10_000


class AtTime:
    """What is asked for about the state at a time of a run."""

    time: float | None

    @property
    def share(self) -> float:
        """That time, in a model, as a share of the end."""
        return 1.0 if self.time is None else self.time

    @property
    def locking(self) -> tuple[History, ...]:
        """With a corner at its time, where a load step ends."""
        return turn_at(self.share)


@dataclass(frozen=True)
class Frequencies(AtTime):
    """Natural frequencies of the assembly as it is loaded at the end of a load step.

    Closed contact stays closed and what sticks sticks; what slips does so without friction along its surface, or with
    ``complex`` under friction that goes with the pressure; what is open stays open. Supports and whatever else is prescribed
    are held. Every body needs the density of its material.

    Parameters
    ----------
    count : int
        How many, from the lowest.
    stiffening : bool
        Whether stresses and centrifugal forces at the end of the last step change the stiffness. With kinematics "finite"
        they always do.
    complex : bool
        Whether friction of what slips follows the pressure as it vibrates: complex frequencies, of which some may grow
        (squeal).
    coriolis : bool
        Whether Coriolis forces of what centrifugal forces say to turn act on the vibrations: complex frequencies, seen from
        the turning bodies, of whirling with and against the rotation.
    diameters : sequence of int
        Nodal diameters, of each of which ``count`` frequencies are found: from 0 to half the number of sectors. Others than
        0 are vibrations in which each sector of a whole of alike sectors is a phase of 2 pi diameter / sectors behind the
        one before.
    sectors : float
        How many sectors like the modelled one make up the whole turn, where there are nodal diameters other than 0.
    side : str
        The node set on one side of the sector whose equations say that it moves as the other side does, turned by one
        sector. Every equation between these nodes and others is taken to be one of those.
    time : float, optional
        Of the state, where a load step then ends; the end of the run where left out. 0: of the model as it is before
        anything acts, all contacts but ties open.
    open : sequence of str
        Contacts that hold nothing in the vibrations, though they press in the state.

    Raises
    ------
    InputError
        For values out of range.

    Examples
    --------
    >>> import abut
    >>> abut.Frequencies(count=20).count
    20
    """

    count: int = 10
    stiffening: bool = True
    complex: bool = False
    coriolis: bool = False
    diameters: Sequence[int] = (0,)
    sectors: float = 0.0
    side: str = ""
    time: float | None = None
    open: Sequence[str] = ()

    def __post_init__(self) -> None:
        _check_count(self.count, "frequencies")
        check_time(self.time, "frequencies", start=True)
        object.__setattr__(self, "open", checks.listed(self.open, "frequencies: open", "names of contacts"))
        for name, value in (("stiffening", self.stiffening), ("complex", self.complex), ("coriolis", self.coriolis)):
            if not isinstance(value, bool):
                raise InputError(f"frequencies: {name}: expected true or false, got {value!r}")
        object.__setattr__(self, "diameters", checks.listed(self.diameters, "frequencies: diameters", "whole numbers"))
        if self.coriolis and not self.stiffening:
            raise InputError(
                "frequencies: coriolis goes with the centrifugal forces' own stiffness; leave stiffening = false out"
            )
        if self.cyclic or self.sectors or self.side:
            self._check_cyclic()

    @property
    def phased(self) -> bool:
        """Whether modes are complex: friction follows the pressure, or Coriolis forces act."""
        return self.complex or self.coriolis

    @property
    def cyclic(self) -> bool:
        """Whether there are nodal diameters other than 0."""
        return any(self.diameters)

    def _check_cyclic(self) -> None:
        if not (self.sectors > 1.0 and self.side):
            raise InputError("frequencies: nodal diameters need sectors (a number > 1) and side (a node set)")
        for diameter in self.diameters:
            if isinstance(diameter, bool) or not isinstance(diameter, int) or not 0 <= diameter <= self.sectors / 2.0:
                raise InputError(
                    f"frequencies: diameters: expected whole numbers from 0 to {self.sectors / 2.0:g}, got {diameter!r}"
                )
        if self.phased:
            raise InputError(
                "frequencies: complex frequencies are those of nodal diameter 0; leave complex, coriolis or diameters out"
            )


@dataclass(frozen=True)
class Buckling(AtTime):
    """Linear buckling: factors of the stresses at the end of the last load step at which the assembly gives way.

    Closed contact stays closed, as for ``Frequencies``. Stresses are those of all that acts together; kinematics must be
    "small".

    Parameters
    ----------
    count : int
        How many positive factors, from the smallest.
    time : float, optional
        As of ``Frequencies``.

    Raises
    ------
    InputError
        For values out of range.

    Examples
    --------
    >>> import abut
    >>> abut.Buckling(count=3).count
    3
    """

    count: int = 5
    time: float | None = None

    def __post_init__(self) -> None:
        _check_count(self.count, "buckling")
        check_time(self.time, "buckling")


def check_time(time: object, name: str, start: bool = False) -> None:
    """Raise InputError for what is no time of a loaded state; ``start``: that of the unloaded one is among them."""
    if time is None:
        return
    if isinstance(time, bool) or not isinstance(time, (int, float)) or not 0.0 <= time < math.inf:
        raise InputError(f"{name}: time: expected a time from the start to the end, got {time!r}")
    if not (start or time):
        raise InputError(f"{name}: time: expected a time after the start, where nothing acts yet, got {time!r}")


def turn_at(time: float) -> tuple[History, ...]:
    """A history with a corner at a time between start and end, none for these."""
    return (Amplitude(((0.0, 0.0), (time, 0.0), (1.0, 1.0))),) if 0.0 < time < 1.0 else ()


def _check_count(count: object, name: str) -> None:
    if isinstance(count, bool) or not isinstance(count, int) or not 1 <= count <= MOST_MODES:
        raise InputError(f"{name}: count: expected a whole number from 1 to {MOST_MODES}, got {count!r}")

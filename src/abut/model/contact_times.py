"""While a contact acts, if that is a part of the time only: glue that sets, or lets go."""

from __future__ import annotations

import math
from dataclasses import dataclass

from abut import checks
from abut.errors import InputError
from abut.model.conditions import Amplitude
from abut.model.step_ends import SAME

END = 1.0  # of time


@dataclass(frozen=True)
class ContactTimes:
    """It acts from ``since`` up to ``until`` (None: the end); forces that it has then go down in a straight line, to none at
    ``released`` (None: at once)."""

    since: float = 0.0
    until: float | None = None
    released: float | None = None

    def checked(self, where: str) -> ContactTimes:
        """The same. Raises InputError for times that do not follow each other."""
        for name in ("since", "until", "released"):
            if name == "since" or getattr(self, name) is not None:
                checks.finite(getattr(self, name), f"{where}: {name}")
        if self.released is not None and self.until is None:
            raise InputError(f"{where}: released goes with until; give the time up to which it acts")
        last = math.inf if self.until is None else self.until
        gone = last if self.released is None else self.released
        if not 0.0 <= self.since < last <= gone:
            given = ", ".join(f"{name} {value:g}" for name, value in vars(self).items() if value is not None)
            raise InputError(f"{where}: expected times 0 <= since < until <= released, got {given}")
        return self

    @property
    def always(self) -> bool:
        """Whether it acts all the time."""
        return self.since <= SAME and self.last >= END - SAME

    @property
    def last(self) -> float:
        """Time up to which it acts."""
        return END if self.until is None else self.until

    @property
    def gone(self) -> float:
        """Time from which on none of its forces is left."""
        return self.last if self.released is None else self.released

    def away(self, time: float) -> bool:
        """Whether it does not act in the step that ends at a time; at the start, whether it does not from the outset."""
        return (self.since > SAME and time <= self.since + SAME) or time > self.last + SAME

    def meets(self, other: ContactTimes) -> bool:
        """Whether there is a time at which both act."""
        return self.since < other.last - SAME and other.since < self.last - SAME

    def left(self, time: float) -> float:
        """Share of its last forces that is left."""
        if time <= self.last + SAME or time >= self.gone - SAME:
            return 0.0
        return (self.gone - time) / (self.gone - self.last)

    @property
    def locking(self) -> tuple[Amplitude, ...]:
        """Histories with corners where it comes, goes, and is gone: load steps must end there."""
        inside = sorted({turn for turn in (self.since, self.last, self.gone) if SAME < turn < END - SAME})
        return tuple(Amplitude(((0.0, 0.0), (turn, 0.0), (END, 1.0))) for turn in inside)

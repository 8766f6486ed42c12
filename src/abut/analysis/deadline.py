"""A limit of time for a run."""

from __future__ import annotations

import time
from collections.abc import Callable
from dataclasses import dataclass, field

from abut.errors import OutOfTime


@dataclass
class Deadline:
    """``seconds`` from now on; None for no limit. clock: tells seconds. Late between load steps, it ends the run; in a step
    it waits for one iteration more, since the last one may have been all that the step needed."""

    seconds: float | None
    clock: Callable[[], float] = time.monotonic
    _began: float = field(init=False)
    _late: bool = field(default=False, init=False)

    def __post_init__(self) -> None:
        self._began = self.clock()

    @property
    def over(self) -> bool:
        return self.seconds is not None and self.clock() - self._began > self.seconds

    def begins(self) -> None:
        """A load step begins. Raises OutOfTime."""
        if self.over:
            raise self._end()
        self._late = False

    def iterated(self) -> None:
        """An iteration has ended. Raises OutOfTime."""
        if self._late:
            raise self._end()
        self._late = self.over

    def _end(self) -> OutOfTime:
        return OutOfTime(f"stopped after {self.seconds:g} s, as solve.seconds says")

"""How a model is to be solved."""

from __future__ import annotations

from dataclasses import dataclass, field
from itertools import pairwise
from typing import Literal

from abut import checks
from abut.errors import InputError
from abut.model.step_ends import SAME

LINEAR = ("auto", "direct", "amg", "petsc")
AUTO = "auto"
MOST_STEPS = 1_000_000  # load steps, and iterations in one


@dataclass(frozen=True)
class SolveOptions:
    """How to solve: load steps, linear solver, limits.

    Where contacts have friction a step that does not converge is taken in parts, whose results are not written.

    Parameters
    ----------
    steps : int or str
        Load steps of equal length; "auto" is one, with friction as many as its onset of slip takes, and with kinematics
        "finite" as many as it takes.
    linear : str
        "auto", "direct", "amg" (multigrid) or "petsc".
    max_iterations : int
        Allowed in a step, of each method that is tried.
    times : sequence of float, optional
        Ends of the steps, increasing, over 0 up to ``end``, in place of ``steps``; the ramp grows with the time.
    seconds : float, optional
        That a run may take, after which it ends with the steps done so far [s].
    end : float
        The time when all of it is done: all times that a model is made of, those of amplitudes too, run from 0 to it. The
        model keeps them as shares of it, from 0 to 1.

    Raises
    ------
    InputError
        For values out of range.

    Examples
    --------
    >>> import abut
    >>> abut.SolveOptions(steps=4).ends
    (0.25, 0.5, 0.75, 1.0)
    """

    steps: int | Literal["auto"] = "auto"
    linear: str = "auto"
    max_iterations: int = 50
    times: tuple[float, ...] | None = None
    seconds: float | None = None
    end: float = field(default=1.0, compare=False)

    def __post_init__(self) -> None:
        for name, other in (("steps", f'"{AUTO}" or '), ("max_iterations", "")):
            value = getattr(self, name)
            if other and value == AUTO:
                continue
            if isinstance(value, bool) or not isinstance(value, int) or not 1 <= value <= MOST_STEPS:
                raise InputError(f"solve.{name}: expected {other}a whole number from 1 to {MOST_STEPS}, got {value!r}")
        checks.choice(self.linear, "solve.linear", LINEAR)
        if self.seconds is not None:
            object.__setattr__(self, "seconds", checks.positive(self.seconds, "solve.seconds"))
        object.__setattr__(self, "end", checks.positive(self.end, "solve.end"))
        if self.times is not None:
            self._check_times()

    @property
    def finds_steps(self) -> bool:
        """Whether a run at large displacements, or with friction, finds all of its load steps."""
        return self.steps == AUTO and not self.times

    @property
    def ends(self) -> tuple[float, ...]:
        """Time at the end of each load step."""
        count = self.steps if isinstance(self.steps, int) else 1
        return self.times or tuple(number / count for number in range(1, count + 1))

    def time(self, share: float) -> float:
        """A time, from its share of the end."""
        return share * self.end

    def said(self, share: float) -> str:
        """The same in words."""
        return f"{self.time(share):.4g} of {self.end:.4g}"

    def _check_times(self) -> None:
        try:
            times = tuple(checks.finite(time, "solve.times") for time in self.times or ())
        except TypeError:
            raise InputError(f"solve.times: expected numbers, got {self.times!r}") from None
        if not times or times[0] <= 0.0 or any(a >= b for a, b in pairwise(times)):  # a model checks the last of them
            raise InputError(f"solve.times: expected increasing numbers over 0 up to {self.end:g}, got {list(times)}")
        for before, time in pairwise((0.0, *times)):
            if time - before <= SAME * times[-1]:
                least = SAME * times[-1]
                raise InputError(
                    f"solve.times: {before!r} and {time!r} are one time, as they differ by {least:g} at most; leave one out"
                )
        if self.steps not in (AUTO, 1, len(times)):
            raise InputError(f"solve: {self.steps} steps, but {len(times)} times; give one of them")
        object.__setattr__(self, "times", times)

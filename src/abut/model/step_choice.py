"""Of which load steps something is written: a rule as users give it, checked, and what it says of a step."""

from __future__ import annotations

from collections.abc import Iterable, Sequence

from abut import checks
from abut.errors import InputError

WORDS = ("all", "last")
StepChoice = str | int | Sequence[int]


def check_steps(steps: StepChoice, where: str) -> None:
    """Raise InputError, beginning with ``where``, for what is no rule."""
    if isinstance(steps, str):
        checks.choice(steps, where, WORDS)
        return
    numbers = list(steps) if isinstance(steps, Iterable) else [steps]
    if not numbers or any(isinstance(n, bool) or not isinstance(n, int) or n < 1 for n in numbers):
        raise InputError(
            f'{where}: expected "all", "last", a number > 0 or a list of such, got {steps!r}; 10 means every tenth step, '
            "[10] the tenth"
        )


def chosen(steps: StepChoice, number: int, last: bool = False) -> bool:
    """Whether step ``number`` is among them; last: it is the last one, which always is."""
    if last or steps == "all":
        return True
    if isinstance(steps, str):
        return False
    return number % steps == 0 if isinstance(steps, int) else number in steps

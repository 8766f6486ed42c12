"""What the processes of a run keep for the one that leads."""

from __future__ import annotations

import gc
from typing import Any

from abut.parallel.team import Store, Team


class Alone:
    """A communicator of one process."""

    size, rank = 1, 0

    def bcast(self, value: Any) -> Any:
        return value

    def scatter(self, values: list[Any]) -> Any:
        return values[0]

    def gather(self, value: Any) -> list[Any]:
        return [value]


class Large:
    """As PETSc's objects: destroyed in so many words."""

    def __init__(self) -> None:
        self.destroyed = 0

    def destroy(self) -> None:
        self.destroyed += 1


def put(store: Store, number: int, value: Large) -> None:
    store[number] = value


def numbers(store: Store) -> list[Any]:
    return sorted(store)


def test_what_nobody_holds_is_dropped_with_the_next_call() -> None:
    """And only that; numbers are not given again."""
    team, values = Team(Alone()), [Large(), Large()]
    first, second = team.keep(), team.keep()
    for kept, value in zip((first, second), values):
        team.each(put, kept.number, per_rank=[(value,)])
    assert team.each(numbers) == [[first.number, second.number]]
    gone = first.number
    del first, kept
    gc.collect()
    assert [value.destroyed for value in values] == [0, 0]
    assert team.each(numbers) == [[second.number]]
    assert [value.destroyed for value in values] == [1, 0]
    assert team.keep().number not in (gone, second.number)

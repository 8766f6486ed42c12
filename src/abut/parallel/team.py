"""The processes of a run: process 0 leads, all of them work. Work is a function and its arguments.

Process 0 runs the serial algorithm; operations whose cost grows with the number of cells (stiffness, products, linear
solutions, stresses) are done by all processes, each on its part of the cells.
"""

from __future__ import annotations

import signal
import sys
import traceback
import weakref
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from itertools import count
from typing import Any

from abut.types import Foreign

Store = dict[str | int, Foreign]  # what a process keeps between calls


@dataclass(frozen=True)
class Kept:
    """What every process keeps under a number in its store, as long as process 0 holds this."""

    number: int


class Team:
    """The processes that were started together, or this one alone."""

    def __init__(self, comm: Any) -> None:
        self.comm = comm
        self.store: Store = {}
        self._numbers = count()
        self._gone: list[int] = []

    @property
    def size(self) -> int:
        """How many processes there are."""
        return int(self.comm.size)

    def each(
        self, function: Callable[..., Any], *shared: Any, per_rank: Sequence[tuple[Any, ...]] | None = None
    ) -> list[Any]:
        """Call function(store, *shared, *per_rank[rank]) on every process and return the results by rank; for process 0.

        function: of a module, as it travels by its name; store: a dict that each process keeps for itself."""
        gone = [self._gone.pop() for _ in range(len(self._gone))]
        self.comm.bcast((function, shared, gone))
        arguments = per_rank or [()] * self.size
        self.comm.scatter([None, *arguments[1:]])  # its own share does not travel, and may be what cannot be pickled
        mine = self._done(function, (*shared, *arguments[0]), gone)
        return [mine, *self.comm.gather(None)[1:]]

    def keep(self) -> Kept:
        """A number for something that every process will keep; it goes with the next call after nobody here holds it."""
        kept = Kept(next(self._numbers))
        weakref.finalize(kept, self._gone.append, kept.number)
        return kept

    def serve(self) -> None:
        """Take part in what process 0 asks for until it is done; for the others."""
        for number in (signal.SIGINT, signal.SIGTERM):
            signal.signal(number, signal.SIG_IGN)  # process 0 ends the run in order, after its iteration
        while (task := self.comm.bcast(None)) is not None:
            function, shared, gone = task
            self.comm.gather(self._done(function, (*shared, *self.comm.scatter(None)), gone))

    def dismiss(self) -> None:
        """Let the others go."""
        self.comm.bcast(None)

    def _done(self, function: Callable[..., Any], arguments: tuple[Any, ...], gone: Sequence[int]) -> Any:
        for number in gone:
            old = self.store.pop(number, None)
            if hasattr(old, "destroy"):
                old.destroy()  # now, not when Python finds the time: it is PETSc's, and large
        try:
            return function(self.store, *arguments)
        except Exception:
            if self.size == 1:
                raise
            # The others wait inside the same call for a message that will not come.
            traceback.print_exc()
            print(f"abut: process {self.comm.rank} failed: the run ends", file=sys.stderr, flush=True)
            self.comm.Abort(1)


def lead(function: Callable[[Team], int], options: Sequence[str] = ()) -> int:
    """Process 0 returns function(team); the others serve it until then, and return 0.

    options: for PETSc, as on a command line. Raises InputError where petsc4py or mpi4py are missing."""
    team = start_team(options)
    if team.comm.rank:
        team.serve()
        return 0
    try:
        return function(team)
    finally:
        team.dismiss()


def start_team(options: Sequence[str] = ()) -> Team:
    """The processes this one was started with. Raises InputError where petsc4py or mpi4py are missing."""
    from abut.parallel.launch import require

    require()
    import petsc4py

    petsc4py.init(["abut", "-no_signal_handler", *options])
    from mpi4py import MPI

    return Team(MPI.COMM_WORLD)

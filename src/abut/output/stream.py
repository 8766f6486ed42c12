"""The output directory during a run: the results of each step as soon as it has converged, and each iteration."""

from __future__ import annotations

import json
import os
from collections.abc import Callable, Mapping, Sequence
from pathlib import Path
from types import TracebackType

from abut.errors import InputError, Stopped
from abut.io.atomic import remove_leftovers
from abut.output.earlier import remove_all, set_aside
from abut.output.fields import WriteFields, write_fields
from abut.output.lock import Lock
from abut.output.options import EVERYTHING, Output
from abut.output.restart import clear, load_steps, save_step
from abut.output.results import is_written, write_held, write_index, write_steps
from abut.report import Origin
from abut.solution import Iteration, Phase, Saved, Solution, Step

LOG = "run.jsonl.part"


class Stream:
    """Results of a run, written while it goes on; a context manager.

    Fields, contact surfaces and restart data of a step are written when it has converged, then the files that list the
    steps anew, so that whatever ends the run, all but the step being solved is there. ``run.jsonl.part`` gets a whole line
    an iteration at once and becomes ``run.jsonl`` at the end. A run that ends before its first step leaves nothing, not
    even a directory that was not there before.

    No other run writes there meanwhile. Results of an earlier run go when this one has its first step; where it fails before
    that, they are moved aside.

    model: what a restart compares (``abut.output.restart.description``); restart: whether to go on after the steps of an
    earlier run, which are ``resumed``; fields: what writes the fields of a step; tell: gets a note; output: which VTU files
    are written;
    begun: steps of another job that this one begins with, kept for a restart like its own.
    Raises InputError where the directory cannot be written or another run writes there, and where there is nothing to go on
    with.
    """

    def __init__(
        self,
        directory: Path,
        model: Mapping[str, str],
        restart: bool = False,
        fields: WriteFields = write_fields,
        tell: Callable[[str], None] | None = None,
        output: Output = EVERYTHING,
        begun: Sequence[Saved] = (),
    ) -> None:
        self.directory = directory
        self._tell = tell
        self._fields, self._output = fields, output
        self._model = model
        self._written: set[int] = set()
        self._whole: set[int] = set()  # those of them with VTU files
        self._lock = Lock(directory)
        try:
            self.resumed: list[Saved] = load_steps(directory, model) if restart else []
            self._taken = () if restart else tuple(begun)
            self._log = self._open_log()
        except BaseException:
            self._lock.release(empty=True)
            raise
        self.time = self.resumed[-1].state.time if self.resumed else 0.0  # that the steps in the directory reach

    def _open_log(self) -> int:
        """Its file, always a fresh one: a link of that name may lead elsewhere."""
        remove_leftovers(self.directory)
        path = self.directory / LOG
        try:
            path.unlink(missing_ok=True)
            return os.open(path, os.O_WRONLY | os.O_CREAT | os.O_EXCL | os.O_APPEND, 0o666)
        except OSError as error:
            raise InputError(f"cannot write {path}: {error.strerror}; choose another output directory") from None

    @property
    def steps(self) -> int:
        """How many steps the directory holds."""
        return max(len(self.resumed), *self._written, 0)

    def observe(self, item: Iteration | Phase | str) -> None:
        """Append an iteration or a note to the log."""
        if isinstance(item, Phase):
            return
        line = {"note": item} if isinstance(item, str) else item.row
        try:
            os.write(self._log, (json.dumps(line) + "\n").encode())  # one call: no line is ever half there
        except OSError as error:
            raise InputError(f"cannot write {self.directory / LOG}: {error.strerror}; make room") from None

    def step(self, solution: Solution, saved: Saved) -> None:
        """Write the last step of the solution so far."""
        self._make_room()
        for earlier in self._taken:
            save_step(self.directory, self._model, earlier)
        self._taken = ()
        write_steps(self.directory, solution, self._missing(solution), self._fields, self._output, final=False)
        if self._output.wants(saved.number):
            self._whole.add(saved.number)
        self._written.add(saved.number)
        self.time = saved.state.time
        write_index(self.directory, solution, self._output, final=False)
        save_step(self.directory, self._model, saved)

    def finish(self, solution: Solution, origin: Origin | None = None) -> None:
        """Write what is still to be written, and the report, which says where the job comes from (``origin``); restart data
        stay only where there is something left to do."""
        self._make_room()
        write_held(solution, self.directory, origin, self._missing(solution), self._fields, self._output)
        self._written.add(len(solution.steps))
        if solution.converged and solution.complete and not self._output.restart:
            clear(self.directory)

    def _make_room(self) -> None:
        """Before the first results of this run: those of an earlier one no longer fit."""
        if not self.resumed and not self._written:
            clear(self.directory)
            remove_all(self.directory)

    def _missing(self, solution: Solution) -> list[Step]:
        """Steps not written in this run; those done before it only where their files are gone."""
        return [
            step
            for step in solution.steps
            if step.number not in self._whole
            and not (step.number <= len(self.resumed) and is_written(self.directory, solution, step, self._output))
        ]

    def __enter__(self) -> Stream:
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        os.close(self._log)
        (self.directory / LOG).unlink(missing_ok=True)
        failed = error is not None and not isinstance(error, (Stopped, KeyboardInterrupt))
        try:
            if failed and not self._written and not self.resumed:
                clear(self.directory)
                aside = set_aside(self.directory)
                if aside is not None and self._tell is not None:
                    self._tell(f"results of an earlier run are now in {aside}")
        finally:
            self._lock.release(empty=not self._written)

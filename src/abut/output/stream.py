"""The output directory during a run: the results of each step as soon as it has converged, and each iteration."""

from __future__ import annotations

import json
import os
from collections.abc import Mapping, Sequence
from pathlib import Path
from types import TracebackType

from abut.errors import InputError
from abut.io.atomic import make_directory, remove_leftovers
from abut.output.fields import WriteFields, write_fields
from abut.output.options import EVERYTHING, Output
from abut.output.restart import clear, save_step
from abut.output.results import is_written, write, write_index, write_steps
from abut.report import Origin
from abut.solution import Iteration, Phase, Saved, Solution, Step

LOG = "run.jsonl.part"


class Stream:
    """Results of a run, written while it goes on; a context manager.

    Fields, contact surfaces and restart data of a step are written when it has converged, then the files that list the
    steps anew, so that whatever ends the run, all but the step being solved is there. ``run.jsonl.part`` gets a whole line
    an iteration at once and becomes ``run.jsonl`` at the end. A run that ends before its first step leaves nothing, not
    even a directory that was not there before.

    model: what a restart compares (``abut.output.restart.description``); resumed: records of the steps done before; fields:
    what writes the fields of a step; output: which VTU files are written.
    Raises InputError where the directory cannot be written.
    """

    def __init__(
        self,
        directory: Path,
        model: Mapping[str, str],
        resumed: Sequence[Saved] = (),
        fields: WriteFields = write_fields,
        output: Output = EVERYTHING,
    ) -> None:
        self.directory = directory
        self._fields, self._output = fields, output
        self._model = model
        self._resumed = len(resumed)
        self._written: set[int] = set()
        self._whole: set[int] = set()  # those of them with VTU files
        self.time = resumed[-1].state.time if resumed else 0.0  # that the steps in the directory reach
        self._made = [p for p in (directory, *directory.parents) if not p.exists()]
        make_directory(directory)
        remove_leftovers(directory)
        try:
            self._log = os.open(directory / LOG, os.O_WRONLY | os.O_CREAT | os.O_TRUNC | os.O_APPEND, 0o666)
        except OSError as error:
            raise InputError(
                f"cannot write {directory / LOG}: {error.strerror}; choose another output directory"
            ) from None

    @property
    def steps(self) -> int:
        """How many steps the directory holds."""
        return max(self._resumed, *self._written, 0)

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
        if not self._resumed and not self._written:
            clear(self.directory)  # of an earlier run: it would no longer fit
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
        write(solution, self.directory, origin, self._missing(solution), self._fields, self._output)
        self._written.add(len(solution.steps))
        if solution.converged and solution.complete:
            clear(self.directory)

    def _missing(self, solution: Solution) -> list[Step]:
        """Steps not written in this run; those done before it only where their files are gone."""
        return [
            step
            for step in solution.steps
            if step.number not in self._whole
            and not (step.number <= self._resumed and is_written(self.directory, step, self._output))
        ]

    def __enter__(self) -> Stream:
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        os.close(self._log)
        (self.directory / LOG).unlink(missing_ok=True)
        if not self._written:
            for folder in self._made:
                if any(folder.iterdir()):
                    break
                folder.rmdir()

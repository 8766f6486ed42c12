"""Progress of a run on the terminal: a table of iterations and the current stage."""

from __future__ import annotations

import contextlib
import sys
import threading
import time
from types import TracebackType
from typing import TYPE_CHECKING

from abut.cli.terminal import plain, show
from abut.solution import Iteration, Phase

if TYPE_CHECKING:
    from rich.status import Status

HEAD = "step  iter   active  changed   residual    contact  penetration   seconds"
HEAD_FRICTION = HEAD.replace("  changed", "   sticks    slips  changed")
LONG = 2.0  # expected seconds from which on a stage is announced where there is no live line
PATIENCE = 5.0  # seconds of silence after which a line says what goes on
REFRESH = 0.25


class Progress:
    """An observer of ``abut.analysis.solve`` that prints; a context manager.

    Notes and iterations are lines. On a terminal a live line below them says which stage it is, for how long, how long it
    may take, and how long all load steps will. Elsewhere (a file, a pipe) stages that will take long are lines, and
    another line follows wherever nothing else was printed for a while, each after twice the time of the one before.
    ``silent``: no output at all; ``plain``: no live line, as mpiexec makes every output look like a terminal.
    """

    def __init__(self, silent: bool = False, plain: bool = False) -> None:
        self._silent, self._plain = silent, plain
        self._live: Status | None = None
        self._stage: Phase | None = None
        self._lock = threading.Lock()
        self._closed = threading.Event()
        self._began = self._spoke = self._first = self._since = time.monotonic()
        self._patience = PATIENCE
        self._step = self._iteration = 0
        self._before = self._done = self._total = (
            0.0  # load steps, or the way: done before this run, by now, to be done
        )
        self._aim = ""  # of a step whose number among all nobody knows

    def __call__(self, item: Iteration | Phase | str) -> None:
        if isinstance(item, Phase):
            self._enter_stage(item)
        elif isinstance(item, str):
            self.line(item)
        else:
            if item.step != self._step:
                self._step = item.step
                if self._aim:
                    self.line(self._aim)
                self.line(HEAD if item.slipping is None else HEAD_FRICTION)
            self._iteration = item.iteration
            self.line(_table_row(item))

    def line(self, text: str) -> None:
        """Print a line above the live one."""
        if self._silent:
            return
        with self._lock:
            self._print(text)
            self._patience = PATIENCE

    def _print(self, text: str) -> None:
        if self._live is not None:
            self._live.console.print(plain(text), markup=False, highlight=False, soft_wrap=True)
        else:
            with contextlib.suppress(BrokenPipeError):  # the results are worth more than who reads along
                show(text, flush=True)
        self._spoke = time.monotonic()

    def _enter_stage(self, stage: Phase) -> None:
        now = time.monotonic()
        with self._lock:
            done, total = (stage.done, stage.total) if stage.share is None else (stage.share, 1.0)
            self._aim = self._aim if stage.share is None else stage.name
            if total and not self._total:
                self._first, self._before = now, done
            if total and (not self._total or done > self._done):
                self._done, self._since = done, now
            self._total = total or self._total
            self._stage, self._began, self._iteration = stage, now, 0
            self._patience = PATIENCE
            if self._live is not None:
                self._live.update(plain(self.status(now)))
            elif not self._silent and (stage.seconds or 0.0) >= LONG:
                self._print(str(stage))

    def status(self, now: float) -> str:
        """The live line: stage, iteration, time spent, time left."""
        stage = self._stage
        if stage is None:
            return "reading"
        text = str(stage)
        if self._iteration:
            text += f", iteration {self._iteration + 1}"
        text += f" ({now - self._began:.0f} s)"
        if self._total > self._done > self._before:
            each = (self._since - self._first) / (self._done - self._before)
            left = max(each * (self._total - self._done) - (now - self._since), 0.0)
            done = f"{self._done:.0%} of the way" if self._aim else f"{self._done} of {self._total} steps"
            text += f"; {done} done, about {_duration(left)} left"
        return text

    def _watch(self) -> None:
        while not self._closed.wait(REFRESH):
            now = time.monotonic()
            with self._lock:
                if self._live is not None:
                    self._live.update(plain(self.status(now)))
                elif now - self._spoke >= self._patience:
                    self._print(f"... {self.status(now)}")
                    self._patience *= 2.0

    def __enter__(self) -> Progress:
        if self._silent:
            return self
        if sys.stdout.isatty() and not self._plain:
            from rich.console import Console

            self._live = Console().status("reading", spinner="line")
            self._live.start()
        self._thread = threading.Thread(target=self._watch, daemon=True)
        self._thread.start()
        return self

    def close(self) -> None:
        """Take the live line away; what is printed afterwards is plain."""
        if self._silent or self._closed.is_set():
            return
        self._closed.set()
        self._thread.join(timeout=1.0)
        if self._live is not None:
            self._live.stop()
            self._live = None

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        self.close()


def _table_row(item: Iteration) -> str:
    """An iteration below the head of the table; with friction two columns more."""
    friction = "" if item.slipping is None else f"{item.sticking:7d}  {item.slipping:7d}  "
    return (
        f"{item.step:4d}  {item.iteration:4d}  {item.active:7d}  {friction}{item.changed:7d}  {item.residual:9.2e}  "
        f"{item.contact_residual:9.2e}    {item.penetration + 0.0:9.2e}  {item.seconds:8.2f}"
    )


def _duration(seconds: float) -> str:
    """ "12 s", "3 min 20 s", "2 h 5 min"."""
    whole = round(seconds)
    if whole < 60:
        return f"{whole} s"
    if whole < 3600:
        return f"{whole // 60} min {whole % 60} s"
    return f"{whole // 3600} h {whole % 3600 // 60} min"

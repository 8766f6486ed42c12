"""Ctrl-C: the run ends after the current iteration; a second one ends it at once."""

from __future__ import annotations

import os
import signal
import socket
import threading
from collections.abc import Callable
from types import TracebackType

from abut.errors import Stopped

SIGNALS = (signal.SIGINT, signal.SIGTERM)


class Interrupt:
    """Catches Ctrl-C and SIGTERM; a context manager, for the main thread.

    Python's own handlers wait until a compiled function returns, which can take minutes. Here the system writes the
    signal's number to a socket, and a thread that reads it answers at once: ``say`` gets a message the first time, the
    second time the process ends after ``leave`` has been called. ``check`` raises Stopped once a signal has come.
    """

    def __init__(self, say: Callable[[str], None], leave: Callable[[], None]) -> None:
        self._say, self._leave = say, leave
        self._signal = 0
        self._active = threading.current_thread() is threading.main_thread()

    @property
    def exit_status(self) -> int:
        """128 plus the signal's number, as shells have it: 130 after Ctrl-C, 143 after SIGTERM."""
        return 128 + self._signal

    def check(self, _: object = None) -> None:
        """Raise Stopped where a signal has come."""
        if self._signal:
            raise Stopped("stopped")

    def _watch(self) -> None:
        while number := self._reader.recv(1):
            if number[0] not in SIGNALS:
                continue
            if self._signal:
                self._leave()
                os._exit(self.exit_status)
            self._signal = number[0]
            self._say("stopping after the current iteration (once more: at once)")

    def __enter__(self) -> Interrupt:
        if self._active:
            self._reader, self._writer = socket.socketpair()
            self._writer.setblocking(False)
            self._wakeup = signal.set_wakeup_fd(self._writer.fileno(), warn_on_full_buffer=False)
            self._handlers = [signal.signal(s, lambda *_: None) for s in SIGNALS]
            self._thread = threading.Thread(target=self._watch, daemon=True)
            self._thread.start()
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        if not self._active:
            return
        signal.set_wakeup_fd(self._wakeup)
        for s, handler in zip(SIGNALS, self._handlers):
            signal.signal(s, handler)
        self._writer.close()
        self._thread.join()
        self._reader.close()

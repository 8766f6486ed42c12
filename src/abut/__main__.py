"""The program abut, as ``python -m abut``: Ctrl-C while it starts ends it with one line."""

from __future__ import annotations

import os
import signal
import sys

INTERRUPTED = 130


def main() -> int:
    """Run the command line and return its exit status.

    Where an import is interrupted by an exception anything may follow, as compiled modules turn it into errors of their
    own; nothing is written yet, and so the process just ends."""
    if signal.getsignal(signal.SIGINT) is signal.default_int_handler:  # else the caller wants it ignored
        signal.signal(signal.SIGINT, _stop)
    from abut.cli import main as command_line

    return command_line(loaded=_loaded)


def _stop(*_: object) -> None:
    os.write(2, b"abut: stopped\n")
    os._exit(INTERRUPTED)


def _loaded() -> None:
    if signal.getsignal(signal.SIGINT) is _stop:
        signal.signal(signal.SIGINT, signal.default_int_handler)


if __name__ == "__main__":
    sys.exit(main())

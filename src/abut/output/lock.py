"""One run at a time writes into an output directory."""

from __future__ import annotations

import contextlib
import os
import sys
from pathlib import Path

from abut.errors import InputError
from abut.io.atomic import make_directory

NAME = ".lock.tmp"  # with the ending of what a run that was killed leaves
TRIES = 100  # a run that ends removes what another one has just opened


class Lock:
    """Holds a directory, which it creates, until ``release``. The system itself frees what a process held that has died.

    Raises InputError where another run holds it, or where it cannot be written."""

    def __init__(self, directory: Path) -> None:
        self._path = directory / NAME
        self._made = [p for p in (directory, *directory.parents) if not os.path.lexists(p)]
        for _ in range(TRIES):
            make_directory(directory)
            try:
                self._file = os.open(self._path, os.O_RDWR | os.O_CREAT | getattr(os, "O_NOFOLLOW", 0), 0o666)
            except FileNotFoundError:
                continue  # a run that ends has removed the directory just now
            except OSError as error:
                self._leave()
                raise InputError(
                    f"cannot write {self._path}: {error.strerror}; choose another output directory"
                ) from None
            if not _locked(self._file):
                holder = os.pread(self._file, 20, 0).decode(errors="replace") if hasattr(os, "pread") else ""
                os.close(self._file)
                which = f"process {holder}" if holder.isdigit() else "another run"
                raise InputError(
                    f"{which} still writes results to {directory}; wait until it has ended, stop it, or choose another "
                    "output directory"
                )
            if _is(self._file, self._path):
                os.truncate(self._file, 0)
                os.write(self._file, str(os.getpid()).encode())
                return
            os.close(self._file)
        raise InputError(f"cannot lock {directory}: other runs begin and end there; choose another output directory")

    def release(self, empty: bool) -> None:
        """Let others write; empty: whether directories that were not there before go where nothing is in them."""
        if sys.platform == "win32":  # which removes no open files
            os.close(self._file)
            with contextlib.suppress(OSError):
                self._path.unlink()
        else:
            if _is(self._file, self._path):  # someone may have removed it, and another run have begun
                self._path.unlink(missing_ok=True)
            os.close(self._file)
        if empty:
            self._leave()

    def _leave(self) -> None:
        with contextlib.suppress(OSError):  # not empty, or the next run is there already
            for folder in self._made:
                folder.rmdir()


def _is(file: int, path: Path) -> bool:
    """Whether an open file is still the one of that name."""
    try:
        return os.path.samestat(os.fstat(file), os.lstat(path))
    except FileNotFoundError:
        return False


def _locked(file: int) -> bool:
    """Lock an open file; whether nobody else has. Where the file system knows no locks there is none."""
    if sys.platform == "win32":
        import msvcrt

        try:
            msvcrt.locking(file, msvcrt.LK_NBLCK, 1)
        except OSError:
            return False
        return True
    import fcntl

    try:
        fcntl.flock(file, fcntl.LOCK_EX | fcntl.LOCK_NB)
    except BlockingIOError:
        return False
    except OSError:
        return True
    return True

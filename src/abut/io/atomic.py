"""Files are written whole or not at all: under a temporary name in the same folder, then renamed."""

from __future__ import annotations

import hashlib
import os
from collections.abc import Callable
from pathlib import Path

from abut.errors import InputError

LONGEST = 200  # bytes of a file's name in a temporary one: most file systems allow 255


def write_file(path: Path, write: Callable[[Path], None]) -> None:
    """Call ``write`` with a temporary path beside ``path`` and move the result into place.

    Raises InputError where the folder cannot be written to; nothing is left behind on failure.
    """
    temporary = path.with_name(f".{_short(path.name)}.{os.getpid()}.tmp{path.suffix}")
    try:
        temporary.unlink(missing_ok=True)  # a link of that name would lead elsewhere
        write(temporary)
        os.replace(temporary, path)
    except OSError as error:
        raise InputError(f"cannot write {path}: {error.strerror or error}; choose another output directory") from None
    finally:
        temporary.unlink(missing_ok=True)


def _short(name: str) -> str:
    """A name that leaves room for what temporary ones have beside it."""
    data = os.fsencode(name)
    return name if len(data) <= LONGEST else hashlib.sha256(data).hexdigest()


def write_text(path: Path, text: str) -> None:
    """Write a text file whole (UTF-8)."""

    def write(temporary: Path) -> None:
        temporary.write_text(text, encoding="utf-8", errors="backslashreplace")  # bytes of names that are no text

    write_file(path, write)


def make_directory(path: Path) -> None:
    """Create an output directory. Raises InputError where a file is in the way or it is not allowed."""
    try:
        str(path).encode("utf-8")  # VTK takes no other names
        path.mkdir(parents=True, exist_ok=True)
    except (OSError, ValueError) as error:  # ValueError: bytes that are no text, or zero
        why = getattr(error, "strerror", None) or error
        raise InputError(f"cannot create the output directory {path}: {why}; choose another") from None


def in_the_way(path: Path) -> Path | None:
    """A file where ``make_directory`` needs a folder; None where there is none."""
    at = next((p for p in (path, *path.parents) if os.path.lexists(p)), None)
    return None if at is None or at.is_dir() else at


def remove_leftovers(folder: Path) -> None:
    """Remove temporary files of runs that were killed; those of processes still alive stay."""
    for path in folder.glob(".*.tmp*"):
        process = path.name.rpartition(".tmp")[0].rpartition(".")[2]
        if process.isdigit() and not _alive(int(process)):
            path.unlink(missing_ok=True)


def _alive(process: int) -> bool:
    if process == os.getpid() or os.name != "posix":  # elsewhere asking is not free of side effects
        return True
    try:
        os.kill(process, 0)
    except (ProcessLookupError, OverflowError):
        return False
    except PermissionError:
        return True
    return True

"""Names as parts of file names: what users call a contact or a probe may be long, in any script, and alike but for a sign
that files cannot have."""

from __future__ import annotations

import hashlib
import re
from collections import Counter
from collections.abc import Sequence
from pathlib import Path

LONGEST = 100  # characters: with what stands around it below the 143 bytes that the shortest file systems allow
DIGITS = 8  # of the mark that tells names apart


def file_labels(names: Sequence[str]) -> list[str]:
    """Each of some different names as part of a file name of letters, digits, dots, hyphens and underscores, no two the
    same, whatever their case. Only where a name is too long or two would be the same, it has a mark, which depends on the
    name alone.

    >>> file_labels(["pin / lug", "shaft", "Shaft"])
    ['pin_lug', 'shaft-a6b18808', 'Shaft-60315ad5']
    """
    plain = [re.sub(r"[^A-Za-z0-9._-]+", "_", name) for name in names]
    count = Counter(label.lower() for label in plain)
    marked = [f"{label[: LONGEST - DIGITS - 1]}-{_mark(name)}" for name, label in zip(names, plain)]
    result = [
        label if count[label.lower()] == 1 and len(label) <= LONGEST else other for label, other in zip(plain, marked)
    ]
    return result if len({label.lower() for label in result}) == len(result) else marked


def is_file(path: Path) -> bool:
    """Whether a file is there; of a name that no file can have it is not."""
    try:
        return path.is_file()
    except (OSError, ValueError):
        return False


def _mark(name: str) -> str:
    return hashlib.sha256(name.encode("utf-8", "surrogatepass")).hexdigest()[:DIGITS]

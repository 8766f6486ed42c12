"""Prints constraints for pip: the lowest version that pyproject.toml allows of each package (`make lowest`)."""

from __future__ import annotations

import re
import tomllib
from pathlib import Path
from typing import Any

FILE = Path(__file__).parents[2] / "pyproject.toml"
BOUND = re.compile(r"(?P<name>[A-Za-z0-9_.-]+)>=(?P<version>[0-9][0-9.]*)(?: *;.*)?")


def bounds(project: dict[str, Any]) -> dict[str, str]:
    """Lowest version by package, of the dependencies. Raises ValueError where one has another form than NAME>=VERSION."""
    found = {}
    for line in project["dependencies"]:
        match = BOUND.fullmatch(line)
        if match is None:
            raise ValueError(f"{line!r}: give the lowest version alone, as name>=version")
        found[match["name"]] = match["version"]
    return found


def read() -> dict[str, str]:
    return bounds(tomllib.loads(FILE.read_text(encoding="utf-8"))["project"])


if __name__ == "__main__":
    print("\n".join(f"{name}=={version}" for name, version in read().items()))

"""Results of an earlier run in the output directory: none may look like one of this run."""

from __future__ import annotations

import os
import re
from collections.abc import Collection
from pathlib import Path

from abut.output.responses import FIELDS, TABLES

ASIDE = "earlier"
OPTIONAL = ("fields.frd", "modes.csv", "modes.vtu", "beams.csv", "shells.csv", FIELDS, *TABLES)
INDEX = ("summary.json", "report.html", "history.csv", "forces.csv", "run.jsonl", "fields.pvd", *OPTIONAL)
_OF_STEP = re.compile(r"(?:fields|shells|laminates|beams|contact_[A-Za-z0-9._-]+?)_(\d{4,7})(?:_\d{4,})?\.p?vtu")
_OF_ALL = re.compile(r"(?:shells|laminates|beams|contact_[A-Za-z0-9._-]+)\.(?:pvd|vtkhdf)|fields\.vtkhdf")
_TABLE = re.compile(r"probe_[A-Za-z0-9._-]+\.csv")
_HEAD = b"step,factor,converged,point"  # of a probe's table; other tables are the user's


def remove_others(folder: Path, steps: int, kept: Collection[str]) -> None:
    """Remove results of steps after number ``steps``, and of contacts and probes whose files are not ``kept``."""
    for path in _results(folder):
        found = _OF_STEP.fullmatch(path.name)
        of_fields = path.name.startswith("fields_")
        if (int(found[1]) > steps or not (of_fields or path.name in kept)) if found else path.name not in kept:
            path.unlink(missing_ok=True)


def remove_all(folder: Path) -> None:
    """Remove the results of an earlier run, those first that tell of all steps: what is left at any moment tells no lie."""
    for path in _results(folder):
        path.unlink(missing_ok=True)


def set_aside(folder: Path) -> Path | None:
    """Move the results of an earlier run to the folder ``earlier`` there, in place of those in it; None where there are
    none."""
    found = _results(folder)
    if not found:
        return None
    aside = folder / ASIDE
    aside.mkdir(exist_ok=True)
    remove_all(aside)
    for path in found:
        os.replace(path, aside / path.name)
    return aside


def _results(folder: Path) -> list[Path]:
    """Files that a run has written, but those of a restart; those that tell of all steps first."""
    first = [folder / name for name in INDEX if (folder / name).is_file()]
    rest = [path for path in sorted(folder.iterdir()) if _is_result(path)]
    return [*first, *sorted(rest, key=lambda path: path.suffix != ".pvd")]


def _is_result(path: Path) -> bool:
    if _TABLE.fullmatch(path.name):
        with open(path, "rb") as file:
            return file.read(len(_HEAD)) == _HEAD
    return any(pattern.fullmatch(path.name) for pattern in (_OF_STEP, _OF_ALL))

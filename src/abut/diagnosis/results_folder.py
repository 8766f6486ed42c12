"""Whether a run can write where a job says."""

from __future__ import annotations

from pathlib import Path

from abut.diagnosis.finding import Finding
from abut.io.atomic import in_the_way


def results_folder(results: Path) -> list[Finding]:
    """An error where a file stands in the place of the folder of results, or of one above it."""
    file = in_the_way(results)
    if file is None:
        return []
    what = f"cannot create the output directory {results}: {file} is a file"
    return [Finding("error", "output.directory", what, "choose another, or move that file away")]

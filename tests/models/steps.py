"""A job of several steps, a run of it that stops in one, and the arrays of its result files."""

from __future__ import annotations

import json
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest
from numpy.typing import NDArray

import abut
from abut.errors import Stopped
from abut.job import load_job
from abut.output.restart import description
from abut.output.stream import Stream

ROOT = Path(__file__).parents[2]
BALL = (ROOT / "examples" / "hertz-sphere" / "job.toml").read_text()
BALL = BALL.replace("cells = 16", "cells = 4").replace("hex20", "hex8")
STEPS = 5


def job(folder: Path, text: str = BALL, **solve: Any) -> Path:
    folder.mkdir(exist_ok=True)
    options = {"steps": STEPS, **solve}
    lines = [f"{key} = {json.dumps(value)}" for key, value in options.items()]
    path = folder / "job.toml"
    path.write_text(text + "\n[solve]\n" + "\n".join(lines) + "\n")
    return path


def stop_in(path: Path, number: int) -> None:
    """Run a job until the first iteration of a step, and stop there."""
    loaded = load_job(path)

    def stop(item: object) -> None:
        if getattr(item, "step", 0) == number:
            raise Stopped("now")

    with pytest.raises(Stopped), Stream(loaded.directory, description(loaded.model)) as stream:
        abut.analysis.solve(loaded.model, stop, stream.step)


def arrays(path: Path) -> Iterator[tuple[str, NDArray[Any]]]:
    from vtkmodules.util.numpy_support import vtk_to_numpy
    from vtkmodules.vtkIOXML import vtkXMLUnstructuredGridReader

    reader = vtkXMLUnstructuredGridReader()
    reader.SetFileName(str(path))
    reader.Update()
    grid = reader.GetOutput()
    assert grid.GetNumberOfCells() > 0, path
    for data in (grid.GetPointData(), grid.GetCellData()):
        for i in range(data.GetNumberOfArrays()):
            yield data.GetArrayName(i), vtk_to_numpy(data.GetArray(i))

"""Result files are compressed, either way with the same numbers, and each can be read by itself."""

from __future__ import annotations

import re
from pathlib import Path

import numpy as np
import pytest
from vtkmodules.util.numpy_support import vtk_to_numpy
from vtkmodules.vtkIOXML import vtkXMLUnstructuredGridReader

import abut
from abut.io.vtu import read_vtu
from abut.job.load import load_job
from abut.mesh import make
from abut.types import Array

WAYS = {"fast": "vtkZLibDataCompressor", "small": "vtkLZMADataCompressor"}


def arrays(path: Path) -> dict[str, Array]:
    """All that VTK's reader finds in a file."""
    reader = vtkXMLUnstructuredGridReader()
    reader.SetFileName(str(path))
    reader.Update()
    grid = reader.GetOutput()
    found = {"points": grid.GetPoints().GetData(), "cells": grid.GetCells().GetConnectivityArray()}
    for data in (grid.GetPointData(), grid.GetCellData()):
        found |= {data.GetArrayName(i): data.GetArray(i) for i in range(data.GetNumberOfArrays())}
    return {name: vtk_to_numpy(values).copy() for name, values in found.items()}


def test_small_files_hold_the_same_numbers(tmp_path: Path) -> None:
    """Bit for bit, in fewer bytes than the quickly written ones, which take fewer than the numbers themselves."""
    mesh = make.join(
        {
            "lower": make.box([0, 3], [0, 3], [0, 1], cells=(6, 6, 2), cell="hex20"),
            "upper": make.box([0, 3], [0, 3], [1, 2], cells=(8, 8, 2), cell="hex20"),
        }
    )
    solution = abut.solve(
        abut.Model(
            mesh,
            [abut.Solid(body, abut.LinearElastic(1e3, 0.3)) for body in mesh.bodies],
            [abut.Support("lower.bottom", x=0, y=0, z=0), abut.Support("upper.top", x=0.01, y=0, z=-0.1)],
            contacts=[abut.Contact("upper.bottom", "lower.top", friction=0.3, name="c")],
        )
    )
    read, sizes = {}, {}
    for way, name in WAYS.items():
        abut.write(solution, tmp_path / way, output=abut.Output(compression=way))
        for kind in ("fields", "contact_c"):
            (path,) = (tmp_path / way).glob(f"{kind}_*.vtu")
            assert f'compressor="{name}"'.encode() in path.read_bytes()[:400]
            read[way, kind], sizes[way, kind] = arrays(path), path.stat().st_size
            assert len(read_vtu(path).points) == len(read[way, kind]["points"])
    for kind in ("fields", "contact_c"):
        assert read["fast", kind].keys() == read["small", kind].keys()
        for name, values in read["fast", kind].items():
            np.testing.assert_array_equal(values, read["small", kind][name], strict=True)
        numbers = sum(values.nbytes for values in read["fast", kind].values())
        assert sizes["small", kind] < sizes["fast", kind] < 0.7 * numbers


def test_job_says_which(tmp_path: Path) -> None:
    job = Path(__file__).parents[2] / "examples" / "two-blocks" / "job.toml"
    text = re.sub(r"\[output\][^\[]*", "", job.read_text(encoding="utf-8"))
    path = tmp_path / "job.toml"
    path.write_text(text + '\n[output]\ncompression = "small"\n', encoding="utf-8")
    assert load_job(path).output.small
    path.write_text(text, encoding="utf-8")
    assert not load_job(path).output.small
    with pytest.raises(abut.InputError, match=r"output\.compression: .*'small'"):
        abut.Output(compression="smal")

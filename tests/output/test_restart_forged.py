"""Restart files that no run has written: refused by name, whatever is in them."""

from __future__ import annotations

import io
import json
import zipfile
from collections.abc import Callable, Iterator, Mapping
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import abut
from abut.output.restart import FOLDER, load_steps, save_step
from abut.solution import Iteration, Saved, State

MODEL = {"plane": "'strain'"}
ROW = Iteration(1, 1, 2, 0, 1e-9, 1e-9, 0.0, 0.1)
NPY = "{{'descr': '{}', 'fortran_order': False, 'shape': {}, }}\n"

HEADS: dict[str, Any] = {
    "number": 7, "number as text": {"number": "1"}, "linear": {"linear": 3}, "no iterations": {"iterations": []},
    "iteration": {"iterations": [{"step": 1}]}, "residual": {"iterations": [{**vars(ROW), "residual": "y"}]},
    "parts": {"parts": 3}, "part": {"parts": [1]}, "model": {"model": ["plane"]}, "no model": {"model": None},
    "version": {"abut": 3}, "schema": {"schema": 99}, "list": [], "nothing": None,
    "schema as text": {"schema": "3"}, "deep": "[" * 100_000,
}  # fmt: skip
ARRAYS: dict[str, dict[str, Any]] = {
    "no numbers": {"unknowns": np.array([0.1, np.nan])}, "complex": {"unknowns": np.array([1j, 0.0])},
    "status": {"status": np.array([99, 0], dtype=np.int8)}, "shorter status": {"status": np.zeros(1, dtype=np.int8)},
    "time": {"time": np.array(5.0)}, "no time": {"time": np.array(np.nan)}, "inside": {"inside": np.zeros(2)},
    "longer inside": {"inside": np.zeros(3, dtype=bool)},
    "inside of two dimensions": {"inside": np.zeros((2, 1), dtype=bool)},
    "head": {"head": np.zeros(3)},
}  # fmt: skip
NPYS = {
    "more than memory": NPY.format("<f8", (10**13,)),
    "more bits": NPY.format("<f8", (2**70,)),
    "negative": NPY.format("<f8", (-1,)),
    "objects": NPY.format("|O", (1,)),
    "unended": "{'descr': 3\n",
    "nested": "(" * 9000 + "\n",
    "records": NPY.format([("a", "<f8")], (2,)),
}


@pytest.fixture
def file(tmp_path: Path) -> Path:
    state = State(0.5, np.array([0.1, 0.2]), np.array([1.0, 2.0]), np.array([0, 1], dtype=np.int8))
    save_step(tmp_path, MODEL, Saved(1, state, np.zeros(2, dtype=bool), "direct", (ROW,)))
    (saved,) = load_steps(tmp_path, MODEL)
    assert (saved.number, saved.state.time) == (1, 0.5)
    return tmp_path / FOLDER / "0001.npz"


def refused(file: Path) -> None:
    with pytest.raises(abut.InputError, match=r"0001.npz: not a whole restart file; remove it"):
        load_steps(file.parents[1], MODEL)


def rewrite(file: Path, arrays: Mapping[str, Any]) -> None:
    with np.load(file) as data:
        whole = {name: data[name] for name in data.files} | dict(arrays)
    with open(file, "wb") as out:
        np.savez(out, **whole)


@pytest.mark.parametrize("case", HEADS)
def test_heads(case: str, file: Path) -> None:
    with np.load(file) as data:
        head = json.loads(str(data["head"]))
    change = {"number": HEADS[case]} if isinstance(HEADS[case], int) else HEADS[case]
    text = change if isinstance(change, str) else json.dumps({**head, **change} if isinstance(change, dict) else change)
    rewrite(file, {"head": np.array(text)})
    refused(file)


@pytest.mark.parametrize("case", ARRAYS)
def test_arrays(case: str, file: Path) -> None:
    rewrite(file, ARRAYS[case])
    refused(file)


@pytest.mark.parametrize("case", NPYS)
def test_heads_of_arrays(case: str, file: Path) -> None:
    text = NPYS[case].encode()
    forged = b"\x93NUMPY\x01\x00" + len(text).to_bytes(2, "little") + text + bytes(64)
    with zipfile.ZipFile(io.BytesIO(file.read_bytes())) as before, zipfile.ZipFile(file, "w") as after:
        for name in before.namelist():
            after.writestr(name, forged if name == "unknowns.npy" else before.read(name))
    refused(file)


def headers(data: bytearray) -> Iterator[int]:
    """Where the flags of each file in an archive are: those beside its data and in the list at the end."""
    for mark, offset in ((b"PK\x03\x04", 6), (b"PK\x01\x02", 8)):
        at = data.find(mark)
        while at >= 0:
            yield at + offset
            at = data.find(mark, at + 4)


def encrypted(data: bytearray, at: int) -> None:
    data[at] |= 1


def patched(data: bytearray, at: int) -> None:
    data[at] |= 0x20


def unknown(data: bytearray, at: int) -> None:
    data[at + 2] = 99


@pytest.mark.parametrize("change", [encrypted, patched, unknown])
def test_archives(change: Callable[[bytearray, int], None], file: Path) -> None:
    data = bytearray(file.read_bytes())
    for at in headers(data):
        change(data, at)
    file.write_bytes(bytes(data))
    refused(file)

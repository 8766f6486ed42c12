"""Meshes made in Python: arrays of any type and memory layout that hold the right numbers, and no others."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np
import pytest

import abut
from abut.mesh.cell_block import CellBlock

POINTS = np.array([[0, 0, 0], [2, 0, 0], [2, 1, 0], [0, 1, 0], [0, 0, 1], [2, 0, 1], [2, 1, 1], [0, 1, 1]], dtype=float)
NODES = np.arange(8, dtype=np.int32)[None]
BOTTOM, TOP, CELL = np.array([[0, 0]]), np.array([[0, 1]]), np.array([0])


def stretched(points: Any = POINTS, nodes: Any = NODES, body: Any = CELL, surface: Any = TOP) -> float:
    """The largest displacement of a block that stands on a surface and is pulled at another."""
    mesh = abut.Mesh(points, [CellBlock("hex8", nodes)], {"block": body}, {"top": surface, "bottom": BOTTOM})  # type: ignore[arg-type]
    model = abut.Model(
        mesh,
        solids=[abut.Solid("block", abut.LinearElastic(100.0, 0.3))],
        supports=[abut.Support("bottom", x=0, y=0, z=0)],
        loads=[abut.Traction("top", (0.0, 0.0, 1.0))],
    )
    return float(np.abs(abut.solve(model).steps[-1].displacement).max())


@pytest.mark.parametrize(
    "points",
    [np.asfortranarray(POINTS), np.repeat(POINTS, 2, axis=1)[:, ::2], POINTS[::-1].copy()[::-1], POINTS.astype(np.float32),
     POINTS.astype(int), POINTS.tolist(), POINTS.astype(">f8")],
)  # fmt: skip
def test_points(points: Any) -> None:
    assert stretched(points) == stretched()


@pytest.mark.parametrize(
    "make", [np.asfortranarray, np.ndarray.tolist, lambda a: a.astype(">i8"), lambda a: a.astype(np.uint64)]
)
def test_numbers_of_points_cells_and_facets(make: Callable[[Any], Any]) -> None:
    assert stretched(nodes=make(NODES), body=make(CELL), surface=make(TOP)) == stretched()


BAD = {
    "points: expected an array of numbers": {"points": POINTS.astype(str)},
    "points: expected shape": {"points": POINTS.ravel()},
    "expected 2 or 3 coordinates": {"points": np.repeat(POINTS, 2, axis=1)},
    "coordinates that are not numbers": {"points": np.where(POINTS == 2, np.nan, POINTS)},
    "points that do not exist": {"nodes": NODES + 1},
    "need 8 nodes": {"nodes": NODES[:, :4]},
    "nodes: expected an array of whole numbers of int32": {"nodes": NODES.astype(np.int64) + 2**32},
    "whole numbers of int32": {"nodes": NODES.astype(object) + 2**64},
    "expected an array of whole numbers": {"nodes": NODES + 0.5},
    "'block': expected an array of whole numbers of int64": {"body": [2**64]},
    "'block': expected an array": {"body": np.array([True])},
    "surfaces: 'top': expected shape": {"surface": TOP[0]},
}


@pytest.mark.parametrize("message", BAD)
def test_what_is_no_mesh(message: str) -> None:
    with pytest.raises(abut.InputError, match=message):
        stretched(**BAD[message])  # type: ignore[arg-type]


def test_right_arrays_are_not_copied() -> None:
    mesh = abut.Mesh(POINTS, (CellBlock("hex8", NODES),), {"block": np.zeros(1, dtype=np.int64)})
    assert mesh.points is POINTS
    assert mesh.blocks[0].nodes is NODES

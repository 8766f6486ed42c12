"""Bodies that pass through each other without a contact are named."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

import abut
from abut.diagnosis.cures import cure
from abut.mesh.make import box, join, rectangle
from abut.mesh.passing import passing
from models.certificate import fit, line, octant, tubes
from models.certificate_odd import moved

CELLS = ["tri3", "quad8", "hex8", "tet4", "tet10"]


def line_of(solution: abut.Solution) -> abut.solution.Check | None:
    return next((check for check in solution.certificate if check.name == "bodies apart"), None)


def stack(cell: str, gap: float) -> abut.Mesh:
    """Two blocks of facets of size 1/3 and 1/2 above each other."""
    if cell.startswith(("tri", "quad")):
        return join(
            {"a": rectangle((0, 1), (0, 1), (3, 3), cell), "b": rectangle((0.2, 0.8), (1 + gap, 2), (2, 2), cell)}
        )
    return join(
        {
            "a": box((0, 1), (0, 1), (0, 1), (3, 3, 3), cell),
            "b": box((0.2, 0.8), (0.2, 0.8), (1 + gap, 2), (2, 2, 2), cell),
        }
    )


@pytest.mark.parametrize("cell", CELLS)
def test_depth_and_names(cell: str) -> None:
    """A block whose bottom lies 0.1 in another one: depth 0.1, over facets of 1/3; one that stands off, or flush, is
    none."""
    mesh = stack(cell, -0.1)
    (one,) = passing(mesh, mesh.points, [])
    assert set(one.bodies) == {"a", "b"}
    assert one.depth == pytest.approx(0.1, rel=1e-9)
    assert 0.29 < one.share < 0.7  # over facets of 1/3 or 0.3, or pieces half as long
    for gap in (0.0, 0.05, -0.01):
        assert passing(stack(cell, gap), stack(cell, gap).points, []) == ()
    rows = [(mesh.surfaces["a.top"], mesh.surfaces["b.bottom"])]
    assert passing(mesh, mesh.points, rows) == passing(mesh, mesh.points, [rows[0][::-1]]) == ()


def test_bodies_without_a_pair() -> None:
    """The upper block passes the lower one's top by 0.3: said with names and depth, and what to do; not where they are a
    pair."""
    built = replace(moved(0.31), contacts=[])
    solution = abut.solve(built)
    check = line_of(solution)
    assert check is not None
    assert check.verdict == "warn"
    assert "'upper'" in check.meaning
    assert "'lower'" in check.meaning
    assert "0.3" in check.meaning
    assert "contact for each" in cure(check, solution)
    assert line_of(abut.solve(moved(0.31))) is None


def test_bodies_that_overlap_in_the_mesh() -> None:
    mesh = stack("quad8", -0.1)
    solution = abut.solve(
        abut.Model(
            mesh,
            [abut.Solid(body, abut.LinearElastic(1000.0, 0.3)) for body in mesh.bodies],
            [abut.Support("a.bottom", x=0, y=0), abut.Support("b.top", x=0, y=-0.01)],
            plane="strain",
        )
    )
    check = line_of(solution)
    assert check is not None
    assert "as in the mesh" in check.meaning


@pytest.mark.parametrize("model", [lambda: fit((8, 12), "quad4"), lambda: line("quad8", (8, 6)), lambda: octant("tet4", 4),
                                   lambda: tubes((12, 16))])  # fmt: skip
def test_contacts_are_no_such_thing(model) -> None:
    assert line_of(abut.solve(model())) is None


def test_it_is_symmetric_in_large_bodies() -> None:
    """A small body wholly inside another is found by its points; beside it nothing is."""
    mesh = join(
        {"big": box((0, 4), (0, 4), (0, 4), (4, 4, 4), "hex8"), "pin": box((1.2, 1.8), (1.2, 1.8), (3.5, 5), (1, 1, 2))}
    )
    (one,) = passing(mesh, mesh.points, [])
    assert one.bodies == ("pin", "big")
    assert one.depth == pytest.approx(0.5)
    apart = mesh.points + np.where(np.isin(np.arange(len(mesh.points)), mesh.nodes_of("pin")), 1.0, 0.0)[:, None] * [
        0,
        0,
        2,
    ]
    assert passing(mesh, apart, []) == ()

"""A clevis: three bodies, two of them held by contact alone, and nothing touches before they move (``bench/clevis.py``)."""

from __future__ import annotations

import functools
import sys
from pathlib import Path

import pytest

import abut

pytest.importorskip("gmsh", exc_type=ImportError)  # a wheel without its libraries is no gmsh either
sys.path.insert(0, str(Path(__file__).parents[2] / "bench"))

import clevis

# linear solutions, up to five of them where contact is closed alone at an edge: with other functions and back, theory (P26)
MOST = 25
mesh = functools.cache(clevis.mesh)


@pytest.mark.long
@pytest.mark.parametrize("force", [100.0, 1000.0, 10000.0])
@pytest.mark.parametrize("size", [3.8, 3.0])
def test_a_clevis_converges(size: float, force: float) -> None:
    """It once cycled, or was said to be pulled off its contact. By statics both contacts carry the whole force, a quarter of
    it in the model; the normals of a loose pin spread it a little to the sides, along x nothing is lost."""
    solution = abut.solve(clevis.clevis(mesh(size), force))
    assert solution.converged
    assert len(solution.steps[0].iterations) <= MOST
    eye, fork = solution.contacts
    assert eye.force[0] == pytest.approx(-0.25 * force, rel=1e-8)
    assert fork.force[0] == pytest.approx(0.25 * force, rel=1e-8)


@pytest.mark.long
@pytest.mark.parametrize("linear", ["direct", "amg"])
def test_the_constraint_function_on_a_clevis(linear: str) -> None:
    solution = abut.solve(clevis.clevis(mesh(3.0), 1000.0, "constraint-function", linear=linear))
    assert solution.converged
    assert not any("going on with the direct solver" in note for note in solution.notes)
    assert solution.contacts[0].force[0] == pytest.approx(-250.0, rel=1e-6)

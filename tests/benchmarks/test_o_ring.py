"""An O-ring of rubber that keeps its volume, squeezed with friction and pushed by a fluid: forces exact, cells alike."""

from __future__ import annotations

import numpy as np
import pytest

import abut
from models.o_ring import BODIES, FLUID, o_ring, wet_ends

pytestmark = pytest.mark.exhaustive


def check_reaction_to_the_fluid(solution: abut.Solution) -> None:
    """Pressure on a side pushes as on the chord between its ends, wherever these have gone, and the three bodies around push
    back by as much."""
    assert solution.converged
    low, high = wet_ends(solution)
    along = high - low
    pushed = FLUID * np.array([along[1], -along[0]])
    last = solution.steps[-1]
    assert np.allclose(last.load, pushed, rtol=0.0, atol=1e-9 * np.linalg.norm(pushed))
    met = sum(np.asarray(contact.force) for contact in last.contacts)
    assert np.allclose(met, -pushed, rtol=0.0, atol=1e-8 * np.linalg.norm(pushed))


def test_squeezed_and_pushed() -> None:
    """Reactions to the fluid; and of two kinds of cells the force that squeezes it, and what floor, wall and cover carry
    under the fluid, within two percent."""
    one, other = (abut.solve(o_ring(8, cell)) for cell in ("quad4", "tri6"))
    check_reaction_to_the_fluid(one)
    check_reaction_to_the_fluid(other)
    (first, second) = (next(s for s in x.steps if abs(s.factor - 0.5) < 1e-9) for x in (one, other))
    assert second.contacts[0].force[1] == pytest.approx(first.contacts[0].force[1], rel=0.02)
    size = np.linalg.norm(one.steps[-1].load)
    for i, _ in enumerate(BODIES):
        a, b = (np.asarray(x.steps[-1].contacts[i].force) for x in (one, other))
        assert np.abs(a - b).max() < 0.02 * max(size, np.abs(a).max())

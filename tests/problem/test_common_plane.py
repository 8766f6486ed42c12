"""Contact of two equal round bodies, which symmetry tells about, without friction."""

from __future__ import annotations

import numpy as np
import pytest

import abut
from abut.mesh import make


@pytest.mark.parametrize("cell", ["quad4", "quad8"])
def test_equal_discs_without_friction(cell: str) -> None:
    """Two equal discs of radius 50, meshed alike but for the turn, pressed together by 4: the plane between them stays where
    it is and nodes of both sides move alike, to 0.0031 and 0.0006 with facets 2.7 wide (0.021 and 0.1 along
    the contactor's normals); and friction that vanishes is none, to its own size and the order of the facets."""
    solutions = []
    for friction in (0.0, 1e-6):
        upper, lower = (
            make.half_disc(50.0, (0, y), fine=16.0, cells=12, cell=cell, flat=flat)
            for y, flat in ((50.0, "top"), (-50.0, "bottom"))
        )
        steel = abut.LinearElastic(20000.0, 0.3)
        model = abut.Model(
            make.join({"up": upper, "lo": lower}), [abut.Solid("up", steel), abut.Solid("lo", steel)],
            [
                abut.Support("up.axis", x=0), abut.Support("lo.axis", x=0),
                abut.Support("up.flat", y=-2.0), abut.Support("lo.flat", y=2.0),
            ],
            contacts=[abut.Contact(contactor="up.round", target="lo.round", friction=friction)], plane="strain",
        )  # fmt: skip
        solutions.append(abut.solve(model))
        assert solutions[-1].converged
        points, moved = model.mesh.points, solutions[-1].steps[-1].displacement
        middle = np.flatnonzero(np.abs(points).max(axis=1) < 1e-9)
        assert len(middle) == 2
        assert np.abs(moved[middle, 1]).max() < 0.004
        sides = []
        for name in ("up.round", "lo.round"):
            nodes = model.mesh.nodes_of(name)
            near = nodes[(np.abs(points[nodes, 1]) < 0.2) & (np.abs(points[nodes, 0] - 4.0) < 0.01)]
            sides.append(float(moved[near[0], 0]))
        assert sides[0] == pytest.approx(sides[1], abs=1e-3)
    forces = [solution.steps[-1].contacts[0].force[1] for solution in solutions]
    assert forces[0] == pytest.approx(forces[1], rel=1e-5)

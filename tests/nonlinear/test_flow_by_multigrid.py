"""Metal that flows in contact, by multigrid: each linearised problem is solved as well as Newton's method has a use for."""

from __future__ import annotations

from dataclasses import replace

import pytest

import abut
from abut.mesh import make


def _dented() -> abut.Model:
    """A quarter of a ball of steel in a block that yields, hex8."""
    ball = make.sphere_octant(8.0, (0.0, 0.0, 8.0), fine=1.1, cells=4, growth=1.3, cell="hex8")
    fine = {"x": [0.0, 1.1], "y": [0.0, 1.1], "z": [-1.1, 0.0]}
    block = make.box((0.0, 8.0), (0.0, 8.0), (-8.0, 0.0), (4, 4, 4), "hex8", fine, growth=1.3)
    steel = abut.LinearElastic(210e3, 0.3)
    return abut.Model(
        make.join({"block": block, "ball": ball}),
        [abut.Solid("block", abut.Plastic(210e3, 0.3, 300.0, 2000.0)), abut.Solid("ball", steel)],
        [
            abut.Support("block.bottom", x=0, y=0, z=0),
            abut.Support("block.left", x=0),
            abut.Support("block.front", y=0),
            abut.Support("ball.x0", x=0),
            abut.Support("ball.y0", y=0),
            abut.Support("ball.z0", x=0, y=0, z=-0.12),
        ],
        contacts=[abut.Contact(contactor="ball.round", target="block.top")],
        solve=abut.SolveOptions(steps=3),
    )


@pytest.mark.long
def test_flow_by_multigrid() -> None:
    """The state is that of a direct solver, and iterations are not many more: solutions of linearised problems to rounding,
    with the tangent of a state that is still far off, took twice as many."""
    model = _dented()
    direct, multigrid = (
        abut.solve(replace(model, solve=replace(model.solve, linear=linear))) for linear in ("direct", "amg")
    )
    assert multigrid.converged
    assert multigrid.contacts[0].force == pytest.approx(direct.contacts[0].force, rel=1e-7)
    assert multigrid.displacement == pytest.approx(direct.displacement, abs=1e-7 * 0.12)
    counts = [sum(len(step.iterations) for step in solution.steps) for solution in (direct, multigrid)]
    assert counts[1] <= 1.6 * counts[0], counts

"""What only comes closer does not slip: direction of approach, and jumps of surfaces that approach straight."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

import abut
from abut.mesh import make
from abut.problem.approach import approach_slip
from abut.problem.constraints import supports
from abut.problem.contact_pairs import pairs
from abut.problem.pair import Pair

CELLS = 30


def facing(upper: object, lower: object, steps: int = 1, friction: float = 0.2) -> abut.Model:
    """Two blocks with the contour y = upper(x) of the upper one's bottom, the contactor, and y = lower(x) of the other."""
    parts = {}
    for name, y, contour in (("lower", (-2.0, 0.0), lower), ("upper", (0.0, 2.0), upper)):
        mesh = make.rectangle((-4.0, 4.0), y, (CELLS, 4), "quad4")
        x, z = mesh.points.T
        parts[name] = replace(mesh, points=np.column_stack([x, z + contour(x) * (1.0 - np.abs(z) / 2.0)]))
    return abut.Model(
        make.join(parts),
        [abut.Solid(name, abut.LinearElastic(200.0, 0.3)) for name in parts],
        [abut.Support("lower.bottom", x=0, y=0), abut.Support("upper.top", x=0, y=-0.2)],
        contacts=[abut.Contact(contactor="upper.bottom", target="lower.top", friction=friction)],
        plane="strain",
        solve=abut.SolveOptions(steps=steps),
    )


def pair_of(model: abut.Model) -> tuple[Pair, np.ndarray]:
    """The pair, and where its functions sit."""
    own = pairs(model, supports(model))[0]
    return own, own.contactor.points[own.space.node]


def approached(own: Pair) -> np.ndarray:
    """Of open surfaces, as a length."""
    nothing = np.zeros(len(own))
    return approach_slip(own, own.gap, nothing, nothing > 0.0) / own.weight[own.tangential]


def test_a_body_that_comes_straight_down_does_not_slip() -> None:
    """Moved down until it closes, each node moves sideways along its own tangent by what is left out. Within a facet the
    surface turns by 0.07: the means of products differ from products of means by the square of that."""
    model = facing(lambda x: x**2 / 8.0, lambda x: 0.0 * x)
    own, at = pair_of(model)
    down = np.zeros_like(model.mesh.points)
    down[model.mesh.nodes_of("upper"), 1] = -1.0
    moved = own.rows @ down.ravel() / own.weight
    inner = np.abs(at[:, 0]) < 2.0  # up to slopes of one half, of which the normals take one half
    way = (own.gap / own.weight)[own.normal] / -moved[own.normal]
    sideways = (way * moved[own.tangential])[inner]
    assert np.abs(sideways).max() > 0.05
    assert approached(own)[inner] == pytest.approx(sideways, abs=0.01 * np.abs(sideways).max())


def test_each_place_has_its_own_direction() -> None:
    """Two bumps over a roof: at either the closest point is where the bump stands square on the roof, and what lies beside
    it closes along the roof's normal there; one direction for both would be upright."""
    model = facing(lambda x: -0.2 * np.abs(x) + (np.abs(x) - 2.0) ** 2 / 8.0, lambda x: -0.2 * np.abs(x))
    own, at = pair_of(model)
    slope = 0.2 * np.sign(at[:, 0])
    square = np.column_stack([slope, np.ones_like(slope)]) / np.hypot(1.0, 0.2)
    beside = np.abs(np.abs(at[:, 0]) - 2.0) < 1.0
    assert own.slip is not None
    lean = np.einsum("kd,kd->k", own.slip.tangents[:, 0], square) / np.einsum("kd,kd->k", own.slip.normals, square)
    gap = (own.gap / own.weight)[own.normal]
    assert np.abs(lean[beside]).max() > 0.1
    wrong = np.abs(approached(own) + gap * lean)[beside]
    assert wrong.max() < 0.1 * np.abs(gap * lean)[beside].max()  # the closest node is up to half a facet off


def test_flat_surfaces_have_none() -> None:
    own, _ = pair_of(facing(lambda x: 0.1 + 0.0 * x, lambda x: 0.0 * x))
    assert (approached(own) == 0.0).all()


def test_energy_is_balanced_where_surfaces_lean() -> None:
    """Tractions of what closes work on the approach, too."""
    solution = abut.solve(facing(lambda x: x**2 / 8.0, lambda x: 0.0 * x, steps=2))
    assert solution.converged
    assert all(check.passed for check in solution.certificate if check.name not in ("strain", "resolution"))

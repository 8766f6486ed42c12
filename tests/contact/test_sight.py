"""How far a contactor sees: not through a body that it has come into by another side, nor beyond where its normals meet."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

import abut
from abut.contact.coupling import CouplingOptions, IntegrationPoints, couple, surface_degree
from abut.contact.geometry import full_moments
from abut.contact.sides import moving_sides
from abut.mesh import make
from models.clamps import wrung
from models.sharp_edges import over_edge

DIP = 0.003  # by which the block's lower edge lies in the ground


def seen(mesh: abut.Mesh, contactor: str, target: str, reach: float) -> IntegrationPoints:
    sides = moving_sides(mesh, contactor, target)
    found = couple(*sides, surface_degree(sides[0]), CouplingOptions(reach=reach, keep_points=True)).points
    assert found is not None
    return found


@pytest.mark.parametrize("cell", ["tri3", "quad4", "quad8", "tet4", "hex8", "hex20"])
def test_a_side_that_dips_in_does_not_see_the_far_side(cell: str) -> None:
    """A block's lower edge lies a little in the ground, whose far side is half a block away. The block's side would see that
    one through the ground, a hundred times as deep: it came in from above, and is seen there by the block's bottom alone."""
    solid = cell in ("tet4", "hex8", "hex20")
    span, depth = [0.9, 1.7], [[0, 0.4]] if solid else []
    ground = (make.box if solid else make.rectangle)([0, 1.5], *depth, [0, 0.6], (8, *[3] * solid, 3), cell)
    block = (make.box if solid else make.rectangle)(span, *depth, [0.6 - DIP, 1.0], (4, *[2] * solid, 3), cell)
    points = seen(make.join({"ground": ground, "block": block}), "block", "ground", 0.7)
    assert len(points.gap)
    assert points.gap.min() == pytest.approx(-DIP, rel=1e-6)


@pytest.mark.parametrize("cell", ["quad4", "quad8", "hex8", "tet10"])
def test_what_is_beside_a_body_does_not_see_its_far_side(cell: str) -> None:
    """A block with leaning sides, a little above the ground: lines of sight from its side go down through the ground's top
    and leave by its end, half a block away. Only its bottom sees the ground, as far away as it is."""
    solid = cell in ("tet10", "hex8")
    span, depth = [1.0, 1.8], [[0, 0.4]] if solid else []
    ground = (make.box if solid else make.rectangle)([0, 1.5], *depth, [0, 0.6], (8, *[3] * solid, 3), cell)
    block = (make.box if solid else make.rectangle)(span, *depth, [0.6 + DIP, 1.0], (4, *[2] * solid, 3), cell)
    leaning = block.points + 0.05 * (block.points[:, -1:] - 0.6 - DIP) * np.eye(block.points.shape[1])[0]
    mesh = make.join({"ground": ground, "block": replace(block, points=leaning)})
    points = seen(mesh, "block", "ground", 0.7)
    assert points.gap.min() == pytest.approx(DIP, rel=1e-6)


@pytest.mark.parametrize("angle", [4.0, 9.0, 15.0])
@pytest.mark.parametrize("cell", ["quad4", "quad8", "hex8", "tet10"])
def test_walls_of_what_stands_on_an_edge_are_beside_it(cell: str, angle: float) -> None:
    """A block on its lower edge, tilted. Under its wall, which is as steep as 90 degrees less the tilt, the plate sees
    nothing: the gap there would grow six times as fast as the way along the plate, and the edge would have to lie deep in
    the plate for the mean over a function to close. With the whole block as target all is as with its bottom."""
    solid = cell in ("tet10", "hex8")
    depth = [[0, 0.4]] if solid else []
    plate = (make.box if solid else make.rectangle)([0, 2.0], *depth, [0, 0.3], (5, *[2] * solid, 2), cell)
    block = (make.box if solid else make.rectangle)([0, 0.8], *depth, [0, 0.6], (4, *[2] * solid, 3), cell)
    points, turn = block.points.copy(), np.deg2rad(angle)
    along, up = block.points[:, 0] - 0.8, block.points[:, -1]
    points[:, 0] = 1.33 + np.cos(turn) * along + np.sin(turn) * up
    points[:, -1] = 0.3 - np.sin(turn) * along + np.cos(turn) * up
    mesh = make.join({"plate": plate, "block": replace(block, points=points)})
    top = "plate.top"
    whole, bottom = (seen(mesh, top, name, 0.7) for name in ("block", "block.bottom"))
    assert whole.gap.max() < 0.8 * np.sin(turn) / np.cos(turn) + 1e-9
    assert whole.gap == pytest.approx(bottom.gap, abs=1e-12)


@pytest.mark.parametrize("cell", ["quad4", "quad8"])
def test_a_knife_sees_a_whole_plate_as_it_sees_its_top(cell: str) -> None:
    """Both faces of a blade see the plate under 78 degrees, and the plate's ends, far away, face them much more: no wall is
    beside an edge that presses."""
    plate = make.rectangle([0, 2.0], [0, 0.3], (9, 2), cell)
    blade = make.rectangle([-1, 1], [0.0, 1.0], (2, 4), cell)
    points = blade.points * [0.01, 1.0] + blade.points[:, 1:] * blade.points[:, :1] * [0.21, 0.0] + [1.03, 0.299]
    mesh = make.join({"plate": plate, "blade": replace(blade, points=points)})
    whole, top = (seen(mesh, "blade", name, 0.7) for name in ("plate", "plate.top"))
    assert len(top.gap) > 12
    assert whole.gap == pytest.approx(top.gap, abs=1e-12)


@pytest.mark.parametrize("depth", [0.02, 0.1, 0.2])
def test_what_is_deep_in_another_counts(depth: float) -> None:
    """A block far in a wider one, from above: its bottom is as deep as it is, to its edges, however deep."""
    ground = make.rectangle([0, 2.0], [0, 0.6], (8, 3))
    block = make.rectangle([0.6, 1.4], [0.6 - depth, 1.0], (4, 3))
    mesh = make.join({"ground": ground, "block": block})
    points = seen(mesh, "block.bottom", "ground", 0.7)
    assert points.gap == pytest.approx(np.full(len(points.gap), -depth))
    assert points.weight.sum() == pytest.approx(0.8)


def test_hollow_facets_see_nothing_upside_down() -> None:
    """The bend between two jaws is hollow, with a radius of 0.25; the jaws beyond are seen across the middle of it, where
    its normals cross. No segment has a negative area, but for a hundredth of the largest, of pieces that reach a little
    beyond there (a quarter when all counted)."""
    model = wrung("tet10")
    pair = moving_sides(model.mesh, "body", "body")
    points = seen(model.mesh, "body", "body", 1.0)
    area = np.zeros((len(pair[0]), len(pair[1])))
    np.add.at(area, (points.facet, points.target_facet), points.weight)
    assert area.min() > -0.01 * area.max()
    covered = area.sum(axis=1) / full_moments(pair[0], 0)[:, 0]  # -0.11 to 1.001 when all counted
    assert covered.min() > -1e-4
    assert covered.max() < 1.0 + 1e-4


@pytest.mark.long
@pytest.mark.parametrize(("cell", "friction", "most"), [("tri3", 0.3, 75), ("quad8", 0.0, 50)])
def test_a_whole_body_slides_over_a_sharp_edge(cell: str, friction: float, most: int) -> None:
    """Named whole as by the faces that touch: until they could see through each other these runs ended at 0.70 and 0.69,
    after 675 and 284 iterations. With friction a third of them follow the onset of slip. In the end the block is off the
    edge, and nothing presses."""
    counts: list[object] = []

    def observe(what: object) -> None:
        if isinstance(what, abut.solution.Iteration):
            counts.append(what)

    solution = abut.solve(over_edge(cell, "block", "ground", friction), observer=observe)
    assert solution.converged
    assert len(counts) <= most
    assert np.abs(solution.contacts[0].force).max() == 0.0

"""Averages on planes of symmetry: where they are found, what stays, and what becomes of linear and even fields."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace

import numpy as np
import pytest
from numpy.typing import NDArray

import abut
from abut.contact.nodal_recovery import averages
from abut.contact.symmetry_planes import evened
from abut.mesh.make import box, join, rectangle
from abut.problem.constraints import supports
from abut.problem.contact_pairs import pair
from abut.problem.pair import Pair
from models.pressure import bent, quarter_ball
from models.surfaces import turned

Array = NDArray[np.float64]


def blocks(cell: str, size: float = 1.0, turn: Array | None = None, **held: dict[str, object]) -> abut.Model:
    """A block, 1 x 1 x 1, under one of its own size or larger (``size``); planes of symmetry at x = 0 and y = 0 by default.

    turn: (3, 3) turns all of it; held: further arguments of the supports on sides of the lower block."""
    target = box((1.0 - size, 1.0), (1.0 - size, 1.0), (1.0, 2.0), (3, 3, 2), cell)
    mesh = join({"a": box((0, 1), (0, 1), (0, 1), (4, 4, 2), cell), "b": target})
    mesh = mesh if turn is None else replace(mesh, points=mesh.points @ turn.T)
    sides: dict[str, dict[str, object]] = {"a.left": {"normal": 0.0}, "a.front": {"normal": 0.0}, **held}
    free = ("b.left", "b.front") if size == 1.0 else ()
    steel = abut.LinearElastic(1000.0, 0.3)
    return abut.Model(
        mesh,
        [abut.Solid(body, steel) for body in mesh.bodies],
        [
            abut.Support("a.bottom", normal=0.0),
            abut.Support("b.top", normal=-0.01),
            *(abut.Support(on, normal=0.0) for on in free),
            *(abut.Support(on, **how) for on, how in sides.items()),
        ],
        contacts=[abut.Contact(contactor="a.top", target="b.bottom")],
    )


def built(model: abut.Model) -> Pair:
    return pair(model, model.contacts[0], supports(model))


def counts(own: Pair) -> tuple[int, int]:
    """Corners of the contactor's facets on one plane and on two."""
    assert own.planes is not None
    corners = np.unique(averages(own.contactor, own.coupling).corners[own.contactor.kinds >= 0][:, :3])
    found = own.planes.count[corners[corners >= 0]]
    return int((found == 1).sum()), int((found == 2).sum())


def test_found_where_supports_hold_what_is_square_to_the_rim() -> None:
    """Four facets a side: eight points on one plane, the corner on both; turned in space alike. Not where the normal is held
    as well, nor where the target goes on beyond the rim."""
    turn = turned(3, np.random.default_rng(1))
    assert counts(built(blocks("tet4"))) == (8, 1)
    assert counts(built(blocks("tet10", turn=turn))) == (8, 1)
    assert counts(built(blocks("tet10", **{"a.front": {"x": 0.0, "y": 0.0, "z": 0.0}}))) == (4, 0)
    assert counts(built(blocks("tet10", size=1.5))) == (0, 0)
    assert counts(built(blocks("tet10", **{"a.right": {"normal": 0.0}, "a.back": {"normal": 0.0}}))) == (12, 4)


def mended(own: Pair, field: Callable[[Array], Array]) -> tuple[Array, Array, Array]:
    """Points of the contactor's corners, averages of a field that is linear on each facet, and the same mended."""
    assert own.planes is not None
    at = averages(own.contactor, own.coupling)
    values = np.zeros((len(own.contactor), 9))
    used = at.corners >= 0
    values[used] = field(own.contactor.points)[at.corners[used]]
    average = at.of(values.ravel())
    result = evened(own.contactor, at, average, own.planes)
    assert result @ at.weight == pytest.approx(average @ at.weight, rel=1e-13)
    corners = np.unique(at.corners[used])
    return own.contactor.points[corners], average[corners], result[corners]


@pytest.mark.parametrize("cell", ["tet10", "wedge15", "tet4", "wedge6"])
def test_linear_along_a_plane(cell: str) -> None:
    """Evenly spaced, even in y: averages on the plane are those of points h / 6 beside their nodes. On facets of second
    order that is put right, on those of first order two thirds of it."""
    own = built(blocks(cell, **{"a.left": {"y": 0.0}}))
    x, average, result = mended(own, lambda x: 1.0 + x[:, 0])
    row = (x[:, 1] < 1e-9) & (x[:, 0] > 0.1) & (x[:, 0] < 0.7)
    error, before = (np.abs(v - 1.0 - x[:, 0])[row] for v in (result, average))
    assert before == pytest.approx(0.25 / 6.0, rel=1e-9)
    assert error == pytest.approx(0.0 if cell in ("tet10", "wedge15") else 0.25 / 18.0, rel=1e-9, abs=1e-12)
    assert result[x[:, 1] > 0.3] == pytest.approx(average[x[:, 1] > 0.3], abs=1e-14)


@pytest.mark.parametrize("cell", ["tet4", "wedge6"])
def test_what_nodes_on_the_plane_take_too_much_is_shared_across_it(cell: str) -> None:
    """First order: two thirds of what averages on the plane exceed those beside it, so that they are the same but for what
    these, of twice the area, get from both sides."""
    own = built(blocks(cell, **{"a.left": {"y": 0.0}}))
    x, average, result = mended(own, lambda x: 1.0 + 0.1 * (x[:, 1] < 1e-9))
    on, next_to = ((np.abs(x[:, 1] - y) < 1e-9) & (x[:, 0] > 0.3) & (x[:, 0] < 0.7) for y in (0.0, 0.25))
    excess = float((average[on] - average[next_to]).max())
    assert excess > 0.01
    assert result[on] == pytest.approx(average[on] - 2.0 / 3.0 * excess, rel=1e-12)
    # One of the two that give to it has the end of the row for a neighbour, which tells a slope along it.
    assert result[next_to] == pytest.approx(average[next_to] + excess / 3.0, abs=0.02 * excess)


@pytest.mark.parametrize("cell", ["hex8", "hex20", "tet4", "tet10", "wedge6", "wedge15"])
def test_nothing_is_lost_and_nothing_negative(cell: str) -> None:
    """Any non-negative field, half of it zero; quadrilaterals, which lie even about their nodes, stay as they are."""
    own = built(blocks(cell))
    rng = np.random.default_rng(2)
    for _ in range(20):
        _, average, result = mended(own, lambda x: np.maximum(rng.normal(size=len(x)), 0.0))
        assert result.min() >= -1e-15
        assert np.array_equal(average, result) == cell.startswith("hex")


def test_ends_in_2d_and_ties() -> None:
    """In 2D the ends of a contactor where supports hold its direction but not its normal; of ties none."""
    found = built(line_on_plane(held=True)).planes
    assert found is not None
    assert found.count.sum() == 1
    (point,) = np.flatnonzero(found.count)
    assert np.abs(found.across[point, 0]) == pytest.approx([1.0, 0.0])
    assert not found.across[point, 1].any()
    free = built(line_on_plane(held=False)).planes
    assert free is not None
    assert not free.count.any()
    tied = built(bent("tet4", 3, "tied"))
    assert tied.planes is None


def line_on_plane(held: bool) -> abut.Model:
    """A block on one of its own width; at x = 0 both may be held along x."""
    mesh = join({"a": rectangle((0, 1), (0, 1), (3, 2)), "b": rectangle((0, 1), (1, 2), (2, 2))})
    steel = abut.LinearElastic(1000.0, 0.3)
    sides = [abut.Support(f"{body}.left", x=0.0) for body in "ab"] if held else [abut.Support("b.left", y=0.0)]
    return abut.Model(
        mesh, [abut.Solid(body, steel) for body in "ab"], [abut.Support("a.bottom", y=0.0), *sides],
        contacts=[abut.Contact("a.top", "b.bottom")], plane="strain",
    )  # fmt: skip


@pytest.mark.parametrize("cell", ["hex20", "tet10"])
def test_normals_of_planes(cell: str) -> None:
    """Unit normals, of both planes where two meet."""
    own = built(blocks(cell))
    assert own.planes is not None
    x, across = own.contactor.points, own.planes.across
    for point in np.flatnonzero(own.planes.count):
        on = np.flatnonzero(np.abs(x[point, :2]) < 1e-12)
        found = np.abs(across[point][: len(on)])
        assert np.sort(found.argmax(axis=1)).tolist() == on.tolist()
        assert found.max(axis=1) == pytest.approx(np.ones(len(on)))


@pytest.mark.parametrize("contactor", ["ball", "block"])
def test_curved_surfaces_meet_planes_at_nearly_a_right_angle(contactor: str) -> None:
    """Facets of a ball stand off the plane by half their angle: found nevertheless, where they are small."""
    own = built(quarter_ball("tet4", 4, contactor))
    assert own.planes is not None
    x = own.contactor.points
    ids = own.contactor.node_ids
    ids = ids[np.linalg.norm(x[ids, :2], axis=1) < 0.3]
    on = (np.abs(x[ids, :2]) < 1e-12).sum(axis=1)
    assert np.array_equal(own.planes.count[ids], on)

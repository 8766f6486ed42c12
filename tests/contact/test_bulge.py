"""The bulge of the smooth surface over flat facets against circles, cylinders, spheres and paraboloids."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace

import numpy as np
import pytest

from abut._core import shape_functions
from abut.cells import CELLS
from abut.contact.bulge import Held, at_reference, bulge_at, with_bulge
from abut.contact.coupling import CouplingOptions, couple
from abut.contact.geometry import by_kind, node_coordinates
from abut.mesh.surface import Surface
from abut.types import Array
from models.sheets import chain, sheet, turn

Height = Callable[[Array], Array]  # how far points (n, dim) lie inside of the surface


def edges(surface: Surface) -> tuple[Array, Array]:
    """Bulges and middles of all edges, (n,) and (n, dim)."""
    assert surface.bulge is not None
    heights, middles = [], []
    for kind, facets in by_kind(surface):
        n = CELLS[kind].corners
        for e in range(1 if surface.dim == 2 else n):
            ends = surface.points[surface.nodes[facets][:, [e, (e + 1) % n]]]
            heights.append(surface.bulge[facets, n + e])
            middles.append(ends.mean(axis=1))
    return np.concatenate(heights), np.concatenate(middles)


def moved(s: Array, n: int, noise: float, seed: int) -> Array:
    """Parameters of nodes with those inside moved by up to ``noise`` of a facet, so that the nodes stay on the surface."""
    inside = (s > 0.0) & (s < 1.0)
    return np.asarray(s + inside * noise / n * np.random.default_rng(seed).uniform(-1.0, 1.0, s.shape))


def arc(n: int, angle: float, kind: str = "line2", noise: float = 0.0) -> Surface:
    """From the x axis on, against the clock, so that the normal points away from the centre."""

    def place(s: Array) -> list[Array]:
        turn = angle * moved(s, n, noise, 1)
        return [np.cos(turn), np.sin(turn)]

    return chain(kind, n, place)


def test_arcs_are_met() -> None:
    """Inside of an even arc to rounding, of one whose facets differ by up to four times to a hundredth; at its ends, where
    nothing lies beyond, with an error that falls."""
    for noise in (0.0, 0.3):
        ends = []
        for n in (6, 12):
            surface = with_bulge(arc(n, np.pi / 2, noise=noise))
            height, middle = edges(surface)
            right = 1.0 - np.linalg.norm(middle, axis=1)
            order = np.argsort(np.arctan2(middle[:, 1], middle[:, 0]))
            assert height[order][1:-1] == pytest.approx(right[order][1:-1], rel=1e-2 if noise else 1e-12)
            ends.append(np.abs(height / right - 1.0).max())
        assert ends[1] < ends[0] / 3.0
        assert ends[0] < 0.02


def dome(s: Array, t: Array) -> list[Array]:
    x, y = 0.8 * s, 0.8 * t
    return [x, y, np.sqrt(1.5**2 - x**2 - y**2)]


def tube(s: Array, t: Array) -> list[Array]:
    return [np.sin(s), 0.7 * t, np.cos(s)]


def saddle(s: Array, t: Array) -> list[Array]:
    return [s, t, 0.2 * s**2 - 0.15 * t**2 + 0.1 * s * t]


def above_saddle(x: Array) -> Array:
    """To first order in the square of the slope, which is at most .35."""
    height = 0.2 * x[:, 0] ** 2 - 0.15 * x[:, 1] ** 2 + 0.1 * x[:, 0] * x[:, 1] - x[:, 2]
    slope = (0.4 * x[:, 0] + 0.1 * x[:, 1]) ** 2 + (0.1 * x[:, 0] - 0.3 * x[:, 1]) ** 2
    return np.asarray(height / np.sqrt(1.0 + slope))


def irregular(kind: str, n: int, place: Callable[[Array, Array], list[Array]], noise: float) -> Surface:
    return sheet(kind, n, lambda s, t: place(moved(s, n, noise, 3), moved(t, n, noise, 4)))


SHAPES: dict[str, tuple[Callable[[Array, Array], list[Array]], Height]] = {
    "dome": (dome, lambda x: 1.5 - np.linalg.norm(x, axis=1)),
    "tube": (tube, lambda x: 1.0 - np.hypot(x[:, 0], x[:, 2])),
    "saddle": (saddle, above_saddle),
}


@pytest.mark.parametrize("noise", [0.0, 0.3])
@pytest.mark.parametrize("kind", ["tri3", "quad4"])
@pytest.mark.parametrize("shape", SHAPES)
def test_curved_sheets(shape: str, kind: str, noise: float) -> None:
    """On regular and irregular meshes, up to the rim: errors of the order h^2 of the largest bulge. Of the saddle less is
    asked: along its edges that bend one way at one end and the other at the other there is no bulge."""
    place, inside = SHAPES[shape]
    errors = []
    for n in (5, 10):
        surface = irregular(kind, n, place, noise)
        height, middle = edges(with_bulge(surface))
        right = inside(middle)
        errors.append(np.abs(height - right).max() / np.abs(right).max())
    assert errors[1] < (0.005 if shape != "saddle" else 0.03)
    assert errors[1] < (0.6 if shape != "saddle" else 0.8) * errors[0]


@pytest.mark.parametrize("kind", ["line2", "tri3", "quad4", "tri6", "quad8", "quad9"])
def test_flat_surfaces_have_none(kind: str) -> None:
    """Tilted and irregular; and a block's sides, which meet at creases."""
    if kind == "line2":
        flat = chain(kind, 7, lambda s: [s**2, 0.3 * s**2])
        bent = chain(kind, 8, lambda s: [np.minimum(s, 0.5), np.maximum(s - 0.5, 0.0)], 0.0, 1)
        assert with_bulge(bent).bulge is None
    else:
        flat = sheet(kind, 4, lambda s, t: [s**2, t**2 + s * t, 0.3 * s**2 - 0.2 * (t**2 + s * t)])
    assert with_bulge(flat).bulge is None


def fillet(facets: int, along: int) -> Callable[[Array], list[Array]]:
    """A line of length 1 and ``along`` facets that goes over into a quarter of a circle of radius 0.3, of ``facets``."""

    def place(s: Array) -> list[Array]:
        t = s * (along + facets)
        angle = np.clip((t - along) / facets, 0.0, 1.0) * np.pi / 2
        return [np.minimum(t / along, 1.0) + 0.3 * np.sin(angle), 0.3 * (1.0 - np.cos(angle))]

    return place


@pytest.mark.parametrize(("facets", "along"), [(6, 6), (3, 4), (4, 20), (12, 3)])
def test_a_flat_beside_a_fillet_stays_flat(facets: int, along: int) -> None:
    """The line that goes over into an arc has no bulge; the facets of the arc have theirs, from the first one on."""
    surface = with_bulge(chain("line2", along + facets, fillet(facets, along), 0.0, 1))
    assert surface.bulge is not None
    order = np.argsort(surface.points[surface.nodes[:, :2]].mean(axis=1)[:, 0])
    height = np.abs(surface.bulge[order, 2])
    assert (height[:along] == 0.0).all()
    sagitta = 0.3 * (1.0 - np.cos(np.pi / 4 / facets))
    assert height[along:-1] == pytest.approx(sagitta, rel=1e-9)


@pytest.mark.parametrize("kind", ["tri3", "quad4"])
def test_a_plane_beside_a_fillet_stays_plane(kind: str) -> None:
    """As the line; edges straight up the arc, away from its end."""
    line = fillet(6, 6)

    def place(s: Array, t: Array) -> list[Array]:
        x, z = line(s)
        return [x, t, -z]

    plain = sheet(kind, 12, place, 0.0, 1)
    surface, corners = with_bulge(plain), CELLS[kind].corners
    assert surface.bulge is not None
    ends = surface.points[
        np.stack([surface.nodes[:, :corners], np.roll(surface.nodes[:, :corners], -1, axis=1)], axis=2)
    ]
    height, across = np.abs(surface.bulge[:, corners : 2 * corners]), np.ptp(ends[..., 1], axis=2) < 1e-12
    middle = ends[..., 0].mean(axis=2)
    assert (height[middle < 1.0] == 0.0).all()
    first = across & (middle > 1.0) & (middle < 1.0 + 0.3 * np.sin(np.pi / 12))
    inside = first & (np.abs(ends[..., 1].mean(axis=2) - 0.5) < 0.45)
    assert inside.sum() > 10
    assert height[inside] == pytest.approx(0.3 * (1.0 - np.cos(np.pi / 24)), rel=1e-9)


def test_a_chamfer_and_a_shallow_bend_are_no_arcs() -> None:
    """Two flats that meet at 20 degrees have no bulge; a chamfer of one facet between flats is none that is met from its
    flats' normals, which would be twice as high."""
    bend = chain("line2", 8, lambda s: [s, np.maximum(s - 0.5, 0.0) * np.tan(np.deg2rad(20.0))], 0.0, 1)
    assert with_bulge(bend).bulge is None
    s = np.linspace(0.0, 1.0, 10)
    turn = np.deg2rad(np.where(s[:-1] < 0.4, 0.0, np.where(s[:-1] < 0.5, 15.0, 30.0)))
    x, y = (np.concatenate([[0.0], np.cumsum(part(turn) / 9)]) for part in (np.cos, np.sin))
    chamfer = with_bulge(chain("line2", 9, lambda t: [np.interp(t, s, x), np.interp(t, s, y)], 0.0, 1))
    assert chamfer.bulge is not None
    assert np.abs(chamfer.bulge).max() < 0.6 / 18 * np.tan(np.deg2rad(7.5))


@pytest.mark.parametrize("kinds", [("line2", "line3"), ("tri3", "tri6"), ("quad4", "quad8"), ("quad4", "quad9")])
def test_middle_nodes_on_the_chord(kinds: tuple[str, str]) -> None:
    """Facets of second order with straight edges on a curved body bulge as those of first order; those with curved edges do
    not."""
    if kinds[0] == "line2":
        plain, curved = (arc(9, 1.2, kind=kind) for kind in kinds)
    else:
        plain, curved = (sheet(kind, 4, dome) for kind in kinds)
    assert with_bulge(curved).bulge is None
    points = curved.points.copy()
    for kind, facets in by_kind(curved):
        corners = CELLS[kind].corners
        x = points[curved.nodes[facets, :corners]]
        count = 1 if curved.dim == 2 else corners
        points[curved.nodes[facets, corners : corners + count]] = 0.5 * (x + np.roll(x, -1, axis=1))[:, :count]
        if CELLS[kind].nodes == 9:
            points[curved.nodes[facets, 8]] = x.mean(axis=1)
    found, expected = (edges(with_bulge(s)) for s in (replace(curved, points=points), plain))
    by_place = [np.lexsort(np.round(middle, 9).T) for _, middle in (found, expected)]
    assert found[0][by_place[0]] == pytest.approx(expected[0][by_place[1]], rel=1e-9, abs=1e-12)


def test_symmetry_planes_and_the_axis_mirror() -> None:
    """Half of a parabola whose vertex lies on the plane: the first facet as the first beside the vertex of the whole."""

    def parabola(s: Array) -> list[Array]:
        return [s, 0.4 * s**2 + 0.3 * s**3]  # the cubic term tells both ends of a half apart

    half = chain("line2", 6, parabola)
    vertex = int(np.abs(half.points[:, 0]).argmin())
    right = 0.4 / 36 / 4  # over the middle of [0, 1/6], for the even part
    first = [
        np.abs(surface.bulge).max(axis=1)[half.points[half.nodes[:, :2]].mean(axis=1)[:, 0].argmin()]
        for surface in (
            with_bulge(half),
            with_bulge(half, Held(np.array([vertex]), np.array([[1.0, 0.0]]))),
            with_bulge(replace(half, axisymmetric=True)),
        )
        if surface.bulge is not None
    ]
    assert first[1] == pytest.approx(first[2], rel=1e-9)
    assert abs(first[1] - right) < abs(first[0] - right)


@pytest.mark.parametrize("kind", ["line2", "line3", "tri3", "tri6", "quad4", "quad8", "quad9"])
def test_three_ways_to_evaluate(kind: str) -> None:
    """By values of shape functions and by reference coordinates, and taken off the gap by the compiled core."""
    flat = arc(3, 0.9, kind) if kind.startswith("line") else sheet(kind, 2, saddle)
    corners, dim = CELLS[kind].corners, CELLS[kind].dim
    count = 1 if dim == 1 else corners
    bulge, rng = np.zeros((len(flat), 9)), np.random.default_rng(4)
    bulge[:, corners : corners + count] = rng.uniform(0.01, 0.1, (len(flat), count))
    over, facets = replace(flat, bulge=bulge), np.arange(len(flat))
    xi = node_coordinates(kind)[:corners].mean(axis=0) + rng.uniform(-0.2, 0.2, (len(flat), dim))
    shapes = np.zeros((len(flat), 9))
    shapes[:, : CELLS[kind].nodes] = shape_functions(CELLS[kind].code, np.ascontiguousarray(xi))[0]
    assert bulge_at(over, facets, shapes) == pytest.approx(at_reference(over, kind, facets, xi), rel=1e-12)
    other = turn(replace(flat, points=flat.points + 0.01))
    options = CouplingOptions(points=2, keep_points=True, reach=0.5)
    for plain, sides in (
        (couple(flat, other, 1, options), (over, other)),
        (couple(other, flat, 1, options), (other, over)),
    ):
        seen = couple(*sides, 1, options)
        at, without = seen.points, plain.points
        assert at is not None
        assert without is not None
        assert len(at.gap)
        facet, of = (at.facet, sides[0]) if sides[0] is over else (at.target_facet, sides[1])
        offset = 0 if sides[0] is over else len(other.points)
        normal = at.gap_operator.tocsc()
        shapes = np.zeros((len(facet), 9))  # of the facets that bulge, from the rows of the gap
        for k in range(CELLS[kind].nodes):
            node = offset + of.nodes[facet, k]
            along = [np.asarray(normal[np.arange(len(facet)), of.dim * node + a]).ravel() for a in range(of.dim)]
            shapes[:, k] = np.abs((np.stack(along, axis=1) * at.normal).sum(axis=1))
            shapes[:, k] *= np.sign((np.stack(along, axis=1) * at.normal).sum(axis=1)) * (
                1.0 if of is sides[0] else -1.0
            )
        assert at.gap == pytest.approx(without.gap - bulge_at(over, facet, shapes), abs=1e-13)

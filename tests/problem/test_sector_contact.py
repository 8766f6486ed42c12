"""Contact that reaches both sides of a sector of cyclic symmetry does what it does in the whole, node by node."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

import abut
from abut.contact.geometry import smoothing
from abut.contact.moving_normals import normal_pattern
from abut.diagnosis import check
from abut.model.turned_sides import turned_sides
from abut.types import Array
from models.sectors import COUNT, RADII, models, sector, solved

ROUNDING = 1e-10  # of two solutions of one problem, of which one has four times the unknowns
ROUND = abut.Axes("cylindrical")
FIT = abut.Contact("in.right", "out.left", offset=-0.002)


def held(dim: int, turned: float = 0.0) -> list[abut.Support]:
    """Nothing turns, and nothing moves along the axis; or the outer ring is turned."""
    along = {"z": 0} if dim == 3 else {}
    return [
        abut.Support("in.left", y=0, axes=ROUND, **along),
        abut.Support("out.right", y=turned, axes=ROUND, **along),
    ]


def pushed(x: Array) -> Array:
    """Where the inner ring's bore is pushed to: out in some places, in in others, alike in all sectors."""
    angle = np.arctan2(x[:, 1], x[:, 0])
    return 0.003 * ((1.0 + x[:, 2]) * np.cos(COUNT * angle - 0.4) - 0.3)


CASES = [
    ("quad4", (3, 3), None, 0.0),
    ("quad4", (3, 4), (3, 12), 0.3),
    ("quad8", (3, 3), (3, 5), 0.0),
    ("quad8", (2, 4), (2, 4), 0.3),
    ("tri6", (2, 3), (2, 4), 0.3),
    ("hex8", (2, 3, 2), (2, 9, 3), 0.0),
    ("hex8", (2, 3, 2), None, 0.3),
    ("hex20", (1, 3, 2), None, 0.3),
    ("tet10", (1, 3, 1), None, 0.3),
]


@pytest.mark.parametrize(("cell", "cells", "other", "uneven"), CASES)
def test_press_fit(cell: str, cells: tuple, other: tuple | None, uneven: float) -> None:
    """Before: off by up to 3.5 times the largest pressure at the sides."""
    mesh = sector(cell, cells, other, uneven)
    both = solved(mesh, held(mesh.dim), FIT)
    assert both.moved < ROUNDING
    assert both.apart(lambda c: c.pressure) < ROUNDING


def test_pressure_is_that_of_lame() -> None:
    """The same at all nodes, of second order as the closed form of two thick rings in plane strain."""
    mesh = sector("quad8", (4, 6))
    pressure = abut.solve(models(mesh, held(2), FIT)[0]).contacts[0].pressure
    pressure = pressure[~np.isnan(pressure)]
    modulus, ratio = 1000.0 / (1.0 - 0.09), 0.3 / 0.7
    bore, mid, rim = RADII
    give = (
        mid
        / modulus
        * ((mid**2 + bore**2) / (mid**2 - bore**2) - ratio + (rim**2 + mid**2) / (rim**2 - mid**2) + ratio)
    )
    assert np.ptp(pressure) < 1e-9 * pressure.max()
    assert pressure == pytest.approx(0.002 / give, rel=2e-3)


@pytest.mark.parametrize(
    ("cell", "cells", "other"),
    [
        ("quad4", (3, 3), (3, 5)),
        ("tri3", (3, 3), None),
        pytest.param("hex8", (2, 3, 2), None, marks=pytest.mark.long),
        pytest.param("tet10", (1, 3, 1), None, marks=pytest.mark.long),
    ],
)
def test_friction_under_a_torque(cell: str, cells: tuple, other: tuple | None) -> None:
    """Sticking and slipping, on facets that no plane mirrors: tractions beyond a side are those of the other, turned."""
    mesh = sector(cell, cells, other, 0.3)
    both = solved(mesh, held(mesh.dim, 0.0012), replace(FIT, friction=0.2))
    assert both.moved < ROUNDING
    for field in (lambda c: c.pressure, lambda c: c.friction.traction, lambda c: c.friction.slip):
        assert both.apart(field) < ROUNDING


@pytest.mark.parametrize("friction", [0.0, 0.3])
def test_partly_open_contact(friction: float) -> None:
    """Contact that opens and closes within the sector, and lies across its side."""
    mesh = sector("hex8", (2, 6, 2))
    supports = [
        abut.Support("in.left", x=pushed, y=0, z=0, axes=ROUND),
        abut.Support("out.right", x=0, y=0, z=0, axes=ROUND),
    ]
    both = solved(mesh, supports, replace(FIT, offset=0.0, friction=friction))
    pressure = both.whole.contacts[0].pressure
    assert (pressure == 0.0).any() or np.nanmin(pressure) < 1e-9 * np.nanmax(pressure)
    assert both.moved < ROUNDING
    assert both.apart(lambda c: c.pressure) < ROUNDING


def test_points_that_close_on_the_way() -> None:
    """Slip of open contact does not count, by the direction in which bodies approach: the mean of a contact that lies across
    the side, whose normals are in one frame."""
    mesh = sector("hex8", (2, 6, 2))
    supports = [
        abut.Support("in.left", x=pushed, y=0, z=0, axes=ROUND),
        abut.Support("out.right", x=0, y=0, z=0, axes=ROUND),
    ]
    contact = replace(FIT, offset=0.0, friction=0.3)
    both = solved(mesh, supports, contact, solve=abut.SolveOptions(steps=3))
    for field in (lambda c: c.pressure, lambda c: c.friction.traction, lambda c: c.friction.slip):
        assert both.apart(field) < ROUNDING


def test_bodies_as_sides() -> None:
    """Their edges are creases, of which each smooth side goes on by itself."""
    both = solved(sector("hex8", (2, 3, 2)), held(3), abut.Contact("in", "out", offset=-0.002))
    assert both.apart(lambda c: c.pressure) < ROUNDING


@pytest.mark.parametrize(("cell", "cells", "other"), [("quad8", (3, 3), (3, 5)), ("hex8", (2, 3, 2), (2, 5, 3))])
def test_large_displacements(cell: str, cells: tuple, other: tuple | None) -> None:
    """To what Newton's method leaves; before, off by the pressure itself."""
    mesh = sector(cell, cells, other)
    both = solved(mesh, held(mesh.dim), FIT, kinematics="finite")
    assert both.moved < 1e-8
    assert both.apart(lambda c: c.pressure) < 1e-8


def test_normals_that_move() -> None:
    """Derivatives of normals by points, those on the other side among them, against differences."""
    model, _, _ = models(sector("hex8", (1, 3, 2), uneven=0.3), held(3), FIT, kinematics="finite")
    surface, _ = model.sides(model.contacts[0])
    pattern = normal_pattern(surface, smoothing(surface))
    now, step = pattern.at(surface), 1e-6
    way = np.random.default_rng(1).normal(size=surface.points.shape)
    ahead, back = (pattern.at(replace(surface, points=surface.points + s * step * way)).values for s in (1.0, -1.0))
    change = (now.turning(len(surface.points)) @ way.ravel()).reshape(-1, 3)
    used = surface.nodes >= 0
    assert ((ahead - back) / (2.0 * step))[used] == pytest.approx(change[now.numbers[used]], abs=1e-7)


def test_sides_are_found_in_equations() -> None:
    """However these are written; nothing else is taken for one."""
    mesh = sector("quad4", (2, 3))
    origin = np.array([0.3, -0.2])
    moved = replace(mesh, points=mesh.points + origin)
    added = abut.add_sectors(moved, [abut.Sector("in.top", "in.bottom", COUNT, origin=tuple(origin))])
    (found,) = turned_sides(moved, added.equations)
    assert (len(found.nodes), found.sectors) == (3, COUNT)
    assert moved.points[found.partners] @ found.turn.T + found.shift == pytest.approx(
        moved.points[found.nodes], abs=1e-12
    )
    mixed = []  # both rows of a node, added and taken off, the partner first
    for one, other in zip(added.equations[::2], added.equations[1::2]):
        for sign in (1.0, -1.0):
            turned = [replace(t, coefficient=sign * t.coefficient) for t in other.terms]
            mixed.append(abut.Equation((*turned, *one.terms)[::-1]))
    (again,) = turned_sides(moved, mixed)
    assert {*zip(again.nodes, again.partners)} == {*zip(found.nodes, found.partners)} or again.turn == pytest.approx(
        found.turn.T
    )
    brick = sector("hex8", (1, 2, 1))
    (flat,) = turned_sides(  # without equations along the axis, along which supports hold both sides
        brick,
        [
            e
            for e in abut.add_sectors(brick, [abut.Sector("in.back", "in.front", COUNT)]).equations
            if e.terms[0].component != "z"
        ],
    )
    assert flat.sectors == COUNT
    assert turned_sides(moved, added.equations[:2]) == ()  # one node lies so for some axis
    ties = [abut.Equation((abut.Term(a, c, 1.0), abut.Term(a + 1, c, -1.0))) for a in (0, 4) for c in "xy"]
    assert turned_sides(moved, ties) == ()


@pytest.mark.parametrize(
    ("change", "cell", "more", "said"),
    [
        ({"kind": "tied", "offset": 0.0}, "hex8", {}, "tractions of a tie at both sides"),
        ({}, "hex8", {"kinematics": "finite"}, "slides beyond a side meets nothing"),
        ({}, "tet4", {}, "linear triangles and tetrahedra"),
        ({}, "hex8", {}, ""),
        ({"friction": 0.2}, "tet4", {}, ""),
    ],
)
def test_what_is_left_out_is_told(change: dict, cell: str, more: dict, said: str) -> None:
    model, whole, _ = models(sector(cell, (1, 3, 1)), held(3, 1e-4), replace(FIT, **change), **more)
    warned = [f.what for f in check(model).findings if "sides of a sector" in f.what]
    noted = [c.meaning for c in abut.solve(model).contacts[0].checks if c.name == "sides of the sector"]
    assert [said in each for each in (*warned, *noted)] == ([True, True] if said else [])
    assert not [f for f in check(whole).findings if "sides of a sector" in f.what]

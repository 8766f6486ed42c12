"""Planes of symmetry at large sliding: a half with its plane held is the whole."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace

import numpy as np
import pytest
from numpy.typing import NDArray

import abut
from abut.contact.bulge import Held, with_bulge
from abut.contact.geometry import nodal_normals, smoothing
from abut.contact.moving_normals import normal_pattern
from abut.mesh.make import box, join, rectangle, ring
from abut.mesh.mesh import Mesh
from abut.model.symmetry import held_directions
from abut.problem.contact_normals import moving_smoothing
from models.mirrored import whole

Array = NDArray[np.float64]
STEEL = abut.LinearElastic(1000.0, 0.3)
SAME = 1e-8  # of the largest displacement: what the solver leaves, many times over
PLANE = ["tri3", "tri6", "quad4", "quad8", "quad9"]
LINEAR = ["tri3", "quad4", "tet4", "hex8"]
SOLID = ["tet4", "tet10", "hex8", "hex20", "hex27"]


def round_body(cell: str) -> Mesh:
    """A quarter of a ring, or of a tube with thin and thick places."""
    if cell in PLANE:
        return ring([1, 2], cells=[2, 5], cell=cell)
    square = box([0, 1], [0, 90], [0, 1], cells=[1, 4, 2], cell=cell)
    r, turn, height = 1.0 + square.points[:, 0], np.deg2rad(square.points[:, 1]), square.points[:, 2]
    r = r + 0.2 * height**2 + 0.1 * np.sin(3.0 * turn) * height
    names = {"inner": "left", "outer": "right", "start": "front", "end": "back"}
    return replace(
        square,
        points=np.column_stack([r * np.cos(turn), r * np.sin(turn), height]),
        surfaces={name: square.surfaces[old] for name, old in names.items()},
    )


def bent(points: Array) -> Array:
    """A motion that keeps the plane x = 0."""
    x, y = points[:, 0], points[:, 1]
    moved = points.copy()
    moved[:, 0] += 0.15 * x * y
    moved[:, 1] += 0.3 * x**2 - 0.1 * y
    return moved


def at_end(mesh: Mesh) -> Held:
    held = held_directions(mesh, [abut.Support("end", x=0.0)])
    assert held is not None
    return held


@pytest.mark.parametrize("cell", PLANE + SOLID)
def test_normals_are_those_of_the_whole(cell: str) -> None:
    """Where the body is and where it moves to, at every node of the half, on its plane in particular."""
    half = round_body(cell)
    own, both = half.surface("outer"), whole(half, 0).surface("outer")
    across, n, used = moving_smoothing(own, at_end(half)), len(own), own.nodes >= 0
    on = np.abs(own.points[own.nodes[used], 0]) < 1e-9
    for move in (lambda x: x, bent):
        here, there = (replace(s, points=move(s.points)) for s in (own, both))
        expected = nodal_normals(there, smoothing(both))[:n][used]  # creases stay those at the outset
        plain = nodal_normals(here, smoothing(own))[used]
        for found in (nodal_normals(here, across), normal_pattern(own, across).at(here).values):
            assert np.abs(found[used] - expected).max() < 1e-12
        assert np.abs(expected[on, 0]).max() < 1e-12
    assert np.abs(plain[on, 0]).max() > (
        0.02 if own.nodes.shape[1] and cell in ("tri3", "quad4", "tet4", "hex8") else 0.0
    )


@pytest.mark.parametrize("cell", LINEAR)
def test_bulges_are_those_of_the_whole(cell: str) -> None:
    """Of a tube between four planes, of which the half has the fourth only as a support."""
    half = round_body(cell)
    sides = [abut.Support(side, **on) for side, on in (("end", {"x": 0.0}), ("start", {"y": 0.0}))]
    own = with_bulge(half.surface("outer"), held_directions(half, sides))
    image = whole(half, 0)
    both = with_bulge(image.surface("outer"), held_directions(image, sides[1:]))
    plain = with_bulge(half.surface("outer"))
    assert own.bulge is not None
    assert both.bulge is not None
    assert plain.bulge is not None
    size, expected = np.abs(both.bulge).max(), both.bulge[: len(own)]
    assert np.abs(own.bulge - expected).max() < 1e-9 * size
    assert np.abs(plain.bulge - expected).max() > 1e-3 * size


@pytest.mark.parametrize("cell", PLANE + SOLID)
def test_their_derivative(cell: str) -> None:
    """Against differences of order four."""
    half = round_body(cell)
    own = half.surface("outer")
    across, used = moving_smoothing(own, at_end(half)), own.nodes >= 0
    pattern = normal_pattern(own, across)
    here = replace(own, points=bent(own.points))
    way = np.random.default_rng(4).uniform(-1, 1, own.points.shape)
    far = [nodal_normals(replace(here, points=here.points + k * 1e-4 * way), across) for k in (-2, -1, 1, 2)]
    expected = ((far[0] - 8 * far[1] + 8 * far[2] - far[3]) / 12e-4)[used]
    now = pattern.at(here)
    found = (now.turning(len(own.points)) @ way.ravel()).reshape(-1, own.dim)[now.numbers[used]]
    assert np.abs(found - expected).max() < 1e-9 * np.abs(expected).max()


def test_only_where_a_surface_ends() -> None:
    """A round die that is held all over has no plane in its middle, and a clamped edge turns with what is beside it."""
    die = ring([1, 2], [20, 160], cells=[2, 28], cell="quad4")
    outer = die.surface("outer")
    held = held_directions(die, [abut.Support("outer", x=0.0, y=0.0)])
    assert moving_smoothing(outer, held).planes is None or not len(moving_smoothing(outer, held).planes.visits)
    plate = rectangle([0, 4], [0, 1], cells=[4, 1], cell="quad4")
    top = plate.surface("top")
    ends = {}
    for name, given in (("roller", {"x": 0.0}), ("clamp", {"x": 0.0, "y": 0.0})):
        across = moving_smoothing(top, held_directions(plate, [abut.Support("left", **given)]))
        moved = replace(top, points=top.points + np.column_stack([0 * top.points[:, 0], -0.1 * top.points[:, 0]]))
        at = np.abs(top.points[top.nodes[:, :2], 0]) < 1e-9
        ends[name] = nodal_normals(moved, across)[:, :2][at][0]
    assert ends["roller"] == pytest.approx([0.0, 1.0], abs=1e-14)
    assert ends["clamp"] == pytest.approx(np.array([0.1, 1.0]) / np.hypot(0.1, 1.0), rel=1e-12)


def solved(
    parts: Mapping[str, Mesh],
    supports: list[abut.Support],
    cuts: Mapping[str, str],
    contact: abut.Contact,
    plane: str | None,
) -> tuple[Array, Array]:
    """Displacements of the half at its points, and those of the whole at these. cuts: surfaces in the plane x = 0."""
    found = []
    for both in (False, True):
        meshes = {name: whole(mesh, 0) if both else mesh for name, mesh in parts.items()}
        mesh, own = join(meshes), list(supports)
        if both:  # in the middle of each body, off the contact: what moves the whole sideways
            middles = {}
            for name, cut in cuts.items():
                nodes = join(parts).nodes_of(f"{name}.{cut}")
                first = sum(len(parts[k].points) for k in list(parts)[: list(parts).index(name)])
                start = sum(len(meshes[k].points) for k in list(parts)[: list(parts).index(name)])
                middles[f"{name}.middle"] = np.sort(nodes - first + start)
            mesh = replace(mesh, node_sets={**mesh.node_sets, **middles})
            own += [abut.Support(name, x=0.0) for name in middles]
        else:
            own += [abut.Support(f"{name}.{cut}", x=0.0) for name, cut in cuts.items()]
        model = abut.Model(
            mesh, [abut.Solid(name, STEEL) for name in parts], own, contacts=[contact], plane=plane, kinematics="finite"
        )
        moved = abut.solve(model).displacement
        sizes = np.cumsum([0, *(len(meshes[name].points) for name in parts)])
        found.append(np.concatenate([moved[a : a + len(parts[name].points)] for a, name in zip(sizes, parts)]))
    return found[0], found[1]


def fit(
    cell: str, friction: float = 0.0, swapped: bool = False, names: bool = True, deep: float = -0.02
) -> tuple[Array, Array]:
    """Of two quarters of rings or tubes that do not match."""
    sizes = {"a": (1.0, 5), "b": (2.0, 7)} if cell in PLANE else {"a": (1.0, 3), "b": (2.0, 4)}
    parts = {}
    for name, (first, n) in sizes.items():
        if cell in PLANE:
            parts[name] = ring([first, first + 1], cells=[2, n], cell=cell)
            continue
        square = box([first, first + 1], [0, 90], [0, 1], cells=[1, n, 1], cell=cell)
        r, turn = square.points[:, 0], np.deg2rad(square.points[:, 1])
        sides = {"inner": "left", "outer": "right", "start": "front", "end": "back", "bottom": "bottom", "top": "top"}
        parts[name] = replace(
            square,
            points=np.column_stack([r * np.cos(turn), r * np.sin(turn), square.points[:, 2]]),
            surfaces={new: square.surfaces[old] for new, old in sides.items()},
        )
    held = [abut.Support(f"{name}.start", y=0.0) for name in parts]
    if cell in SOLID:
        held += [abut.Support(f"{name}.{side}", z=0.0) for name in parts for side in ("bottom", "top")]
    both = (("a.outer", "b.inner") if names else ("a", "b"))[:: -1 if swapped else 1]
    contact = abut.Contact(contactor=both[0], target=both[1], offset=deep, friction=friction)
    return solved(parts, held, {"a": "end", "b": "end"}, contact, "strain" if cell in PLANE else None)


def same(found: tuple[Array, Array]) -> None:
    half, both = found
    assert np.abs(both).max() > 1e-3
    assert np.abs(half - both).max() < SAME * np.abs(both).max()


@pytest.mark.parametrize("swapped", [False, True])
@pytest.mark.parametrize("cell", ["tri3", "quad4", "quad8"])
def test_half_a_fit_is_half_of_the_whole(cell: str, swapped: bool) -> None:
    same(fit(cell, swapped=swapped))


def test_with_friction() -> None:
    same(fit("quad4", friction=0.2))


def test_sides_that_go_round_the_edge() -> None:
    """Whole bodies, whose outsides go on in the plane of symmetry in the half and not in the whole."""
    same(fit("quad4", names=False))

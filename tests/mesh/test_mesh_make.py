"""Bodies meshed by abut: volumes, orders of convergence, curved sides, fine zones, names."""

from __future__ import annotations

from collections.abc import Callable
from itertools import product

import numpy as np
import pytest

from abut.bodies.loads import body_load
from abut.errors import InputError
from abut.mesh.check import check_mesh
from abut.mesh.make import box, cylinder, disc, half_disc, quarter_disc, rectangle, ring, sphere_octant
from abut.mesh.mesh import Mesh

PLANE = ["tri3", "tri6", "quad4", "quad8", "quad9"]
SOLID = ["tet4", "tet10", "hex8", "hex20", "hex27", "wedge6", "wedge15"]
QUADRATIC = {"tri6", "quad8", "quad9", "tet10", "hex20", "hex27", "wedge15"}


def volume(mesh: Mesh) -> float:
    return float(body_load(mesh, dict.fromkeys(mesh.bodies, np.eye(mesh.dim)[0])).sum())


def facet_rows(mesh: Mesh) -> int:
    return sum(len(rows) for rows in mesh.surfaces.values())


@pytest.mark.parametrize("cell", PLANE)
def test_rectangle_sides(cell: str) -> None:
    mesh = rectangle(x=(-1, 2), y=(1, 1.5), cells=(3, 2), cell=cell)
    check_mesh(mesh)
    assert volume(mesh) == pytest.approx(1.5, rel=1e-14)
    for name, (axis, value) in {"left": (0, -1), "right": (0, 2), "bottom": (1, 1), "top": (1, 1.5)}.items():
        assert mesh.points[mesh.nodes_of(name), axis] == pytest.approx(value)
    assert facet_rows(mesh) == 10


@pytest.mark.parametrize("cell", SOLID)
def test_box_sides(cell: str) -> None:
    mesh = box(x=(0, 2), y=(-1, 0), z=(3, 4), cells=(2, 1, 3), cell=cell)
    check_mesh(mesh)
    assert volume(mesh) == pytest.approx(2.0, rel=1e-14)
    sides = {"left": (0, 0), "right": (0, 2), "front": (1, -1), "back": (1, 0), "bottom": (2, 3), "top": (2, 4)}
    for name, (axis, value) in sides.items():
        assert mesh.points[mesh.nodes_of(name), axis] == pytest.approx(value)
    squares = 2 * (2 * 1 + 1 * 3 + 2 * 3)
    triangles = {"tet": squares, "wed": 2 * 2 * 1}.get(cell[:3], 0)  # a square side of two triangles counts twice
    assert facet_rows(mesh) == squares + triangles


@pytest.mark.parametrize("cell", SOLID)
def test_tube_converges_to_the_exact_volume(cell: str) -> None:
    errors = []
    for n in (6, 12):
        mesh = cylinder(2.0, z=(1.0, 4.0), cells=(2, n, 1), cell=cell, inner=1.0)
        check_mesh(mesh)
        errors.append(abs(volume(mesh) / (9 * np.pi) - 1))
        assert set(mesh.surfaces) == {"inner", "round", "bottom", "top"}
        for name, radius in {"inner": 1.0, "round": 2.0}.items():
            assert np.linalg.norm(mesh.points[mesh.nodes_of(name), :2], axis=1) == pytest.approx(radius, rel=1e-14)
        assert len(np.unique(np.round(mesh.points, 9), axis=0)) == len(mesh.points)  # the seam is closed
    assert np.log2(errors[0] / errors[1]) == pytest.approx(4.0 if cell in QUADRATIC else 2.0, abs=0.3)


@pytest.mark.parametrize("cell", SOLID)
def test_solid_cylinder_converges(cell: str) -> None:
    errors = [abs(volume(cylinder(1.0, cells=(n, 1), cell=cell)) / np.pi - 1) for n in (4, 8)]
    assert np.log2(errors[0] / errors[1]) > (3.3 if cell in QUADRATIC else 1.7)


@pytest.mark.parametrize("cell", PLANE)
@pytest.mark.parametrize("flat", ["top", "bottom"])
def test_half_disc_stands_either_way_up(cell: str, flat: str) -> None:
    mesh = half_disc(2.0, centre=(1.0, 3.0), cells=4, cell=cell, flat=flat)
    check_mesh(mesh)
    assert volume(mesh) == pytest.approx(2 * np.pi, rel=1e-5 if cell in QUADRATIC else 5e-3)
    assert mesh.points[mesh.nodes_of("flat"), 1] == pytest.approx(3.0)
    height = mesh.points[mesh.nodes_of("round"), 1]
    tip = {"top": height.min(), "bottom": height.max()}[flat]
    assert tip == pytest.approx(1.0 if flat == "top" else 5.0)
    assert np.linalg.norm(mesh.points[mesh.nodes_of("round")] - [1.0, 3.0], axis=1) == pytest.approx(2.0, rel=1e-14)


@pytest.mark.parametrize("cell", SOLID)
def test_octant_lies_on_the_sphere_and_its_planes(cell: str) -> None:
    mesh = sphere_octant(2.0, cells=3, cell=cell, fine=0.5)
    check_mesh(mesh)
    assert volume(mesh) == pytest.approx(8 * np.pi / 6, rel=1e-4 if cell in QUADRATIC else 2e-2)
    assert np.linalg.norm(mesh.points[mesh.nodes_of("round")], axis=1) == pytest.approx(2.0, rel=1e-14)
    for axis, name in enumerate(["x0", "y0", "z0"]):
        assert mesh.points[mesh.nodes_of(name), axis] == pytest.approx(0.0, abs=1e-14)
    assert mesh.points[:, 2].max() <= 1e-14
    assert mesh.points[:, :2].min() >= -1e-14


@pytest.mark.parametrize("made", [disc, half_disc, sphere_octant])
def test_cells_at_the_contact_are_nearly_square(made: Callable[..., Mesh]) -> None:
    """``cells`` cells along ``fine``, those at the surface as deep as wide."""
    mesh = made(1.0, fine=0.125, cells=5)
    block = mesh.blocks[0]
    corners = mesh.points[block.nodes[:, : 2**mesh.dim]]
    pole = np.zeros(mesh.dim)
    pole[-1] = -1.0
    near = np.linalg.norm(corners.mean(axis=1) - pole, axis=1) < 0.1
    near &= np.linalg.norm(corners, axis=2).max(axis=1) > 1.0 - 1e-9
    extent = np.ptp(corners[near], axis=1)
    assert (extent.max(axis=1) / extent.min(axis=1)).max() < 1.35
    assert np.median(extent) == pytest.approx(0.025, rel=0.1)


@pytest.mark.parametrize(
    ("kind", "arguments", "message"),
    [
        (cylinder, {"inner": 1.0}, "inner: expected less than the radius 1"),
        (cylinder, {"inner": 0.5}, r"expected 3 whole numbers \(wall, around, along\)"),
        (cylinder, {"inner": 0.5, "cells": (1, 3, 1)}, "4 or more around"),
        (cylinder, {"inner": -0.5}, "inner: expected a number > 0"),
        (half_disc, {"flat": "left"}, "flat: expected one of top, bottom"),
        (half_disc, {"fine": 2.0}, "fine: expected a length"),
        (half_disc, {"cells": 0}, "cells: expected a whole number from 1"),
        (half_disc, {"growth": 1.0}, "growth: expected a number > 1"),
        (sphere_octant, {"radius": -1.0}, "radius: expected a number > 0"),
        (sphere_octant, {"cell": "quad8"}, "cell: expected one of"),
    ],
)
def test_arguments_out_of_range(kind: Callable[..., Mesh], arguments: dict[str, object], message: str) -> None:
    with pytest.raises(InputError, match=message):
        kind(**arguments)


FINE = (0.01, 0.1, 0.3, 0.5, 0.69, 0.707)
GROWTHS = (1.05, 1.3, 3.0)


@pytest.mark.parametrize("cell", [*PLANE, *SOLID])
def test_no_generator_makes_cells_that_the_check_refuses(cell: str) -> None:
    """Over a grid of settings; none is refused by the generator either, but rings of too few cells around."""
    meshes: list[Mesh] = []
    if cell in PLANE:
        for made, count, growth, fine in product((disc, half_disc, quarter_disc), (1, 2, 5), GROWTHS, FINE):
            meshes.append(made(fine=fine, cells=count, growth=growth, cell=cell))
        for radii, angles, count in product(
            ((0.01, 1), (0.5, 1), (0.99, 1)), ((10, 10.1), (0, 140), (-30, 320)), (3, 40)
        ):
            meshes.append(ring(radii, angles, cells=(2, count), cell=cell))
        meshes.append(rectangle(y=(0, 1e-3), cells=(3, 2), cell=cell, fine={"x": (0.2, 0.3)}, growth=1.1))
    else:
        for count, growth, fine in product((1, 2, 5), GROWTHS, (0.1, 0.3, 0.5, 0.69, 0.707)):
            if count / fine < 20 or growth > 1.05:
                meshes.append(sphere_octant(fine=fine, cells=count, growth=growth, cell=cell))
        meshes += [cylinder(z=(0, z), cells=(n, 2), cell=cell) for n in (1, 2, 3, 4, 7, 12) for z in (0.01, 3.0)]
        for inner, wall, around in product((0.01, 0.5, 0.99), (1, 3), (4, 5, 17)):
            meshes.append(cylinder(cells=(wall, around, 1), cell=cell, inner=inner))
        meshes.append(box(z=(0, 1e-3), cells=(3, 2, 2), cell=cell, fine={"x": (0.2, 0.3)}, growth=1.1))
    for mesh in meshes:
        check_mesh(mesh)


def test_nodes_inside_curved_cells_follow_their_edges() -> None:
    """Without the one in the middle, a cell has the same shape: its node is where the eight others lead."""
    nine, eight = (half_disc(cells=2, cell=cell) for cell in ("quad9", "quad8"))
    assert volume(nine) == pytest.approx(volume(eight), rel=1e-14)
    nodes = nine.blocks[0].nodes
    led = nine.points[nodes[:, 4:8]].sum(axis=1) / 2 - nine.points[nodes[:, :4]].sum(axis=1) / 4
    assert nine.points[nodes[:, 8]] == pytest.approx(led, abs=1e-15)


def test_ring_of_too_few_cells() -> None:
    with pytest.raises(InputError, match="one spans 180 degrees; give more around"):
        ring(angles=(0, 180), cells=(1, 1))

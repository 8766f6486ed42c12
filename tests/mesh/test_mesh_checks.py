"""Unsound meshes are refused, with the names of what is wrong."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace

import numpy as np
import pytest

from abut.errors import InputError
from abut.mesh.check import check_mesh
from abut.mesh.make import box, join, rectangle
from abut.mesh.mesh import CellBlock, Mesh

Change = Callable[[Mesh], Mesh]


def _point_out_of_range(mesh: Mesh) -> Mesh:
    nodes = mesh.blocks[0].nodes.copy()
    nodes[3, 2] = 99
    return replace(mesh, blocks=(CellBlock(mesh.blocks[0].kind, nodes),))


def _surface(*rows: tuple[int, int]) -> Change:
    return lambda mesh: replace(mesh, surfaces={"own": np.array(rows, dtype=np.int64).reshape(-1, 2)})


def _bodies(**cells: list[int]) -> Change:
    return lambda mesh: replace(mesh, bodies={n: np.array(c, dtype=np.int64) for n, c in cells.items()})


def _doubled(mesh: Mesh) -> Mesh:
    block = mesh.blocks[0]
    bodies = {"a": np.arange(4), "b": np.array([4])}
    return Mesh(mesh.points, (block, CellBlock(block.kind, block.nodes[:1])), bodies)


CASES: dict[str, tuple[Change, str]] = {
    "point": (_point_out_of_range, r"cells 3 use points that do not exist \(there are 9"),
    "dimension": (lambda m: replace(m, points=np.c_[m.points, m.points[:, 0]]), "quad4 cells do not fit"),
    "nodes": (lambda m: replace(m, blocks=(CellBlock("quad8", m.blocks[0].nodes),)), "need 8 nodes"),
    "node set": (lambda m: replace(m, node_sets={"n": np.array([9])}), "node set 'n' has points that do not exist"),
    "no cells": (_bodies(a=[0, 1, 2, 3], b=[]), "body 'b' has no cells"),
    "body cells": (_bodies(a=[0, 1, 2, 3, 4]), "body 'a' has cells that do not exist"),
    "two bodies": (_bodies(a=[0, 1, 2], b=[2, 3]), "cells 2 stand more than once in bodies 'a', 'b'"),
    "no body": (_bodies(a=[0, 1, 2]), "cells 3 belong to no body"),
    "twice": (_doubled, "cells 0 of 'a', 'b' stand in the mesh twice"),
    "empty": (_surface(), "surface 'own' has no facets"),
    "cell": (_surface((4, 0)), "surface 'own' has facets of cells that do not exist"),
    "facet": (_surface((0, 4)), "surface 'own' has facets of cells that do not exist"),
    "doubled facet": (_surface((0, 0), (0, 0)), "surface 'own' lists facets of cells 0 twice"),
    "inner": (_surface((0, 3), (0, 1)), "surface 'own' lies inside body 'body': 1 of its facets"),
}


@pytest.mark.parametrize("case", CASES)
def test_unsound_meshes_are_refused(case: str) -> None:
    change, message = CASES[case]
    mesh = rectangle(cells=(2, 2), cell="quad4")
    check_mesh(mesh)
    with pytest.raises(InputError, match=message):
        check_mesh(change(mesh))


def test_a_surface_between_glued_bodies_names_both() -> None:
    mesh = box(cells=(2, 1, 1), cell="hex20")
    glued = replace(mesh, bodies={"a": np.array([0]), "b": np.array([1])})
    check_mesh(glued)  # gluing is allowed, contact there is not
    with pytest.raises(InputError, match="'own' lies between the bodies 'a', 'b', which share the nodes of 1"):
        check_mesh(_surface((0, 1))(glued))


@pytest.mark.parametrize("scale", [1e-9, 1.0, 1e150])
def test_the_check_of_shapes_has_no_unit(scale: float) -> None:
    mesh = rectangle(cells=(2, 2), cell="quad8")
    check_mesh(replace(mesh, points=scale * mesh.points))
    with pytest.raises(InputError, match="inverted"):
        check_mesh(replace(mesh, points=scale * mesh.points * [-1.0, 1.0]))


def test_cells_of_a_body() -> None:
    mesh = join({"a": rectangle(cells=(2, 1), cell="quad4"), "b": rectangle(x=(2, 3), cells=(1, 1), cell="tri3")})
    ((kind, nodes, cells),) = mesh.cells_of("b")
    assert (kind, nodes.shape, cells.tolist()) == ("tri3", (2, 3), [2, 3])
    assert mesh.points[nodes][..., 0].min() == 2.0
    with pytest.raises(InputError, match="known: a, b"):
        mesh.cells_of("c")


def test_join_keeps_several_bodies_and_refuses_mixed_dimensions() -> None:
    pair = join({"a": rectangle(cells=(1, 1)), "b": rectangle(x=(2, 3), cells=(1, 1))})
    both = join({"p": pair, "q": rectangle(x=(4, 5), cells=(1, 1))})
    assert {name: cells.tolist() for name, cells in both.bodies.items()} == {"p.a": [0], "p.b": [1], "q": [2]}
    assert "p.a.left" in both.surfaces
    with pytest.raises(InputError, match="all plane or all solid"):
        join({"a": rectangle(), "b": box()})
    with pytest.raises(InputError, match="join"):
        join({})

"""Which functions at a sharp corner see the target edge-on."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from abut.contact.corners import at_corners, edge_on
from abut.contact.coupling import CouplingOptions, couple
from abut.contact.pressure_space import PressureSpace
from abut.types import Array
from models.corners import landing, peg
from models.sliding import finite


def seen(angle: float, opening: float = 90.0, near: float = 0.2, cell: str = "quad4") -> tuple[Array, PressureSpace]:
    """Of the faces at the lowest corner of the peg, with its sides ``opening`` degrees apart and its bottom at an angle to
    the plate: what ``edge_on`` says, in the order of their cosines."""
    pair = finite(peg(cell)).pairs[0]
    contactor, target = pair.contactor, pair.target
    corner = contactor.node_ids[np.argmin(contactor.points[contactor.node_ids, 1])]
    a, b, was = np.deg2rad(angle), np.deg2rad(angle + opening), np.deg2rad(20.0)
    way = contactor.points - contactor.points[corner]
    along = way @ np.array([[np.cos(was), -np.sin(was)], [np.sin(was), np.cos(was)]])
    points = contactor.points.copy()
    mine = contactor.node_ids
    points[mine] = along[mine, :1] * [np.cos(a), np.sin(a)] + along[mine, 1:] * [np.cos(b), np.sin(b)] + [0.013, 0.01]
    contactor, target = replace(contactor, points=points), replace(target, points=points)
    coupling = couple(contactor, target, pair.coupling.degree, CouplingOptions(reach=3.0, keep_points=True))
    found = edge_on(pair.space, target, coupling, near)
    assert not found[pair.space.node != corner].any()
    return found[pair.space.node == corner], pair.space


@pytest.mark.parametrize("cell", ["quad4", "quad8"])
@pytest.mark.parametrize(
    ("angle", "opening", "expected"),
    [
        (10.0, 90.0, 1),  # cosines 0.98 and 0.17
        (17.0, 90.0, 1),  # 0.96 and 0.29
        (20.0, 90.0, 0),  # 0.94 and 0.34
        (45.0, 90.0, 0),
        (73.0, 90.0, 1),
        (78.0, 24.0, 0),  # a sharp wedge, whose faces are all that sees the plate: 0.21 and 0.21
    ],
)
def test_a_face_is_left_out(cell: str, angle: float, opening: float, expected: int) -> None:
    """Where its cosine to the plate is less than a third of the other's."""
    found, _ = seen(angle, opening, cell=cell)
    assert len(found) == 2
    assert found.sum() == expected


def test_far_from_the_target_none_is() -> None:
    found, space = seen(10.0, near=1e-3)
    assert not found.any()
    assert at_corners(space).sum() == 4


def test_corners_of_a_cube() -> None:
    """Bottom and sides: three functions at the four lower corners, two in the middle of the edges between them and of those
    that rise from them, whose upper ends a support holds."""
    space = finite(landing("hex8", 2, False)).pairs[0].space
    count = np.bincount(space.node[at_corners(space)])
    assert (count == 3).sum() == 4
    assert (count == 2).sum() == 4 + 4
    assert (count > 3).sum() == 0

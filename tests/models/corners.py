"""Contact that hangs on one node or a sharp corner, at large displacements."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

import abut
from abut.mesh.make import box, join, rectangle
from models.rolling import round_
from models.sliding import bent

STEEL, WEIGHT = abut.LinearElastic(210e3, 0.3), 8e-5  # per volume of the pin
TREAD = tuple(f"pin.{side}" for side in ("left", "bottom", "right", "top"))
SOFT, RUBBER = abut.LinearElastic(2000.0, 0.35), abut.NeoHooke(10.0, 0.4)
CLEARANCE = 0.01  # of the pin in its cradle, over its radius


def pin_in_cradle(friction: float, above: float = 0.0) -> abut.Model:
    """A steel pin of radius 1 lies under its weight in a cradle a little wider: the lowest of its nodes on the lowest of
    the cradle's, which are at the same angles. Nothing else holds it. above: the gap there at the outset."""

    def cradle(points: NDArray[np.float64]) -> NDArray[np.float64]:
        sine, radius = points[:, 0] / np.sqrt(2.0), 1.0 + CLEARANCE + 0.5 * (1.0 - points[:, 1])
        return np.column_stack([radius * sine, CLEARANCE - radius * np.sqrt(1.0 - sine**2)])

    mesh = join({
        "pin": bent(rectangle((-1.0, 1.0), (-1.0, 1.0), (10, 10), "quad4"), round_),
        "cradle": bent(rectangle((-1.0, 1.0), (0.0, 1.0), (10, 3), "quad4"), cradle),
    })  # fmt: skip
    points = mesh.points.copy()
    points[mesh.nodes_of("pin"), 1] += above
    return abut.Model(
        replace(mesh, points=points), [abut.Solid("pin", STEEL), abut.Solid("cradle", STEEL)],
        [abut.Support("cradle.bottom", x=0.0, y=0.0)], [abut.BodyForce((0.0, -WEIGHT), on="pin")],
        contacts=[abut.Contact(contactor=TREAD, target="cradle.top", friction=friction, geometry="faceted")],
        plane="strain", kinematics="finite",
    )  # fmt: skip


def peg(cell: str, plate_is_contactor: bool = False) -> abut.Model:
    """A square peg, held aslant at its top, is pressed on a plate with its corner and drawn along it."""
    angle = np.deg2rad(20.0)
    turn = np.array([[np.cos(angle), -np.sin(angle)], [np.sin(angle), np.cos(angle)]])
    square = rectangle((0.0, 1.0), (0.0, 1.5), (6, 9), cell)
    points = square.points @ turn.T
    mesh = join({
        "plate": rectangle((-1.0, 4.0), (-1.0, 0.0), (31, 6), cell),
        "peg": replace(square, points=points - points.min(axis=0) + [0.0, 0.01]),
    })  # fmt: skip
    press, slide = abut.Amplitude(((0, 0), (0.3, 1), (1, 1))), abut.Amplitude(((0, 0), (0.3, 0), (1, 1)))
    sides = (("peg.bottom", "peg.left", "peg.right"), "plate.top")
    return abut.Model(
        mesh, [abut.Solid("plate", SOFT), abut.Solid("peg", SOFT)],
        [abut.Support("plate.bottom", x=0.0, y=0.0), abut.Support("peg.top", y=-0.08, amplitude=press),
         abut.Support("peg.top", x=1.5, amplitude=slide)],
        contacts=[abut.Contact(contactor=sides[plate_is_contactor], target=sides[not plate_is_contactor], friction=0.3)],
        plane="strain", kinematics="finite",
    )  # fmt: skip


def wedge(cell: str, aside: float = 0.0) -> abut.Model:
    """A steel wedge with a narrow edge is pushed into a round rubber block, beside its crown."""
    way = rectangle((-1.0, 1.0), (0.0, 1.0), (4, 8), cell)
    x, y = way.points.T
    sharp = replace(way, points=np.column_stack([x * (0.15 + 0.85 * y) + aside, 0.05 + 2.0 * y]))
    flat = rectangle((-1.0, 1.0), (0.0, 1.0), (24, 10), cell)
    x, y = flat.points.T
    angle = x * np.pi / 3.0
    arc = 2.0 * np.column_stack([np.sin(angle), np.cos(angle) - 1.0])
    base = np.column_stack([2.0 * np.sin(np.pi / 3.0) * x, np.full(len(x), -2.0)])
    round_ = replace(flat, points=(1.0 - y)[:, None] * base + y[:, None] * arc)
    return abut.Model(
        join({"block": round_, "wedge": sharp}),
        [abut.Solid("block", RUBBER), abut.Solid("wedge", STEEL)],
        [abut.Support("block.bottom", x=0.0, y=0.0), abut.Support("wedge.top", x=0.0, y=-0.6)],
        contacts=[abut.Contact(contactor=("wedge.bottom", "wedge.left", "wedge.right"), target="block.top", friction=0.2)],
        plane="strain", kinematics="finite",
    )  # fmt: skip


def landing(cell: str, cells: int, on_corner: bool, tilt: float = 25.0) -> abut.Model:
    """A cube that lands on a plate with an edge or a corner, deep enough for whole facets to touch, and is drawn along.
    tilt: of its bottom, in degrees."""
    a, b = np.deg2rad(tilt), np.deg2rad(20.0)
    turn = np.array([[np.cos(a), 0.0, np.sin(a)], [0.0, 1.0, 0.0], [-np.sin(a), 0.0, np.cos(a)]])
    if on_corner:
        turn = turn @ np.array([[1.0, 0.0, 0.0], [0.0, np.cos(b), -np.sin(b)], [0.0, np.sin(b), np.cos(b)]])
    cube = box((0, 1), (0, 1), (0, 1), (cells, cells, cells), cell)
    points = (cube.points - 0.5) @ turn.T
    mesh = join({
        "plate": box((-1.2, 1.2), (-1.2, 1.2), (-0.6, 0), (8, 8, 2), cell),
        "cube": replace(cube, points=points - [0.0, 0.0, points[:, 2].min() - 0.02]),
    })  # fmt: skip
    press, slide = abut.Amplitude(((0, 0), (0.5, 1), (1, 1))), abut.Amplitude(((0, 0), (0.5, 0), (1, 1)))
    sides = tuple(f"cube.{name}" for name in ("bottom", "left", "right", "front", "back"))
    return abut.Model(
        mesh, [abut.Solid("plate", RUBBER), abut.Solid("cube", RUBBER)],
        [abut.Support("plate.bottom", x=0.0, y=0.0, z=0.0), abut.Support("cube.top", z=-0.4, amplitude=press),
         abut.Support("cube.top", x=0.4, y=0.0, amplitude=slide)],
        contacts=[abut.Contact(contactor=sides, target="plate.top", friction=0.3)], kinematics="finite",
    )  # fmt: skip

"""Joints between reference points: a lever with a weight, a slider-crank, a universal joint, beams that meet in a hinge."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace
from typing import Any

import numpy as np

from abut.benchmarks.record import Benchmark, Reference
from abut.materials.elastic import LinearElastic
from abut.mesh.make import box, join, rectangle
from abut.mesh.mesh import Mesh
from abut.model import Connector, Coupling, Force, Frequencies, Model, Rigid, Solid, SolveOptions, Support
from abut.solution import Solution
from abut.types import Array

YOUNG = 1000.0
LENGTH, WEIGHT, SPRING = 10.0, 12.0, 100.0  # of the lever
CRANK, ROD, PUSH, ANGLE = 3.0, 10.0, 5.0, 2.0
BEND, TURN = 0.5, 1.2  # between the shafts; of the driving one
DENSITY = 2e-3  # of the lever
LIMIT = 0.1  # of the hinge between two beams
RIGID = "rigid bodies: conditions are met to 1e-9 of their lengths"
HALF = 20.0  # length of each beam, of the height 1


def bars(dim: int, ends: Mapping[str, tuple[Sequence[float], Sequence[float]]]) -> Mesh:
    """Bars of the width 1 between two points each, and a block far away: a model needs a body that deforms."""
    parts = {"block": _box(dim, 1.0, (1, 1, 1), np.eye(dim), np.full(dim, -60.0))}
    for name, (start, end) in ends.items():
        along = np.subtract(end, start)
        length = float(np.linalg.norm(along))
        one = along / length
        across = [-one[1], one[0]] if dim == 2 else np.cross(one, np.eye(3)[np.abs(one).argmin()])
        frame = [one, np.divide(across, np.linalg.norm(across))]
        frame += [np.cross(frame[0], frame[1])] if dim == 3 else []
        parts[name] = _box(dim, length, (4, 2, 2), np.array(frame), np.array(start))
    return join(parts)


def _box(dim: int, length: float, cells: tuple[int, int, int], frame: Array, start: Array) -> Mesh:
    ranges = (0.0, length), (-0.5, 0.5), (-0.5, 0.5)
    made = rectangle(*ranges[:2], cells[:2]) if dim == 2 else box(*ranges, cells)
    return replace(made, points=made.points @ frame + start)


def mechanism(
    mesh: Mesh, connectors: Sequence[Connector], given: Mapping[str, Any] | None = None, **more: Any
) -> Model:
    """Rigid bars with connectors at large turns, the block held. given: keys of single bars."""
    names = [name for name in mesh.bodies if name != "block"]
    return Model(
        mesh,
        [Solid("block", LinearElastic(YOUNG, 0.3))],
        [Support("block.bottom", x=0.0, y=0.0, z=0.0 if mesh.dim == 3 else None)],
        rigid=[Rigid(name, **(given or {}).get(name, {})) for name in names],
        connectors=connectors,
        plane="strain" if mesh.dim == 2 else None,
        kinematics="finite",
        **more,
    )


def _lever(level: int) -> Model:
    """A lever on a hinge with a torsion spring, and a weight at its end."""
    end = {"lever": {"reference": (LENGTH, 0.0)}}
    joint = Connector("hinge", "hinge", "lever", at=(0.0, 0.0), stiffness=SPRING)
    mesh = bars(2, {"lever": ((0.0, 0.0), (LENGTH, 0.0))})
    return mechanism(mesh, [joint], end, loads=[Force("lever", (0.0, -WEIGHT))])


def _turn_of_the_lever() -> float:
    """k t = W L cos t by bisection: the weight turns it down by t."""
    low, high = 0.0, 0.5 * np.pi
    for _ in range(100):
        middle = 0.5 * (low + high)
        low, high = (middle, high) if SPRING * middle < WEIGHT * LENGTH * np.cos(middle) else (low, middle)
    return low


def _of_lever(solution: Solution) -> dict[str, float]:
    step = solution.steps[-1]
    hinge = step.connectors["hinge"]
    return {
        "turn": -hinge.motion["turn"],
        "force of the hinge": float(hinge.force[1]),
        "way of the weight": float(step.rigid["lever"].displacement[1]),
    }


def slider_crank(turn: float = ANGLE) -> Model:
    """The crank is turned, the eye of its rod slides along x against a force."""
    mesh = bars(2, {"crank": ((0.0, 0.0), (CRANK, 0.0)), "rod": ((CRANK, 0.0), (CRANK + ROD, 0.0))})
    joints = [
        Connector("axle", "hinge", "crank", at=(0.0, 0.0), motion=turn),
        Connector("pin", "hinge", "rod", "crank", at=(CRANK, 0.0)),
        Connector("eye", "slot", "rod", at=(CRANK + ROD, 0.0), axis=(1.0, 0.0), load=-PUSH),
    ]
    return mechanism(mesh, joints, solve=SolveOptions(steps=8))


def travel(turn: Any) -> Any:
    """Of the eye, and its slope, over the turn of the crank."""
    s, c = CRANK * np.sin(turn), CRANK * np.cos(turn)
    along = np.sqrt(ROD**2 - s**2)
    return c + along - CRANK - ROD, -s - s * c / along


def _of_crank(solution: Solution) -> dict[str, float]:
    joints = solution.steps[-1].connectors
    drive = joints["axle"].drive
    assert drive is not None
    return {"travel of the eye": joints["eye"].motion["travel"], "moment of the crank": drive}


def _shafts(level: int) -> Model:
    """The driving shaft along z, the driven one at an angle, in a bearing at its end."""
    axis = np.array([0.0, np.sin(BEND), np.cos(BEND)])
    end = tuple(8.0 * axis)
    joints = [
        Connector(
            "cross", "universal", "out", "in", at=(0, 0, 0), axis=(1, 0, 0), axis2=tuple(np.cross(axis, [1, 0, 0]))
        ),
        Connector("bearing", "slot", "out", at=end, axis=tuple(axis)),
    ]
    turned = {"in": {"reference": (0, 0, 0), "x": 0, "y": 0, "z": 0, "rx": 0, "ry": 0, "rz": TURN}}
    return mechanism(bars(3, {"in": ((0, 0, -8), (0, 0, 0)), "out": ((0, 0, 0), end)}), joints, turned)


def _of_shafts(solution: Solution) -> dict[str, float]:
    return {"turn of the driven shaft": float(np.linalg.norm(solution.steps[-1].rigid["out"].rotation))}


def _beams(level: int) -> Model:
    """Two beams held at their far ends meet in a hinge, which stops at an angle; a force there."""
    n = 2**level
    parts = {
        "left": rectangle((0.0, HALF), (-0.5, 0.5), (20 * n, 2 * n), "quad8"),
        "right": rectangle((HALF, 2.0 * HALF), (-0.5, 0.5), (20 * n, 2 * n), "quad8"),
    }
    joint = Connector("hinge", "hinge", "right end", "left end", limits=(-LIMIT, LIMIT))
    return Model(
        join(parts),
        [Solid(name, LinearElastic(YOUNG, 0.0)) for name in parts],
        [Support("left.left", x=0, y=0), Support("right.right", x=0, y=0)],
        [Force("left end", (0.0, FORCE))],
        couplings=[Coupling("left end", "left.right"), Coupling("right end", "right.left")],
        connectors=[joint],
        plane="stress",
    )


INERTIA = 1.0 / 12.0
FIRST, THEN = 6.0 * YOUNG * INERTIA / HALF**3, 24.0 * YOUNG * INERTIA / HALF**3  # two cantilevers; a clamped beam
REACHED = LIMIT * HALF / 3.0  # each end turns by 3 w / 2 L
FORCE = FIRST * REACHED + THEN * 0.5


def _of_beams(solution: Solution) -> dict[str, float]:
    step = solution.steps[-1]
    hinge = step.connectors["hinge"]
    return {
        "deflection": float(step.rigid["left end"].displacement[1]),
        "turn of the hinge": abs(hinge.motion["turn"]),
        "moment of the stop": abs(hinge.stop or 0.0),
    }


def _swinging(level: int) -> Model:
    """The lever with a mass of its own, as it hangs on its spring under a dead force."""
    model = _lever(level)
    return replace(
        model,
        solids=[Solid("block", LinearElastic(YOUNG, 0.3, density=DENSITY))],
        rigid=[replace(body, density=DENSITY) for body in model.rigid],
        modes=[Frequencies(1)],
    )


LEVER = _turn_of_the_lever()
HEAVY = DENSITY * LENGTH * (LENGTH**2 / 3.0 + 1.0 / 12.0)  # of the lever, about the hinge
SWINGS = float(np.sqrt((SPRING + WEIGHT * LENGTH * np.sin(LEVER)) / HEAVY) / (2.0 * np.pi))
SLENDER = "shear of beams 20 times as long as high"
BENCHMARKS = (
    Benchmark(
        "hinged-lever", "lever on a hinge with a torsion spring, a weight at its end, far down", _lever, _of_lever,
        {
            "turn": Reference(LEVER, 1e-8, "k t = W L cos t", RIGID),
            "force of the hinge": Reference(WEIGHT, 1e-8, "the weight", RIGID),
            "way of the weight": Reference(-LENGTH * np.sin(LEVER), 1e-8, "L sin t", RIGID),
        },
    ),
    Benchmark(
        "swinging-lever", "its frequency there, with a mass of its own", _swinging,
        lambda solution: {"frequency": float(solution.modes[0].values[0])},
        {"frequency": Reference(SWINGS, 1e-7, "((k + W L sin t) / J)^(1/2) / 2 pi", RIGID)},
    ),
    Benchmark(
        "slider-crank", "crank, rod, and an eye that slides against a force", lambda level: slider_crank(), _of_crank,
        {
            "travel of the eye": Reference(travel(ANGLE)[0], 1e-8, "r cos a + (l^2 - r^2 sin^2 a)^(1/2) - r - l", RIGID),
            "moment of the crank": Reference(PUSH * travel(ANGLE)[1], 1e-8, "virtual work, F dx/da", RIGID),
        },
    ),
    Benchmark(
        "universal-joint", "shafts at an angle joined by a cross", _shafts, _of_shafts,
        {
            "turn of the driven shaft": Reference(
                float(np.arctan(np.tan(TURN) * np.cos(BEND))), 1e-8, "tan b = tan a cos phi", RIGID
            )
        },
    ),
    Benchmark(
        "hinged-beams", "two beams that meet in a hinge, which stops at an angle and makes one beam of them", _beams,
        _of_beams,
        {
            "deflection": Reference(REACHED + 0.5, 1e-2, "beams: 6 E I / L^3, then 24 E I / L^3", SLENDER),
            "turn of the hinge": Reference(LIMIT, 1e-9, "its limit", "a condition"),
            "moment of the stop": Reference(
                6.0 * YOUNG * INERTIA * 0.5 / HALF**2, 1e-6, "middle of a clamped beam under the rest of the force, F L / 4",
                "statics; shear turns no end",
            ),
        },
    ),
)  # fmt: skip

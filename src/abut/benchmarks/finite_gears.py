"""Large sliding: two involute gears turned through two teeth; torques and force against statics."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from abut.benchmarks.record import Benchmark, Reference
from abut.materials.elastic import LinearElastic
from abut.mesh.cell_block import CellBlock
from abut.mesh.make import join, rectangle
from abut.mesh.mesh import Mesh
from abut.model import Amplitude, Contact, Model, Rotation, Solid
from abut.solution import Solution

MODULE, SLOPE, TEETH = 4.0, np.radians(20.0), (20, 30)  # mm; pressure angle; of pinion and wheel
SECTOR = 5  # teeth of each gear that are in the model
PLAY, RELIEF, FILLET = 0.1, 0.06, 1.2  # between the flanks that do not touch; at the tip, over a module; at the root
CENTRES = 0.5 * MODULE * sum(TEETH)
BASE = tuple(0.5 * MODULE * n * np.cos(SLOPE) for n in TEETH)  # radii
WIND = 0.2 / BASE[1]  # radians that the wheel is turned against the pinion
LOADED = 0.1  # time at which it has been turned


def _half_angle(radius: NDArray[np.float64], teeth: int, play: float = PLAY) -> NDArray[np.float64]:
    """Of a tooth at each radius: involute above the base circle, radial below, with fillet and tip relief."""
    pitch, base = 0.5 * MODULE * teeth, 0.5 * MODULE * teeth * np.cos(SLOPE)
    turn = np.arccos(np.minimum(base / radius, 1.0))
    half = 0.5 * np.pi / teeth - 0.25 * play / pitch + np.tan(SLOPE) - SLOPE - (np.tan(turn) - turn)
    above = np.maximum(radius - pitch, 0.0) / MODULE  # 1 at the tip
    below = np.maximum(pitch - 1.25 * MODULE + FILLET - radius, 0.0)
    return half - (RELIEF * above**3 - 0.5 * below**2 / FILLET) / radius


def gear(teeth: int, level: int, both: bool = False, play: float = PLAY, cell: str = "quad8") -> Mesh:
    """A sector about the origin with its middle tooth along x. Surfaces: hub, flanks (counterclockwise ones, or both). play:
    between flanks, of the two gears together, along the pitch circle."""
    pitch = 0.5 * MODULE * teeth
    root, tip, hub = pitch - 1.25 * MODULE, pitch + MODULE, pitch - 4.0 * MODULE
    up, across, gap, rim = 12 * 2**level, 4 * 2**level, 2 * 2**level, 2 * 2**level
    tooth = rectangle((-1.0, 1.0), (0.0, 1.0), (across, up), cell)
    r = root + (tip - root) * tooth.points[:, 1]
    tooth = _polar(tooth, r, -tooth.points[:, 0] * _half_angle(r, teeth, play))
    foot = float(_half_angle(np.array([root]), teeth, play)[0])
    below = rectangle((-foot, foot), (hub, root), (across, rim), cell)
    valley = rectangle((foot - 2.0 * np.pi / teeth, -foot), (hub, root), (gap, rim), cell)
    parts: dict[str, Mesh] = {}
    for i in range(SECTOR):
        turn = 2.0 * np.pi / teeth * (i - SECTOR // 2)
        parts[f"tooth{i}"] = placed(tooth, turn)
        for name, part in (("below", below), ("valley", valley)):
            parts[f"{name}{i}"] = _polar(part, part.points[:, 1], turn - part.points[:, 0])
    mesh = _merged(join(parts))
    sides = ("left", "right") if both else ("left",)
    flanks = np.concatenate([mesh.surfaces[f"tooth{i}.{side}"] for i in range(SECTOR) for side in sides])
    bottoms = [rows for name, rows in mesh.surfaces.items() if name.endswith(".bottom") and "tooth" not in name]
    cells = np.arange(mesh.n_cells)
    return replace(mesh, bodies={"gear": cells}, surfaces={"flanks": flanks, "hub": np.concatenate(bottoms)})


def _polar(mesh: Mesh, radius: NDArray[np.float64], angle: NDArray[np.float64]) -> Mesh:
    return replace(mesh, points=np.column_stack([radius * np.cos(angle), radius * np.sin(angle)]))


def placed(mesh: Mesh, angle: float, centre: float = 0.0) -> Mesh:
    """About the origin, and then moved along x to ``centre``."""
    c, s = np.cos(angle), np.sin(angle)
    return replace(mesh, points=mesh.points @ np.array([[c, s], [-s, c]]) + np.array([centre, 0.0]))


def _merged(mesh: Mesh) -> Mesh:
    """Points that coincide become one."""
    _, first, number = np.unique(np.round(mesh.points, 8), axis=0, return_index=True, return_inverse=True)
    blocks = tuple(CellBlock(block.kind, number.ravel()[block.nodes].astype(np.int32)) for block in mesh.blocks)
    return replace(mesh, points=mesh.points[first], blocks=blocks, node_sets={})


def _gears(level: int) -> Model:
    """The pinion turns counterclockwise by two teeth; the wheel goes along and is held back by ``WIND`` more."""
    turn = 4.0 * np.pi / TEETH[0]
    ratio = TEETH[0] / TEETH[1]
    touch = 0.5 * PLAY / (0.5 * MODULE * TEETH[1])  # so that driving flanks touch at the outset
    pinion = placed(gear(TEETH[0], level), -0.5 * turn)
    between = np.pi / TEETH[1]  # a tooth of the pinion on the line of centres meets a gap of the wheel
    wheel = placed(gear(TEETH[1], level), np.pi + between + 0.5 * turn * ratio + touch, CENTRES)
    history = Amplitude(((0.0, 0.0), (LOADED, -WIND / (turn * ratio)), (1.0, 1.0 - WIND / (turn * ratio))))
    plastic = LinearElastic(3000.0, 0.35)
    return Model(
        join({"pinion": pinion, "wheel": wheel}),
        [Solid("pinion", plastic), Solid("wheel", plastic)],
        rotations=[
            Rotation("pinion.hub", turn, (0.0, 0.0), amplitude=Amplitude(((0.0, 0.0), (LOADED, 0.0), (1.0, 1.0)))),
            Rotation("wheel.hub", -turn * ratio, (CENTRES, 0.0), amplitude=history),
        ],
        contacts=[Contact("pinion.flanks", "wheel.flanks")],
        plane="strain", kinematics="finite",
    )  # fmt: skip


def _statics(solution: Solution) -> Mapping[str, float]:
    """Largest deviations from theory over all steps under load."""
    arms, ratios = [], []
    for step in solution.steps:
        if step.factor < LOADED - 1e-9:
            continue
        force, moment = step.contacts[0].resultant.force, step.contacts[0].resultant.moment[0]
        other = -(moment - CENTRES * force[1])  # on the wheel about its own centre
        arms += [abs(moment) / np.linalg.norm(force) / BASE[0], abs(other) / np.linalg.norm(force) / BASE[1]]
        ratios.append(other / moment * TEETH[0] / TEETH[1])
    return {
        "torque over force and base radius": _worst(arms), "ratio of torques": _worst(ratios),
        "iterations": float(sum(len(step.iterations) for step in solution.steps)), "steps": float(len(solution.steps)),
    }  # fmt: skip


def _worst(values: list[float]) -> float:
    """The value that is farthest from one."""
    return float(max(values, key=lambda value: abs(value - 1.0)))


THEORY = "the common normal of involutes is tangent to both base circles"
EFFORT = "what it took when it was written, and half as much again"
BENCHMARKS = (
    Benchmark(
        "gears", "two involute gears turned through two teeth under load", _gears, _statics,
        {
            "torque over force and base radius": Reference(1.0, 0.03, THEORY, "teeth bend by up to 0.2 mm"),
            "ratio of torques": Reference(1.0, 0.03, THEORY, "the same"),
            "iterations": Reference(110.0, 1.0, EFFORT, "linear solutions"),
            "steps": Reference(18.0, 1.0, EFFORT, "load steps, found by abut"),
        },
    ),
)  # fmt: skip

"""Large sliding over sharp edges and sharp ends: blocks named whole that leave each other, and beams that press on beams."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray
from scipy.integrate import solve_ivp
from scipy.optimize import fsolve

from abut.analysis import solve
from abut.benchmarks.record import Benchmark, Reference
from abut.materials.hyperelastic import NeoHooke
from abut.mesh.make import join, rectangle
from abut.model import Amplitude, Contact, Model, Solid, SolveOptions, Support
from abut.solution import Solution

Array = NDArray[np.float64]
RUBBER = NeoHooke(young=100.0, poisson=0.3)
PRESSED = 0.2  # time from which on the block slides
PRESS = Amplitude(((0.0, 0.0), (PRESSED, 1.0), (1.0, 1.0)))
SLIDE = Amplitude(((0.0, 0.0), (PRESSED, 0.0), (1.0, 1.0)))
FACES = ("block.bottom", "ground.top")  # that touch while it is pressed
YOUNG, POISSON, PUSH = 1e4, 0.3, 4.0
REACH, TIP = 10.0, 6.0  # along x, of the lower beam from its clamp, to the upper one's end
ALIKE, BY_ITS_END = (
    1.25994,
    3.91682,
)  # as ``pressed_alike`` and ``pressed_by_its_end`` find; kept, since that takes a second


def over_edge(cell: str, contactor: str, friction: float) -> Model:
    """A block pressed on another one by an eighth of its height, and slid over its edge until it is off. Both are named
    whole: the block's rear side comes over the edge, too."""
    parts = {
        "ground": rectangle([0, 1.5], [0, 0.6], (10, 4), cell),
        "block": rectangle([0.3, 1.1], [0.6, 1.0], (5, 4), cell),
    }
    (target,) = parts.keys() - {contactor}
    return Model(
        join(parts),
        [Solid(name, RUBBER) for name in parts],
        [
            Support("ground.bottom", x=0, y=0), Support("block.top", y=-0.05, amplitude=PRESS),
            Support("block.top", x=1.5, amplitude=SLIDE),
        ],
        contacts=[Contact(contactor=contactor, target=target, friction=friction)],
        plane="strain", kinematics="finite",
    )  # fmt: skip


@dataclass(frozen=True)
class _Edge:
    """The whole way, and the first part of it with the faces that touch named."""

    whole: Solution
    faces: Solution


def _both(model: Model) -> _Edge:
    (contact,) = model.contacts
    faces = FACES if contact.contactor == "block" else FACES[::-1]
    named = replace(contact, contactor=faces[0], target=faces[1])
    return _Edge(solve(model), solve(replace(model, contacts=[named], solve=SolveOptions(times=(PRESSED,)))))


def _edge_measure(done: _Edge) -> Mapping[str, float]:
    forces = np.array([(step.reactions["block.top"], step.reactions["ground.bottom"]) for step in done.whole.steps])
    at = next(step for step in done.whole.steps if np.isclose(step.factor, PRESSED))
    down = at.reactions["block.top"][1]
    return {
        "pressing force": float(down / done.faces.steps[-1].reactions["block.top"][1]),
        "out of balance": float(np.abs(forces.sum(axis=1)).max() / abs(down)),
        "left at the end": float(np.abs(forces[-1]).max() / abs(down)),
    }


def _edge(cell: str, contactor: str, friction: float) -> Benchmark:
    statics = "statics: supports balance each other, and carry nothing where nothing touches"
    rough = "without friction" if friction == 0.0 else f"coefficient of friction {friction:g}"
    return Benchmark(
        f"over-edge-{cell}-{contactor}",
        f"a block slides over a sharp edge and off, {cell}, {rough}, contactor the whole {contactor}",
        lambda level: over_edge(cell, contactor, friction),
        _edge_measure,
        {
            "pressing force": Reference(
                1.0,
                1e-6 if friction == 0.0 else 1e-4,
                "the same with the faces that touch named alone",
                "what iterations leave" if friction == 0.0 else "friction depends on the load steps, which differ",
            ),
            "out of balance": Reference(0.0, 1e-7, statics, "what iterations leave"),
            "left at the end": Reference(0.0, 1e-7, statics, "what iterations leave"),
        },
        solve=_both,
    )


def beams(thickness: float, length: float, contactor: str, cell: str = "quad8") -> Model:
    """Two cantilevers that lie over each other with their ends, clamped at their far ends; the upper one's clamp goes down.
    thickness, length: of the upper one, whose end is at ``TIP``; the lower one is 0.5 thick and ``REACH`` long."""
    parts = {
        "lower": rectangle([0, REACH], [-0.5, 0], (40, 1), cell),
        "upper": rectangle([TIP, TIP + length], [0.0, thickness], (int(4 * length), 1), cell),
    }
    (target,) = parts.keys() - {contactor}
    return Model(
        join(parts),
        [Solid(name, NeoHooke(YOUNG, POISSON)) for name in parts],
        [Support("lower.left", x=0, y=0), Support("upper.right", x=0, y=-PUSH)],
        contacts=[Contact(contactor=contactor, target=target)],
        plane="strain", kinematics="finite",
    )  # fmt: skip


def cantilever(length: float, stiffness: float, force: Array, moment: float) -> tuple[Array, float]:
    """Where the end of a slender beam along x from the origin goes, (2,), and its slope: under a dead force (2,) and a
    moment there, by the elastica E I theta' = m, m' = -(cos theta, sin theta) x F."""

    def bent(root: float) -> tuple[Array, float, float]:
        def change(_: float, state: Array) -> list[float]:
            c, s = np.cos(state[2]), np.sin(state[2])
            return [c, s, state[3] / stiffness, -(c * force[1] - s * force[0])]

        end = solve_ivp(change, (0.0, length), [0.0, 0.0, 0.0, root], rtol=1e-9, atol=1e-12).y[:, -1]
        return end[:2], float(end[2]), float(end[3])

    (root,) = fsolve(lambda m: bent(float(m[0]))[2] - moment, [force[1] * length + moment], xtol=1e-12)
    place, slope, _ = bent(float(root))
    return place, slope


def _stiffness(thickness: float) -> float:
    return YOUNG / (1.0 - POISSON**2) * thickness**3 / 12.0


def pressed_alike() -> float:
    """Force of two equal beams 0.5 thick whose clamps are 16 apart: alike turned by 180 degrees, they touch half way,
    square to both."""
    half, middle = 0.25, np.array([8.0, -0.5 * PUSH])

    def miss(guess: Array) -> Array:
        size, length, slope = guess
        normal = np.array([-np.sin(slope), np.cos(slope)])
        end, turned = cantilever(length, _stiffness(0.5), -size * normal, 0.0)
        return np.append(end + [0.0, -half] + half * normal - middle, turned - slope)

    return float(fsolve(miss, [3.0 * _stiffness(0.5) * 2.0 / 8.0**3, 8.2, -0.35], xtol=1e-10)[0])


def pressed_by_its_end(thickness: float, length: float) -> float:
    """Force where the corner of a thicker upper beam presses on the lower one, square to that."""
    half = 0.5 * thickness

    def miss(guess: Array) -> Array:
        size, reach, slope, tilt = guess
        normal = np.array([-np.sin(slope), np.cos(slope)])
        below, turned = cantilever(reach, _stiffness(0.5), -size * normal, 0.0)
        top = below + [0.0, -0.25] + 0.25 * normal
        # The upper beam, turned by 180 degrees, so that it goes along x from its clamp.
        arm = half * np.array([-np.sin(tilt), np.cos(tilt)])
        push = -size * normal
        end, its = cantilever(length, _stiffness(thickness), push, float(arm[0] * push[1] - arm[1] * push[0]))
        corner = np.array([TIP + length, half - PUSH]) - (end + arm)
        return np.array([*(top - corner), turned - slope, its - tilt])

    first = 3.0 * _stiffness(0.5) * 3.0 / TIP**3
    return float(fsolve(miss, [first, TIP, -0.5, -0.05], xtol=1e-10)[0])


def _force(solution: Solution) -> Mapping[str, float]:
    return {"force": float(np.linalg.norm(solution.steps[-1].reactions["upper.right"]))}


def _alike(contactor: str) -> Benchmark:
    def measure(solution: Solution) -> Mapping[str, float]:
        points, moved = solution.model.mesh.points, solution.displacement
        ends = [moved[np.argmin(np.abs(points - place).sum(axis=1))] for place in ((REACH, -0.25), (TIP, 0.25))]
        apart = ends[0] + ends[1] + [0.0, PUSH]
        return {**_force(solution), "unlike": float(np.linalg.norm(apart)) / PUSH}

    return Benchmark(
        f"beams-alike-{contactor}",
        f"two equal cantilevers pressed on each other, contactor the {contactor} one",
        lambda level: beams(0.5, 10.0, contactor),
        measure,
        {
            "force": Reference(
                ALIKE, 0.02, "elastica of either beam up to where they touch, half way by symmetry",
                "shear of beams 16 times as long as thick, and contact over a length",
            ),
            "unlike": Reference(
                0.0, 1e-3, "turned by 180 degrees the model is the same", "two sides of a contact are integrated on one"
            ),
        },
    )  # fmt: skip


def _by_its_end(contactor: str) -> Benchmark:
    return Benchmark(
        f"beam-on-sharp-end-{contactor}",
        f"the sharp end of a thick cantilever pressed on a thin one, contactor the {contactor} one",
        lambda level: beams(1.0, 8.0, contactor),
        _force,
        {
            "force": Reference(
                BY_ITS_END, 0.04, "elastica of both beams, force square to the lower one",
                "the force goes with the inverse cube of its place, which facets of 0.25 of 6 tell to a third of one",
            )
        },
    )  # fmt: skip


BENCHMARKS = (
    _edge("tri3", "block", 0.3), _edge("quad4", "block", 0.3), _edge("quad4", "ground", 0.0),
    _edge("quad8", "block", 0.3), _edge("quad8", "ground", 0.0),
    *(_alike(name) for name in ("lower", "upper")), *(_by_its_end(name) for name in ("lower", "upper")),
)  # fmt: skip

"""Two cylinders with friction: pressed together and pushed along (Cattaneo 1938, Mindlin 1949), and pushed to and fro."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray
from scipy.integrate import trapezoid

from abut.benchmarks.record import Benchmark, Reference
from abut.materials.elastic import LinearElastic
from abut.mesh.make import join, rectangle
from abut.mesh.mesh import Mesh
from abut.model import Amplitude, Contact, Force, Model, Rigid, Solid, SolveOptions, Support
from abut.solution import ContactResult, Solution

Array = NDArray[np.float64]
RADIUS, MATERIAL, COEFFICIENT = 8.0, LinearElastic(200.0, 0.3), 0.2
DOWN, ALONG = 10.0, 0.93622  # forces per unit thickness
MODULUS = 0.5 * MATERIAL.young / (1.0 - 0.3**2)  # E* of both
WIDTH = float(np.sqrt(4.0 * DOWN * (0.5 * RADIUS) / (np.pi * MODULUS)))  # half the contact
STICK = WIDTH * float(np.sqrt(1.0 - ALONG / (COEFFICIENT * DOWN)))  # half of what sticks
HALF, DEPTH = 6.0, 8.0  # of the blocks cut from the half planes
CATTANEO = "Cattaneo 1938, Mindlin 1949 (Johnson 1985, section 7.2)"
CELLS = {"quad4": 8, "quad8": 10}  # over half of what sticks
BEYOND = {"quad4": 1.0125, "quad8": 1.03}  # times half of what sticks: there is a node near the peak, theory (R19)
NEAR = 1.1  # of half the contact: as far as tractions are compared


def traction(x: Array) -> Array:
    """Tangential traction at x under ``DOWN``, then ``ALONG``."""
    outer, inner = (np.sqrt(np.maximum(1.0 - (x / width) ** 2, 0.0)) for width in (WIDTH, STICK))
    return np.asarray(COEFFICIENT * 2.0 * DOWN / (np.pi * WIDTH) * (outer - STICK / WIDTH * inner))


def _block(y: tuple[float, float], cells: int, cell: str, way: float) -> Mesh:
    """A block whose side at y = 0 is bent to the ``RADIUS``, with ``cells`` over half of what sticks and a little more."""
    zone = 2.0 * BEYOND[cell] * STICK
    fine = {"x": [-zone, zone], "y": [-zone, 0.0] if y[1] == 0.0 else [0.0, zone]}
    mesh = rectangle((-HALF, HALF), y, (4 * cells, 2 * cells), cell, fine)
    x, z = mesh.points.T
    bent = way * (RADIUS - np.sqrt(RADIUS**2 - x**2)) * (1.0 - np.abs(z) / DEPTH)
    return replace(mesh, points=np.column_stack([x, z + bent]))


def cylinders(
    cell: str, upper: bool, cells: int, pushes: Sequence[tuple[float, float]], friction: float | str = COEFFICIENT
) -> Model:
    """The cylinders; the upper one is held upright by a rigid plate tied to it. upper: whether it is the contactor; cells:
    of the contactor over half of what sticks, the target has a third more; pushes: (time, share of ``ALONG``), the first of
    them 0, once ``DOWN`` is there."""
    counts = [cells, -(-4 * cells // 3)]
    lower, above = reversed(counts) if upper else counts
    plate = rectangle((-HALF, HALF), (DEPTH, DEPTH + 1.0), (1, 1))
    parts = {
        "lower": _block((-DEPTH, 0.0), lower, cell, -1.0), "upper": _block((0.0, DEPTH), above, cell, 1.0), "plate": plate,
    }  # fmt: skip
    sides = ("upper.bottom", "lower.top") if upper else ("lower.top", "upper.bottom")
    return Model(
        join(parts),
        [Solid(body, MATERIAL) for body in ("lower", "upper")],
        [Support("lower.bottom", x=0, y=0)],
        [
            Force("plate.top", (0.0, -DOWN), Amplitude(((0.0, 0.0), (pushes[0][0], 1.0)))),
            Force("plate.top", (ALONG, 0.0), Amplitude(tuple(pushes))),
        ],
        [
            Contact(contactor=sides[0], target=sides[1], friction=friction),
            Contact(contactor="upper.top", target="plate.bottom", kind="tied"),
        ],
        plane="strain",
        rigid=[Rigid("plate", rz=0.0)],
        solve=SolveOptions(times=tuple(time for time, _ in pushes)),
    )


def along(contact: ContactResult) -> tuple[Array, Array, NDArray[np.bool_]]:
    """Place and size of the tangential traction at the corners of the contactor's facets, from left to right, and whether
    they stick."""
    assert contact.friction is not None
    x = contact.contactor.points[contact.contactor.nodes[:, :2], 0].ravel()
    order = np.argsort(x, kind="stable")
    drag = contact.friction.traction[:, :2, 0].ravel() * np.sign(contact.force[0])
    return x[order], drag[order], contact.friction.status[:, :2].ravel()[order] == 1


def measure(solution: Solution) -> dict[str, float]:
    """Of a push in one way: traction in the middle and its peak, half of what sticks, and the error in the mean square."""
    x, drag, sticks = along(solution.contacts[0])
    near = np.abs(x) < NEAR * WIDTH
    exact = traction(x)
    missed, size = (trapezoid(values[near] ** 2, x[near]) for values in (drag - exact, exact))
    return {
        "middle": float(np.interp(0.0, x, drag)),
        "largest": float(drag.max()),
        "stick": float(0.5 * np.ptp(x[sticks])),
        "traction": float(np.sqrt(missed / size)),
    }


def _cattaneo(cell: str, upper: bool) -> Benchmark:
    cells = CELLS[cell]

    def model(level: int) -> Model:
        return cylinders(cell, upper, cells * 2**level, [(0.5, 0.0), (1.0, 1.0)])

    facet = BEYOND[cell] * STICK / cells
    reason = f"blocks of {2 * HALF:g} by {DEPTH:g} for half planes, {2.0 * WIDTH / facet:.0f} facets over the contact"
    peak = float(traction(np.array([STICK]))[0])
    side = "upper" if upper else "lower"
    return Benchmark(
        f"cattaneo-{cell}-{side}",
        f"two cylinders pressed together, then pushed along, {cell}, the {side} one the contactor",
        model,
        measure,
        {
            "middle": Reference(float(traction(np.zeros(1))[0]), 0.02, CATTANEO, reason),
            "largest": Reference(
                peak, 0.02 if cell == "quad4" else 0.05, CATTANEO,
                f"a kink: the first node that slips is {BEYOND[cell]:g} times as far out; {reason}",
            ),
            "stick": Reference(STICK, facet / STICK, CATTANEO, "one facet"),
            "traction": Reference(0.0, 0.05, CATTANEO, f"in the mean square, over that of the exact one; {reason}"),
        },
    )  # fmt: skip


SHARE = 1.4  # of ``ALONG``: the largest push of the cycle, 0.655 of what friction carries


def lost(push: float) -> float:
    """Work that friction takes while a force goes from ``push`` to its opposite and back: the tangential displacement is
    that of flat punches one in the other, f' = -ln(1 - Q / mu P) / (pi E*) but for a constant (Ciavarella 1998, Jaeger
    1998), and turns back by Masing's rule: 4 Q f(Q) - 8 int f."""
    most = COEFFICIENT * DOWN
    k = push / most
    f = (1.0 - k) * np.log(1.0 - k) + k
    integral = -0.5 * (1.0 - k) ** 2 * np.log(1.0 - k) + 0.25 * ((1.0 - k) ** 2 - 1.0) + 0.5 * k**2
    return float(most**2 / (np.pi * MODULUS) * (4.0 * k * f - 8.0 * integral))


def _cycle(level: int) -> Model:
    pushes = [(0.1, 0.0), (0.2, SHARE), (0.6, -SHARE), (1.0, SHARE)]
    return cylinders("quad4", False, 2 * CELLS["quad4"] * 2**level, pushes)


def _work(solution: Solution) -> dict[str, float]:
    done = [step.contacts[0].friction for step in solution.steps[-2:]]
    return {"loop": sum(result.work for result in done if result is not None)}


LOOP = "Mindlin and Deresiewicz 1953, for cylinders by Ciavarella 1998 and Jaeger 1998"
BENCHMARKS = (
    *(_cattaneo(cell, upper) for cell in CELLS for upper in (False, True)),
    Benchmark(
        "mindlin-cycle",
        "two cylinders pressed together and pushed to and fro, quad4",
        _cycle,
        _work,
        {
            "loop": Reference(
                lost(SHARE * ALONG), 0.03, LOOP, "facets of a 40th of the contact: where it slips is narrow"
            )
        },
    ),
)

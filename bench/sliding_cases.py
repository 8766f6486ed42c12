"""What sliding.py compares: models, load steps, and the settings with which Kratos gets furthest."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field, replace
from typing import Any

import numpy as np

import abut
from abut.benchmarks import finite_contact_3d
from abut.benchmarks.finite_contact import DIE, RADIUS
from abut.materials.hyperelastic import NeoHooke
from abut.mesh.make import box, join

PRESS, SLIDE = (
    abut.Amplitude(((0.0, 0.0), (1 / 3, 1.0), (1.0, 1.0))),
    abut.Amplitude(((0.0, 0.0), (1 / 3, 0.0), (1.0, 1.0))),
)
GAP, DEPTH, WAY = 1e-4, 0.8, 10.0  # at the outset; how far the die goes down; how far along


@dataclass(frozen=True)
class Case:
    """model: by level, which halves the cells; parts: time at which each ends and its number of equal load steps;
    solver, contact: what Kratos' solver and contact are told beside the defaults."""

    model: Callable[[int], abut.Model]
    parts: tuple[tuple[float, int], ...]
    solver: Mapping[str, Any] = field(default_factory=dict)
    contact: Mapping[str, Any] = field(default_factory=dict)

    def times(self) -> list[float]:
        """At which the load steps end."""
        starts = [0.0, *(end for end, _ in self.parts)]
        pieces = [start + np.arange(1, n + 1) * (end - start) / n for start, (end, n) in zip(starts, self.parts)]
        return [float(time) for time in np.concatenate(pieces)]

    def step_table(self) -> list[list[float]]:
        """Length of the step that begins at a time, linear between rows."""
        starts = [0.0, *(end for end, _ in self.parts)]
        lengths = [(start, end, (end - start) / n) for start, (end, n) in zip(starts, self.parts)]
        return [row for start, end, step in lengths for row in ([start, step], [end - 0.5 * step, step])]


def strip(level: int, friction: float) -> abut.Model:
    """Shallow ironing in space: one layer of hex8, of which one face is held, the other free."""
    n = 2**level
    slab, die = box((0.0, 12.0), (0.0, 1.0), (0.0, 4.0), (40 * n, 1, 6 * n), "hex8"), _die(n)
    moduli = {"slab": 68.96e7, "die": 68.96e8}
    return abut.Model(
        join({"slab": slab, "die": die}),
        [abut.Solid(name, NeoHooke(young, 0.32, volumetric="log-squared")) for name, young in moduli.items()],
        [
            abut.Support("slab.bottom", x=0.0, y=0.0, z=0.0), abut.Support("die.top", z=-DEPTH, amplitude=PRESS),
            abut.Support("die.top", x=WAY, amplitude=SLIDE), *(abut.Support(f"{name}.front", y=0.0) for name in moduli),
        ],
        contacts=[abut.Contact(contactor="slab.top", target="die.bottom", friction=friction)], kinematics="finite",
    )  # fmt: skip


def _die(n: int) -> abut.Mesh:
    """Half width of 0.6 and an arc below, just above the slab's left end."""
    mesh, half = box((-1.0, 1.0), (0.0, 1.0), (0.0, 1.0), (6 * n, 1, 3 * n), "hex8"), 0.5 * DIE[0]
    x, y, z = mesh.points.T
    turn = np.arcsin(half / RADIUS) * x
    along = (1.0 - z) * RADIUS * np.sin(turn) + z * half * x
    up = (1.0 - z) * RADIUS * (1.0 - np.cos(turn)) + z * DIE[1]
    return replace(mesh, points=np.column_stack([0.2 + half + along, y, 4.0 + GAP + up]))


CASES = {
    "die": Case(lambda level: finite_contact_3d.model(level, "hex8"), ((1.0, 20),)),
    "ironing": Case(
        lambda level: strip(level, 0.3), ((1 / 3, 20), (1.0, 500)),
        {"max_iteration": 20, "contact_settings": {"use_mixed_ulm_solver": False}},
        {
            "operator_threshold": 0.0, "slip_step_reset_frequency": 25,
            "search_parameters": {"search_factor": 2.25, "active_check_factor": 0.0045},
        },
    ),
    "frictionless": Case(lambda level: strip(level, 0.0), ((1 / 3, 20), (1.0, 100)), {"max_iteration": 20}),
}  # fmt: skip

"""Modes in the picture: what each adds to the displacements of the state about which it is one."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from abut.report.arrays import moved as on_grid
from abut.report.surface_triangles import Patch, Skin
from abut.solution import ModesResult, Solution
from abut.solution.grids import vectors
from abut.solution.modes import BUCKLING, COMPLEX
from abut.types import Json

REAL = 12  # bytes of a point in a mode, and as many more where it has an imaginary part
SHAPE = "mode shape"  # the field that shows how far each point moves

Vector = NDArray[np.float64]


def cost(result: ModesResult) -> int:
    """Bytes of a point in a mode of a result."""
    return REAL * (2 if len(result.imaginary) else 1)


def drawn(solution: Solution, points: int, room: float) -> list[tuple[ModesResult, int]]:
    """As many modes as stay within ``room`` bytes at so many points, the first of all, and at least the first one."""
    every = [(result, i) for result in solution.modes for i in range(len(result))]
    used = np.cumsum([points * cost(result) for result, _ in every])
    return every[: max(1, int((used <= room).sum()))]


def mode_shapes(
    modes: Sequence[tuple[ModesResult, int]], skins: Sequence[Skin], patches: Sequence[Patch]
) -> list[Json]:
    """Of each mode its name and, at the points of bodies and contact surfaces, real and imaginary parts of the
    displacement, over the largest amplitude of a point."""
    return [_one(result, i, skins, patches) for result, i in modes]


def _one(result: ModesResult, i: int, skins: Sequence[Skin], patches: Sequence[Patch]) -> Json:
    parts = {"real": vectors(result.shapes[i])}
    if len(result.imaginary):
        parts["imaginary"] = vectors(result.imaginary[i])
    square = sum((part**2).sum(axis=1) for part in parts.values())
    largest = float(np.sqrt(np.nanmax(square, initial=0.0))) or 1.0
    return {
        "name": title(result, i),
        "bodies": [{name: on_grid(part[own.nodes] / largest) for name, part in parts.items()} for own in skins],
        "contacts": [{name: on_grid(own.of_points(part / largest)) for name, part in parts.items()} for own in patches],
    }


def title(result: ModesResult, i: int) -> str:
    """A mode in a few words."""
    value = f"{result.values[i]:.6g}"
    if result.kind == BUCKLING:
        return f"buckling {i + 1}: factor {value}"
    of = f"nodal diameter {result.diameter}, " if result.diameter else ""
    growth = f", growth {result.growth[i]:.6g}" if result.kind == COMPLEX else ""
    return f"{of}mode {i + 1}: {value} per time{growth}"

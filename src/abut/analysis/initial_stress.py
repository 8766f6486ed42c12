"""Stress that bodies have before anything moves, as a field of results."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

import numpy as np

from abut._core import shape_functions
from abut.bodies.history_fields import averaged
from abut.bodies.solids import Group, Solids
from abut.cells import CELLS
from abut.materials.prestressed import INITIAL, Prestressed
from abut.solution import Step
from abut.types import Array


def initial_stress(solids: Solids, before: Sequence[Step]) -> dict[str, Array]:
    """At points, (n_points, 6), zero where bodies have none; empty where no body has. before: steps that know it."""
    if before:
        return {name: values for name, values in before[-1].remembered.items() if name == INITIAL}
    if not any(isinstance(material, Prestressed) for material in solids.materials.values()):
        return {}
    return {INITIAL: averaged(solids, _held(solids))}


def _held(solids: Solids) -> Iterator[tuple[Group, Array]]:
    """Groups of such bodies, with it at the integration points, (cells, q, 6)."""
    for group in solids.cellwise.groups():
        material = solids.materials.get(group.body)
        if isinstance(material, Prestressed):
            shapes, _ = shape_functions(CELLS[group.kind].code, np.ascontiguousarray(group.rule[0]))
            points = shapes @ solids.points[group.nodes]
            held = material.held(points.reshape(-1, points.shape[-1]))
            yield group, held.reshape(*points.shape[:2], 6)

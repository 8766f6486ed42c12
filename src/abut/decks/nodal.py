"""Supports, equations and forces at nodes of a deck as those of a model."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

from abut.decks.temperatures import history
from abut.io.deck.groups import Groups
from abut.io.deck.nodal_constraints import Bonds
from abut.io.deck.time_histories import Course, scaled, zero
from abut.model import Amplitude, Equation, Load, NodalForce, Support, Term
from abut.types import Json

AXES = "xyz"
Names = Mapping[int, tuple[str, ...]]


def supports(bound: Bonds, groups: Groups) -> list[Support]:
    """Nodes held alike together; components with the same course over time in one support."""
    by_node: dict[int, dict[int, Course]] = {}
    for (node, axis), course in bound.supports.items():
        by_node.setdefault(node, {})[axis] = course
    alike: dict[tuple[tuple[int, Course], ...], list[int]] = {}
    for node, histories in by_node.items():
        alike.setdefault(tuple(sorted(histories.items())), []).append(node)
    result: list[Support] = []
    for key, nodes in alike.items():
        on = groups.node_set(np.array(nodes), f"support-{len(result) + 1}")
        still = {AXES[axis]: 0.0 for axis, course in key if zero(course)}
        moving: dict[Course | None, Json] = {}
        for axis, course in key:
            if not zero(course):
                size, unit = scaled(course)
                moving.setdefault(unit, {})[AXES[axis]] = size
        for unit, values in (moving or {None: {}}).items():
            amplitude = None if unit is None else Amplitude(unit)
            result.append(Support(on, **(values | still), amplitude=amplitude))
            still = {}
    return result


def equations(bound: Bonds, groups: Groups, names: Names) -> list[Equation]:
    """Linear constraints. names: of the supports of nodes of shells, beams and trusses."""
    return [
        Equation(
            tuple(Term(groups.node_set(np.array([n]), f"n{n}"), AXES[k], c) for (n, k), c in bond.terms.items()),
            *history(bond.course),
            names.get(bond.holds, ()),
        )
        for bond in bound.bonds
    ]


def thin_supports(bound: Bonds, groups: Groups, start: int) -> Names:
    """The names of the supports of nodes of shells, beams and trusses, those held alike together: sets of the solids' nodes.
    start: how many others there are."""
    alike: dict[tuple[tuple[int, Course], ...], list[int]] = {}
    for node, held in bound.held.items():
        alike.setdefault(held.courses, []).append(node)
    result: dict[int, tuple[str, ...]] = {}
    for i, nodes in enumerate(alike.values(), start=start + 1):
        every = np.unique([n for node in nodes for n in bound.held[node].nodes])
        result |= dict.fromkeys(nodes, (groups.node_set(every, f"support-{i}"),))
    return result


def forces(bound: Bonds, groups: Groups, plane: str | None, thickness: float) -> list[Load]:
    """Forces at nodes; over the thickness of plane models."""
    by_node: dict[tuple[int, Course | None], dict[int, float]] = {}
    for (node, axis), course in bound.forces.items():
        if not zero(course):
            size, unit = scaled(course)
            by_node.setdefault((node, unit), {})[axis] = size / thickness
    alike: dict[tuple[Course | None, tuple[float, ...]], list[int]] = {}
    for (node, unit), histories in by_node.items():
        vector = tuple(histories.get(axis, 0.0) for axis in range(2 if plane else 3))
        alike.setdefault((unit, vector), []).append(node)
    return [
        NodalForce(groups.node_set(np.array(nodes), f"force-{i}"), vector, None if unit is None else Amplitude(unit))
        for i, ((unit, vector), nodes) in enumerate(alike.items(), start=1)
    ]

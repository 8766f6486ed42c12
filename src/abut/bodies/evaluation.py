"""Materials evaluated in Python at the integration points of cells, some cells at a time.

The history of a body has a row for every integration point: its cells by type as in the mesh, those of a type in ascending
order, the points of a cell as in the rule.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from functools import partial

import numpy as np

from abut._core import Cells, finite_strains, shape_functions, strains
from abut.bodies.inverted import require_sound
from abut.bodies.solids import Array, Group, Solids, TemperatureChange
from abut.cells import CELLS
from abut.errors import InputError
from abut.materials.material import Evaluated, FiniteMaterial, Material
from abut.materials.places import Places, is_local, placed
from abut.materials.plane_stress import Evaluate, law
from abut.mesh.quadrature import Rule

History = Mapping[str, Array]  # by body, of materials that are not integrated together: (points, h)


@dataclass(frozen=True)
class Part:
    """Some cells of a group, also as they are for the compiled core; thermal: their thermal strains at the nodes, None
    without; material: where it is."""

    group: Group
    cells: Cells
    thermal: Array | None
    material: Material


def evaluate(
    solids: Solids,
    group: Group,
    rule: Rule,
    displacement: Array | None,
    temperature: TemperatureChange,
    history: History | None,
) -> Iterator[tuple[Part, Array, Evaluated]]:
    """Cells of a group, some after the other, with strain (points, 6), stress (points, 6), tangent (points, 6, 6) and new
    history at their integration points. displacement None: none; history None: the initial one.

    Raises InputError for a material that returns other shapes, and Inverted under finite strains."""
    material, finite = solids.materials[group.body], solids.kinematics == "finite"
    where = f"material of body '{group.body}'"
    moved = np.zeros(solids.points.shape) if displacement is None else displacement
    for part in group.portions(rule):
        cells = part.arrays(solids, rule)
        thermal = None if is_local(material) else temperature.strain(solids, part)
        here = placed(material, places(solids, part, rule, temperature)) if is_local(material) else material
        told = here.evaluate_finite if finite and isinstance(here, FiniteMaterial) else here.evaluate
        respond = law(partial(_asked, told, where), solids.plane)
        if finite:
            strain, unsound = finite_strains(cells, moved, thermal)
            require_sound(solids, part, unsound)
        else:
            strain = strains(cells, moved, thermal)
        rows = slice(part.first, part.first + len(strain))
        before = history[group.body][rows] if history else material.initial(len(strain))
        yield Part(part, cells, thermal, here), *respond(strain, before)


def places(solids: Solids, group: Group, rule: Rule, temperature: TemperatureChange) -> Places:
    """Where the points of a rule are, how much warmer, and the time since their history. Mixed cells see of the temperature
    what their pressures do."""
    shapes, _ = shape_functions(CELLS[group.kind].code, np.ascontiguousarray(rule[0]))
    points = (shapes @ solids.points[group.nodes]).reshape(-1, solids.points.shape[1])
    degrees = temperature.degrees(solids, group)
    if degrees is None:
        return Places(points, np.zeros(len(points)), temperature.elapsed)
    unmoved = strains(group.arrays(solids, rule), np.zeros(solids.points.shape), degrees)  # less one by degree
    return Places(points, -unmoved[:, 0], temperature.elapsed)


def _asked(told: Evaluate, where: str, strain: Array, history: Array) -> Evaluated:
    return _checked(told(strain, history), history.shape, where)


def _checked(result: Evaluated, history: tuple[int, ...], where: str) -> Evaluated:
    n = history[0]
    stress, tangent, after = (np.asarray(values, dtype=float) for values in result)
    for name, values, shape in zip(
        ("stress", "tangent", "history"), (stress, tangent, after), ((n, 6), (n, 6, 6), history)
    ):
        if values.shape != shape:
            raise InputError(f"{where}: evaluate returned a {name} of shape {values.shape}, expected {shape}")
    return np.ascontiguousarray(stress), np.ascontiguousarray(tangent), after

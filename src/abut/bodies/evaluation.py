"""Materials evaluated in Python at the integration points of cells, some cells at a time.

The history of a body has a row for every integration point: its cells by type as in the mesh, those of a type in ascending
order, the points of a cell as in the rule.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass

import numpy as np

from abut._core import Cells, finite_strains, strains
from abut.bodies.inverted import require_sound
from abut.bodies.solids import Array, Group, Solids, TemperatureChange
from abut.errors import InputError
from abut.materials.material import Evaluated, FiniteMaterial
from abut.materials.plane_stress import law
from abut.mesh.quadrature import Rule

History = Mapping[str, Array]  # by body, of materials that are not integrated together: (points, h)


@dataclass(frozen=True)
class Part:
    """Some cells for the compiled core, and their thermal strains at the nodes, None without."""

    cells: Cells
    thermal: Array | None


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
    told = material.evaluate_finite if finite and isinstance(material, FiniteMaterial) else material.evaluate
    respond = law(lambda *at: _checked(told(*at), at[1].shape, where), solids.plane)
    moved = np.zeros(solids.points.shape) if displacement is None else displacement
    for part in group.portions(rule):
        cells, thermal = part.arrays(solids, rule), temperature.strain(solids, part)
        if finite:
            strain, unsound = finite_strains(cells, moved, thermal)
            require_sound(solids, part, unsound)
        else:
            strain = strains(cells, moved, thermal)
        rows = slice(part.first, part.first + len(strain))
        before = history[group.body][rows] if history else material.initial(len(strain))
        yield Part(cells, thermal), *respond(strain, before)


def _checked(result: Evaluated, history: tuple[int, ...], where: str) -> Evaluated:
    n = history[0]
    stress, tangent, after = (np.asarray(values, dtype=float) for values in result)
    for name, values, shape in zip(
        ("stress", "tangent", "history"), (stress, tangent, after), ((n, 6), (n, 6, 6), history)
    ):
        if values.shape != shape:
            raise InputError(f"{where}: evaluate returned a {name} of shape {values.shape}, expected {shape}")
    return np.ascontiguousarray(stress), np.ascontiguousarray(tangent), after

"""Forces, stiffness, stresses and histories of a group of cells, whoever knows its material: the compiled core or Python."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from abut._core import integrate_given, integrate_given_finite
from abut.bodies.evaluation import History, Part, evaluate, places
from abut.bodies.inverted import require_sound
from abut.bodies.solids import Array, Group, Solids, TemperatureChange
from abut.bodies.volumes import point_volumes
from abut.materials.kernel import At, Since, Wanted
from abut.materials.material import compiled, stored
from abut.materials.places import is_local
from abut.mesh.quadrature import Rule


def integrate(
    solids: Solids,
    group: Group,
    rule: Rule,
    displacement: Array | None,
    temperature: TemperatureChange,
    history: History | None,
    wanted: Wanted,
    since: Since | None = None,
) -> list[Array]:
    """Adds and writes what is wanted of a group, in place; returns its new history, in parts, empty for bodies that go
    together. wanted.after is made here. Pressures that are continuous are missing (``continuous``). displacement (n_points,
    dim), None under small strains: none; history None: the initial one; since: from where Newton's method came.

    Raises Inverted, under finite strains, and InputError for materials that return arrays of other shapes."""
    solids = solids.cellwise
    if group.kernel is not None:
        return _compiled(solids, group, rule, displacement, temperature, history, wanted, since)
    after, done, told = [], 0, 0
    for part, strain, (stress, slope, new) in evaluate(solids, group, rule, displacement, temperature, history):
        rows = slice(done, done := done + len(stress))
        if solids.kinematics == "finite":
            assert displacement is not None
            at_points = None if wanted.stress is None else wanted.stress[rows]
            integrate_given_finite(
                part.cells, displacement, part.thermal, strain, stress, slope, solids.plane == "stress", wanted.force,
                wanted.tangent, at_points, *((None, False) if since is None else (since.displacement, since.guessed)),
            )  # fmt: skip
            if wanted.energy is not None:
                of_cells = slice(told, told := told + len(part.group.cells))
                wanted.energy[of_cells] = _stored(solids, part, rule, strain, new)
        else:
            integrate_given(part.cells, stress, None if wanted.tangent is None else slope, wanted.force, wanted.tangent)
            if wanted.stress is not None:
                wanted.stress[rows] = stress
        after.append(new)
    return after


def _stored(solids: Solids, part: Part, rule: Rule, strain: Array, history: Array) -> Array | float:
    """Elastic energy of each cell under finite strains; not a number of a material that does not tell it, or is warm."""
    density = stored(part.material, strain, history)
    if density is None or part.thermal is not None:
        return np.nan
    volumes = point_volumes(solids, part.group, rule)
    return np.asarray((volumes * density.reshape(volumes.shape)).sum(axis=1))


def _compiled(
    solids: Solids,
    group: Group,
    rule: Rule,
    displacement: Array | None,
    temperature: TemperatureChange,
    history: History | None,
    wanted: Wanted,
    since: Since | None,
) -> list[Array]:
    kernel = group.kernel
    assert kernel is not None
    cells, thermal = group.arrays(solids, rule), temperature.strain(solids, group)
    constants = {}
    for body, material in solids.materials.items():
        known = compiled(material, solids.kinematics == "finite")
        constants[body] = (0.0, 0.0) if known is None or known.kernel != kernel else known.constants
    at = At(cells, solids.by_cell(group, constants), solids.plane == "stress", displacement, thermal, since=since)
    if not group.body:
        require_sound(solids, group, kernel.integrate(at, wanted))
        return []
    if displacement is None:
        at = replace(at, displacement=np.zeros(solids.points.shape))
    material = solids.materials[group.body]
    if is_local(material):
        at = replace(at, thermal=None, change=places(solids, group, rule, temperature).change)
    n = len(group.cells) * len(rule[1])
    before = history[group.body][group.first : group.first + n] if history else material.initial(n)
    after = np.empty(before.shape)  # all of it is written
    found = kernel.integrate(replace(at, before=np.ascontiguousarray(before)), replace(wanted, after=after))
    require_sound(solids, group, found)
    return [after]

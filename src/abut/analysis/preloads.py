"""Results of the sections of preloads at the end of a step."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from abut.model import Model
from abut.model.preload import Section, sections
from abut.model.step_ends import SAME
from abut.problem.preloads import LockedPreloads
from abut.problem.sections import given_force, shortening_row
from abut.solution import PreloadResult
from abut.solution.state import State

Array = NDArray[np.float64]


def preload_results(
    model: Model, state: State, displacement: Array, loads: Array, linked: Array
) -> dict[str, PreloadResult]:
    """Of all preloads by name. displacement: (dim n_points,); loads: the nodal forces (dim n_points,) of preloads; linked:
    those of what holds the two sides together, and of equations."""
    result = {}
    for section in sections(model.mesh, model.preloads):
        preload, dim = section.preload, model.dim
        forces = -(loads + linked).reshape(-1, dim)[section.beyond]
        force = -forces.sum(axis=0)
        short = float(shortening_row(section, dim, len(displacement)) @ displacement)
        locked = preload.lock is not None and state.time > preload.lock + SAME
        given = None if preload.force is None or locked else given_force(preload, state.time)
        kept = float(state.history.of(LockedPreloads.name)[preload.name][0, 0]) if locked else None
        result[preload.name] = PreloadResult(
            float(-section.normal @ force), short, force, _moment(model, section, -forces), given, kept
        )
    return result


def _moment(model: Model, section: Section, forces: Array) -> Array:
    """About the middle of the section, of forces (n, dim) at its points."""
    if model.mesh.axisymmetric:
        return np.zeros(1)
    x = model.mesh.points[section.beyond]
    arms = x - 0.5 * (x.min(axis=0) + x.max(axis=0))
    if model.dim == 3:
        return np.cross(arms, forces).sum(axis=0)
    return np.array([(arms[:, 0] * forces[:, 1] - arms[:, 1] * forces[:, 0]).sum()])

"""Beams that were made solid as lines with the forces across their sections, for viewers and tables."""

from __future__ import annotations

import numpy as np

from abut.model import Model
from abut.solution.beam_forces import BeamForces, of_step, unknown
from abut.solution.grids import Grid
from abut.solution.records import Step


def known(model: Model) -> tuple[str, ...]:
    """The beams of a model whose forces are known."""
    return tuple(body for body in model.mesh.beams if not unknown(model, body))


def forces(model: Model, step: Step) -> dict[str, BeamForces]:
    """Of these beams."""
    return {body: of_step(model, step, body)[0] for body in known(model)}


def grid(model: Model, step: Step) -> Grid:
    """These beams as lines from section to section, where they are in finite deformations; cells have the number of their
    body."""
    points, lines, bodies, found, first = [], [], [], [], 0
    names = list(model.mesh.bodies)
    for body in known(model):
        of, cells = of_step(model, step, body)
        found.append(of)
        points.append(of.points)
        lines.append(cells + first)
        bodies.append(np.full(len(cells), names.index(body), np.int32))
        first += len(of.points)
    data = {
        "force": [of.force for of in found],
        "moment": [of.moment for of in found],
        "normal_force": [of.normal_force for of in found],
        "shear_force": [of.shear_force for of in found],
        "torque": [of.torque for of in found],
        "bending_moment": [of.bending_moment for of in found],
        "tangent": [of.tangent for of in found],
    }
    return Grid(
        np.concatenate(points), (("line2", np.concatenate(lines).astype(np.int32)),),
        {name: np.concatenate(values) for name, values in data.items()}, {"body": np.concatenate(bodies)},
    )  # fmt: skip

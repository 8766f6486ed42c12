"""Planes of symmetry, as the supports of a model tell of them."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from abut.contact.bulge import Held
from abut.contact.geometry import nodal_normals
from abut.mesh.mesh import Mesh
from abut.model.conditions import COMPONENTS, Support


def held_directions(mesh: Mesh, supports: Sequence[Support]) -> Held | None:
    """Directions in which points do not move at all: along the axes, or along the normal of the supported surface. None
    where there are none."""
    points, directions = [], []
    for support in supports:
        for axis, name in enumerate(COMPONENTS[: mesh.points.shape[1]]):
            value = getattr(support, name)
            if value is not None and not callable(value) and value == 0.0:
                at = mesh.nodes_of(support.on)
                points.append(at)
                directions.append(support.directions(mesh.points[at])[:, axis])
        if support.normal == 0.0 and support.on in mesh.surfaces:
            surface = mesh.surface(support.on)
            used = surface.nodes >= 0
            points.append(surface.nodes[used].astype(np.int64))
            directions.append(nodal_normals(surface)[used])
    return Held(np.concatenate(points), np.concatenate(directions)) if points else None

"""The volume of a mesh."""

from __future__ import annotations

import numpy as np

from abut.bodies.loads import body_load
from abut.mesh.mesh import Mesh


def volume(mesh: Mesh) -> float:
    return float(body_load(mesh, dict.fromkeys(mesh.bodies, np.eye(mesh.dim)[0])).sum())

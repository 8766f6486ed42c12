"""Forces of supports by name."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from abut.model import Model
from abut.problem.rigid_bodies import RigidBody

Vector = NDArray[np.float64]


@dataclass(frozen=True)
class Reactions:
    """As ``Step`` has them: by the name of what is supported the force (dim,), and its moment (1,) or (3,) about the mean of
    its points."""

    reactions: Mapping[str, Vector]
    moments: Mapping[str, Vector]


def reactions(model: Model, bodies: Sequence[RigidBody], forces: Vector, displacement: Vector) -> Reactions:
    """Of forces (n_points, dim) that hold the points. displacement: (n_points, dim), by which arms follow at large ones.

    Sums round the axis of an axisymmetric model have no moment."""
    names = dict.fromkeys([*(support.on for support in model.supports), *(hold.on for hold in model.holds)])
    names |= dict.fromkeys(name for equation in model.equations for name in equation.supports)
    names |= dict.fromkeys(name for coupling in model.couplings for name in coupling.supports)
    points = model.mesh.points + displacement if model.finite else model.mesh.points
    force, moment = dict[str, Vector](), dict[str, Vector]()
    for on in names:
        own = model.mesh.nodes_of(on)
        held = _with_bodies(own, bodies)
        arms = points[held] - (points[own].mean(axis=0) if len(own) else 0.0)
        force[on] = forces[held].sum(axis=0)
        if not model.mesh.axisymmetric:
            moment[on] = _cross(arms, forces[held]).sum(axis=0)
    return Reactions(force, moment)


def _cross(arms: Vector, forces: Vector) -> Vector:
    """Moments (n, 3), or (n, 1) in the plane."""
    if arms.shape[1] == 2:
        return np.asarray(arms[:, :1] * forces[:, 1:] - arms[:, 1:] * forces[:, :1])
    return np.cross(arms, forces)


def _with_bodies(nodes: NDArray[np.int64], bodies: Sequence[RigidBody]) -> NDArray[np.int64]:
    """Nodes, and all of the rigid bodies they belong to: what holds one point of those holds the whole."""
    touched = [body.nodes for body in bodies if body.holds and np.isin(nodes, body.nodes).any()]
    return np.unique(np.concatenate([nodes, *touched]))

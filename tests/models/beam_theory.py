"""What beam theory says of the examples with shells."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.integrate import quad
from scipy.optimize import fsolve


@dataclass(frozen=True)
class Leaves:
    """Leaves clamped together, each touched by the next one's end, with a load across at the end of the longest.

    forces: (n - 1,) between them; moved: way of the load's point, in its direction."""

    forces: NDArray[np.float64]
    moved: float


def leaf_forces(
    lengths: list[float], stiffness: float, load: float, mu: float = 0.0, thick: float = 0.0
) -> NDArray[np.float64]:
    """Forces of ``bent_leaves``."""
    return bent_leaves(lengths, stiffness, load, mu, thick).forces


def bent_leaves(lengths: list[float], stiffness: float, load: float, mu: float = 0.0, thick: float = 0.0) -> Leaves:
    """Where leaves touch both bend by as much. All slip, the upper one's face inwards, the lower one's outwards, so that
    friction has an arm of half the thickness about either's middle, and bends both back. stiffness: E I of each."""

    def force(x: float, at: float) -> float:  # way of a cantilever at x by a force of 1
        near, far = min(x, at), max(x, at)
        return near**2 * (3.0 * far - near) / (6.0 * stiffness)

    def rubbed(x: float, at: float) -> float:  # the same by the moment of that force's friction
        return 0.5 * mu * thick * min(x, at) * (x - 0.5 * min(x, at)) / stiffness

    count = len(lengths) - 1
    matrix, right = np.zeros((count, count)), np.zeros(count)
    for k, x in enumerate(
        lengths[1:]
    ):  # the way of leaf k there, less that of the next one; both are rubbed alike at x
        matrix[k, k] = -2.0 * force(x, x)
        if k == 0:
            right[k] = -load * force(x, lengths[0])
        else:
            matrix[k, k - 1] = force(x, lengths[k]) - rubbed(x, lengths[k])
        if k < count - 1:
            matrix[k, k + 1] = force(x, lengths[k + 2]) + rubbed(x, lengths[k + 2])
    forces = np.linalg.solve(matrix, right)
    end, first = lengths[0], lengths[1]
    return Leaves(forces, load * force(end, end) - float(forces[0]) * (force(end, first) + rubbed(end, first)))


def clip_force(way: float, stiffness: float, thick: float, pipe: float, tight: float, arm: float, mu: float) -> float:
    """Force across on the arm of half a U-shaped clip that has come by ``way`` over a rigid pipe of radius ``pipe``.

    arm: where its bend begins at the outset; tight: by how much its lower face is nearer to the plane of symmetry than the
    pipe's top. The arm touches where it is as steep as the pipe; with friction the force is turned by its angle.
    Castigliano for lift and slope there, and for how far the bend's top is moved along by opening."""
    radius = pipe - tight + 0.5 * thick

    def misses(unknown: NDArray[np.float64]) -> list[float]:
        force, slope, along = unknown
        length = arm - way + along - pipe * np.sin(slope)
        drag = force * np.tan(np.arctan(mu) + slope)

        def in_arm(x: float) -> float:
            return float(force * x - drag * thick / 2.0)

        def in_bend(a: float) -> float:
            return float(force * (length + radius * np.sin(a)) + drag * (radius - thick / 2.0 - radius * np.cos(a)))

        def bent(lever_arm: object, lever_bend: object) -> float:
            return (
                quad(lambda x: in_arm(x) * lever_arm(x), 0.0, length)[0]  # type: ignore[operator]
                + radius * quad(lambda a: in_bend(a) * lever_bend(a), 0.0, np.pi / 2.0)[0]  # type: ignore[operator]
            ) / stiffness

        lifted = bent(lambda x: x, lambda a: length + radius * np.sin(a))
        turned = bent(lambda x: 1.0, lambda a: 1.0)
        moved = bent(lambda x: 0.0, lambda a: radius * (1.0 - np.cos(a)))
        return [lifted + radius - (thick / 2.0 + pipe) * np.cos(slope), turned - slope, moved - along]

    return float(fsolve(misses, [100.0, 0.07, 0.0])[0])


def belt_ratio(mu: float, radius: float, thick: float, angle: float) -> float:
    """Euler and Eytelwein's ratio of the forces on a belt's ends, for its thickness: friction acts at the pulley's radius,
    the forces at that of its middle; l + l^2 mu t / 2 r = mu R / r in place of mu."""
    middle = radius + 0.5 * thick
    shear, arm = 0.5 * mu * thick / middle, mu * radius / middle
    return float(np.exp((np.sqrt(1.0 + 4.0 * shear * arm) - 1.0) / (2.0 * shear) * angle))

"""Models with friction whose solution is known: two flush blocks under uniform pressure and shear, in a general position."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

import abut
from abut.mesh.mesh import Mesh
from patch import POISSON, ROTATION

Array = NDArray[np.float64]
PRESSURE = 1e-3  # over Young's modulus: far above the rounding of the coordinates
FRICTION = 0.3
SIDES = ("left", "right", "front", "back")


def turn_of(dim: int) -> Array:
    """The position of the blocks: turned in 3D, as the patch test's."""
    return ROTATION if dim == 3 else np.array([[0.8, -0.6], [0.6, 0.8]])


def shear_vector(dim: int, size: float) -> Array:
    """A shear of that size along the interface, in a direction of its own in 3D."""
    return size * (np.array([1.0, 0.0]) if dim == 2 else np.array([0.8, 0.6, 0.0]))


def stress(dim: int, shear: Array) -> Array:
    """Uniform stress: unit pressure along the last axis, and the shear."""
    result = np.zeros((dim, dim))
    result[-1] += PRESSURE * shear
    result[:, -1] += PRESSURE * shear
    result[-1, -1] = -PRESSURE
    return result


def displacement(x: Array, shear: Array) -> Array:
    """The field of that stress with Young's modulus one, zero at the bottom's corner, without turning the bottom; x: (n, dim)
    before the blocks are turned."""
    dim = x.shape[1]
    plane = dim == 2
    side = POISSON * (1.0 + POISSON) if plane else POISSON
    along = -(1.0 - POISSON**2) if plane else -1.0
    u = side * x
    u[:, -1] = along * x[:, -1]
    return PRESSURE * (u + 2.0 * (1.0 + POISSON) * np.outer(x[:, -1], shear))


def sheared(mesh: Mesh, size: float, slide: float | None = None, **contact: object) -> abut.Model:
    """Blocks under unit pressure and a shear (over the pressure) of ``size``. Friction alone holds the upper one, or where
    ``slide`` is given its top is moved on by that much in the direction of the shear, which is then what friction takes."""
    dim = mesh.dim
    turn, shear = turn_of(dim), shear_vector(dim, size)
    sigma = stress(dim, shear)
    normals = {"left": -np.eye(dim)[0], "right": np.eye(dim)[0]}
    if dim == 3:
        normals |= {"front": -np.eye(dim)[1], "back": np.eye(dim)[1]}
    loads = [
        abut.Traction(f"{body}.{side}", tuple(turn @ sigma @ n))
        for body in ("lower", "upper")
        for side, n in normals.items()
    ]

    def given(axis: int, shift: float):
        def value(points: Array) -> Array:
            u = displacement(points @ turn, shear) + shift * shear / max(size, 1e-300)
            return (u @ turn.T)[:, axis]

        return value

    supports = [abut.Support("lower.bottom", **{"xyz"[a]: given(a, 0.0) for a in range(dim)})]
    if slide is None:
        loads.append(abut.Traction("upper.top", tuple(turn @ sigma[:, -1])))
    else:
        supports.append(abut.Support("upper.top", **{"xyz"[a]: given(a, slide) for a in range(dim)}))
    return abut.Model(
        replace(mesh, points=mesh.points @ turn.T),
        [abut.Solid(b, abut.LinearElastic(1.0, POISSON)) for b in ("lower", "upper")],
        supports=supports,
        loads=loads,
        contacts=[abut.Contact("lower.top", "upper.bottom", **{"friction": FRICTION, **contact})],
        plane="strain" if dim == 2 else None,
    )


def errors(model: abut.Model, size: float, slide: float | None = None) -> tuple[float, float, float, abut.Solution]:
    """Largest relative errors of pressure, of tangential traction and of the displacement, and the solution."""
    solution = abut.solve(model)
    assert solution.converged
    dim = model.dim
    turn, shear = turn_of(dim), shear_vector(dim, size)
    contact = solution.contacts[0]
    used = np.isfinite(contact.pressure)
    pressure = np.abs(contact.pressure[used] / PRESSURE - 1.0).max()
    # the contactor is the lower block, whose top feels the stress of the upper one
    drag = np.abs(contact.friction.traction[used] / PRESSURE - turn @ shear).max()
    x = model.mesh.points @ turn
    exact = displacement(x, shear)
    if slide is not None:
        exact[model.mesh.nodes_of("upper")] += slide * shear / size
    exact = exact @ turn.T
    return pressure, drag, np.abs(solution.displacement - exact).max() / np.abs(exact).max(), solution

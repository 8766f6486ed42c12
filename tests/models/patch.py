"""The contact patch test: two flush blocks under uniform pressure, free to expand sideways, in a general position."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

import abut
from abut.mesh.make import block, join
from abut.mesh.mesh import Mesh

POISSON = 0.3
STRAIN = 1e-3  # pressure over Young's modulus: far above the rounding of the coordinates
CELL_OF = {"tri3": "wedge6", "tri6": "wedge15", "quad4": "hex8", "quad8": "hex20", "quad9": "hex27"}
# A rotation that leaves no direction along an axis.
_q, _ = np.linalg.qr(np.array([[1.0, 0.4, -0.3], [0.2, 1.0, 0.6], [0.5, -0.7, 1.0]]))
ROTATION = _q if np.linalg.det(_q) > 0 else -_q


def _perturb(amount: float, low: NDArray[np.float64], high: NDArray[np.float64], seed: int, cells: tuple[int, ...]):
    """Move corner points at random; points on a side stay in it."""

    def move(x: NDArray[np.float64]) -> NDArray[np.float64]:
        rng = np.random.default_rng(seed)
        shift = amount * rng.uniform(-1.0, 1.0, x.shape) * (high - low) / np.array(cells)
        on_side = (np.abs(x - low) < 1e-9) | (np.abs(x - high) < 1e-9)
        return x + np.where(on_side, 0.0, shift)

    return move


def two_blocks(
    lower: str, upper: str, cells: tuple[tuple[int, ...], tuple[int, ...]], distort: float = 0.2, seed: int = 3
) -> Mesh:
    """Unit blocks, the upper one 0.8 high, the interface at height 1; cell types by name."""
    dim = len(cells[0])
    parts = {}
    for name, cell, n, (low, high), s in (
        ("lower", lower, cells[0], (0.0, 1.0), seed), ("upper", upper, cells[1], (1.0, 1.8), seed + 1),
    ):  # fmt: skip
        a, b = np.zeros(dim), np.ones(dim)
        a[-1], b[-1] = low, high
        lines = [np.linspace(p, q, k + 1) for p, q, k in zip(a, b, n)]
        parts[name] = block.grid(lines, cell, _perturb(distort, a, b, s, n))
    return join(parts)


def model(mesh: Mesh, young: tuple[float, float] = (1.0, 1.0), rotate: bool = True, **contact: object) -> abut.Model:
    """Unit pressure over STRAIN times the softer modulus on top; symmetry supports on two sides and below."""
    dim = mesh.dim
    pressure = STRAIN * min(young)
    if rotate and dim == 3:
        mesh = replace(mesh, points=mesh.points @ ROTATION.T)
    supports = [abut.Support("lower.bottom", normal=0.0)]
    for side in ("left", "front")[: dim - 1]:
        supports += [abut.Support(f"{body}.{side}", normal=0.0) for body in ("lower", "upper")]
    options = {"contactor": "lower.top", "target": "upper.bottom", **contact}
    return abut.Model(
        mesh,
        [abut.Solid(b, abut.LinearElastic(e, POISSON)) for b, e in zip(("lower", "upper"), young)],
        supports=supports,
        loads=[abut.Pressure("upper.top", pressure)],
        contacts=[abut.Contact(**options)],
        plane="strain" if dim == 2 else None,
    )


def exact_displacement(built: abut.Model, rotated: bool = True) -> NDArray[np.float64]:
    """Uniaxial compression along the last axis with free sides, in the position of the model's mesh."""
    mesh = built.mesh
    dim = mesh.dim
    turn = ROTATION if rotated and dim == 3 else np.eye(dim)
    x = mesh.points @ turn
    young = {solid.body: solid.material.young for solid in built.solids}
    pressure = built.loads[0].value
    u = np.zeros_like(x)
    base = 0.0
    for body in ("lower", "upper"):
        nodes = mesh.nodes_of(body)
        strain = pressure / young[body]
        if dim == 2:
            side, along = POISSON * (1 + POISSON) * strain, -(1 - POISSON**2) * strain
        else:
            side, along = POISSON * strain, -strain
        u[nodes, :-1] = side * x[nodes, :-1]
        height = 0.0 if body == "lower" else 1.0
        u[nodes, -1] = base + along * (x[nodes, -1] - height)
        base += along
    return u @ turn.T


def errors(built: abut.Model, rotated: bool = True) -> tuple[float, float]:
    """Largest relative errors of the contact pressure and of the displacement."""
    solution = abut.solve(built)
    assert solution.converged
    pressure = built.loads[0].value
    exact = exact_displacement(built, rotated)
    p = solution.contacts[0].pressure
    return (
        float(np.nanmax(np.abs(p / pressure - 1.0))),
        float(np.abs(solution.displacement - exact).max() / np.abs(exact).max()),
    )

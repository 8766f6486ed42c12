"""An O-ring between two plates, squeezed by a quarter, then pushed against a wall by a fluid: plane strain."""

from __future__ import annotations

from itertools import pairwise

import numpy as np
from numpy.typing import NDArray

import abut
from abut.mesh.cell_block import CellBlock
from abut.mesh.make import join, rectangle
from abut.mesh.promote import promote

RADIUS, WALL, SQUEEZE = 1.765, 2.3, 0.25
FLUID, FRICTION = 3.0, 0.2
WET = np.pi / 4.0  # to either side of the middle of the free side: contact with the plates begins beyond, squeezed
YOUNG, POISSON = 6.0, 0.4999
CORE, BULGE = 0.39, 0.12  # half width of the square in the middle over the radius, and how much its sides bulge
BODIES = ("floor", "wall", "cover")


def disc(n: int, cell: str) -> abut.Mesh:
    """n x n cells in the middle, 4 n around; surfaces wet, the quarter on the side of -x, and skin, the others."""
    layers = max(2, 2 * n // 3)
    u, v = (x.ravel() for x in np.meshgrid(*2 * [np.linspace(-1.0, 1.0, n + 1)], indexing="ij"))
    middle = CORE * RADIUS * np.column_stack([u * (1.0 + BULGE * (1.0 - v**2)), v * (1.0 + BULGE * (1.0 - u**2))])
    at = np.arange((n + 1) ** 2).reshape(n + 1, n + 1)
    loop = np.concatenate([at[n, :n], at[n:0:-1, n], at[0, n:0:-1], at[:n, 0]])
    angle = np.pi * (-0.25 + 2.0 * np.arange(4 * n) / (4 * n))
    round_side = RADIUS * np.column_stack([np.cos(angle), np.sin(angle)])
    shares = np.arange(1, layers + 1) / layers
    points = np.vstack([middle, *(middle[loop] + share * (round_side - middle[loop]) for share in shares)])
    rows = [loop, *(len(middle) + 4 * n * k + np.arange(4 * n) for k in range(layers))]
    inside = np.stack([at[:-1, :-1], at[1:, :-1], at[1:, 1:], at[:-1, 1:]], axis=2).reshape(-1, 4)
    around = [np.column_stack([a, b, np.roll(b, -1), np.roll(a, -1)]) for a, b in pairwise(rows)]
    quads = np.concatenate([inside, *around])
    outer = len(quads) - 4 * n + np.arange(4 * n)  # whose second side is the round one
    if cell.startswith("tri"):
        quads = np.concatenate([quads[:, [0, 1, 2]], quads[:, [0, 2, 3]]])
    points, nodes = promote(points, quads, "tri3" if cell.startswith("tri") else "quad4", cell)
    if cell != "quad4":
        own = nodes[outer][:, quads.shape[1] + 1]
        points[own] *= RADIUS / np.linalg.norm(points[own], axis=1, keepdims=True)
    facets = np.column_stack([outer, np.ones_like(outer)])
    wet = np.abs(np.pi - (angle + np.pi / (4 * n))) < WET
    return abut.Mesh(
        points,
        [CellBlock(cell, nodes)],
        {"ring": np.arange(len(nodes))},
        {"wet": facets[wet], "skin": facets[~wet]},
    )


def o_ring(n: int, cell: str) -> abut.Model:
    """Squeezed until time 1/2, then pushed."""
    mesh = join(
        {
            "ring": disc(n, cell),
            "floor": rectangle((-4.0, WALL + 1.0), (-RADIUS - 1.0, -RADIUS), (1, 1), "quad4"),
            "wall": rectangle((WALL, WALL + 1.0), (-RADIUS, RADIUS), (1, 1), "quad4"),
            "cover": rectangle((-4.0, WALL), (RADIUS, RADIUS + 1.0), (1, 1), "quad4"),
        }
    )
    shear = 0.5 * YOUNG / (1.0 + POISSON)
    rubber = abut.NeoHooke(shear=shear, bulk=YOUNG / 3.0 / (1.0 - 2.0 * POISSON), volumetric="isochoric")
    down = abut.Amplitude([(0.0, 0.0), (0.5, 1.0), (1.0, 1.0)])
    fluid = abut.Pressure("ring.wet", FLUID, amplitude=abut.Amplitude([(0.0, 0.0), (0.5, 0.0), (1.0, 1.0)]))
    sides = zip(BODIES, ("top", "left", "bottom"))
    rigid = [abut.Rigid(body, x=0.0, y=0.0, rz=0.0) for body in BODIES[:2]]
    return abut.Model(
        mesh,
        [abut.Solid("ring", rubber, integration="mixed")],
        [],
        [fluid],
        contacts=[abut.Contact("ring.skin", f"{body}.{side}", name=body, friction=FRICTION) for body, side in sides],
        rigid=[*rigid, abut.Rigid("cover", x=0.0, y=-2.0 * SQUEEZE * RADIUS, rz=0.0, amplitude=down)],
        plane="strain",
        kinematics="finite",
        solve=abut.SolveOptions(steps=20),
    )


def wet_ends(solution: abut.Solution) -> NDArray[np.float64]:
    """(2, 2) the ends of the deformed wet side, lower one first."""
    mesh = solution.model.mesh
    nodes = mesh.nodes_of("ring.wet")
    nodes = nodes[np.argsort(mesh.points[nodes, 1])]
    return (mesh.points + solution.displacement)[nodes[[0, -1]]]

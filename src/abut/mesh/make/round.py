"""Round bodies: tensor grids bent into discs, cylinders and the octant of a ball; nodes of round sides lie on them."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from abut import checks
from abut.errors import InputError
from abut.mesh.cell_block import CellBlock
from abut.mesh.make.block import axis, grid
from abut.mesh.make.grading import MOST, graded
from abut.mesh.mesh import Mesh
from abut.mesh.promote import middles

CROWDED = 0.3  # of the distances from the round sides of an octant: about the last fifth of the way to where they meet


def disc(
    radius: float = 1.0,
    centre: Sequence[float] = (0.0, 0.0),
    fine: float | None = None,
    cells: int = 12,
    growth: float = 1.25,
    cell: str = "quad8",
) -> Mesh:
    """A disc, graded toward its lowest point. fine, cells, growth as for ``half_disc``. Surface round; node set axis."""
    radius, along, up = _lines(radius, fine, cells, growth)
    mesh = _section(_mirrored(along), np.concatenate([up, -up[-2::-1]]), radius, cell)
    surfaces = {"round": np.concatenate(list(mesh.surfaces.values()))}
    return _finish(replace(mesh, surfaces=surfaces, node_sets={"axis": _axis(mesh, radius)}), radius, centre)


def cylinder(
    radius: float = 1.0,
    z: Sequence[float] = (0.0, 1.0),
    cells: Sequence[int] = (8, 8),
    cell: str = "hex20",
    inner: float | None = None,
) -> Mesh:
    """A cylinder along z. Surfaces round (the outside), bottom, top.

    Solid: ``cells`` = (across the diameter, along the axis). With ``inner``, the radius of a bore (surface inner):
    ``cells`` = (through the wall, around, along the axis).
    """
    radius = checks.positive(radius, "radius")
    if inner is not None:
        return _tube(radius, checks.positive(inner, "inner"), z, cells, cell)
    if isinstance(cells, (int, str)) or len(cells) != 2:
        raise InputError(f"cells: expected 2 whole numbers, got {cells!r}")
    across = axis((-1.0, 1.0), cells[0], "cylinder: cells across")

    def bend(x: NDArray[np.float64]) -> NDArray[np.float64]:
        return np.column_stack([radius * _disc_map(x[:, :2]), x[:, 2]])

    mesh = grid([across, across, axis(z, cells[1], "cylinder: z")], cell, bend)
    sides = [mesh.surfaces[n] for n in ("left", "right", "front", "back")]
    surfaces = {"round": np.concatenate(sides), "bottom": mesh.surfaces["bottom"], "top": mesh.surfaces["top"]}
    return _rounded(replace(mesh, surfaces=surfaces), radius, 2)


def _tube(radius: float, inner: float, z: Sequence[float], cells: Sequence[int], cell: str) -> Mesh:
    if inner >= radius:
        raise InputError(f"inner: expected less than the radius {radius:g}, got {inner!r}")
    if isinstance(cells, (int, str)) or len(cells) != 3 or not isinstance(cells[1], int) or cells[1] < 4:
        raise InputError(f"cells: expected 3 whole numbers (wall, around, along), 4 or more around, got {cells!r}")
    lines = (
        axis((inner, radius), cells[0], "cylinder: cells through the wall"),
        axis((0.0, 1.0), cells[1], "cylinder: cells around"),
        axis(z, cells[2], "cylinder: z"),
    )
    mesh = grid(lines, cell)
    # The nodes at the end of the turn become those at its start. Mid nodes are bent too, so that all layers are round.
    start, end = mesh.nodes_of("front"), mesh.nodes_of("back")
    start, end = (n[np.lexsort(np.round(mesh.points[n][:, [0, 2]], 12).T)] for n in (start, end))
    number = np.arange(len(mesh.points))
    number[end] = start
    kept = np.setdiff1d(number, end)
    number = np.searchsorted(kept, number)
    r, turn, height = mesh.points[kept].T
    points = np.column_stack([r * np.cos(2 * np.pi * turn), r * np.sin(2 * np.pi * turn), height])
    blocks = tuple(CellBlock(b.kind, number[b.nodes].astype(np.int32)) for b in mesh.blocks)
    names = {"inner": "left", "round": "right", "bottom": "bottom", "top": "top"}
    surfaces = {new: mesh.surfaces[old] for new, old in names.items()}
    return Mesh(points, blocks, mesh.bodies, surfaces)


def half_disc(
    radius: float = 1.0,
    centre: Sequence[float] = (0.0, 0.0),
    fine: float | None = None,
    cells: int = 12,
    growth: float = 1.25,
    cell: str = "quad8",
    flat: str = "top",
) -> Mesh:
    """Half a disc, round side down, graded toward its lowest point; ``flat="bottom"`` turns it by 180 degrees.

    fine: half width of the evenly meshed zone at the lowest point (a tenth of the radius), with ``cells`` cells across
    it; cells grow by ``growth`` outward and upward. Surfaces round, flat; node set axis (the line x = 0, for a
    symmetry support).
    """
    checks.choice(flat, "flat", ("top", "bottom"))
    radius, along, up = _lines(radius, fine, cells, growth)
    mesh = _section(_mirrored(along), up, radius, cell)
    surfaces = {
        "round": np.concatenate([mesh.surfaces[n] for n in ("left", "bottom", "right")]),
        "flat": mesh.surfaces["top"],
    }
    if flat == "bottom":
        mesh = replace(mesh, points=-mesh.points)
    return _finish(replace(mesh, surfaces=surfaces, node_sets={"axis": _axis(mesh, radius)}), radius, centre)


def quarter_disc(
    radius: float = 1.0,
    centre: Sequence[float] = (0.0, 0.0),
    fine: float | None = None,
    cells: int = 12,
    growth: float = 1.25,
    cell: str = "quad8",
) -> Mesh:
    """The right half of a ``half_disc``: the section of a ball for axisymmetric models. Surfaces round, flat (top), left
    (on the line x = 0)."""
    radius, along, up = _lines(radius, fine, cells, growth)
    mesh = _section(along, up, radius, cell)
    surfaces = {
        "round": np.concatenate([mesh.surfaces[n] for n in ("bottom", "right")]),
        "flat": mesh.surfaces["top"],
        "left": mesh.surfaces["left"],
    }
    return _finish(replace(mesh, surfaces=surfaces), radius, centre)


def _mirrored(along: NDArray[np.float64]) -> NDArray[np.float64]:
    """Grid lines on [-1, 1] from those on [0, 1]."""
    return np.concatenate([-along[:0:-1], along])


def _section(x: NDArray[np.float64], y: NDArray[np.float64], radius: float, cell: str) -> Mesh:
    """Grid lines in the square [-1, 1]^2, bent into a disc."""
    return grid([x, y], cell, lambda points: radius * _disc_map(points))


def _lines(
    radius: float, fine: float | None, cells: int, growth: float
) -> tuple[float, NDArray[np.float64], NDArray[np.float64]]:
    """Radius, and grid lines on [0, 1] across and [-1, 0] upward: fine near the lowest point."""
    radius = checks.positive(radius, "radius")
    fine = 0.1 * radius if fine is None else checks.positive(fine, "fine")
    if fine >= np.sqrt(0.5) * radius:
        raise InputError(f"fine: expected a length below 0.7 of the radius {radius:g}, got {fine!r}")
    if isinstance(cells, bool) or not isinstance(cells, int) or not 1 <= cells <= MOST:
        raise InputError(f"cells: expected a whole number from 1 to {MOST}, got {cells!r}")
    # On the rim the map to the disc shortens lengths by sqrt(1/2).
    return radius, _graded(np.sqrt(2.0) * fine, cells, radius, growth), -1.0 + _graded(fine / cells, 1, radius, growth)


def _graded(fine: float, cells: int, radius: float, growth: float) -> NDArray[np.float64]:
    """Grid lines on [0, 1]; no thin cell at the end where little is left beyond ``fine``."""
    if radius - fine < 0.5 * fine / cells:
        return np.linspace(0.0, 1.0, cells + 1)
    return graded(fine / radius, cells, 1.0, growth)


def _axis(mesh: Mesh, radius: float) -> NDArray[np.int64]:
    return np.flatnonzero(np.abs(mesh.points[:, 0]) < 1e-12 * radius).astype(np.int64)


def _disc_map(x: NDArray[np.float64]) -> NDArray[np.float64]:
    """Square [-1, 1]^2 -> unit disc: concentric squares go to ellipse-like curves, the sides to the circle."""
    u, v = x.T
    return np.stack([u * np.sqrt(1.0 - 0.5 * v**2), v * np.sqrt(1.0 - 0.5 * u**2)], axis=1)


def _rounded(mesh: Mesh, radius: float, axes: int) -> Mesh:
    """Put all nodes of the round side at their radius from the origin, along the first ``axes`` axes."""
    points = mesh.points.copy()
    nodes = mesh.nodes_of("round")
    points[nodes, :axes] *= radius / np.linalg.norm(points[nodes, :axes], axis=1, keepdims=True)
    middles(points, mesh.blocks[0].nodes, mesh.blocks[0].kind, nodes)
    return replace(mesh, points=points)


def _finish(mesh: Mesh, radius: float, centre: Sequence[float]) -> Mesh:
    """The round side made round, and the origin put at the centre."""
    mesh = _rounded(mesh, radius, mesh.dim)
    return replace(mesh, points=mesh.points + checks.array(centre, "centre", shape=(mesh.dim,)))


def sphere_octant(
    radius: float = 1.0,
    centre: Sequence[float] = (0.0, 0.0, 0.0),
    fine: float | None = None,
    cells: int = 8,
    growth: float = 1.3,
    cell: str = "hex20",
) -> Mesh:
    """The octant of a ball toward +x, +y and -z of its centre, graded toward its lowest point.

    fine: extent of the evenly meshed zone (a tenth of the radius) with ``cells`` cells along it. Surfaces round (the
    sphere), x0, y0, z0 (the flat sides).
    """
    # Near the pole the map to the ball shortens lengths as that to the disc does.
    radius, side, up = _lines(radius, fine, cells, growth)
    # Grid axes (y, x, -z): tetrahedra are cut along diagonals from the centre outward, so that none has all four corners
    # on the sphere.
    mesh = grid([side, side, -up[::-1]], cell, lambda x: radius * _octant_map(x[:, [1, 0, 2]]))
    surfaces = {
        "round": np.concatenate([mesh.surfaces[n] for n in ("top", "back", "right")]),
        "x0": mesh.surfaces["front"],
        "y0": mesh.surfaces["left"],
        "z0": mesh.surfaces["bottom"],
    }
    return _finish(replace(mesh, surfaces=surfaces), radius, centre)


def _octant_map(x: NDArray[np.float64]) -> NDArray[np.float64]:
    """Cube [0, 1]^3 -> octant of the unit ball below its centre, the three sides away from the centre to the sphere."""
    u, v, w = x.T
    ball = np.stack(
        [
            u * np.sqrt(np.maximum(1 - v**2 / 2 - w**2 / 2 + v**2 * w**2 / 3, 0)),
            v * np.sqrt(np.maximum(1 - w**2 / 2 - u**2 / 2 + w**2 * u**2 / 3, 0)),
            w * np.sqrt(np.maximum(1 - u**2 / 2 - v**2 / 2 + u**2 * v**2 / 3, 0)),
        ],
        axis=1,
    )
    # |p|^2 = 1 - a b c with a = 1 - u^2, ...: where the three round sides meet, points crowd under the sphere faster than it
    # bends. There they are put deeper, so that small cells are still convex.
    a, b, c = 1.0 - x.T**2
    edges = 1.0 - (1.0 - a * b) * (1.0 - b * c) * (1.0 - c * a)
    near = (edges < CROWDED) & (a * b * c > 0.0)
    depth = a[near] * b[near] * c[near]
    ball[near] *= np.sqrt((1.0 - depth * CROWDED / edges[near]) / (1.0 - depth))[:, None]
    return ball * np.array([1.0, 1.0, -1.0])

"""Contacts whose stresses have closed forms: Hertz's line and ball, Lame's press fit. Errors of what nodes show there.

Hertz's half spaces: the half width (radius) of contact is a hundredth or so of the bodies, since they differ from half
spaces by terms of that order."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

import abut
from abut.cells import CELLS
from abut.materials.invariants import von_mises
from abut.mesh.make import box, half_disc, join, quarter_disc, rectangle, ring, sphere_octant
from abut.types import Array

NU = 0.3
HALF_WIDTH, LINE_PEAK, LINE_FORCE = 6.2146 / 8.0, 3585.36 / 8.0, 35e3 / 64.0  # R = 50, E 210e3 on 70e3
RADIUS, BALL_PEAK, BALL_FORCE = 1.00964 / 10.0, 88.290 / 10.0, 60.0 * np.pi / 1000.0  # R = 8, E = 1000, rigid plane
FIT = 1.287775  # pressure of rings of radii 1, 2 and 3, E = 1000, interference 0.01, plane strain
INSIDE = 0.8  # of the half width: beyond, the pressure ends within two facets


def hertz_line(cell: str, n: int) -> abut.Model:
    """A cylinder on a block, facets alike, 0.78 n on the half width."""
    disc = half_disc(50.0, (0.0, 50.0), fine=1.0, cells=n, cell=cell)
    block = rectangle((-100.0, 100.0), (-200.0, 0.0), (2 * n, n), cell, fine={"x": [-1.0, 1.0], "y": [-1.0, 0.0]})
    return abut.Model(
        join({"cylinder": disc, "block": block}),
        [
            abut.Solid("cylinder", abut.LinearElastic(210e3, NU)),
            abut.Solid("block", abut.LinearElastic(70e3, NU)),
        ],
        [abut.Support("block.bottom", x=0, y=0), abut.Support("cylinder.axis", x=0)],
        [abut.Force("cylinder.flat", (0.0, -LINE_FORCE))],
        [abut.Contact("block.top", "cylinder.round")],
        plane="strain",
    )


def hertz_ball(cell: str, n: int, growth: float = 2.0) -> abut.Model:
    """A ball on a rigid plane, axisymmetric or an octant, whose layers grow by ``growth``, 0.9 n facets on the radius of
    contact."""
    material, solid = abut.LinearElastic(1000.0, NU), CELLS[cell].dim == 3
    if solid:
        whole = sphere_octant(8.0, (0.0, 0.0, 8.0), fine=0.11, cells=n, growth=growth, cell=cell)
        parts = {"ball": whole, "plane": box((0.0, 8.0), (0.0, 8.0), (-1.0, 0.0), (1, 1, 1))}
        held = [abut.Support(f"plane.{side}", x=0, y=0, z=0) for side in ("bottom", "top")]
        held += [abut.Support("ball.x0", x=0), abut.Support("ball.y0", y=0)]
        load = abut.Force("ball.z0", (0.0, 0.0, -BALL_FORCE / 4.0))
    else:
        half = quarter_disc(8.0, (0.0, 8.0), fine=0.11, cells=n, cell=cell)
        parts = {"ball": half, "plane": rectangle((0.0, 8.0), (-1.0, 0.0), (1, 1))}
        held = [abut.Support(f"plane.{side}", x=0, y=0) for side in ("bottom", "top")]
        load = abut.Force("ball.flat", (0.0, -BALL_FORCE))
    contact = abut.Contact("ball.round", "plane.top")
    solids = [abut.Solid(body, material) for body in parts]
    return abut.Model(join(parts), solids, held, [load], [contact], plane=None if solid else "axisymmetric")


def press_fit(cell: str, n: int) -> abut.Model:
    """A quarter of two rings shrunk on each other, plane strain, n cells through each wall and 3 n round."""
    parts = {
        "hub": ring((2.0, 3.0), cells=(n, 3 * n), cell=cell),
        "shaft": ring((1.0, 2.0), cells=(n, 3 * n), cell=cell),
    }
    held = [abut.Support(f"{body}.start", y=0) for body in parts] + [abut.Support(f"{body}.end", x=0) for body in parts]
    material = abut.LinearElastic(1000.0, NU)
    contact = abut.Contact("hub.inner", "shaft.outer", offset=-0.01)
    return abut.Model(join(parts), [abut.Solid(b, material) for b in parts], held, contacts=[contact], plane="strain")


def line_errors(solution: abut.Solution) -> dict[str, float]:
    """Over the largest pressure: normal and von Mises stress at nodes of contact; the largest shear below the surface over
    Hertz's, less 1 (McEwen 1949; Johnson, Contact Mechanics, 4.2)."""
    x, stress, a = solution.model.mesh.points, solution.steps[-1].stress, HALF_WIDTH
    nodes = _nodes(solution, "block.top", lambda x: np.abs(x[:, 0]) < INSIDE * a)
    p = np.sqrt(1.0 - (x[nodes, 0] / a) ** 2)
    known = {
        "normal": stress[nodes, 1] / LINE_PEAK + p,
        "von Mises": von_mises(stress[nodes]) / LINE_PEAK - (1 - 2 * NU) * p,
    }
    block = solution.model.mesh.nodes_of("block")
    middle = block[(np.abs(x[block, 0]) < 1e-9) & (x[block, 1] > -2 * a)]
    shear = np.hypot(0.5 * (stress[middle, 0] - stress[middle, 1]), stress[middle, 3])
    z = -x[middle, 1] / a
    exact = z - z**2 / np.sqrt(1.0 + z**2)
    return {**_largest(known), "shear": float(shear.max() / LINE_PEAK / exact.max() - 1.0)}


def ball_errors(solution: abut.Solution) -> dict[str, float]:
    """The same of the ball (Johnson, Contact Mechanics, 3.4)."""
    x, stress, a = solution.model.mesh.points, solution.steps[-1].stress / BALL_PEAK, RADIUS
    across, up = x[:, :-1], x.shape[1] - 1
    nodes = _nodes(solution, "ball.round", lambda x: np.linalg.norm(x[:, :-1], axis=1) < INSIDE * a)
    r = np.linalg.norm(across[nodes], axis=1) / a
    exact = ball_von_mises(r)
    known = {"normal": stress[nodes, up] + np.sqrt(1.0 - r**2), "von Mises": von_mises(stress[nodes]) - exact}
    body = solution.model.mesh.nodes_of("ball")
    axis = body[(np.linalg.norm(across[body], axis=1) < 1e-9) & (x[body, up] < 3 * a)]
    z = x[axis, up] / a
    flat = 1.0 / (1.0 + z**2)
    other = (1 + NU) * (1.0 - z * np.arctan2(1.0, z)) - 0.5 * flat
    shear = 0.5 * np.abs(stress[axis, 0] - stress[axis, up])
    return {**_largest(known), "shear": float(shear.max() / (0.5 * np.abs(flat - other)).max() - 1.0)}


def ball_von_mises(r: Array) -> Array:
    """Von Mises stress at the ball's surface over the largest pressure, at radii (n,) over that of contact, up to 1."""
    p = np.sqrt(1.0 - r**2)
    ring = np.where(r > 1e-6, (1.0 - p**3) / np.maximum(r, 1e-6) ** 2, 1.5) * (1 - 2 * NU) / 3.0
    return von_mises(np.column_stack([ring - p, -ring - 2 * NU * p, -p, np.zeros((len(p), 3))]))


def fit_errors(solution: abut.Solution) -> dict[str, float]:
    """Over the largest von Mises stress: radial and von Mises stress at nodes of contact on both sides (Lame)."""
    x, stress, result = solution.model.mesh.points, solution.steps[-1].stress, {"normal": 0.0, "von Mises": 0.0}
    for name, hoop in (("hub.inner", (9.0 + 4.0) / 5.0), ("shaft.outer", -(4.0 + 1.0) / 3.0)):
        nodes = solution.model.mesh.nodes_of(name)
        normal = x[nodes] / np.linalg.norm(x[nodes], axis=1, keepdims=True)
        radial = stress[nodes, 0] * normal[:, 0] ** 2 + stress[nodes, 1] * normal[:, 1] ** 2
        radial += 2.0 * stress[nodes, 3] * normal[:, 0] * normal[:, 1]
        exact = float(von_mises(FIT * np.array([[-1.0, hoop, NU * (hoop - 1.0), 0.0, 0.0, 0.0]]))[0])
        found = {"normal": (radial + FIT) / exact, "von Mises": von_mises(stress[nodes]) / exact - 1.0}
        result = {key: max(value, _largest(found)[key]) for key, value in result.items()}
    return result


def _nodes(solution: abut.Solution, on: str, where: Callable[[Array], Array]) -> Array:
    nodes = solution.model.mesh.nodes_of(on)
    return np.asarray(nodes[where(solution.model.mesh.points[nodes])])


def _largest(errors: dict[str, Array]) -> dict[str, float]:
    return {name: float(np.abs(values).max()) for name, values in errors.items()}

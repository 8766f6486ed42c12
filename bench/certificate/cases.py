"""Contacts with known pressures: cells of all kinds, unlike bodies, unlike meshes, either side as contactor."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass, replace
from itertools import product

import numpy as np
from numpy.typing import NDArray

import abut
from abut.mesh.make import box, cylinder, half_disc, join, quarter_disc, rectangle, ring, sphere_octant

Array = NDArray[np.float64]
NU = 0.3
FLAT, SOLID = ("tri3", "quad4", "tri6", "quad8", "quad9"), ("hex8", "tet4", "wedge6", "hex20", "tet10")
RATIOS = (1e-4, 1e-2, 0.1, 1.0, 10.0, 1e2, 1e4)
SIZES = ((4, 4), (6, 6), (10, 10), (16, 16), (8, 6), (6, 8), (12, 6), (6, 12), (15, 5), (5, 15), (20, 4), (4, 20))


@dataclass(frozen=True)
class Case:
    """name; order: of the cells; model: builds it; exact: points (n, dim) -> pressure (n,); where: points that count;
    bounded: whether the exact pressure has a largest value."""

    name: str
    order: int
    model: Callable[[], abut.Model]
    exact: Callable[[Array], Array]
    where: Callable[[Array], NDArray[np.bool_]]
    bounded: bool = True


def true_error(case: Case, solution: abut.Solution) -> float:
    """Largest error of the reported pressure at all nodes that count, mid-nodes included, over the largest exact one."""
    own = solution.contacts[0]
    used = (own.contactor.nodes >= 0) & own.covered[:, None]
    x, p = own.contactor.points[own.contactor.nodes[used]], own.pressure[used]
    inside = case.where(x)
    exact = case.exact(x)
    return float(np.abs(p - exact)[inside].max(initial=0.0) / np.abs(exact[inside]).max()) if inside.any() else 1.0


def order(cell: str) -> int:
    return 2 if cell in ("tri6", "quad8", "quad9", "hex20", "hex27", "tet10", "wedge15") else 1


def modulus(young: tuple[float, float]) -> float:
    return 1.0 / ((1.0 - NU**2) * sum(1.0 / e for e in young))


def solids(mesh: abut.Mesh, young: tuple[float, ...]) -> list[abut.Solid]:
    return [abut.Solid(body, abut.LinearElastic(e, NU)) for body, e in zip(mesh.bodies, young)]


def sides(one: str, other: str, swap: bool, **options: object) -> list[abut.Contact]:
    contactor, target = (other, one) if swap else (one, other)
    return [abut.Contact(contactor=contactor, target=target, **options)]


def everywhere(x: Array) -> NDArray[np.bool_]:
    return np.ones(len(x), dtype=bool)


def wide(cells: tuple[int, int], ratio: float, swap: bool) -> float:
    """Length of the fine part over the half width of contact: the edge of contact lies anywhere between nodes."""
    number = cells[0] + 3 * cells[1] + RATIOS.index(ratio) + 2 * swap
    return (1.05, 1.1, 1.15, 1.2, 1.25, 1.3, 1.35)[number % 7]


# A cylinder of radius 200 on a block, half width 6.


def line(cell: str, cells: tuple[int, int], ratio: float, swap: bool) -> Case:
    """cells: over the fine part of the cylinder and the block each."""
    fine = 6.0 * wide(cells, ratio, swap)
    young, (n, m) = (1000.0 * max(ratio, 1.0), 1000.0 / min(ratio, 1.0)), cells
    top = modulus(young) * 6.0 / 400.0

    def model() -> abut.Model:
        mesh = join(
            {
                "cylinder": half_disc(200.0, (0.0, 200.0), fine=fine, cells=n, cell=cell),
                "block": rectangle(
                    (-200.0, 200.0), (-400.0, 0.0), (2 * m, m), cell, {"x": [-fine, fine], "y": [-fine, 0]}
                ),
            }
        )
        return abut.Model(
            mesh, solids(mesh, young), [abut.Support("block.bottom", x=0, y=0), abut.Support("cylinder.axis", x=0)],
            [abut.Force("cylinder.flat", (0.0, -0.5 * np.pi * 6.0 * top))],
            sides("cylinder.round", "block.top", swap), plane="strain",
        )  # fmt: skip

    return Case(
        f"line {cell} {n} on {m}, E {ratio:g} : 1{', swapped' if swap else ''}", order(cell), model,
        lambda x: top * np.sqrt(np.maximum(0.0, 1.0 - (x[:, 0] / 6.0) ** 2)), lambda x: np.abs(x[:, 0]) < 5.4,
    )  # fmt: skip


# A ball of radius 8 on another, axisymmetric; on a rigid plane, an eighth of it in 3D.


def on_ball(young: tuple[float, float], radius: float, dim: int) -> tuple[float, Callable[[Array], Array], Callable]:
    """Force, pressure, and where it counts, of contact of radius 1.5."""
    a = 1.5
    force = 4.0 / 3.0 * modulus(young) * a**3 / radius
    top = 1.5 * force / (np.pi * a**2)

    def far(x: Array) -> Array:
        return np.linalg.norm(x[:, : dim - 1], axis=1)

    return force, lambda x: top * np.sqrt(np.maximum(0.0, 1.0 - (far(x) / a) ** 2)), lambda x: far(x) < 0.9 * a


def turned(mesh: abut.Mesh, cell: str) -> abut.Mesh:
    """A mesh of quadrilaterals or triangles turned by half a turn in its plane, then mirrored at the axis."""
    corners = 3 if cell.startswith("tri") else 4
    n = {"tri3": 3, "quad4": 4, "tri6": 6, "quad8": 8, "quad9": 9}[cell]
    nodes = [0, *range(corners - 1, 0, -1), *(range(2 * corners - 1, corners - 1, -1) if n > corners else ())]
    nodes += [8] if n == 9 else []
    facet = np.array([corners - 1 - k for k in range(corners)])
    blocks = tuple(replace(b, nodes=np.ascontiguousarray(b.nodes[:, nodes])) for b in mesh.blocks)
    surfaces = {name: np.column_stack([rows[:, 0], facet[rows[:, 1]]]) for name, rows in mesh.surfaces.items()}
    return replace(mesh, points=mesh.points * np.array([1.0, -1.0]), blocks=blocks, surfaces=surfaces)


def balls(cell: str, cells: tuple[int, int], ratio: float, swap: bool) -> Case:
    """cells: over the fine part of each."""
    fine = 1.5 * wide(cells, ratio, swap)
    young, (n, m) = (1000.0 * max(ratio, 1.0), 1000.0 / min(ratio, 1.0)), cells
    radius = 32.0
    force, exact, where = on_ball(young, 0.5 * radius, 2)

    def model() -> abut.Model:
        upper, lower = (quarter_disc(radius, (0.0, radius), fine=fine, cells=k, cell=cell) for k in cells)
        mesh = join({"upper": upper, "lower": turned(lower, cell)})
        return abut.Model(
            mesh, solids(mesh, young), [abut.Support("lower.flat", x=0, y=0)], [abut.Force("upper.flat", (0.0, -force))],
            sides("upper.round", "lower.round", swap), plane="axisymmetric",
        )  # fmt: skip

    name = f"balls {cell} {n} on {m}, E {ratio:g} : 1{', swapped' if swap else ''}"
    return Case(name, order(cell), model, exact, where)


def octant(cell: str, cells: int, fine: float = 1.67) -> Case:
    radius, soft = 16.0, 1000.0
    force, exact, where = on_ball((soft, 1e30), radius, 3)

    def model() -> abut.Model:
        ball = sphere_octant(radius, (0, 0, radius), fine=fine, cells=cells, growth=2.0, cell=cell)
        mesh = join({"ball": ball, "plane": box((0, radius), (0, radius), (-1, 0), (1, 1, 1), "hex8")})
        held = [abut.Support(f"plane.{side}", x=0, y=0, z=0) for side in ("bottom", "top")]
        held += [abut.Support("ball.x0", x=0), abut.Support("ball.y0", y=0)]
        load = abut.Force("ball.z0", (0.0, 0.0, -force / 4.0))
        return abut.Model(mesh, solids(mesh, (soft, soft)), held, [load], sides("ball.round", "plane.top", False))

    return Case(f"octant {cell} {cells} over {fine:g}", order(cell), model, exact, where)


# Rings of radii r, 10, 20 with an interference, plane strain: Lame, bodies of unlike stiffness.


def fit_pressure(young: tuple[float, float], inner: float, interference: float) -> float:
    give = 0.0
    for e, sign, r in ((young[0], 1.0, 20.0), (young[1], -1.0, inner)):
        plane, nu = e / (1.0 - NU**2), NU / (1.0 - NU)
        give += 10.0 / plane * ((100.0 + r**2) / abs(100.0 - r**2) + sign * nu)
    return interference / give


def fit(
    cell: str, cells: tuple[int, int], ratio: float, swap: bool, inner: float = 5.0, interference: float = 0.02,
    finite: bool = False,
) -> Case:  # fmt: skip
    """cells: a quarter round, of hub and shaft."""
    young, (n, m) = (210e3 * max(ratio, 1.0), 210e3 / min(ratio, 1.0)), cells
    p = fit_pressure(young, inner, interference)

    def model() -> abut.Model:
        deep = max(2, round((10.0 - inner) * m / 16.0)), max(3, round(10.0 * n / 20.0))
        hub = ring((10, 20), cells=(deep[1], n), cell=cell)
        mesh = join({"hub": hub, "shaft": ring((inner, 10), cells=(deep[0], m), cell=cell)})
        held = [
            abut.Support(f"{body}.{end}", **{a: 0}) for body in mesh.bodies for end, a in (("start", "y"), ("end", "x"))
        ]
        contact = sides("hub.inner", "shaft.outer", swap, offset=-interference)
        kind = "finite" if finite else "small"
        return abut.Model(mesh, solids(mesh, young), held, contacts=contact, plane="strain", kinematics=kind)

    thin = f", thin ({inner:g})" if inner > 8.0 else ""
    name = f"fit {cell} {n} on {m}, E {ratio:g} : 1, {interference:g}{thin}"
    name += f"{', swapped' if swap else ''}{', finite' if finite else ''}"
    return Case(name, order(cell), model, lambda x: np.full(len(x), p), everywhere)


def hydrostatic(cell: str, cells: tuple[int, int], swap: bool) -> Case:
    """Two rings under one pressure inside and outside: that pressure everywhere."""
    n, m = cells

    def model() -> abut.Model:
        mesh = join({"hub": ring((2, 3), cells=(4, n), cell=cell), "shaft": ring((1, 2), cells=(4, m), cell=cell)})
        held = [
            abut.Support(f"{body}.{end}", **{a: 0}) for body in mesh.bodies for end, a in (("start", "y"), ("end", "x"))
        ]
        loads = [abut.Pressure("hub.outer", 1.0), abut.Pressure("shaft.inner", 1.0)]
        contact = sides("hub.inner", "shaft.outer", swap)
        return abut.Model(mesh, solids(mesh, (1000.0, 1000.0)), held, loads, contact, plane="strain")

    name = f"hydrostatic {cell} {n} on {m}{', swapped' if swap else ''}"
    return Case(name, order(cell), model, lambda x: np.ones(len(x)), everywhere)


def tubes(cell: str, around: tuple[int, int], swap: bool) -> Case:
    """The fit in 3D, whole."""
    p = fit_pressure((210e3, 210e3), 5.0, 0.02)

    def model() -> abut.Model:
        hub = cylinder(20.0, (0, 4), (3, around[0], 1), cell, inner=10.0)
        mesh = join({"hub": hub, "shaft": cylinder(10.0, (0, 4), (2, around[1], 1), cell, inner=5.0)})
        held = [abut.Support(f"{b}.{s}", z=0) for b in mesh.bodies for s in ("bottom", "top")]
        contact = sides("hub.inner", "shaft.round", swap, offset=-0.02)
        return abut.Model(mesh, solids(mesh, (210e3, 210e3)), held, contacts=contact)

    name = f"tubes {cell} {around[0]} on {around[1]}{', swapped' if swap else ''}"
    return Case(name, order(cell), model, lambda x: np.full(len(x), p), everywhere)


# A flat punch of half width 1 with sharp edges on a wide block, as stiff as given; away from its edges.


def punch(cell: str, cells: tuple[int, int], stiff: float, swap: bool) -> Case:
    """cells: half of the punch, and of the block over the same length."""
    n, m = cells
    young = (1000.0 * stiff, 1000.0)

    def model() -> abut.Model:
        lower = rectangle((-40, 40), (-40, 0), (round(2.5 * m) * 2, m), cell, {"x": [-2.5, 2.5], "y": [-1, 0]})
        mesh = join({"punch": rectangle((-1, 1), (0, 2), (2 * n, 2 * n), cell), "block": lower})
        held = [abut.Support("block.bottom", x=0, y=0), abut.Support("punch.top", x=0)]
        load = abut.Pressure("punch.top", 1.0)
        return abut.Model(
            mesh, solids(mesh, young), held, [load], sides("punch.bottom", "block.top", swap), plane="strain"
        )

    return Case(
        f"punch {cell} {n} on {m}, E {stiff:g} : 1{', swapped' if swap else ''}", order(cell), model,
        lambda x: 2.0 / np.pi / np.sqrt(np.maximum(1.0 - x[:, 0] ** 2, 0.01)), lambda x: np.abs(x[:, 0]) < 0.8,
        bounded=False,
    )  # fmt: skip


AROUND = ((8, 12), (12, 8), (20, 8), (8, 20), (16, 24), (24, 16), (24, 24), (48, 64))


def cases() -> Iterator[Case]:
    """All of them."""
    for cell, cells, ratio, swap in product(FLAT, SIZES, RATIOS, (False, True)):
        if cells[0] * cells[1] < 200 or ratio == 1.0:
            yield line(cell, cells, ratio, swap)
    for cell, cells, ratio, swap in product(
        ("tri3", "quad4", "tri6", "quad8"), SIZES, (0.01, 1.0, 100.0), (False, True)
    ):
        yield balls(cell, cells, ratio, swap)
    for cell, cells, swap in product(FLAT, AROUND, (False, True)):
        for ratio, interference in ((1.0, 0.02), (1.0, 1e-3), (0.01, 0.02), (100.0, 0.02)):
            yield fit(cell, cells, ratio, swap, interference=interference)
        yield fit(cell, cells, 1.0, swap, inner=9.5)
        yield hydrostatic(cell, cells, swap)
        if cell in ("quad4", "quad8"):
            yield fit(cell, cells, 1.0, swap, finite=True)
    for cell, cells, swap in product(FLAT, ((8, 8), (16, 12), (12, 16), (20, 5), (5, 20), (50, 5)), (False, True)):
        yield punch(cell, cells, 1e4, swap)
    for cell, cells, fine in product(SOLID, (3, 4, 5, 7), (1.55, 1.67, 1.85)):
        yield octant(cell, cells, fine)
    for around, swap in product(((16, 16), (16, 24), (24, 16), (24, 30)), (False, True)):
        for cell in ("hex8", "hex20"):
            yield tubes(cell, around, swap)

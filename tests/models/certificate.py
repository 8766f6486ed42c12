"""Small models with known pressures, for the catalogue of runs that the certificate must tell apart."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

import abut
from abut.mesh.make import box, cylinder, half_disc, join, quarter_disc, rectangle, ring, sphere_octant

Array = NDArray[np.float64]
Exact = Callable[[Array], Array]  # points (n, dim) -> pressure (n,)
Truth = Callable[[abut.Solution], float]  # -> largest local error over the largest true pressure
NU = 0.3
SOFT = abut.LinearElastic(1000.0, NU)


def steel(young: float = 210e3) -> abut.LinearElastic:
    return abut.LinearElastic(young, NU)


def reported(solution: abut.Solution, contact: int = 0) -> tuple[Array, Array]:
    """Points (n, dim) of the covered facets' nodes and the pressure there (n,)."""
    own = solution.contacts[contact]
    used = (own.contactor.nodes >= 0) & own.covered[:, None]
    return own.contactor.points[own.contactor.nodes[used]], own.pressure[used]


def local(exact: Exact, where: Callable[[Array], NDArray[np.bool_]] | None = None, contact: int = 0) -> Truth:
    """Largest error of the reported pressure over the largest exact one, at all points or those ``where``."""

    def error(solution: abut.Solution) -> float:
        x, p = reported(solution, contact)
        wanted = exact(x)
        inside = np.ones(len(x), dtype=bool) if where is None else where(x)
        if not inside.any():
            return 1.0
        return float(np.abs(p - wanted)[inside].max() / np.abs(wanted).max())

    return error


def even(value: float, contact: int = 0) -> Truth:
    return local(lambda x: np.full(len(x), value), contact=contact)


def force(value: float, axis: int = -1, contact: int = 0) -> Truth:
    """Error of a component of the resultant over its true size."""
    return lambda solution: abs(abs(float(solution.contacts[contact].force[axis])) / value - 1.0)


def peak(value: float, contact: int = 0) -> Truth:
    """Error of the largest pressure, the headline."""
    return lambda solution: abs(solution.contacts[contact].max_pressure / value - 1.0)


def worst(*truths: Truth) -> Truth:
    return lambda solution: max(truth(solution) for truth in truths)


def along(fine: abut.Model, where: Callable[[Array], NDArray[np.bool_]] | None = None) -> Truth:
    """Error beside a fine mesh of the same problem, along the first coordinate."""

    def error(solution: abut.Solution) -> float:
        x, p = reported(abut.solve(fine))
        order = np.argsort(x[:, 0])
        return local(lambda at: np.interp(at[:, 0], x[order, 0], p[order]), where)(solution)

    return error


# Hertz: a cylinder of radius 50 on a block, half width 6; a ball of radius 8 on a rigid plane or another ball.


def line(
    cell: str = "quad8",
    cells: tuple[int, int] = (12, 12),
    young: tuple[float, float] = (1000.0, 1000.0),
    contactor: str = "cylinder",
    **options: object,
) -> abut.Model:
    """cells: over 8 on the cylinder and the block each; young: of both."""
    n, m = cells
    mesh = join(
        {
            "cylinder": half_disc(50.0, (0.0, 50.0), fine=8.0, cells=n, cell=cell),
            "block": rectangle((-100.0, 100.0), (-200.0, 0.0), (2 * m, m), cell, {"x": [-8, 8], "y": [-8, 0]}),
        }
    )
    modulus = 1.0 / ((1.0 - NU**2) * sum(1.0 / e for e in young))
    load = 0.25 * np.pi * 36.0 * modulus / 50.0
    sides = ("cylinder.round", "block.top") if contactor == "cylinder" else ("block.top", "cylinder.round")
    return abut.Model(
        mesh,
        [abut.Solid(body, steel(e)) for body, e in zip(("cylinder", "block"), young)],
        [abut.Support("block.bottom", x=0, y=0), abut.Support("cylinder.axis", x=0)],
        [abut.Force("cylinder.flat", (0.0, -load))],
        [abut.Contact(contactor=sides[0], target=sides[1], **options)],
        plane="strain",
    )


def line_truth(young: tuple[float, float] = (1000.0, 1000.0)) -> Truth:
    modulus = 1.0 / ((1.0 - NU**2) * sum(1.0 / e for e in young))
    top = modulus * 6.0 / (2.0 * 50.0)
    exact = local(lambda x: top * np.sqrt(np.maximum(0.0, 1.0 - (x[:, 0] / 6.0) ** 2)), lambda x: np.abs(x[:, 0]) < 5.0)
    return worst(exact, peak(top))


BALL_FORCE = 60.0 * np.pi


def ball(cell: str = "quad8", cells: int = 10, **options: object) -> abut.Model:
    """Axisymmetric, on a rigid plane."""
    mesh = join(
        {
            "ball": quarter_disc(8.0, (0.0, 8.0), fine=1.5, cells=cells, cell=cell),
            "plane": rectangle((0.0, 8.0), (-1.0, 0.0), (1, 1), "quad4"),
        }
    )
    return abut.Model(
        mesh,
        [abut.Solid(body, SOFT) for body in mesh.bodies],
        [abut.Support("plane.bottom", x=0, y=0), abut.Support("plane.top", x=0, y=0)],
        [abut.Force("ball.flat", (0.0, -BALL_FORCE))],
        [abut.Contact(contactor="ball.round", target="plane.top", **options)],
        plane="axisymmetric",
    )


def balls(cell: str, cells: tuple[int, int], young: tuple[float, float]) -> abut.Model:
    """Axisymmetric, a ball of radius 8 on another, of other stiffness."""
    mesh = join(
        {
            "upper": quarter_disc(8.0, (0.0, 8.0), fine=1.5, cells=cells[0], cell=cell),
            "lower": mirrored(quarter_disc(8.0, (0.0, 8.0), fine=1.5, cells=cells[1], cell=cell)),
        }
    )
    return abut.Model(
        mesh,
        [abut.Solid(body, steel(e)) for body, e in zip(("upper", "lower"), young)],
        [abut.Support("lower.flat", x=0, y=0)],
        [abut.Force("upper.flat", (0.0, -BALL_FORCE))],
        [abut.Contact("upper.round", "lower.round")],
        plane="axisymmetric",
    )


def mirrored(mesh: abut.Mesh) -> abut.Mesh:
    """A mesh of quadrilaterals or triangles turned over y = 0, with its cells' nodes put in order again."""
    from abut.mesh.mesh import CellBlock

    order = {"tri3": [0, 2, 1], "quad4": [0, 3, 2, 1], "quad8": [0, 3, 2, 1, 7, 6, 5, 4], "tri6": [0, 2, 1, 5, 4, 3]}
    facet = {"tri3": [2, 1, 0], "tri6": [2, 1, 0], "quad4": [3, 2, 1, 0], "quad8": [3, 2, 1, 0]}
    kind = mesh.blocks[0].kind
    blocks = tuple(CellBlock(b.kind, np.ascontiguousarray(b.nodes[:, order[kind]])) for b in mesh.blocks)
    turn = np.array(facet[kind])
    surfaces = {name: np.column_stack([rows[:, 0], turn[rows[:, 1]]]) for name, rows in mesh.surfaces.items()}
    return replace(mesh, points=mesh.points * np.array([1.0, -1.0]), blocks=blocks, surfaces=surfaces)


def octant(cell: str, cells: int, **options: object) -> abut.Model:
    """An eighth of the ball on a rigid plane, in 3D."""
    mesh = join(
        {
            "ball": sphere_octant(8.0, (0, 0, 8), fine=1.5, cells=cells, growth=2.0, cell=cell),
            "plane": box((0, 8), (0, 8), (-1, 0), (1, 1, 1), "hex8"),
        }
    )
    return abut.Model(
        mesh,
        [abut.Solid(body, SOFT) for body in mesh.bodies],
        [
            *(abut.Support(f"plane.{side}", x=0, y=0, z=0) for side in ("bottom", "top")),
            abut.Support("ball.x0", x=0),
            abut.Support("ball.y0", y=0),
        ],
        [abut.Force("ball.z0", (0.0, 0.0, -BALL_FORCE / 4.0))],
        [abut.Contact(contactor="ball.round", target="plane.top", **options)],
    )


def ball_truth(radius: float = 8.0, modulus: float = 1000.0 / (1.0 - NU**2)) -> Truth:
    """radius: of both sides together."""
    a = (0.75 * BALL_FORCE * radius / modulus) ** (1.0 / 3.0)
    top = 1.5 * BALL_FORCE / (np.pi * a**2)

    def far(x: Array) -> Array:
        return np.linalg.norm(x[:, :-1], axis=1)

    exact = local(lambda x: top * np.sqrt(np.maximum(0.0, 1.0 - (far(x) / a) ** 2)), lambda x: far(x) < 0.8 * a)
    return worst(exact, peak(top))


# Press fits, radii 5, 10, 20, by Lame.


def faceted(model: abut.Model) -> abut.Model:
    """With gaps between facets instead of smooth surfaces."""
    return replace(model, contacts=[replace(contact, geometry="faceted") for contact in model.contacts])


def fit(
    around: tuple[int, int], cell: str = "quad8", interference: float = 0.02, swap: bool = False, plane: str = "stress"
) -> abut.Model:
    hub, shaft = around
    mesh = join({"hub": ring((10, 20), cells=(5, hub), cell=cell), "shaft": ring((5, 10), cells=(4, shaft), cell=cell)})
    ends = (("start", "y"), ("end", "x"))
    supports = [abut.Support(f"{body}.{end}", **{a: 0}) for body in mesh.bodies for end, a in ends]
    sides = ("shaft.outer", "hub.inner") if swap else ("hub.inner", "shaft.outer")
    contact = abut.Contact(contactor=sides[0], target=sides[1], offset=-interference)
    return abut.Model(mesh, [abut.Solid(b, steel()) for b in mesh.bodies], supports, contacts=[contact], plane=plane)


def fit_pressure(interference: float = 0.02) -> float:
    return interference * 210e3 / 10 / (500 / 300 + 125 / 75)


def tubes(around: tuple[int, int], cell: str = "hex8", linear: str = "auto", held: bool = True) -> abut.Model:
    """The same in 3D, whole, both ends held along the axis (plane strain), or free in space."""
    mesh = join(
        {
            "hub": cylinder(20.0, (0, 4), (3, around[0], 1), cell, inner=10.0),
            "shaft": cylinder(10.0, (0, 4), (2, around[1], 1), cell, inner=5.0),
        }
    )
    supports = [abut.Support(f"{b}.{s}", z=0) for b in mesh.bodies for s in ("bottom", "top")] if held else []
    contact = abut.Contact(contactor="hub.inner", target="shaft.round", offset=-0.02)
    options = abut.SolveOptions(linear=linear)
    return abut.Model(mesh, [abut.Solid(b, steel()) for b in mesh.bodies], supports, contacts=[contact], solve=options)


def wrapped(cell: str = "quad8") -> abut.Model:
    """Axisymmetric: hub and shaft of one length."""
    mesh = join({"hub": rectangle((10, 20), (0, 4), (6, 3), cell), "shaft": rectangle((5, 10), (0, 4), (4, 2), cell)})
    sides = [abut.Support(f"{body}.{side}", y=0) for body in mesh.bodies for side in ("bottom", "top")]
    contact = abut.Contact(contactor="hub.left", target="shaft.right", offset=-0.02)
    return abut.Model(
        mesh, [abut.Solid(b, steel()) for b in mesh.bodies], sides, contacts=[contact], plane="axisymmetric"
    )


STRAIN_FIT = fit_pressure() / (1.0 - NU**2)  # plane strain, equal materials


# Blocks.


def squares(
    n: int, m: int, cell: str = "quad4", young: tuple[float, float] = (1.0, 1.0), down: float = -0.05, **options: object
) -> abut.Model:
    """Two unit squares clamped on the far sides, pressed and sheared: n cells along the contactor below, m above."""
    mesh = join(
        {"lower": rectangle((0, 1), (0, 1), (n, n), cell), "upper": rectangle((0, 1), (1, 2), (m, m), cell)},
    )
    return abut.Model(
        mesh,
        [abut.Solid(body, abut.LinearElastic(e, NU)) for body, e in zip(("lower", "upper"), young)],
        [abut.Support("lower.bottom", x=0, y=0), abut.Support("upper.top", x=0.02, y=down)],
        contacts=[abut.Contact(contactor="lower.top", target="upper.bottom", **options)],
        plane="strain",
    )


def away_from_ends(x: Array) -> NDArray[np.bool_]:
    """The corners of equal squares are mildly singular."""
    return np.asarray((x[:, 0] > 0.15) & (x[:, 0] < 0.85))


def column(lower: str, upper: str, cells: tuple[tuple[int, ...], tuple[int, ...]], **options: object) -> abut.Model:
    """A pressure of 1e-3 through two blocks that do not match, distorted: the contact patch test."""
    from models.patch import model, two_blocks

    return model(two_blocks(lower, upper, cells), young=(1.0, 3.0), **options)


def plate(cell: str, n: int, m: int, contactor: str = "plate", down: float = -0.01) -> abut.Model:
    """A narrow block (2 < x < 4, n cells wide) pressed on a plate (0 < x < 6, 3 m cells): the plate hangs over."""
    mesh = join(
        {"plate": rectangle((0, 6), (0, 2), (3 * m, m), cell), "block": rectangle((2, 4), (2, 4), (n, n), cell)}
    )
    sides = ("plate.top", "block.bottom") if contactor == "plate" else ("block.bottom", "plate.top")
    return abut.Model(
        mesh,
        [abut.Solid(body, SOFT) for body in mesh.bodies],
        [abut.Support("plate.bottom", x=0, y=0), abut.Support("block.top", x=0, y=down)],
        contacts=[abut.Contact(contactor=sides[0], target=sides[1])],
        plane="strain",
    )


def under(x: Array) -> NDArray[np.bool_]:
    """Under the narrow block, away from its sharp corners, where the pressure is singular."""
    return np.asarray((x[:, 0] > 2.4) & (x[:, 0] < 3.6))

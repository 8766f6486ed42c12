"""Contact problems with known pressure, and how far the pressure that is reported is from it."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray

import abut
from abut.benchmarks.errors import pressure_l2
from abut.cells import BY_CODE
from abut.mesh.make import box, half_disc, join, quarter_disc, rectangle, sphere_octant
from abut.mesh.make.block import grid
from abut.solution import ContactResult
from models.best_fit import fits
from models.certificate import mirrored

Array = NDArray[np.float64]
Exact = Callable[[Array], Array]  # points (n, dim) -> pressure (n,)
INSIDE = 0.9  # of the half width or radius of contact: where pressures are compared


def at_corners(contact: ContactResult, values: Array | None = None) -> tuple[Array, Array]:
    """Corner points of the contactor (n, dim) and the reported pressure there, or other ``values`` (n_facets, 9)."""
    surface = contact.contactor
    corners = np.array([BY_CODE[code].corners for code in surface.kinds])
    used = np.arange(9) < corners[:, None]
    nodes, first = np.unique(surface.nodes[used], return_index=True)
    return surface.points[nodes], (contact.pressure if values is None else values)[used][first]


def ellipse(radius: float, peak: float, dim: int) -> Exact:
    """Hertz's pressure over the first coordinate (2D, also axisymmetric), or over the distance from the z axis (3D)."""
    return lambda x: peak * np.sqrt(np.maximum(0.0, 1.0 - (x[:, : max(1, dim - 1)] ** 2).sum(axis=1) / radius**2))


def distance(x: Array) -> Array:
    return np.asarray(np.sqrt((x[:, : max(1, x.shape[1] - 1)] ** 2).sum(axis=1)))


def errors(solution: abut.Solution, radius: float, peak: float) -> tuple[float, float, float]:
    """Largest error at facet corners inside INSIDE a, root mean square at those within 1.5 a, both over the peak; relative
    L2 error over the contactor."""
    exact = ellipse(radius, peak, solution.model.dim)
    x, p = at_corners(solution.contacts[0])
    r, error = distance(x), np.abs(p - exact(x)) / peak
    return (
        float(error[r < INSIDE * radius].max()),
        float(np.sqrt((error[r < 1.5 * radius] ** 2).mean())),
        pressure_l2(solution, exact),
    )


def everywhere(solution: abut.Solution, radius: float, peak: float) -> tuple[float, float]:
    """Mean and largest error at all nodes inside INSIDE a, mid-nodes included, over the peak."""
    contact = solution.contacts[0]
    used = contact.contactor.nodes >= 0
    nodes, first = np.unique(contact.contactor.nodes[used], return_index=True)
    x = contact.contactor.points[nodes]
    error = np.abs(contact.pressure[used][first] - ellipse(radius, peak, solution.model.dim)(x)) / peak
    inside = error[distance(x) < INSIDE * radius]
    return float(inside.mean()), float(inside.max())


def iterations(solution: abut.Solution) -> int:
    return len(solution.steps[-1].iterations)


# A steel cylinder on an aluminium block, NAFEMS R0094: half width and peak of the exact pressure.
LINE, LINE_PEAK = 6.2146, 3585.36


def line(
    cell: str, n: int, contactor: str = "block", flatter: float = 1.0, width: float = LINE, **contact: object
) -> abut.Model:
    """n: facets over a length of 8 on both sides. flatter: factor on the cylinder's radius and the block's size, for the
    half space of the formula; width: the half width at which the load aims."""
    far = 100.0 * flatter
    mesh = join(
        {
            "cylinder": half_disc(50.0 * flatter, (0.0, 50.0 * flatter), fine=8.0, cells=n, cell=cell),
            "block": rectangle(
                (-far, far),
                (-2.0 * far, 0.0),
                (2 * n, n),
                cell,
                {"x": [-8, 8], "y": [-8, 0]},
            ),
        }
    )
    sides = ("block.top", "cylinder.round") if contactor == "block" else ("cylinder.round", "block.top")
    load = 35e3 * (width / LINE) ** 2 / flatter
    return abut.Model(
        mesh,
        [abut.Solid("cylinder", abut.LinearElastic(210e3, 0.3)), abut.Solid("block", abut.LinearElastic(70e3, 0.3))],
        [abut.Support("block.bottom", x=0, y=0), abut.Support("cylinder.axis", x=0)],
        [abut.Force("cylinder.flat", (0.0, -load))],
        [abut.Contact(contactor=sides[0], target=sides[1], **contact)],
        plane="strain",
    )


# A quarter of a ball of radius 1 pressed by 0.0026 on a block, both of width 0.5; contact to a radius of about 0.05.
YOUNG, NU, WIDTH, FINE, PRESSED, BALL = 2e5, 0.3, 0.5, 0.08, 0.0026, 0.05


def _lines(n: int, fine: float, outside: int) -> Array:
    """Grid lines from 0 to WIDTH: n equal cells up to ``fine``, then ``outside`` growing ones."""
    low, high = 1.0, 5.0
    for _ in range(100):
        growth = 0.5 * (low + high)
        steps = fine / n * growth ** np.arange(1, outside + 1)
        low, high = (growth, high) if steps.sum() < WIDTH - fine else (low, growth)
    return np.concatenate([np.linspace(0.0, fine, n + 1), fine + np.cumsum(steps)])


def quarter_ball(cell: str, m: int, contactor: str = "ball", pressed: float = PRESSED, **contact: object) -> abut.Model:
    """m: cells of the ball over FINE; the block's are 1/0.8 as large. pressed: how far the ball's top comes down."""
    m0 = round(0.8 * m)
    out, out0 = round(0.75 * m), round(0.75 * m0)

    def ball(x: Array) -> Array:
        rise = 1.0 - np.sqrt(1.0 - x[:, 0] ** 2 - x[:, 1] ** 2)
        return np.column_stack([x[:, :2], rise + x[:, 2] * (WIDTH - rise) / WIDTH])

    across, across0 = _lines(m, FINE, out), _lines(m0, FINE, out0)
    up, down = _lines(int(0.6 * m), 0.6 * FINE, out), -_lines(int(0.75 * m0), 0.75 * FINE, out0)[::-1]
    mesh = join({"block": grid([across0, across0, down], cell), "ball": grid([across, across, up], cell, ball)})
    sides = ("ball.bottom", "block.top") if contactor == "ball" else ("block.top", "ball.bottom")
    held = [abut.Support(f"{body}.{side}", **{axis: 0.0})
            for body in ("block", "ball") for side, axis in (("left", "x"), ("front", "y"))]  # fmt: skip
    return abut.Model(
        mesh,
        [abut.Solid(body, abut.LinearElastic(YOUNG, NU)) for body in mesh.bodies],
        [*held, abut.Support("block.bottom", z=0.0), abut.Support("ball.top", z=-pressed)],
        contacts=[abut.Contact(contactor=sides[0], target=sides[1], **contact)],
    )


def quarter_ball_truth(solution: abut.Solution) -> tuple[float, float]:
    """Radius and peak of Hertz's pressure under the force that was found."""
    modulus, force = YOUNG / (2.0 * (1.0 - NU**2)), 4.0 * abs(float(solution.contacts[0].force[2]))
    radius = float(np.cbrt(0.75 * force / modulus))
    return radius, 1.5 * force / (np.pi * radius**2)


def quarter_ball_in_the_mean(cell: str, m: int, contactor: str, places: int = 4) -> tuple[float, float, float, float]:
    """Facets of the contactor over the radius of contact, and relative L2 errors: of the reported pressure, of averages of
    the exact one and of its best fit (``fits``). Root mean squares over edges of contact at several places of a facet."""
    size = FINE / (m if contactor == "ball" else round(0.8 * m))
    found = []
    for shift in (np.arange(places) + 0.5) / places - 0.5:
        solution = abut.solve(quarter_ball(cell, m, contactor, PRESSED * (1.0 + shift * size / BALL) ** 2))
        where = quarter_ball_truth(solution)
        exact = ellipse(*where, 3)
        found.append((errors(solution, *where)[2], *fits(solution.contacts[0].contactor, exact)))
    reported, averages, best = np.sqrt(np.mean(np.square(found), axis=0))
    return BALL / size, float(reported), float(averages), float(best)


# Balls of radius 8, the upper one five times as stiff, axisymmetric; a ball on a rigid plane.
BALLS_FORCE = 120.0
BALLS = float(np.cbrt(0.75 * BALLS_FORCE * 4.0 * (1.0 - NU**2) * (1.0 / 1000.0 + 1.0 / 5000.0)))
BALLS_PEAK = 1.5 * BALLS_FORCE / (np.pi * BALLS**2)


def balls(cell: str, cells: int, contactor: str = "lower", **contact: object) -> abut.Model:
    """cells: of the upper ball over 1.1; the lower one has three quarters of them."""
    upper, lower = (quarter_disc(8.0, (0.0, 8.0), fine=1.1, cells=n, cell=cell) for n in (cells, round(0.75 * cells)))
    sides = ("lower.round", "upper.round") if contactor == "lower" else ("upper.round", "lower.round")
    return abut.Model(
        join({"upper": upper, "lower": mirrored(lower)}),
        [abut.Solid("upper", abut.LinearElastic(5000.0, NU)), abut.Solid("lower", abut.LinearElastic(1000.0, NU))],
        [abut.Support("lower.flat", y=0)],
        [abut.Force("upper.flat", (0.0, -BALLS_FORCE))],
        [abut.Contact(contactor=sides[0], target=sides[1], **contact)],
        plane="axisymmetric",
    )


OCTANT, OCTANT_PEAK, OCTANT_FORCE = 1.00964, 88.29, 60.0 * np.pi  # ANSYS VM63


def octant(cell: str, cells: int, **contact: object) -> abut.Model:
    """An eighth of a ball of radius 8 on a rigid plane; cells over 1.1."""
    ball = sphere_octant(8.0, (0, 0, 8.0), fine=1.1, cells=cells, growth=2.0, cell=cell)
    parts = {"ball": ball, "plane": box((0, 8), (0, 8), (-1, 0), (1, 1, 1))}
    rigid = [abut.Support(f"plane.{side}", x=0, y=0, z=0) for side in ("bottom", "top")]
    return abut.Model(
        join(parts),
        [abut.Solid(body, abut.LinearElastic(1000.0, NU)) for body in parts],
        [*rigid, abut.Support("ball.x0", x=0), abut.Support("ball.y0", y=0)],
        [abut.Force("ball.z0", (0.0, 0.0, -OCTANT_FORCE / 4))],
        [abut.Contact(contactor="ball.round", target="plane.top", **contact)],
    )


def square_punch(part: float, cell: str = "hex8", whole: int = 3, **contact: object) -> abut.Model:
    """A quarter of a nearly rigid square punch, 2 x 2, under the mean pressure 1 on a plate: its edge takes ``part`` of a
    facet of the plate, which is the contactor."""
    size = 1.0 / (whole + part)
    n = whole + 5
    plate = box((0, n * size), (0, n * size), (-n * size, 0), (n, n, n), cell)
    mesh = join({"plate": plate, "punch": box((0, 1), (0, 1), (0, 1), (whole, whole, whole), cell)})
    held = [abut.Support(f"{body}.{side}", **{axis: 0.0})
            for body in ("plate", "punch") for side, axis in (("left", "x"), ("front", "y"))]  # fmt: skip
    return abut.Model(
        mesh,
        [abut.Solid("plate", abut.LinearElastic(1e3, NU)), abut.Solid("punch", abut.LinearElastic(1e6, NU))],
        [*held, abut.Support("plate.bottom", z=0.0)],
        [abut.Pressure("punch.top", 1.0)],
        [abut.Contact(contactor="plate.top", target="punch.bottom", **contact)],
    )


def flat_punch(cell: str, n: int) -> abut.Model:
    """A sharp, nearly rigid punch of width 2 under a unit force on a wide block, plane strain, n facets on half of both."""
    block = rectangle((-20, 20), (-20, 0), (2 * n, n), cell, fine={"x": [-1, 1], "y": [-1, 0]})
    return abut.Model(
        join({"punch": rectangle((-1, 1), (0, 1), (2 * n, n), cell), "block": block}),
        [abut.Solid("punch", abut.LinearElastic(1e7, 0.3)), abut.Solid("block", abut.LinearElastic(1e3, 0.3))],
        [abut.Support("block.bottom", x=0, y=0), abut.Support("punch.top", x=0)],
        [abut.Force("punch.top", (0.0, -1.0))],
        [abut.Contact(contactor="punch.bottom", target="block.top")],
        plane="strain",
    )


def bent(cell: str, n: int, kind: str = "contact", **contact: object) -> abut.Model:
    """A column of two blocks under end loads that bend and press it: the pressure between them is that of ``bent_pressure``,
    the displacement of second order."""
    solid = cell.startswith(("hex", "tet", "wedge"))
    young, nu = (1000.0, NU) if solid else (1000.0 / (1.0 - NU**2), NU / (1.0 - NU))

    def side(x: Array) -> Array:
        other = x[:, 1] ** 2 if solid else 0.0
        return np.asarray((nu * x[:, 0] + 0.8 * (x[:, -1] ** 2 + nu * (x[:, 0] ** 2 - other))) / young)

    def across(x: Array) -> Array:
        return np.asarray(nu * (x[:, 1] + 1.6 * x[:, 0] * x[:, 1]) / young)

    def end(x: Array) -> Array:
        return np.column_stack([np.zeros((len(x), x.shape[1] - 1)), -bent_pressure(x)])

    if solid:
        lower, upper = (box((-0.5, 0.5), (0, 1), z, (k, k, n), cell) for z, k in (((0, 1), n), ((1, 2), n + 1)))
        held: dict[str, object] = {"x": side, "y": across}
    else:
        lower, upper = (rectangle((-0.5, 0.5), y, (k, n), cell) for y, k in (((0, 1), n), ((1, 2), n + 1)))
        held = {"x": side}
    mesh = join({"a": lower, "b": upper})
    return abut.Model(
        mesh,
        [abut.Solid(body, abut.LinearElastic(1000.0, NU)) for body in mesh.bodies],
        [abut.Support("a.bottom", **held, **{"z" if solid else "y": 0.0}), abut.Support("b.top", **held)],
        [abut.Traction("b.top", end)],
        [abut.Contact(contactor="a.top", target="b.bottom", kind=kind, **contact)],
        plane=None if solid else "strain",
    )


def opened(n: int) -> abut.Model:
    """Two blocks, quad8, pressed with a slope: closed on the right up to the rim, open on the left."""
    mesh = join({"a": rectangle((-0.5, 0.5), (0, 1), (n, n)), "b": rectangle((-0.5, 0.5), (1, 2), (n, n))})
    return abut.Model(
        mesh,
        [abut.Solid(body, abut.LinearElastic(1000.0, NU)) for body in mesh.bodies],
        [
            abut.Support("a.bottom", x=0.0, y=0.0),
            abut.Support("b.top", x=0.0, y=lambda x: np.asarray(-0.002 - 0.012 * x[:, 0])),
        ],
        contacts=[abut.Contact(contactor="a.top", target="b.bottom")],
        plane="strain",
    )


def stepped(n: int, **contact: object) -> abut.Model:
    """A block, n facets wide, under one whose lower side steps up by 0.05 at 0.4 of the width, pressed together by 0.005."""
    x = np.unique(np.concatenate([np.linspace(0, 0.4, n + 1), np.linspace(0.401, 1.0, n + 1)]))

    def step(at: Array) -> Array:
        return np.column_stack([at[:, 0], at[:, 1] + 0.05 * (at[:, 0] > 0.4005) * (2.0 - at[:, 1])])

    mesh = join({"a": rectangle((0, 1), (0, 1), (n, n)), "b": grid([x, np.linspace(1.0, 2.0, n + 1)], "quad8", step)})
    return abut.Model(
        mesh,
        [abut.Solid(body, abut.LinearElastic(1000.0, NU)) for body in mesh.bodies],
        [abut.Support("a.bottom", x=0, y=0), abut.Support("b.top", x=0, y=-0.005)],
        contacts=[abut.Contact(contactor="a.top", target="b.bottom", **contact)],
        plane="strain",
    )


def along(model: abut.Model) -> tuple[Array, Array]:
    """Corners' first coordinates in order, and the reported pressure there."""
    x, p = at_corners(abut.solve(model).contacts[0])
    order = np.argsort(x[:, 0])
    return x[order, 0], p[order]


def approach(solution: abut.Solution, top: str) -> float:
    """How far a surface has come down, in the mean over its nodes."""
    return -float(solution.displacement[solution.model.mesh.nodes_of(top), -1].mean())


def bent_pressure(x: Array) -> Array:
    return np.asarray(1.0 + 1.6 * x[:, 0])

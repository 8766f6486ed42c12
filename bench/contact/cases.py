"""The models that every code solves: two blocks pressed flat, two blocks with the upper one tilted, without friction and
with, a ball on a block, the same on a block of metal that yields and of rubber.

A case is named GEOMETRY-CELL, as in flat-hex8, tilted-tet10, hertz-hex20; its size is chosen by the number of
displacements wanted, fixed ones included. Units are mm, N and MPa.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import replace

import abut
from abut.mesh.make import box, join, sphere_octant
from abut.mesh.mesh import Mesh

STEEL = abut.LinearElastic(young=210e3, poisson=0.3)
CELLS = ("hex8", "hex20", "tet10")
SIDE = 10.0  # of each block
DEPTH = 0.02  # the top is pressed down by: a strain of 0.1 %
TILT = 2.0 * DEPTH / SIDE  # radians: the gap at the open end is twice the depth, about half of the interface closes
FRICTION = 0.3
RADIUS, ZONE = 8.0, 1.1  # of the ball and of its fine zone
INDENT = 0.12  # the ball is pressed down by; half of it on either side of the contact
METAL = abut.Plastic(young=210e3, poisson=0.3, yield_stress=300.0, hardening=2000.0)
RUBBER, HARD = (
    abut.NeoHooke(young=young, poisson=nu, volumetric="isochoric") for young, nu in ((3.0, 0.48), (3e3, 0.3))
)
DENT, DENTED = 0.6, 2.2  # the ball is pressed into rubber by; fine zone there
STEPS = 5  # of what depends on the way to it


def _blocks(n: int, cell: str) -> tuple[Mesh, Mesh]:
    """Lower block of n cells along each side, upper block of three quarters as many."""
    m = max(1, round(0.75 * n))
    return box((0, SIDE), (0, SIDE), (0, SIDE), (n, n, n), cell), box(
        (0, SIDE), (0, SIDE), (SIDE, 2 * SIDE), (m, m, m), cell
    )


def _tilted(mesh: Mesh) -> Mesh:
    """The upper block turned about the edge of the interface along y, so that it opens toward +x."""
    c, s = math.cos(TILT), math.sin(TILT)
    points = mesh.points.copy()
    x, z = mesh.points[:, 0], mesh.points[:, 2] - SIDE
    points[:, 0], points[:, 2] = c * x - s * z, s * x + c * z + SIDE
    return replace(mesh, points=points)


def _two_blocks(n: int, cell: str, tilt: bool) -> abut.Model:
    lower, upper = _blocks(n, cell)
    return abut.Model(
        join({"lower": lower, "upper": _tilted(upper) if tilt else upper}),
        [abut.Solid(body, STEEL) for body in ("lower", "upper")],
        [abut.Support("lower.bottom", x=0, y=0, z=0), abut.Support("upper.top", x=0, y=0, z=-DEPTH)],
        contacts=[abut.Contact(contactor="lower.top", target="upper.bottom")],
    )


def _flat(n: int, cell: str) -> abut.Model:
    return _two_blocks(n, cell, False)


def _tilted_blocks(n: int, cell: str) -> abut.Model:
    return _two_blocks(n, cell, True)


def _rubbing(n: int, cell: str) -> abut.Model:
    case = _two_blocks(n, cell, True)
    return replace(case, contacts=[replace(own, friction=FRICTION) for own in case.contacts])


def _hertz(n: int, cell: str, depth: float = INDENT, zone: float = ZONE) -> abut.Model:
    """A quarter of a ball's lower half on a quarter of a block; symmetry on x = 0 and y = 0."""
    m = max(1, round(0.75 * n))
    ball = sphere_octant(RADIUS, (0.0, 0.0, RADIUS), fine=zone, cells=n, growth=1.3, cell=cell)
    fine = {"x": [0.0, zone], "y": [0.0, zone], "z": [-zone, 0.0]}
    block = box((0.0, RADIUS), (0.0, RADIUS), (-RADIUS, 0.0), (m, m, m), cell, fine, growth=1.3)
    return abut.Model(
        join({"block": block, "ball": ball}),
        [abut.Solid(body, STEEL) for body in ("block", "ball")],
        [
            abut.Support("block.bottom", x=0, y=0, z=0),
            abut.Support("block.left", x=0),
            abut.Support("block.front", y=0),
            abut.Support("ball.x0", x=0),
            abut.Support("ball.y0", y=0),
            abut.Support("ball.z0", x=0, y=0, z=-depth),
        ],
        contacts=[abut.Contact(contactor="ball.round", target="block.top")],
    )


def _alike(cell: str) -> str:
    """How cells are integrated in all codes: hex8 is stiffer so where metal flows than what abut takes by itself."""
    return "reduced" if cell == "hex20" else "full"


def _plastic(n: int, cell: str) -> abut.Model:
    """The block yields under the ball, small strains. Alike in all codes: contact where the surfaces have come to, between
    the facets as they are, on the softer side as by abut's own choice."""
    solids = [
        abut.Solid("block", METAL, integration=_alike(cell)),
        abut.Solid("ball", STEEL, integration=_alike(cell)),
    ]
    model = _hertz(n, cell)
    contacts = [abut.Contact(contactor="block.top", target="ball.round", geometry="faceted")]
    return replace(
        model, solids=solids, contacts=contacts, kinematics="small-strain", solve=abut.SolveOptions(steps=STEPS)
    )


def _rubber(n: int, cell: str) -> abut.Model:
    """A hard ball in a block of rubber, finite strains; the softer side is the contactor, as by abut's own choice."""
    solids = [
        abut.Solid("block", RUBBER, integration=_alike(cell)),
        abut.Solid("ball", HARD, integration=_alike(cell)),
    ]
    model = _hertz(n, cell, DENT, DENTED)
    contacts = [abut.Contact(contactor="block.top", target="ball.round")]
    return replace(model, solids=solids, contacts=contacts, kinematics="finite", solve=abut.SolveOptions(steps=STEPS))


def _neo_hooke(n: int, cell: str) -> abut.Model:
    """The same with neo-Hooke's law as Kratos has it, lambda/2 (ln J)^2, and between the facets as they are."""
    model = _rubber(n, cell)
    solids = [
        replace(solid, material=replace(law, volumetric="log-squared"))
        for solid, law in zip(model.solids, (RUBBER, HARD))
    ]
    contacts = [replace(contact, geometry="faceted") for contact in model.contacts]
    return replace(model, solids=solids, contacts=contacts)


GEOMETRIES: dict[str, Callable[[int, str], abut.Model]] = {
    "flat": _flat, "tilted": _tilted_blocks, "friction": _rubbing, "hertz": _hertz,
    "plastic": _plastic, "rubber": _rubber, "neohooke": _neo_hooke,
}  # fmt: skip

BALLS = ("hertz", "plastic", "rubber", "neohooke")


def dofs(model: abut.Model) -> int:
    """Displacements of a model, fixed ones included."""
    return int(model.mesh.points.size)


def nodes_of_blocks(n: int, cell: str) -> int:
    """Nodes of the two blocks, without making them."""

    def cube(k: int) -> int:
        return {"hex8": (k + 1) ** 3, "hex20": (k + 1) ** 3 + 3 * k * (k + 1) ** 2, "tet10": (2 * k + 1) ** 3}[cell]

    return cube(n) + cube(max(1, round(0.75 * n)))


def model(name: str, wanted: int) -> abut.Model:
    """The case whose number of displacements is nearest to the one wanted."""
    geometry, cell = name.split("-")
    make = GEOMETRIES[geometry]
    if cell not in CELLS:
        raise ValueError(f"no cell {cell!r}; use {', '.join(CELLS)}")
    size = (lambda n: dofs(make(n, cell))) if geometry in BALLS else (lambda n: 3 * nodes_of_blocks(n, cell))
    n = _nearest(size, wanted)
    return make(n, cell)


def _nearest(size: Callable[[int], int], wanted: int) -> int:
    """The number of cells >= 2 whose ``size`` (growing with it) comes nearest to the wanted one, by bisection."""
    low, high = 2, 4
    while size(high) < wanted:
        low, high = high, 2 * high
    while high - low > 1:
        middle = (low + high) // 2
        low, high = (middle, high) if size(middle) < wanted else (low, middle)
    return low if wanted - size(low) < size(high) - wanted else high


def with_options(case: abut.Model, *, linear: str, tied: bool, dual: bool = False) -> abut.Model:
    """The same model for another linear solver, with the bodies tied, or with dual multipliers."""
    contacts = [replace(c, kind="tied", friction=0.0) if tied else c for c in case.contacts]
    contacts = [replace(c, pressure="dual") if dual else c for c in contacts]
    return replace(case, contacts=contacts, solve=replace(case.solve, linear=linear))


def prescribed(case: abut.Model) -> dict[int, dict[int, float]]:
    """Prescribed displacements by axis and node (from zero): {axis: {node: value}}; later supports win."""
    result: dict[int, dict[int, float]] = {0: {}, 1: {}, 2: {}}
    for support in case.supports:
        for axis, value in enumerate((support.x, support.y, support.z)):
            if value is not None:
                result[axis].update(dict.fromkeys(case.mesh.nodes_of(support.on).tolist(), float(value)))
    return result

"""Models with friction: two flush blocks under uniform pressure and shear, in a general position; blocks pushed to and fro,
on a slope; Cattaneo and Mindlin's cylinders."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

import abut
from abut.materials.material import Evaluated, OwnMaterial
from abut.mesh import make
from abut.mesh.mesh import Mesh
from models.patch import POISSON, ROTATION

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
    """The field of that stress with Young's modulus one, zero at the origin, without turning the bottom; x: (n, dim)
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
        contacts=[abut.Contact(contactor="lower.top", target="upper.bottom", **{"friction": FRICTION, **contact})],
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


def pushed(far: float = 0.02, friction: float = FRICTION) -> abut.Model:
    """A block pressed on a longer one, and its top moved to one side, back by half, and to the other side."""
    parts = {
        "lower": make.rectangle([0, 4], [0, 1], cells=[16, 4]),
        "upper": make.rectangle([1, 3], [1, 2], cells=[11, 5]),
    }
    return abut.Model(
        make.join(parts),
        [abut.Solid(name, abut.LinearElastic(1e4, POISSON)) for name in parts],
        [
            abut.Support("lower.bottom", x=0, y=0),
            abut.Support("upper.top", x=far, amplitude=abut.Amplitude([(0.2, 0), (0.6, 1), (1, -1)])),
        ],
        [abut.Pressure("upper.top", 100.0, amplitude=abut.Amplitude([(0, 0), (0.2, 1)]))],
        [abut.Contact(contactor="upper.bottom", target="lower.top", friction=friction)],
        plane="strain",
        solve=abut.SolveOptions(times=[0.2, 0.4, 0.6, 0.8, 1.0]),
    )


def on_a_slope(angle: float) -> abut.Model:
    """A block on a plate under gravity, turned by an angle."""
    parts = {
        "lower": make.rectangle([0, 4], [0, 1], cells=[8, 2]),
        "upper": make.rectangle([1, 2], [1, 1.5], cells=[5, 3]),
    }
    return abut.Model(
        make.join(parts),
        [abut.Solid(name, abut.LinearElastic(1e4, POISSON, density=1.0)) for name in parts],
        [abut.Support("lower.bottom", x=0, y=0)],
        [abut.Gravity((10.0 * np.sin(angle), -10.0 * np.cos(angle)), on="upper")],
        [abut.Contact(contactor="upper.bottom", target="lower.top", friction=FRICTION)],
        plane="strain",
    )


RADIUS, YOUNG, COEFFICIENT = 800.0, 200.0, 0.2  # of two cylinders; so flat that strains are small, p0 / E = 5e-4


def cattaneo(cell: str, n: int) -> abut.Model:
    """Two blocks cut from half planes, the upper one with a bottom of half that radius, under P = 0.1, Q = 0.0094 about.

    n: half the cells of the lower block along 1.8 units, in which the contact lies; the upper one has a third more."""
    half, depth, zone, m = 6.0, 8.0, 0.9, int(n * 4 / 3)
    lower, upper = (
        make.rectangle((-half, half), y, cells, cell, fine={"x": [-zone, zone], "y": fine})
        for y, cells, fine in (
            ((-depth, 0.0), (2 * n, n), [-zone, 0.0]),
            ((0.0, depth), (2 * m, m), [0.0, zone]),
        )
    )
    x, y = upper.points.T
    gap = x**2 / RADIUS
    upper = replace(upper, points=np.column_stack([x, y + gap * (1.0 - y / depth)]))
    steps = {"down": abut.Amplitude([(0, 0), (0.5, 1)]), "along": abut.Amplitude([(0.5, 0), (1, 1)])}
    return abut.Model(
        make.join({"lower": lower, "upper": upper}),
        [abut.Solid(name, abut.LinearElastic(YOUNG, POISSON)) for name in ("lower", "upper")],
        [
            abut.Support("lower.bottom", x=0, y=0),
            abut.Support("upper.top", y=-0.00187, amplitude=steps["down"]),
            abut.Support("upper.top", x=0.000362, amplitude=steps["along"]),
        ],
        contacts=[abut.Contact(contactor="lower.top", target="upper.bottom", friction=COEFFICIENT)],
        plane="strain",
        solve=abut.SolveOptions(steps=2),
    )


@dataclass(frozen=True)
class Cattaneo:
    """Two equal cylinders of ``RADIUS`` under a force P, then Q along (Cattaneo 1938, Mindlin 1949)."""

    normal: float
    along: float

    @property
    def half_width(self) -> float:
        return float(np.sqrt(4.0 * self.normal * (RADIUS / 2.0) / (np.pi * YOUNG / (2.0 * (1.0 - POISSON**2)))))

    @property
    def stick(self) -> float:
        return self.half_width * float(np.sqrt(1.0 - self.along / (COEFFICIENT * self.normal)))

    def traction(self, x: Array) -> Array:
        b, c = self.half_width, self.stick
        outer, inner = (np.sqrt(np.maximum(1.0 - (x / own) ** 2, 0.0)) for own in (b, c))
        return COEFFICIENT * 2.0 * self.normal / (np.pi * b) * (outer - c / b * inner)


def profile(solution: abut.Solution) -> tuple[Array, Array, Array, Cattaneo]:
    """Place, traction and status at the corners of the contactor's facets, from left to right, and the formulas for the
    forces that came out."""
    contact = solution.contacts[0]
    corners = contact.contactor.nodes[:, :2]
    x = contact.contactor.points[corners, 0].ravel()
    order = np.argsort(x, kind="stable")
    along = contact.friction.traction[:, :2, 0]
    drag = (along * np.sign(along.sum())).ravel()
    exact = Cattaneo(abs(float(contact.force[1])), abs(float(contact.force[0])))
    return x[order], drag[order], contact.friction.status[:, :2].ravel()[order], exact


def rubbed(n: int = 4, cell: str = "hex8") -> abut.Model:
    """A block pressed askew on a wider one, its top moved along both axes, back and to the other side: some of it opens,
    some sticks, some slips."""
    parts = {
        "lower": make.box([0, 4], [0, 4], [0, 2], cells=[n + 1, n + 1, n // 2], cell=cell),
        "upper": make.box([1, 3], [1, 3], [2, 3], cells=[n, n, n // 2], cell=cell),
    }
    down, along = abut.Amplitude([(0, 0), (0.25, 1)]), abut.Amplitude([(0.25, 0), (0.5, 1), (1, -1)])
    return abut.Model(
        make.join(parts),
        [abut.Solid(name, abut.LinearElastic(1e4, POISSON)) for name in parts],
        [
            abut.Support("lower.bottom", x=0, y=0, z=0),
            abut.Support("upper.top", z=lambda x: -0.015 + 0.02 * (x[:, 0] - 1.0), amplitude=down),
            abut.Support("upper.top", x=0.006, y=0.003, amplitude=along),
        ],
        contacts=[abut.Contact(contactor="upper.bottom", target="lower.top", friction=FRICTION)],
        solve=abut.SolveOptions(times=[0.25, 0.5, 0.75, 1.0]),
    )


@dataclass(frozen=True)
class Hooke(OwnMaterial):
    """Linear elasticity as a user's own material: Newton's method goes round again where it need not."""

    young: float = 1e4
    poisson: float = 0.3
    modulus: float = 1e4

    def evaluate(self, strain: np.ndarray, history: np.ndarray) -> Evaluated:
        shear = self.young / (2.0 * (1.0 + self.poisson))
        first = 2.0 * shear * self.poisson / (1.0 - 2.0 * self.poisson)
        normal = np.array([1.0, 1, 1, 0, 0, 0])
        matrix = first * np.outer(normal, normal) + shear * np.diag([2.0, 2, 2, 1, 1, 1])
        return strain @ matrix, np.broadcast_to(matrix, (len(strain), 6, 6)), history

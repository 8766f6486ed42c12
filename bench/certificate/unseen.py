"""Models that no test holds, with defaults: the true local error of the pressure beside what the certificate says.

python bench/certificate/unseen.py [NAME ...]; needs gmsh, which a `bench` install brings. A wavy surface pressed flat
(Westergaard; metres and pascals), a roller of unstructured triangles on another metal (inches and psi), a heated shaft of
unstructured triangles in a hub of bricks' sections, crossed cylinders, a ball of unstructured tetrahedra on a finer and much
stiffer block, a cone (Sneddon); a steel shaft in a soft hub three times as coarse (inches), a thin sleeve, a disc that
spins, a ball fitted in a hollow one (unstructured tetrahedra of both orders), a polymer ball of unstructured triangles.
"""

from __future__ import annotations

import sys
import tempfile
from collections.abc import Callable
from pathlib import Path

import gmsh
import numpy as np
from cases import Case, everywhere, true_error
from numpy.typing import NDArray

import abut
from abut.diagnosis.cures import cures
from abut.mesh.make import join, ring
from abut.mesh.make.block import grid

Array = NDArray[np.float64]
ROOT = Path(__file__).parents[2]


def star(*materials: abut.LinearElastic) -> float:
    return 1.0 / sum((1.0 - m.poisson**2) / m.young for m in materials)


def hertz(load: float, a: float, dim: int, across: int = 0) -> Callable[[Array], Array]:
    """dim: 2 for a line, 3 for a round contact; across: coordinates along the surface, one fewer by default."""
    across = across or dim - 1
    top = 2.0 * load / (np.pi * a) if dim == 2 else 1.5 * load / (np.pi * a**2)
    return lambda x: top * np.sqrt(np.maximum(0.0, 1.0 - (x[:, :across] ** 2).sum(axis=1) / a**2))


def within(a: float, dim: int) -> Callable[[Array], NDArray[np.bool_]]:
    return lambda x: np.linalg.norm(x[:, : dim - 1], axis=1) < 0.9 * a


def wavy() -> Case:
    """Wave length 1 mm, height 1 micrometre, pressed until half of it touches; ceramic, fine, on aluminium."""
    length, height, a = 1e-3, 1e-6, 0.25e-3
    hard, soft = abut.LinearElastic(380e9, 0.22), abut.LinearElastic(70e9, 0.33)
    s = np.sin(np.pi * a / length)
    mean = np.pi * star(hard, soft) * height / length * s**2

    def wave(x: Array) -> Array:
        rise = height * (1.0 - np.cos(2.0 * np.pi * x[:, 0] / length))
        return np.column_stack([x[:, 0], x[:, 1] + rise * (1.0 - x[:, 1] / length)])

    def model() -> abut.Model:
        across = (np.linspace(0.0, 0.5 * length, n + 1) for n in (50, 20))
        up, down = (np.concatenate([[0.0], np.cumsum(1.15 ** np.arange(n))]) for n in (22, 16))
        parts = {
            "upper": grid([next(across), up / up[-1] * length], "tri3", wave),
            "lower": grid([next(across), -down[::-1] / down[-1] * length], "quad8"),
        }
        return abut.Model(
            join(parts), [abut.Solid("upper", hard), abut.Solid("lower", soft)],
            [abut.Support("lower.bottom", y=0), *(abut.Support(f"{p}.{s}", x=0) for p in parts for s in ("left", "right"))],
            [abut.Pressure("upper.top", mean)], [abut.Contact("upper.bottom", "lower.top")], plane="strain",
        )  # fmt: skip

    def exact(x: Array) -> Array:
        inside = np.sqrt(np.maximum(s**2 - np.sin(np.pi * x[:, 0] / length) ** 2, 0.0))
        return 2.0 * mean * np.cos(np.pi * x[:, 0] / length) / s**2 * inside

    return Case("wavy surface, tri3 on quad8, m", 1, model, exact, lambda x: x[:, 0] < 0.9 * a)


def meshed(build: Callable[[], None], size: Callable[..., float], order: int, dim: int) -> abut.Mesh:
    """A mesh by Gmsh. build: geometry and physical groups."""
    gmsh.initialize()
    gmsh.option.setNumber("General.Terminal", 0)
    build()
    gmsh.model.mesh.setSizeCallback(size)
    for option in ("MeshSizeFromPoints", "MeshSizeExtendFromBoundary", "MeshSizeFromCurvature"):
        gmsh.option.setNumber(f"Mesh.{option}", 0)
    gmsh.model.mesh.generate(dim)
    gmsh.model.mesh.setOrder(order)
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "part.msh"
        gmsh.write(str(path))
        gmsh.finalize()
        return abut.Mesh.read(path)


def sector(
    radius: float, centre: float, start: float, end: float, size: Callable[..., float], order: int = 1
) -> abut.Mesh:
    """Of a disc about (0, centre), angles in degrees; surfaces round, start, end."""

    def build() -> None:
        occ = gmsh.model.occ
        angles = np.radians([start, end])
        middle = occ.addPoint(0, centre, 0)
        ends = [occ.addPoint(radius * np.cos(t), centre + radius * np.sin(t), 0) for t in angles]
        lines = [occ.addLine(middle, ends[0]), occ.addCircleArc(ends[0], middle, ends[1]), occ.addLine(ends[1], middle)]
        face = occ.addPlaneSurface([occ.addCurveLoop(lines)])
        occ.synchronize()
        gmsh.model.addPhysicalGroup(2, [face], name="body")
        for line, name in zip(lines, ("start", "round", "end")):
            gmsh.model.addPhysicalGroup(1, [line], name=name)

    return meshed(build, size, order, 2)


def roller() -> Case:
    """Steel on bronze, tri3, half of it by symmetry: radius 2 inches, half width .05."""
    radius, a = 2.0, 0.05
    steel, bronze = abut.LinearElastic(30e6, 0.29), abut.LinearElastic(15e6, 0.34)
    load = np.pi * star(steel, bronze) * a**2 / (4.0 * radius)

    def model() -> abut.Model:
        def size(dim: int, tag: int, x: float, y: float, z: float, lc: float) -> float:
            return a / 8.0 * max(1.0, (np.hypot(x, y) / a - 0.5) * 0.7)

        ball = sector(radius, radius, -90.0, 0.0, size)
        lines = np.concatenate([np.linspace(0.0, 1.6 * a, 10), 1.6 * a + np.cumsum(0.01 * 1.3 ** np.arange(17))])
        parts = {
            "roller": ball,
            "block": grid([lines, -np.concatenate([[0], np.cumsum(0.008 * 1.22 ** np.arange(28))])[::-1]], "tri3"),
        }
        return abut.Model(
            join(parts), [abut.Solid("roller", steel), abut.Solid("block", bronze)],
            [abut.Support("block.bottom", x=0, y=0), abut.Support("block.left", x=0), abut.Support("roller.start", x=0)],
            [abut.Force("roller.end", (0.0, -0.5 * load))], [abut.Contact("roller.round", "block.top")], plane="strain",
        )  # fmt: skip

    return Case("roller, unstructured tri3 on tri3, inches", 1, model, hertz(load, a, 2), within(a, 2))


def shaft() -> Case:
    """An aluminium shaft of radius 25 in a steel hub, heated by 80 degrees."""
    a, b, hot = 25.0, 60.0, 80.0
    alloy, steel = abut.LinearElastic(70e3, 0.33, expansion=23e-6), abut.LinearElastic(210e3, 0.3)
    own = a * (1.0 + alloy.poisson) * (1.0 - 2.0 * alloy.poisson) / alloy.young
    other = a * (1.0 + steel.poisson) / steel.young * ((1.0 - 2.0 * steel.poisson) * a**2 + b**2) / (b**2 - a**2)
    p = (1.0 + alloy.poisson) * 23e-6 * hot * a / (own + other)

    def model() -> abut.Model:
        parts = {
            "shaft": sector(a, 0.0, 0.0, 90.0, lambda *_: 2.6),
            "hub": ring((a, b), cells=(10, 11), cell="quad4"),
        }
        held = [abut.Support(f"{part}.{end}", normal=0) for part in parts for end in ("start", "end")]
        return abut.Model(
            join(parts), [abut.Solid("shaft", alloy, temperature=hot), abut.Solid("hub", steel)], held,
            contacts=[abut.Contact("shaft.round", "hub.inner")], plane="strain",
        )  # fmt: skip

    return Case("heated shaft, unstructured tri3 in quad4", 1, model, lambda x: np.full(len(x), p), everywhere)


def crossed() -> Case:
    """Two steel cylinders of radius 10 crossed at right angles, a quarter; hex8 on coarser hex20."""
    radius, a, width = 10.0, 0.5, 5.0
    steel = abut.LinearElastic(205e3, 0.3)
    force = 4.0 / 3.0 * star(steel, steel) * a**3 / radius

    def lines(n: int) -> Array:
        steps = 1.5 * a / n * np.concatenate([np.ones(n), 1.45 ** np.arange(1, 30)])
        inside = np.concatenate([[0.0], np.cumsum(steps)])
        return np.append(inside[inside < 0.85 * width], width)

    def part(cell: str, n: int, along: int, sign: float) -> abut.Mesh:
        def bend(x: Array) -> Array:
            rise = radius - np.sqrt(radius**2 - x[:, along] ** 2)
            return np.column_stack([x[:, :2], x[:, 2] + sign * rise * (1.0 - np.abs(x[:, 2]) / width)])

        up = lines(n)
        return grid([lines(n), lines(n), up if sign > 0 else -up[::-1]], cell, bend)

    def model() -> abut.Model:
        parts = {"upper": part("hex8", 12, 1, 1.0), "lower": part("hex20", 7, 0, -1.0)}
        held = [abut.Support(f"{p}.{s}", **{c: 0}) for p in parts for s, c in (("left", "x"), ("front", "y"))]
        return abut.Model(
            join(parts), [abut.Solid(p, steel) for p in parts], [*held, abut.Support("lower.bottom", z=0)],
            [abut.Force("upper.top", (0.0, 0.0, -0.25 * force))], [abut.Contact("upper.bottom", "lower.top")],
        )  # fmt: skip

    return Case("crossed cylinders, hex8 on hex20", 1, model, hertz(force, a, 3), within(a, 3))


def tetrahedra() -> Case:
    """A soft ball of unstructured tet10 on a block 1.6 times as fine and 100 times as stiff; kN, cm."""
    sys.path.insert(0, str(ROOT / "bench" / "pressure"))
    import unstructured

    soft, stiff = abut.LinearElastic(200.0, 0.4), abut.LinearElastic(20000.0, 0.3)
    a, radius = unstructured.CONTACT, unstructured.RADIUS
    force = 4.0 / 3.0 * star(soft, stiff) * a**3 / radius

    def model() -> abut.Model:
        mesh = unstructured.mesh(4.5, 2, block=0.62)
        held = [abut.Support(f"{b}.{s}", **{s[0]: 0}) for b in ("ball", "block") for s in ("x0", "y0")]
        return abut.Model(
            mesh, [abut.Solid("ball", soft), abut.Solid("block", stiff)], [*held, abut.Support("block.far", z=0)],
            [abut.Force("ball.far", (0.0, 0.0, -0.25 * force))], [abut.Contact("ball.round", "block.top")],
        )  # fmt: skip

    return Case("soft ball, unstructured tet10, on stiff tet10", 2, model, hertz(force, a, 3), within(a, 3))


def cone() -> Case:
    """A steel cone, 3 degrees, on a coarser polymer, axisymmetric, contact to a radius of 1; judged from a tenth of it on,
    since at its tip the pressure has no limit."""
    steel, soft, slope = abut.LinearElastic(210e3, 0.3), abut.LinearElastic(2e3, 0.4), np.tan(np.radians(3.0))
    e = star(steel, soft)
    force = 0.5 * np.pi * e * slope

    def model() -> abut.Model:
        def part(n: int) -> Array:
            return np.concatenate([np.linspace(0.0, 1.5, n + 1), 1.5 + np.cumsum(1.5 / n * 1.25 ** np.arange(1, 16))])

        upper, lower = part(24), part(15)

        def tip(x: Array) -> Array:
            return np.column_stack([x[:, 0], x[:, 1] + slope * x[:, 0] * (1.0 - x[:, 1] / upper[-1])])

        parts = {"cone": grid([upper, upper], "quad4", tip), "block": grid([lower, -lower[::-1]], "quad4")}
        return abut.Model(
            join(parts), [abut.Solid("cone", steel), abut.Solid("block", soft)], [abut.Support("block.bottom", x=0, y=0)],
            [abut.Force("cone.top", (0.0, -force))], [abut.Contact("cone.bottom", "block.top")], plane="axisymmetric",
        )  # fmt: skip

    return Case(
        "cone, quad4 on quad4", 1, model,
        lambda x: 0.5 * e * slope * np.arccosh(1.0 / np.clip(x[:, 0], 1e-3, 1.0)),
        lambda x: (x[:, 0] > 0.1) & (x[:, 0] < 0.9),
    )  # fmt: skip


def lame(own: abut.LinearElastic, other: abut.LinearElastic, radii: tuple[float, float, float], plane: str) -> float:
    """Interference over pressure of a ring (own, from the first radius to the second) in another one."""
    a, r, b = radii
    give = 0.0
    for m, sign, wall in ((own, -1.0, (r**2 + a**2) / (r**2 - a**2)), (other, 1.0, (b**2 + r**2) / (b**2 - r**2))):
        young, nu = (
            (m.young, m.poisson) if plane == "stress" else (m.young / (1 - m.poisson**2), m.poisson / (1 - m.poisson))
        )
        give += r / young * (wall + sign * nu)
    return give


def fitted(
    name: str, parts: dict[str, abut.Mesh], materials: tuple[abut.LinearElastic, abut.LinearElastic],
    interference: float, pressure: float, order: int, **options: object,
) -> Case:  # fmt: skip
    """A quarter of two rings; parts: the inner one first; options: of the model."""
    inner, outer = parts

    def model() -> abut.Model:
        held = [abut.Support(f"{part}.{end}", normal=0) for part in parts for end in ("start", "end")]
        contact = abut.Contact(f"{outer}.inner", f"{inner}.outer", offset=-interference)
        solids = [abut.Solid(part, m) for part, m in zip(parts, materials)]
        return abut.Model(join(parts), solids, held, contacts=[contact], **options)

    return Case(name, order, model, lambda x: np.full(len(x), pressure), everywhere)


def soft_hub() -> Case:
    """Steel in a plastic 30 times as soft, inches and psi; the shaft three times as fine."""
    steel, soft, radii = abut.LinearElastic(30e6, 0.29), abut.LinearElastic(1e6, 0.35), (0.5, 1.0, 2.0)
    parts = {"shaft": ring(radii[:2], cells=(9, 18), cell="tri3"), "hub": ring(radii[1:], cells=(4, 6), cell="quad4")}
    p = 0.002 / lame(steel, soft, radii, "strain")
    return fitted(
        "steel shaft tri3 18 in a soft hub quad4 6, inches", parts, (steel, soft), 0.002, p, 1, plane="strain"
    )


def sleeve() -> Case:
    """A thin steel sleeve (R 50 to 50.8) shrunk on an aluminium tube, plane stress; the sleeve is named first."""
    alloy, steel, radii = abut.LinearElastic(70e3, 0.33), abut.LinearElastic(210e3, 0.3), (30.0, 50.0, 50.8)
    parts = {
        "tube": ring(radii[:2], cells=(6, 17), cell="quad4"),
        "sleeve": ring(radii[1:], cells=(1, 11), cell="quad8"),
    }
    p = 0.04 / lame(alloy, steel, radii, "stress")
    return fitted("thin sleeve quad8 11 on a tube quad4 17", parts, (alloy, steel), 0.04, p, 2, plane="stress")


def spinning() -> Case:
    """A steel disc on a sleeve of steel, 1000 radians a second, plane stress: Lame less what rotation opens; mm, t, s."""
    steel, (a, r, b), speed = abut.LinearElastic(210e3, 0.3, density=7.85e-9), (20.0, 40.0, 100.0), 1000.0
    unit = steel.density * speed**2 * r / (4.0 * steel.young)
    opened = unit * (3.0 + steel.poisson) * (b**2 - a**2)
    p = (0.04 - opened) / lame(steel, steel, (a, r, b), "stress")
    parts = {"sleeve": ring((a, r), cells=(5, 9), cell="tri6"), "disc": ring((r, b), cells=(12, 22), cell="quad4")}
    options = {"plane": "stress", "loads": [abut.Centrifugal(speed)]}
    return fitted("spinning disc quad4 22 on a sleeve tri6 9", parts, (steel, steel), 0.04, p, 1, **options)


def shell(radii: tuple[float, float], size: float, order: int) -> abut.Mesh:
    """An octant of a (hollow) ball of unstructured tetrahedra; surfaces x0, y0, z0, inner, outer."""

    def build() -> None:
        occ = gmsh.model.occ
        solid = occ.addSphere(0, 0, 0, radii[1], -1, 0, np.pi / 2, np.pi / 2)
        if radii[0] > 0.0:
            occ.cut([(3, solid)], [(3, occ.addSphere(0, 0, 0, radii[0], -1, 0, np.pi / 2, np.pi / 2))])
        occ.synchronize()
        gmsh.model.addPhysicalGroup(3, [tag for _, tag in gmsh.model.getEntities(3)], name="body")
        for _, tag in gmsh.model.getEntities(2):
            flat = np.abs(gmsh.model.occ.getCenterOfMass(2, tag)) < 1e-6 * radii[1]
            reach = gmsh.model.getBoundingBox(2, tag)[3]
            inside = radii[0] > 0.0 and abs(reach - radii[0]) < 1e-3 * radii[0]
            name = f"{'xyz'[flat.argmax()]}0" if flat.any() else "inner" if inside else "outer"
            gmsh.model.addPhysicalGroup(2, [tag], name=name)

    return meshed(build, lambda *_: size, order, 3)


def sphere() -> Case:
    """A ball of brass in a hollow ball of steel, with an interference: Lame's spheres."""
    brass, steel, (r, b), interference = (
        abut.LinearElastic(100e3, 0.34),
        abut.LinearElastic(210e3, 0.3),
        (10.0, 16.0),
        0.02,
    )
    give = (1 - 2 * brass.poisson) / brass.young * r
    hollow = (1 - 2 * steel.poisson) * r**3 + 0.5 * (1 + steel.poisson) * b**3
    give += r / steel.young * hollow / (b**3 - r**3)

    def model() -> abut.Model:
        parts = {"ball": shell((0.0, r), 1.5, 1), "shell": shell((r, b), 2.5, 2)}
        held = [abut.Support(f"{part}.{s}", **{s[0]: 0}) for part in parts for s in ("x0", "y0", "z0")]
        return abut.Model(
            join(parts), [abut.Solid("ball", brass), abut.Solid("shell", steel)], held,
            contacts=[abut.Contact("shell.inner", "ball.outer", offset=-interference)],
        )  # fmt: skip

    p = interference / give
    return Case("ball tet4 in a hollow ball tet10, unstructured", 1, model, lambda x: np.full(len(x), p), everywhere)


def polymer() -> Case:
    """A polymer ball of unstructured tri6 on a coarser steel plate, axisymmetric, metres."""
    soft, steel, radius, a = abut.LinearElastic(3e9, 0.38), abut.LinearElastic(200e9, 0.3), 0.05, 0.002
    force = 4.0 / 3.0 * star(soft, steel) * a**3 / radius

    def model() -> abut.Model:
        def size(dim: int, tag: int, x: float, y: float, z: float, lc: float) -> float:
            return a / 6.0 * max(1.0, (np.hypot(x, y) / a - 1.0) * 0.7)

        lines = np.concatenate([np.linspace(0.0, 1.5 * a, 8), 1.5 * a + np.cumsum(0.35 * a * 1.35 ** np.arange(13))])
        parts = {
            "ball": sector(radius, radius, -90.0, 0.0, size, 2),
            "plate": grid([lines, -lines[::-1]], "quad9"),
        }
        return abut.Model(
            join(parts), [abut.Solid("ball", soft), abut.Solid("plate", steel)], [abut.Support("plate.bottom", x=0, y=0)],
            [abut.Force("ball.end", (0.0, -force))], [abut.Contact("plate.top", "ball.round")], plane="axisymmetric",
        )  # fmt: skip

    return Case("polymer ball, unstructured tri6 on quad9, m", 2, model, hertz(force, a, 3, across=1), within(a, 2))


MODELS = {
    "wavy": wavy, "roller": roller, "shaft": shaft, "crossed": crossed, "tetrahedra": tetrahedra, "cone": cone,
    "soft-hub": soft_hub, "sleeve": sleeve, "spinning": spinning, "sphere": sphere, "polymer": polymer,
}  # fmt: skip


def main() -> None:
    """Solve and tell."""
    for name in sys.argv[1:] or MODELS:
        case = MODELS[name]()
        solution = abut.solve(case.model())
        own = solution.contacts[0]
        estimate = next(c for c in solution.certificate if c.name == "pressure error")
        print(f"{case.name}: {'' if solution.converged else 'NOT CONVERGED, '}contactor {own.contactor.name}, "
              f"{len(solution.steps[-1].iterations)} iterations, true error {true_error(case, solution):.4f}, "
              f"estimate {estimate.value:.4f}, largest pressure {own.max_pressure:.5g}")  # fmt: skip
        for check in solution.certificate:
            if check.verdict in ("FAIL", "warn"):
                print(f"    {check.verdict} {check.name} {check.value:.3g}: {check.meaning}")
        for check, text in cures(solution):
            print(f"    cure of {check.name}: {text}")
        sys.stdout.flush()


if __name__ == "__main__":
    main()

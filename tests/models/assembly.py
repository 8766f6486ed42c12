"""Seven assemblies as engineers draw them, whose contacts are to be found: no surface is named for contact."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from itertools import pairwise
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any

import numpy as np

import abut
from abut.mesh import make

STEEL = abut.LinearElastic(210e3, 0.3)
RUBBER = abut.LinearElastic(10.0, 0.45)
Point = tuple[float, float]


@dataclass(frozen=True)
class Assembly:
    """mesh: with the surfaces that supports and loads need; pairs: the bodies that face each other; rest: of the model."""

    mesh: abut.Mesh
    pairs: frozenset[frozenset[str]]
    rest: dict[str, Any]

    def solids(self) -> list[abut.Solid]:
        return [s if isinstance(s, abut.Solid) else abut.Solid(*s) for s in self.rest.get("solids", self._all(STEEL))]

    def _all(self, material: abut.LinearElastic) -> list[tuple[str, abut.LinearElastic]]:
        return [(body, material) for body in self.mesh.bodies]

    def found(self) -> tuple[abut.FoundContact, ...]:
        return abut.find_contacts(self.mesh, self.solids())

    def model(self) -> abut.Model:
        found = self.found()
        rest = {key: value for key, value in self.rest.items() if key != "solids"}
        mesh = abut.add_surfaces(self.mesh, found)
        return abut.Model(mesh, self.solids(), contacts=[f.contact() for f in found], **rest)


def names(*pairs: tuple[str, str]) -> frozenset[frozenset[str]]:
    return frozenset(map(frozenset, pairs))


def in_gmsh(build: Callable[[Any], None], size: float, order: int) -> abut.Mesh:
    """A mesh of what ``build`` makes in gmsh."""
    import gmsh

    gmsh.initialize(interruptible=False)
    try:
        gmsh.option.setNumber("General.Terminal", 0)
        gmsh.option.setNumber("Mesh.MeshSizeMax", size)
        gmsh.option.setNumber("Mesh.ElementOrder", order)
        build(gmsh)
        gmsh.model.mesh.generate(gmsh.model.getDimension())
        with TemporaryDirectory() as folder:
            path = str(Path(folder) / "mesh.msh")
            gmsh.write(path)
            return abut.Mesh.read(path)
    finally:
        gmsh.finalize()


def polygon(gmsh: Any, name: str, corners: Sequence[Point], edges: dict[str, Sequence[int]], size: float) -> None:
    """A body with straight edges, counter-clockwise; edges: names for some, by the number of their first corner."""
    geo = gmsh.model.geo
    points = [geo.addPoint(x, y, 0.0, size) for x, y in corners]
    lines = [geo.addLine(a, b) for a, b in zip(points, [*points[1:], points[0]])]
    face = geo.addPlaneSurface([geo.addCurveLoop(lines)])
    geo.synchronize()
    gmsh.model.addPhysicalGroup(2, [face], name=name)
    for edge, numbers in edges.items():
        gmsh.model.addPhysicalGroup(1, [lines[i] for i in numbers], name=edge)


def bearing() -> Assembly:
    """A bearing of six balls, in section, between two races, preloaded by 0.05, loaded through the bore."""
    count, middle, radius, preload = 6, 12.0, 5.0, 0.05
    turns = 2 * np.pi * (np.arange(count) + 0.25) / count

    def build(gmsh: Any) -> None:
        occ = gmsh.model.occ

        def race(inner: float, outer: float) -> int:
            return int(
                occ.cut([(2, occ.addDisk(0, 0, 0, outer, outer))], [(2, occ.addDisk(0, 0, 0, inner, inner))])[0][0][1]
            )

        bodies = {"inner": race(4.0, middle - radius + preload), "outer": race(middle + radius - preload, 21.0)}
        bodies |= {
            f"ball{i}": occ.addDisk(middle * np.cos(t), middle * np.sin(t), 0, radius, radius)
            for i, t in enumerate(turns)
        }
        occ.synchronize()
        for name, tag in bodies.items():
            gmsh.model.addPhysicalGroup(2, [tag], name=name)
        for name, wanted, body in (("bore", 4.0, "inner"), ("seat", 21.0, "outer")):
            curves = [t for _, t in gmsh.model.getBoundary([(2, bodies[body])], oriented=False)]
            own = [t for t in curves if abs(gmsh.model.getBoundingBox(1, t)[3] - wanted) < 1e-3]
            gmsh.model.addPhysicalGroup(1, own, name=name)
        touch = [
            occ.addPoint(r * np.cos(t), r * np.sin(t), 0) for t in turns for r in (middle - radius, middle + radius)
        ]
        occ.synchronize()
        field = gmsh.model.mesh.field
        near, size = field.add("Distance"), field.add("Threshold")
        field.setNumbers(near, "PointsList", touch)
        for key, value in {"InField": near, "SizeMin": 0.12, "SizeMax": 1.2, "DistMin": 0.8, "DistMax": 4.0}.items():
            field.setNumber(size, key, value)
        field.setAsBackgroundMesh(size)

    mesh = in_gmsh(build, 1.2, 2)
    rest = {"plane": "strain", "supports": [abut.Support("seat", x=0, y=0), abut.Support("bore", x=0, y=-0.03)]}
    every = [(race, f"ball{i}") for race in ("inner", "outer") for i in range(count)]
    return Assembly(mesh, names(*every), rest)


def fir_tree(size: float = 0.3) -> Assembly:
    """A blade root with three lobes a side in its slot, pulled out by the centrifugal force: pressure flanks touch, relief
    flanks keep a clearance of 0.05."""
    gap, steps = 0.05, 3
    right: list[Point] = [(2.2, 0.0)]
    for i in range(steps):  # from the bottom up; each lobe: relief flank out, tip, pressure flank in, neck
        y, out = 0.6 + 2.6 * i, 3.6 + 1.1 * i
        right += [(out, y + 0.6), (out, y + 1.1), (out - 0.9, y + 2.0), (out - 0.9, y + 2.3)]
    blade = [*right, (right[-1][0], right[-1][1] + 3.0)]
    blade = [*blade, *((-x, y) for x, y in reversed(blade))]
    # Moved along the pressure flanks, so that these slide on themselves.
    slot = [(x + gap, y - gap) for x, y in right]
    rim = slot[-1][1]
    disc = [(-10.0, -6.0), (10.0, -6.0), (10.0, rim), *reversed(slot), *((-x, y) for x, y in slot), (-10.0, rim)]

    def build(gmsh: Any) -> None:
        n = len(right)
        polygon(gmsh, "blade", blade, {"platform": [n]}, size)
        polygon(gmsh, "disc", disc, {"bottom": [0]}, size)

    mesh = in_gmsh(build, size, 2)
    rest = {
        "plane": "strain",
        "supports": [abut.Support("bottom", x=0, y=0), abut.Support("platform", x=0)],
        "loads": [abut.Force("platform", (0.0, 500.0))],
    }
    return Assembly(mesh, names(("blade", "disc")), rest)


def wall() -> Assembly:
    """Twenty-five blocks in running bond on a floor, between two piers, under their load."""
    parts = {"floor": make.rectangle((-1, 11), (-1, 0), (12, 1), "quad4")}
    pairs: list[tuple[str, str]] = []
    rows: list[list[tuple[str, float, float]]] = []
    for row in range(5):
        offset = 1.0 if row % 2 else 0.0
        cuts = np.clip(np.array([0.0, 2.0, 4.0, 6.0, 8.0, 10.0]) + offset, 0.0, 10.0)
        if row % 2:
            cuts = np.array([0.0, 1.5, 3.5, 5.5, 7.5, 10.0])
        rows.append([])
        for k, (left, right) in enumerate(pairwise(cuts)):
            name = f"block{row}{k}"
            cells = (round(4 * (right - left)) + (row + k) % 2, 4 + k % 2)
            parts[name] = make.rectangle((left, right), (row, row + 1), cells, "quad4")
            rows[-1].append((name, left, right))
        pairs += [(a[0], b[0]) for a, b in zip(rows[-1], rows[-1][1:])]
        below = rows[-2] if row else [("floor", 0.0, 10.0)]
        pairs += [(a[0], b[0]) for a in rows[-1] for b in below if min(a[2], b[2]) > max(a[1], b[1])]
    for name, x, end in (("west", (-1.0, 0.0), 0), ("east", (10.0, 11.0), -1)):
        parts[name] = make.rectangle(x, (0, 5), (6, 33), "quad4")
        pairs += [(name, "floor"), *((name, row[end][0]) for row in rows)]
    mesh = make.join(parts)
    stone = abut.LinearElastic(20e3, 0.2, density=2.4e-9)
    supports = [abut.Support("floor.bottom", x=0, y=0), *(abut.Support(on, x=0) for on in ("west.left", "east.right"))]
    loads: list[Any] = [abut.Gravity((0.0, -9810.0))]
    loads += [abut.Pressure(f"block4{k}.top", 1.0) for k in range(5)]
    return Assembly(
        mesh, names(*pairs),
        {"plane": "stress", "supports": supports, "loads": loads, "solids": [(b, stone) for b in mesh.bodies]},
    )  # fmt: skip


def o_ring() -> Assembly:
    """A rubber ring, radius 2.65, squeezed by a lid into a groove 4.2 deep and 7 wide; axisymmetric."""
    mean = 30.0

    def build(gmsh: Any) -> None:
        groove = [(20, -4), (40, -4), (40, 4.2), (33.5, 4.2), (33.5, 0), (26.5, 0), (26.5, 4.2), (20, 4.2)]
        polygon(gmsh, "groove", groove, {"below": [0]}, 0.8)
        polygon(gmsh, "lid", [(20, 5.3), (40, 5.3), (40, 8), (20, 8)], {"above": [2]}, 0.8)

    steel = in_gmsh(build, 0.8, 2)
    ring = make.disc(2.65, (mean, 2.65), fine=1.2, cells=5, cell="quad8")
    mesh = _with(steel, {"ring": ring})
    rest = {
        "plane": "axisymmetric",
        "supports": [abut.Support("below", x=0, y=0), abut.Support("above", x=0, y=-0.4)],
        "solids": [("groove", STEEL), ("lid", STEEL), ("ring", RUBBER)],
    }
    return Assembly(mesh, names(("ring", "groove"), ("ring", "lid")), rest)


def _with(mesh: abut.Mesh, others: dict[str, abut.Mesh]) -> abut.Mesh:
    """The mesh, its names kept, and other bodies."""
    joined = make.join({"own": mesh, **others})

    def plain(name: str) -> str:
        return name.removeprefix("own.")

    return replace(
        joined,
        bodies={plain(name): cells for name, cells in joined.bodies.items()},
        surfaces={plain(name): rows for name, rows in joined.surfaces.items()},
        node_sets={plain(name): nodes for name, nodes in joined.node_sets.items()},
    )


def flange() -> Assembly:
    """A bolt M16 that cools by 100 K through a washer and two flanges; its shank stands in holes 0.5 wider, its nut is part
    of it; axisymmetric."""
    bolt = [(0, -10), (12, -10), (12, 0), (8, 0), (8, 43), (12, 43), (12, 53), (0, 53)]
    parts = {
        "washer": [(8.5, 40), (15, 40), (15, 43), (8.5, 43)],
        "upper": [(8.5, 20), (30, 20), (30, 40), (8.5, 40)],
        "lower": [(8.5, 0), (30, 0), (30, 20), (8.5, 20)],
    }

    def build(gmsh: Any) -> None:
        polygon(gmsh, "bolt", bolt, {}, 2.0)
        for i, (name, corners) in enumerate(parts.items()):
            polygon(gmsh, name, corners, {"rim": [1]} if name == "lower" else {}, 1.6 + 0.3 * i)

    cooled = abut.LinearElastic(210e3, 0.3, expansion=1.2e-5)
    rest = {
        "plane": "axisymmetric",
        "supports": [abut.Support("rim", y=0)],
        "solids": [abut.Solid("bolt", cooled, temperature=-100.0), *((b, STEEL) for b in parts)],
    }
    every = [("bolt", "washer"), ("washer", "upper"), ("upper", "lower"), ("bolt", "lower"), ("bolt", "upper")]
    return Assembly(in_gmsh(build, 2.5, 2), names(*every), rest)


def involute(teeth: int, module: float, backlash: float, roundness: int = 6) -> list[Point]:
    """The outline of a gear, pressure angle 20 degrees, counter-clockwise, the middle of a gap at angle 0."""
    pitch = 0.5 * module * teeth
    base, tip, root = pitch * np.cos(np.deg2rad(20)), pitch + module, pitch - 1.25 * module

    def roll(radius: Any) -> Any:
        angle = np.arccos(np.clip(base / radius, -1, 1))
        return np.tan(angle) - angle

    radii = np.linspace(max(base, root), tip, roundness)
    half = np.pi / (2 * teeth) - backlash / (2 * pitch) + roll(pitch) - roll(radii)  # half the tooth's angle
    corners: list[Point] = []
    for k in range(teeth):
        centre = 2 * np.pi * (k + 0.5) / teeth
        flank = [(r, centre - h) for r, h in zip(radii, half)]
        tooth = [
            (root, centre - half[0]),
            *flank,
            *((r, 2 * centre - a) for r, a in reversed(flank)),
            (root, centre + half[0]),
        ]
        corners += [(r * np.cos(a), r * np.sin(a)) for r, a in dict.fromkeys(tooth)]
    return corners


def gears() -> Assembly:
    """Two gears of 17 and 23 teeth, module 4, backlash 0.05; the first, on its shaft, is turned, the second held."""
    module, teeth, backlash = 4.0, (17, 23), 0.05
    distance = 0.5 * module * sum(teeth)

    def build(gmsh: Any) -> None:
        occ = gmsh.model.occ
        for i, (name, count) in enumerate(zip(("pinion", "wheel"), teeth)):
            outline = involute(count, module, backlash)
            # A tooth of the pinion, a gap of the wheel on the line of centres.
            turn = np.pi / count if i == 0 else np.pi
            shift = 0.0 if i == 0 else distance
            c, s = np.cos(turn), np.sin(turn)
            points = [occ.addPoint(c * x - s * y + shift, s * x + c * y, 0.0) for x, y in outline]
            lines = [occ.addLine(a, b) for a, b in zip(points, [*points[1:], points[0]])]
            bore = occ.addCircle(shift, 0.0, 0.0, 0.3 * module * count)
            face = occ.addPlaneSurface([occ.addCurveLoop(lines), occ.addCurveLoop([bore])])
            occ.synchronize()
            gmsh.model.addPhysicalGroup(2, [face], name=name)
            gmsh.model.addPhysicalGroup(1, [bore], name=f"{name}_bore")
        for entity in gmsh.model.getEntities(0):
            x, y, _ = gmsh.model.getValue(*entity, [])
            fine = np.hypot(x - 0.5 * module * teeth[0], y) < 12.0
            gmsh.model.mesh.setSize([entity], 0.25 if fine else 2.5)

    mesh = in_gmsh(build, 4.0, 2)
    turn = 0.005

    rest = {
        "plane": "strain",
        "supports": [
            abut.Support("wheel_bore", x=0, y=0),
            abut.Support("pinion_bore", x=lambda p: -turn * p[..., 1], y=lambda p: turn * p[..., 0]),
        ],
    }
    return Assembly(mesh, names(("pinion", "wheel")), rest)


def clevis(size: float = 3.2) -> Assembly:
    """A quarter of an eye between the arms of a fork on a pin, clearance 0.05 on radius 6, pulled by 5 kN."""

    def build(gmsh: Any) -> None:
        occ = gmsh.model.occ

        def arm(z: float, thick: float, sign: int, length: float) -> int:
            plate = occ.addBox(min(0, sign * length), 0, z, length, 12, thick)
            head = occ.addCylinder(0, 0, z, 0, 0, thick, 12)
            both = occ.fuse([(3, plate)], [(3, head)])[0]
            half = occ.intersect(both, [(3, occ.addBox(-100, 0, z, 200, 100, thick))])[0]
            return int(occ.cut(half, [(3, occ.addCylinder(0, 0, z, 0, 0, thick, 6.05))])[0][0][1])

        eye, fork = arm(0.0, 8.0, 1, 40.0), arm(8.3, 8.0, -1, 40.0)
        whole = occ.addCylinder(0, 0, 0, 0, 0, 19.0, 6.0)
        pin = occ.intersect([(3, whole)], [(3, occ.addBox(-50, 0, 0, 100, 50, 50))])[0][0][1]
        occ.synchronize()
        for name, tag in (("eye", eye), ("fork", fork), ("pin", pin)):
            gmsh.model.addPhysicalGroup(3, [tag], name=name)

        def faces(body: int, where: Callable[[Any], bool]) -> list[int]:
            every = [t for _, t in gmsh.model.getBoundary([(3, body)], oriented=False)]
            return [t for t in every if where(np.array(gmsh.model.getBoundingBox(2, t)))]

        flat = {
            "middle": faces(eye, lambda b: b[5] < 1e-3) + faces(pin, lambda b: b[5] < 1e-3),
            "plane": [face for t in (eye, fork, pin) for face in faces(t, lambda b: b[4] < 1e-3)],
            "pulled": faces(eye, lambda b: b[0] > 39.9),
            "held": faces(fork, lambda b: b[3] < -39.9),
        }
        for name, tags in flat.items():
            gmsh.model.addPhysicalGroup(2, tags, name=name)

    mesh = in_gmsh(build, size, 2)
    supports = [abut.Support("middle", z=0), abut.Support("plane", y=0), abut.Support("held", x=0, z=0)]
    rest = {"supports": supports, "loads": [abut.Force("pulled", (1250.0, 0.0, 0.0))]}
    return Assembly(mesh, names(("eye", "pin"), ("fork", "pin"), ("eye", "fork")), rest)


ASSEMBLIES = {
    "bearing": bearing, "fir tree": fir_tree, "wall": wall, "o-ring": o_ring, "flange": flange, "gears": gears,
    "clevis": clevis,
}  # fmt: skip

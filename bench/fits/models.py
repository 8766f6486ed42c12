"""Round bodies of facets that do not match, whose pressure is known: tubes, shells of balls, bearings."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np
from exact import Layer, interface_pressures

import abut
from abut.mesh import make
from abut.mesh.cell_block import CellBlock
from abut.mesh.mesh import Mesh


def rings(cell: str, layers: Sequence[Layer], facets: Sequence[int]) -> Mesh:
    """Quarters, with ``facets`` a quarter each, about square cells, and no fewer than three through the wall."""
    parts = {}
    for i, (layer, n) in enumerate(zip(layers, facets, strict=True)):
        deep = max(3, round((layer.outer - layer.inner) / (0.5 * np.pi * layer.inner / n)))
        parts[f"ring{i}"] = make.ring([layer.inner, layer.outer], cells=[deep, n], cell=cell)
    return make.join(parts)


def tubes(cell: str, layers: Sequence[Layer], facets: Sequence[int]) -> Mesh:
    """The same in 3D, a layer of height 1; surfaces ring's inner, outer, start, end, bottom, top."""
    parts = {}
    names = {"inner": "left", "outer": "right", "start": "front", "end": "back", "bottom": "bottom", "top": "top"}
    for i, (layer, n) in enumerate(zip(layers, facets, strict=True)):
        deep = max(2, round((layer.outer - layer.inner) / (0.5 * np.pi * layer.inner / n)))
        high = max(2, round(n / (0.5 * np.pi * layer.inner)) // 2)
        box = make.box([layer.inner, layer.outer], [0, 90], [0, 1], cells=[deep, n, high], cell=cell)
        r, turn = box.points[:, 0], np.deg2rad(box.points[:, 1])
        points = np.column_stack([r * np.cos(turn), r * np.sin(turn), box.points[:, 2]])
        parts[f"ring{i}"] = replace(box, points=points, surfaces={new: box.surfaces[old] for new, old in names.items()})
    return make.join(parts)


def shells(cell: str, layers: Sequence[Layer], facets: Sequence[int]) -> Mesh:
    """A sixth of each spherical shell, between four planes through the centre."""
    parts = {}
    for i, (layer, n) in enumerate(zip(layers, facets, strict=True)):
        deep = max(2, round((layer.outer - layer.inner) / (0.5 * np.pi * layer.inner / n)))
        box = make.box([-45, 45], [-45, 45], [layer.inner, layer.outer], cells=[n, n, deep], cell=cell)
        along = np.column_stack([np.tan(np.deg2rad(box.points[:, :2])), np.ones(len(box.points))])
        points = box.points[:, 2:] * along / np.linalg.norm(along, axis=1, keepdims=True)
        parts[f"ring{i}"] = replace(box, points=points)
    return make.join(parts)


def symmetry(mesh: Mesh, shape: str) -> list[abut.Support]:
    """Planes of symmetry of all bodies."""
    held: dict[str, dict[str, float]] = {
        "rings": {"start": {"y": 0.0}, "end": {"x": 0.0}},
        "tubes": {"start": {"y": 0.0}, "end": {"x": 0.0}, "bottom": {"z": 0.0}, "top": {"z": 0.0}},
        "shells": {side: {"normal": 0.0} for side in ("left", "right", "front", "back")},
    }[shape]
    return [abut.Support(f"{body}.{side}", **given) for body in mesh.bodies for side, given in held.items()]


def fit(
    shape: str,
    cell: str,
    layers: Sequence[Layer],
    facets: Sequence[int],
    interferences: Sequence[float],
    contactor: str = "inner",
    pressures: tuple[float, float] = (0.0, 0.0),
    **given: str,
) -> tuple[abut.Model, np.ndarray]:
    """The model and its exact pressures. shape: rings, tubes or shells; contactor: which side of every interface."""
    mesh = {"rings": rings, "tubes": tubes, "shells": shells}[shape](cell, layers, facets)
    inner, outer = ("inner", "outer") if shape != "shells" else ("bottom", "top")
    solids = [
        abut.Solid(
            f"ring{i}", abut.LinearElastic(layer.young, layer.poisson, expansion=layer.expansion), temperature=layer.hot
        )
        for i, layer in enumerate(layers)
    ]
    contacts = []
    for i, interference in enumerate(interferences):
        both = f"ring{i}.{outer}", f"ring{i + 1}.{inner}"
        own, other = both if contactor == "inner" else both[::-1]
        options = {"geometry": given["geometry"]} if "geometry" in given else {}
        contacts.append(abut.Contact(contactor=own, target=other, offset=-interference, name=f"fit{i}", **options))
    loads = []
    for value, on in zip(pressures, (f"ring0.{inner}", f"ring{len(layers) - 1}.{outer}"), strict=True):
        loads += [abut.Pressure(on, value)] if value else []
    model = abut.Model(
        mesh, solids=solids, supports=symmetry(mesh, shape), contacts=contacts, loads=loads,
        plane="strain" if shape == "rings" else None, kinematics=given.get("kinematics", "small"),
    )  # fmt: skip
    return model, interface_pressures(layers, interferences, *pressures, sphere=shape == "shells")


def whole_ring(inner: float, outer: float, around: int, deep: int, cell: str) -> Mesh:
    """Two halves, put together where they meet."""
    halves = make.join(
        {
            str(i): make.ring([inner, outer], [-90 + 180 * i, 90 + 180 * i], cells=[deep, around // 2], cell=cell)
            for i in range(2)
        }
    )
    place = np.round(halves.points / outer * 1e9).astype(np.int64)
    _, first, number = np.unique(place, axis=0, return_index=True, return_inverse=True)
    blocks = tuple(CellBlock(block.kind, number.ravel()[block.nodes].astype(np.int32)) for block in halves.blocks)
    surfaces = {side: np.concatenate([halves.surfaces[f"{i}.{side}"] for i in range(2)]) for side in ("inner", "outer")}
    return Mesh(np.ascontiguousarray(halves.points[first]), blocks, {"ring": np.arange(halves.n_cells)}, surfaces, {})


def bearing(cell: str, around: tuple[int, int], contactor: str = "shaft", **given: object) -> abut.Model:
    """A hollow steel shaft (R 10 mm) in a bore (R 10.02 mm), pushed down by .06 mm. around: facets of shaft and bore."""
    mesh = make.join(
        {
            "shaft": whole_ring(5.0, 10.0, around[0], max(3, around[0] // 8), cell),
            "bore": whole_ring(10.02, 20.0, around[1], max(4, around[1] // 8), cell),
        }
    )
    steel = abut.LinearElastic(210e3, 0.3)
    sides = ("shaft.outer", "bore.inner") if contactor == "shaft" else ("bore.inner", "shaft.outer")
    options = {"geometry": given["geometry"]} if "geometry" in given else {}
    return abut.Model(
        mesh, plane="strain", kinematics=str(given.get("kinematics", "small")),
        solids=[abut.Solid(body, steel) for body in ("shaft", "bore")],
        supports=[abut.Support("bore.outer", x=0, y=0), abut.Support("shaft.inner", x=0, y=-0.06)],
        contacts=[abut.Contact(contactor=sides[0], target=sides[1], **options)],  # type: ignore[arg-type]
    )  # fmt: skip


def turned(cell: str, around: tuple[int, int], angle: float = 0.35, steps: int = 12) -> abut.Model:
    """The bearing with its bore pushed instead, in the first fifth of the time; then the shaft turns by ``angle``."""
    pushed = abut.Amplitude(((0.0, 0.0), (0.2, 1.0), (1.0, 1.0)))
    turns = abut.Amplitude(((0.0, 0.0), (0.2, 0.0), (1.0, 1.0)))
    return replace(
        bearing(cell, around, kinematics="finite"),
        supports=[abut.Support("bore.outer", x=0, y=0.06, amplitude=pushed)],
        rotations=[abut.Rotation("shaft.inner", angle, (0.0, 0.0), amplitude=turns)],
        solve=abut.SolveOptions(times=tuple(np.linspace(0.2, 1.0, steps + 1))),
    )


def tapered_hub(cell: str, facets: tuple[int, int], contactor: str = "shaft", interference: float = 0.01) -> abut.Model:
    """A hollow shaft (R .5 inside) in a hub (R 2.2 outside), both of height 1, that meet on a cone of radius 1 to 1.15; ends
    held along the axis. facets: over a quarter, of shaft and hub; cell: of 3D, or of the plane for the meridian section,
    with ``facets`` along it."""
    flat = cell in ("quad4", "quad8")
    parts = {}
    for part, n in zip(("shaft", "hub"), facets, strict=True):
        if flat:
            square = make.rectangle([0, 1], [0, 1], cells=[n, n], cell=cell)
            along, height = square.points.T
            parts[part] = replace(square, points=np.column_stack([_radius(part, along, height), height]))
            continue
        deep = max(2, round({"shaft": 0.55, "hub": 1.1}[part] * n / (0.5 * np.pi)))
        box = make.box([0, 1], [0, 90], [0, 1], cells=[deep, n, max(2, round(n / (0.5 * np.pi)))], cell=cell)
        r, turn, height = (
            _radius(part, box.points[:, 0], box.points[:, 2]),
            np.deg2rad(box.points[:, 1]),
            box.points[:, 2],
        )
        parts[part] = replace(box, points=np.column_stack([r * np.cos(turn), r * np.sin(turn), height]))
    sides = ("shaft.right", "hub.left") if contactor == "shaft" else ("hub.left", "shaft.right")
    held = [abut.Support(f"{part}.{end}", **{"y" if flat else "z": 0.0}) for part in parts for end in ("bottom", "top")]
    if not flat:
        held += [abut.Support(f"{part}.{side}", normal=0.0) for part in parts for side in ("front", "back")]
    return abut.Model(
        make.join(parts), plane="axisymmetric" if flat else None,
        solids=[abut.Solid(part, abut.LinearElastic(1000.0, 0.3)) for part in parts], supports=held,
        contacts=[abut.Contact(contactor=sides[0], target=sides[1], offset=-interference)],
    )  # fmt: skip


def _radius(part: str, through: np.ndarray, height: np.ndarray) -> np.ndarray:
    """Of points a share ``through`` of the wall at a ``height`` of the tapered hub."""
    cone = 1.0 + 0.15 * height
    inner, outer = (0.5, cone) if part == "shaft" else (cone, 2.2)
    return np.asarray(inner + through * (outer - inner))

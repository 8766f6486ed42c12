"""Models whose active set is hard to find: a beam lifted off a floor, a ball and a cylinder driven by a force, a layer that
recedes, a loose pin."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

import abut
from abut.mesh import make

STEEL = abut.LinearElastic(1000.0, 0.3)
HARD = abut.LinearElastic(1e6, 0.3)


def beam(facets: int, cell: str, lift: float = 8.0, **solve: object) -> abut.Model:
    """A beam of length 20 and height 1 that weighs 20 lies on a hard floor; ``lift`` pulls its right end up. Above 10 the
    force turns it over its left end."""
    mesh = make.join(
        {
            "beam": make.rectangle(x=[0, 20], y=[0, 1], cells=[facets, 4], cell=cell),
            "floor": make.rectangle(x=[-1, 21], y=[-1, 0], cells=[22, 1], cell=cell),
        }
    )
    corner = np.flatnonzero(np.abs(mesh.points - [0.0, 1.0]).max(axis=1) < 1e-9)
    mesh = replace(mesh, node_sets={**mesh.node_sets, "corner": corner})
    return abut.Model(
        mesh,
        [abut.Solid("beam", STEEL), abut.Solid("floor", HARD)],
        [abut.Support("floor.bottom", x=0, y=0), abut.Support("corner", x=0)],
        [abut.Pressure("beam.top", 1.0), abut.Force("beam.right", (0.0, lift))],
        [abut.Contact(contactor="beam.bottom", target="floor.top", name="floor")],
        plane="strain",
        solve=abut.SolveOptions(**solve),
    )


def solid_beam(facets: int, cell: str, lift: float = 8.0, **solve: object) -> abut.Model:
    """The same in space, of width 1."""
    mesh = make.join(
        {
            "beam": make.box(x=[0, 20], y=[0, 1], z=[0, 1], cells=[facets, 2, 2], cell=cell),
            "floor": make.box(x=[-1, 21], y=[-0.5, 1.5], z=[-1, 0], cells=[22, 2, 1], cell=cell),
        }
    )
    corner = np.flatnonzero(np.abs(mesh.points[:, [0, 2]] - [0.0, 1.0]).max(axis=1) < 1e-9)
    mesh = replace(mesh, node_sets={**mesh.node_sets, "corner": corner})
    return abut.Model(
        mesh,
        [abut.Solid("beam", STEEL), abut.Solid("floor", HARD)],
        [abut.Support("floor.bottom", x=0, y=0, z=0), abut.Support("corner", x=0), abut.Support("beam.front", y=0)],
        [abut.Pressure("beam.top", 1.0), abut.Force("beam.right", (0.0, 0.0, lift))],
        [abut.Contact(contactor="beam.bottom", target="floor.top", name="floor")],
        solve=abut.SolveOptions(**solve),
    )


def layer(cells: int, cell: str, **solve: object) -> abut.Model:
    """Half of an elastic layer of thickness 1 on a half-plane, both without weight: pressed on the middle, it recedes to a
    contact of about its own thickness."""
    mesh = make.join(
        {
            "layer": make.rectangle(x=[0, 10], y=[0, 1], cells=[cells, 4], cell=cell),
            "half": make.rectangle(x=[0, 30], y=[-30, 0], cells=[cells, 8], cell=cell, fine={"x": [0, 10]}),
        }
    )
    axis = np.flatnonzero(np.abs(mesh.points[:, 0]) < 1e-9)
    corners = mesh.points[mesh.surface("layer.top").nodes[:, :2], 0]
    patch = mesh.surfaces["layer.top"][corners.mean(axis=1) < 0.5]
    mesh = replace(mesh, node_sets={**mesh.node_sets, "axis": axis}, surfaces={**mesh.surfaces, "layer.patch": patch})
    return abut.Model(
        mesh,
        [abut.Solid("layer", STEEL), abut.Solid("half", STEEL)],
        [abut.Support("half.bottom", x=0, y=0), abut.Support("axis", x=0)],
        [abut.Pressure("layer.patch", 1.0)],
        [abut.Contact(contactor="layer.bottom", target="half.top", name="layer")],
        plane="strain",
        solve=abut.SolveOptions(**solve),
    )


def line(cells: int, cell: str, swap: bool = False, **contact: object) -> abut.Model:
    """A steel cylinder of radius 50 mm pressed into an aluminium block; ``swap``: the cylinder carries the pressure."""
    mesh = make.join(
        {
            "cylinder": make.half_disc(50.0, (0.0, 50.0), fine=8.0, cells=cells, cell=cell),
            "block": make.rectangle(
                (-100.0, 100.0), (-200.0, 0.0), (2 * cells, cells), cell, fine={"x": [-8.0, 8.0], "y": [-8.0, 0.0]}
            ),
        }
    )
    sides = ("cylinder.round", "block.top") if swap else ("block.top", "cylinder.round")
    return abut.Model(
        mesh,
        [
            abut.Solid("cylinder", abut.LinearElastic(210e3, 0.3)),
            abut.Solid("block", abut.LinearElastic(70e3, 0.3)),
        ],
        [abut.Support("block.bottom", x=0, y=0), abut.Support("cylinder.axis", x=0)],
        [abut.Force("cylinder.flat", (0.0, -35e3))],
        [abut.Contact(contactor=sides[0], target=sides[1], **contact)],
        plane="strain",
    )


def ball(cells: int, force: float = 1.0, cell: str = "quad4", **solve: object) -> abut.Model:
    """Half a ball of radius 1, axisymmetric, pressed onto a block by ``force``."""
    mesh = make.join(
        {
            "ball": make.quarter_disc(radius=1.0, centre=[0, 1], fine=0.3, cells=cells, cell=cell),
            "block": make.rectangle(x=[0, 2], y=[-1, 0], cells=[cells, 8], cell=cell, fine={"x": [0, 0.35]}),
        }
    )
    return abut.Model(
        mesh,
        [abut.Solid("ball", STEEL), abut.Solid("block", STEEL)],
        [abut.Support("block.bottom", y=0)],
        [abut.Force("ball.flat", (0.0, -force))],
        [abut.Contact(contactor="ball.round", target="block.top", name="touch")],
        plane="axisymmetric",
        solve=abut.SolveOptions(**solve),
    )


def pin(cells: int, force: float, clearance: float = 0.01, **solve: object) -> abut.Model:
    """A pin, loose between two lugs with half a hole each (half of everything), the lower one pushed up by ``force``, the
    upper one held at its rim: nothing touches at the outset, and contact alone holds the pin and the lower lug."""
    around = {
        "pin": ([0.3, 1.0 - clearance], [-90, 90], 2 * cells),
        "upper": ([1.0, 2.0], [3, 90], cells + 3),
        "lower": ([1.0, 2.0], [-90, -3], cells + 2),
    }
    deep = max(2, cells // 4)
    mesh = make.join({name: make.ring(radii=r, angles=a, cells=[deep, n]) for name, (r, a, n) in around.items()})
    return abut.Model(
        mesh,
        [abut.Solid(body, STEEL) for body in around],
        [
            abut.Support("upper.outer", x=0, y=0),
            *(abut.Support(on, x=0) for on in ("pin.start", "pin.end", "lower.start", "upper.end")),
        ],
        [abut.Force("lower.outer", (0.0, force))],
        [abut.Contact(contactor=f"{lug}.inner", target="pin.outer", name=lug) for lug in ("upper", "lower")],
        plane="strain",
        solve=abut.SolveOptions(**solve),
    )

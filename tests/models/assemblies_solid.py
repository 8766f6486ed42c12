"""Random assemblies in space, made as those in the plane are."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

import abut
from abut.mesh import make
from models.assembly_parts import Parts, Rng, press


def stack(rng: Rng) -> abut.Model:
    """Boxes on top of each other, some glued, with gaps and overlaps, tilted or bulging undersides; contact alone holds
    most of them but for sliding and turning on the spot."""
    parts = Parts(rng)
    parts.add("ground", make.box(x=[-0.3, 3.3], y=[-0.3, 3.3], z=[-1, 0], cells=[5, 4, 1], cell=parts.cell(3)))
    parts.hold("ground.bottom", x=0.0, y=0.0, z=0.0)
    below, top = "ground", 0.0
    for number in range(parts.count(1, 2)):
        name, high = f"block{number}", parts.size(0.4, 1.5)
        left, right = rng.uniform(0.0, 1.0), rng.uniform(2.0, 3.0)
        front, back = rng.uniform(0.0, 1.0), rng.uniform(2.0, 3.0)
        glued = number > 0 and parts.chance(0.2)
        gap = 0.0 if glued else parts.clearance(high)
        z = [top + max(gap, 0.0), top + max(gap, 0.0) + high]
        cells = [parts.count(2, 4), parts.count(2, 4), parts.count(1, 2)]
        mesh = make.box(x=[left, right], y=[front, back], z=z, cells=cells, cell=parts.cell(3))
        if not glued and parts.chance(0.5):
            x, y, height = mesh.points.T
            shape = (x - left) + 0.4 * (y - front) if parts.chance(0.5) else (x - 1.5) ** 2 + (y - 1.5) ** 2
            rise = parts.size(1e-4, 2e-2) * shape * (z[1] - height) / high
            mesh = replace(mesh, points=np.column_stack([x, y, height + rise]))
        parts.add(name, mesh)
        parts.meet(f"{name}.bottom", f"{below}.top", **({"kind": "tied"} if glued else {"offset": min(gap, 0.0)}))
        if not glued:  # against sliding and turning on the spot, and against nothing else
            parts.hold(parts.node(name, "corner", (left, front, z[0])), x=0.0, y=0.0)
            parts.hold(parts.node(name, "other", (right, front, z[0])), y=0.0)
        press(parts, name, 2)
        below, top = name, z[1]
    return parts.model(None)


def table(rng: Rng) -> abut.Model:
    """A slab on four legs, some of them too short, with a block on it."""
    parts = Parts(rng)
    parts.add("slab", make.box(x=[0, 4], y=[0, 4], z=[0, parts.size(0.3, 1.0)], cells=[5, 5, 1], cell=parts.cell(3)))
    for number, (x, y) in enumerate([(0, 0), (3, 0), (0, 3), (3, 3)]):
        short = max(parts.clearance(0.3), 0.0) if number else 0.0
        leg = make.box(x=[x, x + 1], y=[y, y + 1], z=[-2, -short], cells=[2, 2, 2], cell=parts.cell(3))
        parts.add(f"leg{number}", leg)
        parts.hold(f"leg{number}.bottom", x=0.0, y=0.0, z=0.0)
        parts.touch(f"leg{number}.top", "slab.bottom")
    top = parts.meshes["slab"].points[:, 2].max()
    at = rng.uniform(0.5, 2.0)
    parts.add("load", make.box(x=[at, at + 1.2], y=[1, 2.5], z=[top, top + 1], cells=[2, 3, 1], cell=parts.cell(3)))
    parts.meet("load.bottom", "slab.top", offset=min(parts.clearance(1.0), 0.0))
    for name, x, y, z, far in (("slab", 0.0, 0.0, 0.0, 4.0), ("load", at, 1.0, top, at + 1.2)):
        parts.hold(parts.node(name, "corner", (x, y, z)), x=0.0, y=0.0)
        parts.hold(parts.node(name, "other", (far, y, z)), y=0.0)
        press(parts, name, 2)
    return parts.model(None)


def balls(rng: Rng) -> abut.Model:
    """A quarter of a ball between two plates, in two halves that touch at its equator or are glued there."""
    parts = Parts(rng)
    lower = make.sphere_octant(
        radius=1.0, centre=[0, 0, 1], fine=rng.uniform(0.1, 0.3), cells=parts.count(1, 3), cell=parts.cell(3)
    )
    upper = make.sphere_octant(
        radius=1.0, centre=[0, 0, 1], fine=rng.uniform(0.1, 0.3), cells=parts.count(1, 3), cell=parts.cell(3)
    )
    turn = np.array([[0, 1, 0], [1, 0, 0], [0, 0, -1]])  # upside down, the round side up
    upper = replace(upper, points=(upper.points - [0, 0, 1]) @ turn.T + [0, 0, 1])
    parts.add("lower", lower)
    parts.add("upper", upper)
    for name, z in (("floor", [-0.5, 0.0]), ("lid", [2.0, 2.5])):
        parts.add(name, make.box(x=[0, 1.5], y=[0, 1.5], z=z, cells=[5, 5, 1], cell=parts.cell(3), fine=None))
        parts.hold(f"{name}.left", x=0.0)
        parts.hold(f"{name}.front", y=0.0)
    for name, across in (("lower", ("x", "y")), ("upper", ("y", "x"))):
        parts.hold(f"{name}.x0", **{across[0]: 0.0})
        parts.hold(f"{name}.y0", **{across[1]: 0.0})
    parts.hold("floor.bottom", z=0.0)
    clearance = parts.clearance(1.0)
    parts.meet("lower.round", "floor.top")
    parts.meet("upper.round", "lid.bottom", offset=min(clearance, 0.0))
    parts.meet("lower.z0", "upper.z0", kind="tied" if parts.chance(0.3) else "contact")
    parts.loads.append(abut.Pressure("lid.top", parts.size(1e-3, 3.0)))
    return parts.model(None)


def pins(rng: Rng) -> abut.Model:
    """A pin in one or two sleeves, loose or pressed in; a force at its end pushes it sideways, contact alone holds it."""
    parts = Parts(rng)
    clearance, around = parts.clearance(1.0), parts.count(8, 12)
    radius = 1.0 - max(clearance, 0.0)
    solid = parts.chance(0.5)
    cells = [4, 3] if solid else [1, around, 3]
    pin = make.cylinder(radius=radius, z=[-0.03, 3], cells=cells, cell=parts.cell(3), inner=None if solid else 0.5)
    turn = rng.uniform(0.0, 1.0)  # so that no edges coincide, of which rounding would decide whether they are crossed
    spin = np.array([[np.cos(turn), -np.sin(turn), 0.0], [np.sin(turn), np.cos(turn), 0.0], [0.0, 0.0, 1.0]])
    parts.add("pin", replace(pin, points=pin.points @ spin.T))
    gaps = [[0.0, 1.0], [1.2, 2.2]][: parts.count(1, 2)]
    for number, z in enumerate(gaps):
        name = f"sleeve{number}"
        parts.add(
            name,
            make.cylinder(radius=rng.uniform(1.3, 2.0), z=z, cells=[1, around + 2, 2], cell=parts.cell(3), inner=1.0),
        )
        parts.hold(f"{name}.round", x=0.0, y=0.0, z=0.0)
        parts.touch(f"{name}.inner", "pin.round", offset=min(clearance, 0.0))
    parts.hold("pin.bottom", z=0.0)
    for label, x in (("near", radius), ("far", -radius)):
        parts.node("pin", label, (x, 0.0, -0.03))
    parts.spins.append(("pin.near", "pin.far", "y"))
    angle = rng.uniform(0.0, 2.0 * np.pi)
    push = parts.size(1e-3, 3.0)
    parts.loads.append(abut.Force("pin.top", (push * np.cos(angle), push * np.sin(angle), 0.0)))
    return parts.model(None)


SOLID = {f.__name__: f for f in (stack, table, balls, pins)}

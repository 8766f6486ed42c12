"""Random assemblies in the plane: several bodies and contacts each, drawn from a seed."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

import abut
from abut.mesh import make
from models.assembly_parts import Parts, Rng, keep_upright, plane_of, press


def stack(rng: Rng) -> abut.Model:
    """Blocks on top of each other, some glued, with gaps and overlaps, rough or tilted undersides."""
    parts = Parts(rng)
    wide = rng.uniform(2.0, 5.0)
    top = 0.0
    ground = make.rectangle(x=[-0.5, wide + 0.5], y=[-1, 0], cells=[parts.count(6, 14), 2], cell=parts.cell(2))
    parts.add("ground", ground)
    parts.hold("ground.bottom", x=0.0, y=0.0)
    if parts.chance(0.2):
        parts.supports.clear()
        parts.rigid.append(abut.Rigid("ground", x=0.0, y=0.0, rz=0.0))
    below = "ground"
    for number in range(parts.count(1, 3)):
        name, high = f"block{number}", parts.size(0.3, 2.0)
        left, right = rng.uniform(0.0, 0.3) * wide, wide * rng.uniform(0.6, 1.0)
        glued = number > 0 and parts.chance(0.2)
        gap = 0.0 if glued else parts.clearance(high)
        mesh = make.rectangle(
            x=[left, right], y=[top, top + high], cells=[parts.count(4, 12), parts.count(1, 3)], cell=parts.cell(2)
        )
        shape = rng.random()
        if not glued and shape < 0.5:
            x, y = mesh.points.T
            rough = parts.size(1e-4, 3e-2) * (
                np.interp(x, np.linspace(left, right, 8), rng.uniform(0, 1, 8)) if shape < 0.3 else (x - left) / wide
            )
            mesh = replace(mesh, points=np.column_stack([x, y + rough * (top + high - y) / high]))
        lifted = max(gap, 0.0)
        mesh = replace(mesh, points=mesh.points + np.array([0.0, lifted]))
        parts.add(name, mesh)
        options = {"kind": "tied"} if glued else {"offset": min(gap, 0.0)}
        pair = (f"{name}.bottom", f"{below}.top")
        (parts.touch if parts.rigid and below == "ground" else parts.meet)(*pair, **options)
        if shape < 0.5 and not glued:
            parts.hold(f"{name}.left" if parts.chance(0.5) else parts.node(name, "pinned", (left, top)), x=0.0)
        elif not glued:
            keep_upright(parts, name, left, top)
        press(parts, name, 1)
        top, below = top + high + lifted, name
    return parts.model(plane_of(parts))


def bridge(rng: Rng) -> abut.Model:
    """A beam on pillars, some of them too short, and a block on the beam."""
    parts = Parts(rng)
    span, count = rng.uniform(4.0, 12.0), parts.count(2, 4)
    deck = make.rectangle(
        x=[0, span], y=[0, parts.size(0.3, 1.5)], cells=[parts.count(10, 30), parts.count(2, 3)], cell=parts.cell(2)
    )
    parts.add("deck", deck)
    for number, x in enumerate(np.linspace(0.0, span, count)):
        name, half = f"pillar{number}", 0.4 * span / (2 * count)
        short = abs(parts.clearance(1.0)) if 0 < number < count - 1 or parts.chance(0.3) else 0.0
        middle = np.clip(x, half, span - half)
        parts.add(
            name,
            make.rectangle(
                x=[middle - half, middle + half], y=[-2.0, -short], cells=[parts.count(2, 5), 3], cell=parts.cell(2)
            ),
        )
        parts.hold(f"{name}.bottom", x=0.0, y=0.0)
        parts.touch(f"{name}.top", "deck.bottom")
    parts.hold(parts.node("deck", "pinned", (0.0, 0.0)), x=0.0)
    press(parts, "deck", 1)
    high, left = deck.points[:, 1].max(), rng.uniform(0.0, 0.7) * span
    parts.add(
        "load",
        make.rectangle(
            x=[left, left + 0.25 * span], y=[high, high + 1], cells=[parts.count(3, 8), 2], cell=parts.cell(2)
        ),
    )
    parts.meet("load.bottom", "deck.top", offset=min(parts.clearance(1.0), 0.0))
    keep_upright(parts, "load", left, high)
    press(parts, "load", 1)
    return parts.model(plane_of(parts))


def pins(rng: Rng) -> abut.Model:
    """Half of a hollow pin in two or three lugs, loose or pressed in; one lug is held, forces pull at the others."""
    parts = Parts(rng)
    lugs = parts.count(2, 3)
    clearance = parts.clearance(1.0)
    radius = 1.0 - max(clearance, 0.0)
    around = parts.count(10, 24)
    parts.add(
        "pin",
        make.ring(radii=[rng.uniform(0.2, 0.6), radius], angles=[-90, 90], cells=[3, around], cell=parts.cell(2)),
    )
    edges = np.linspace(-90, 90, lugs + 1)
    held = parts.count(0, lugs - 1)
    for number in range(lugs):
        name = f"lug{number}"
        first = edges[number] + (3.0 if number else 0.0)
        last = edges[number + 1] - (3.0 if number < lugs - 1 else 0.0)
        parts.add(
            name,
            make.ring(
                radii=[1.0, rng.uniform(1.5, 2.5)], angles=[first, last],
                cells=[3, parts.count(around // lugs, around)], cell=parts.cell(2),
            ),
        )  # fmt: skip
        parts.touch(f"{name}.inner", "pin.outer", offset=min(clearance, 0.0))
        middle = np.deg2rad(0.5 * (first + last))
        if number == held:
            parts.hold(f"{name}.outer", x=0.0, y=0.0)
        elif abs(np.sin(middle)) > 0.3:
            parts.hold(f"{name}.{'start' if middle < 0 else 'end'}", x=0.0)
            parts.loads.append(abut.Force(f"{name}.outer", (0.0, -np.sign(middle) * parts.size(1e-3, 10.0))))
        else:  # the one at the side presses on the pin
            parts.hold(f"{name}.start", y=0.0)
            parts.loads.append(abut.Pressure(f"{name}.outer", parts.size(1e-3, 10.0)))
    parts.hold("pin.start", x=0.0)
    parts.hold("pin.end", x=0.0)
    return parts.model(plane_of(parts))


def rings(rng: Rng) -> abut.Model:
    """Half of rings round each other, shrunk on or loose, under pressure inside and forces; the outermost is held."""
    parts = Parts(rng)
    inner, count, around = 1.0, parts.count(2, 4), parts.count(8, 16)
    for number in range(count):
        outer = inner * rng.uniform(1.2, 1.8)
        parts.add(
            f"ring{number}",
            make.ring(
                radii=[inner, outer], angles=[-90, 90], cells=[parts.count(2, 3), parts.count(around, 2 * around)],
                cell=parts.cell(2),
            ),
        )  # fmt: skip
        for end in ("start", "end"):
            parts.hold(f"ring{number}.{end}", x=0.0)
        gap = parts.clearance(outer)
        if number < count - 1:
            if parts.chance(0.5):
                parts.loads.append(abut.Force(f"ring{number}.end", (0.0, float(rng.normal()))))
            parts.meet(f"ring{number}.outer", f"ring{number + 1}.inner", offset=min(gap, 0.0))
        inner = outer + max(gap, 0.0)
    if parts.chance(0.6) or not parts.loads:
        parts.loads.append(abut.Pressure("ring0.inner", parts.size(1e-3, 10.0)))
    parts.hold(f"ring{count - 1}.outer", x=0.0, y=0.0)
    return parts.model(plane_of(parts))


def balls(rng: Rng) -> abut.Model:
    """Rollers of slightly different sizes between two plates; the upper one, pressed down, is held by them alone."""
    parts = Parts(rng)
    count = parts.count(1, 3)
    length = 2.5 * count
    for name, y in (("lower", [-0.6, 0.0]), ("upper", [2.0, 2.6])):
        parts.add(
            name,
            make.rectangle(x=[0, length], y=y, cells=[parts.count(8, 14) * count, 2], cell=parts.cell(2)),
        )
    parts.hold("lower.bottom", x=0.0, y=0.0)
    parts.hold("upper.left" if count == 1 or parts.chance(0.4) else parts.node("upper", "pinned", (0.0, 2.0)), x=0.0)
    for number in range(count):
        name, radius = f"ball{number}", 1.0 - (parts.size(1e-5, 1e-2) if parts.chance(0.5) else 0.0)
        centre = [2.5 * number + 1.25, radius]
        parts.add(
            name,
            make.disc(radius=radius, centre=centre, cells=parts.count(2, 4), fine=rng.uniform(0.1, 0.3), cell=parts.cell(2)),
            below=lambda x, c=centre: x[:, 1] < c[1] - 0.3, above=lambda x, c=centre: x[:, 1] > c[1] + 0.3,
        )  # fmt: skip
        parts.hold(f"{name}.axis", x=0.0)
        parts.touch(f"{name}.below", "lower.top")
        parts.touch(f"{name}.above", "upper.bottom", offset=-parts.size(1e-5, 1e-2) if parts.chance(0.3) else 0.0)
    parts.loads.append(abut.Pressure("upper.top", parts.size(1e-3, 1.0)))
    if count > 1 and parts.chance(0.5):
        parts.loads.append(abut.Force("upper.right", (0.0, -parts.size(1e-3, 1.0))))
    return parts.model(plane_of(parts))


def pile(rng: Rng) -> abut.Model:
    """Two cylinders side by side on the ground, between walls, and a third one on top of them: held by contact alone."""
    parts = Parts(rng)
    apart = rng.uniform(1.02, 1.5)  # half the distance of the lower ones
    high = 1.0 + np.sqrt(4.0 - apart**2)
    reach = apart + 1.0
    parts.add("ground", make.rectangle(x=[-reach - 1, reach + 1], y=[-1, 0], cells=[24, 2], cell=parts.cell(2)))
    parts.hold("ground.bottom", x=0.0, y=0.0)
    along = np.arctan2(high - 1.0, apart)
    for sign, name in ((-1.0, "left"), (1.0, "right")):
        walls = [[-reach - 1, -reach], [reach, reach + 1]]
        play = max(parts.clearance(1.0), 0.0)
        wall = make.rectangle(
            x=list(np.array(walls[int(sign > 0)]) + sign * play),
            y=[0.3, 1.7],
            cells=[2, parts.count(8, 14)],
            cell=parts.cell(2),
        )
        parts.add(f"{name} wall", wall)
        parts.hold(f"{name} wall.{name}", x=0.0, y=0.0)
        centre = np.array([sign * apart, 1.0])

        def toward(x: NDArray[np.float64], angle: float, c: NDArray[np.float64] = centre) -> NDArray[np.bool_]:
            d = x - c
            turn = np.arctan2(d[:, 1], d[:, 0]) - angle
            return np.abs((turn + np.pi) % (2 * np.pi) - np.pi) < np.deg2rad(25)

        parts.add(
            name,
            make.disc(radius=1.0, centre=list(centre), cells=2, fine=0.3, growth=1.15, cell=parts.cell(2)),
            down=lambda x, t=toward: t(x, -np.pi / 2),
            out=lambda x, t=toward, s=sign: t(x, 0.0 if s > 0 else np.pi),
            up=lambda x, t=toward, s=sign: t(x, along if s < 0 else np.pi - along),
        )  # fmt: skip
        parts.stop_spin(name, tuple(centre), 1.0)
        parts.touch(f"{name}.down", "ground.top")
        parts.touch(f"{name}.out", f"{name} wall.{'left' if sign > 0 else 'right'}")
        parts.touch(f"{name}.up", "top.round")
        parts.loads.append(abut.BodyForce((0.0, -parts.size(1e-3, 1.0)), on=name))
    parts.add("top", make.disc(radius=1.0, centre=[0.0, high], cells=2, fine=0.3, growth=1.15, cell=parts.cell(2)))
    parts.stop_spin("top", (0.0, high), 1.0)
    parts.loads.append(abut.BodyForce((0.0, -parts.size(1e-3, 1.0)), on="top"))
    return parts.model(plane_of(parts))


def turned(rng: Rng) -> abut.Model:
    """Axisymmetric: a ball on a plate on a ring, all held by contact alone along the axis."""
    parts = Parts(rng)
    parts.add(
        "ring",
        make.rectangle(
            x=[rng.uniform(0.3, 0.9), 2.0], y=[-2.0, -1.0], cells=[parts.count(3, 8), 3], cell=parts.cell(2)
        ),
    )
    gap = parts.clearance(1.0)
    parts.add(
        "plate",
        make.rectangle(
            x=[0, 2],
            y=[-1.0 + max(gap, 0.0), max(gap, 0.0)],
            cells=[parts.count(8, 16), parts.count(2, 4)],
            cell=parts.cell(2),
        ),
    )
    parts.hold("ring.bottom", y=0.0)
    parts.meet("plate.bottom", "ring.top", offset=min(gap, 0.0))
    lift = max(gap, 0.0) + max(parts.clearance(1.0), 0.0)
    parts.add(
        "ball",
        make.quarter_disc(
            radius=1.0, centre=[0, 1 + lift], fine=rng.uniform(0.1, 0.4), cells=parts.count(4, 8), cell=parts.cell(2)
        ),
    )
    parts.meet("ball.round", "plate.top")
    parts.loads.append(abut.Force("ball.flat", (0.0, -parts.size(0.01, 30.0))))
    if parts.chance(0.5):  # a sleeve round the plate's rim
        fit = parts.clearance(2.0, tight=0.7)
        high = max(gap, 0.0)
        parts.add(
            "sleeve",
            make.rectangle(
                x=[2.0 + max(fit, 0.0), 2.8],
                y=[high - 1.2, high + 0.2],
                cells=[2, parts.count(4, 9)],
                cell=parts.cell(2),
            ),
        )
        parts.meet("sleeve.left", "plate.right", offset=min(fit, 0.0))
        parts.hold(parts.node("sleeve", "pinned", (2.8, high - 1.2)), y=0.0)
    if parts.chance(0.3):
        parts.loads.append(abut.Pressure("plate.top", parts.size(1e-3, 0.1)))
    return parts.model("axisymmetric")


PLANE = {f.__name__: f for f in (stack, bridge, pins, rings, balls, pile, turned)}

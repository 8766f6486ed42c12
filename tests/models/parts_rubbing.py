"""Parts with friction: a clevis, a bolted flange, a blade root, press fits, one of them with a key."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from typing import Any

import abut
from abut.mesh import make
from models.assembly import STEEL, clevis, fir_tree, flange, in_gmsh

FRICTION = 0.15


def rubbing(model: abut.Model, friction: float = FRICTION) -> abut.Model:
    """The same with friction in every contact."""
    contacts = [own if own.kind == "tied" else replace(own, friction=friction) for own in model.contacts]
    return replace(model, contacts=contacts)


def press_fit(cell: str = "tet4", friction: float = 0.2, hub: bool = True, around: int = 12) -> abut.Model:
    """A shaft in a shorter hub, 0.02 too large for it; hub: its bore is the contactor."""
    parts = {
        "shaft": make.cylinder(10.0, (0.0, 40.0), (2, around, 8), cell, inner=4.0),
        "hub": make.cylinder(20.0, (10.0, 30.0), (2, around + 3, 5), cell, inner=10.0),
    }
    sides = ("hub.inner", "shaft.round") if hub else ("shaft.round", "hub.inner")
    return abut.Model(
        make.join(parts),
        [abut.Solid(name, STEEL) for name in parts],
        [abut.Support("shaft.bottom", x=0, y=0, z=0)],
        contacts=[abut.Contact(contactor=sides[0], target=sides[1], offset=-0.02, friction=friction)],
    )


def keyway(size: float = 2.0) -> abut.Model:
    """A shaft of radius 20 pressed into a hub, 0.01 too large for it, with a key between them; the hub's rim turns by an
    angle that slides the fit until the key carries. In section."""
    radius, fit, play = 20.0, 0.01, 0.02
    turn = 2e-3

    def build(gmsh: Any) -> None:
        occ = gmsh.model.occ
        shaft = occ.addDisk(0, 0, 0, radius, radius)
        shaft = occ.cut([(2, shaft)], [(2, occ.addDisk(0, 0, 0, 6, 6)), (2, occ.addRectangle(-6, 13, 0, 12, 10))])[0][
            0
        ][1]
        hub = occ.addDisk(0, 0, 0, 36, 36)
        hole = occ.fuse([(2, occ.addDisk(0, 0, 0, radius, radius))],
                        [(2, occ.addRectangle(-6 - play, 10, 0, 12 + 2 * play, 15))])[0]  # fmt: skip
        hub = occ.cut([(2, hub)], hole)[0][0][1]
        key = occ.addRectangle(-6, 13, 0, 12, 11.5)
        occ.synchronize()
        for name, tag in (("shaft", shaft), ("hub", hub), ("key", key)):
            gmsh.model.addPhysicalGroup(2, [tag], name=name)

        def curves(body: int, where: Callable[[float, float], bool]) -> list[int]:
            middle = [(t, gmsh.model.occ.getCenterOfMass(1, t), gmsh.model.occ.getMass(1, t))
                      for _, t in gmsh.model.getBoundary([(2, body)], oriented=False)]  # fmt: skip
            return [t for t, c, length in middle if where(float(c[0] ** 2 + c[1] ** 2), float(length))]

        bore = curves(shaft, lambda d, length: abs(length - 2 * 3.14159265 * 6) < 1e-2)
        rim = curves(hub, lambda d, length: abs(length - 2 * 3.14159265 * 36) < 1e-2)
        gmsh.model.addPhysicalGroup(1, bore, name="held")
        gmsh.model.addPhysicalGroup(1, rim, name="rim")
        for name, body in (("fit", shaft), ("bore", hub)):
            lines = [t for _, t in gmsh.model.getBoundary([(2, body)], oriented=False)]
            own = [t for t in lines if t not in (*bore, *rim) and gmsh.model.getType(1, t) != "Line"]
            gmsh.model.addPhysicalGroup(1, own, name=name)
            slot = [t for t in lines if gmsh.model.getType(1, t) == "Line"]
            gmsh.model.addPhysicalGroup(1, slot, name=f"{name}_slot")
        gmsh.model.addPhysicalGroup(1, [t for _, t in gmsh.model.getBoundary([(2, key)], oriented=False)], name="sides")

    mesh = in_gmsh(build, size, 2)
    return abut.Model(
        mesh,
        [abut.Solid(name, STEEL) for name in mesh.bodies],
        [
            abut.Support("held", x=0, y=0),
            abut.Support("rim", x=lambda p: -turn * p[..., 1], y=lambda p: turn * p[..., 0]),
        ],
        contacts=[
            abut.Contact(contactor="fit", target="bore", offset=-fit),
            abut.Contact(contactor="sides", target="fit_slot"),
            abut.Contact(contactor="sides", target="bore_slot"),
        ],
        plane="strain",
    )


PARTS: dict[str, Callable[[], abut.Model]] = {
    "clevis": lambda: rubbing(clevis().model()),
    "flange": lambda: rubbing(flange().model()),
    "blade root": lambda: rubbing(fir_tree().model()),
    "press fit": press_fit,
    "keyway": lambda: rubbing(keyway()),
}

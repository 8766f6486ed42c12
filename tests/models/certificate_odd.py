"""More small models for the catalogue: several pairs, histories, heat, and what users get wrong."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

import abut
from abut.mesh.make import box, cylinder, join, rectangle
from models.certificate import NU, SOFT, fit, squares, steel


def strip(facets: int, cell: str = "quad8", **contact: object) -> abut.Model:
    """A round punch, 0.384 wide and of radius 0.5, pressed on a plate by a pressure of 100, with ``adjust``."""
    punch = rectangle((-0.192, 0.192), (0, 0.4), (facets, 2), cell)
    x, y = punch.points.T
    punch = replace(punch, points=np.column_stack([x, y + x * x * (1.0 - y / 0.4)]))
    mesh = join({"punch": punch, "plate": rectangle((-0.5, 0.5), (-0.5, 0), (facets, facets), cell)})
    return abut.Model(
        mesh,
        [abut.Solid(body, abut.LinearElastic(210e3, 0.0)) for body in mesh.bodies],
        [abut.Support("plate.bottom", x=0, y=0), abut.Support("punch.left", x=0), abut.Support("punch.right", x=0)],
        [abut.Pressure("punch.top", 100.0)],
        [abut.Contact(contactor="punch.bottom", target="plate.top", **{"adjust": 0.005, **contact})],
        plane="strain",
    )


def approach(model: abut.Model) -> float:
    """How far the strip's punch comes down beyond its initial gap."""
    solution = abut.solve(model)
    return -float(solution.displacement[solution.model.mesh.nodes_of("punch.top"), 1].mean())


def sheets(*contacts: abut.Contact) -> abut.Model:
    """A sheet on a base, under a cover within reach. Pressure 1 on the sheet. Contacts: base and sheet where left out."""
    mesh = join(
        {
            "base": rectangle((0, 1), (0, 1), (4, 4), "quad4"),
            "sheet": rectangle((0, 1), (1, 1.05), (3, 1), "quad4"),
            "cover": rectangle((0, 1), (1.06, 1.5), (5, 2), "quad4"),
        }
    )
    return abut.Model(
        mesh,
        [abut.Solid(body, abut.LinearElastic(1000.0, 0.0)) for body in mesh.bodies],
        [abut.Support("base.bottom", x=0, y=0), abut.Support("cover.top", x=0, y=0), abut.Support("sheet.left", x=0)],
        [abut.Pressure("sheet.top", 1.0)],
        contacts=contacts or [abut.Contact(contactor="base.top", target="sheet.bottom")],
        plane="strain",
    )


def stack(unload: float | None = None, kind: str = "contact", **contact: object) -> abut.Model:
    """Two cubes that do not match under a pressure of 5; ``unload``: of which so much is left in a second step."""
    mesh = join(
        {"lower": box(z=(0, 1), cells=(3, 3, 2), cell="hex8"), "upper": box(z=(1, 2), cells=(2, 4, 2), cell="hex8")}
    )
    history = None if unload is None else abut.Amplitude(((0.0, 0.0), (0.5, 1.0), (1.0, unload)))
    sides = [abut.Support(f"{b}.{s}", normal=0) for b in mesh.bodies for s in ("left", "front")]
    return abut.Model(
        mesh,
        [abut.Solid(body, steel()) for body in mesh.bodies],
        [abut.Support("lower.bottom", z=0), *sides],
        [abut.Pressure("upper.top", 5.0, amplitude=history)],
        [abut.Contact(contactor="lower.top", target="upper.bottom", kind=kind, **contact)],
        solve=abut.SolveOptions(steps=1 if unload is None else 2),
    )


def heated(kind: str) -> abut.Model:
    """Two cubes, tied or side by side between walls, heated by 100: free (stress 0), or held along z."""
    mesh = join({"a": box(z=(0, 1), cells=(3, 3, 2)), "b": box(z=(1, 2), cells=(2, 2, 2))})
    hot = abut.LinearElastic(1000.0, 0.0, expansion=1e-5)
    walls = [abut.Support("a.bottom", z=0), abut.Support("b.top", z=0)]
    sides = [abut.Support(f"{b}.{s}", normal=0) for b in mesh.bodies for s in ("left", "front")]
    return abut.Model(
        mesh,
        [abut.Solid(body, hot, temperature=100.0) for body in mesh.bodies],
        [] if kind == "tied" else [*walls, *sides],
        contacts=[abut.Contact(contactor="a.top", target="b.bottom", kind=kind)],
    )


def tower(light: float) -> abut.Model:
    """Two stacks of blocks side by side, one under a pressure of 10, the other under ``light``: two pairs."""
    parts = {}
    for name, x in (("a", 0.0), ("b", 2.0)):
        parts[f"{name}1"] = rectangle((x, x + 1), (0, 1), (5, 4), "quad4")
        parts[f"{name}2"] = rectangle((x, x + 1), (1, 2), (4, 4), "quad4")
    mesh = join(parts)
    supports = [abut.Support(f"{b}1.bottom", y=0) for b in "ab"] + [abut.Support(f"{b}.left", x=0) for b in mesh.bodies]
    return abut.Model(
        mesh,
        [abut.Solid(body, SOFT) for body in mesh.bodies],
        supports,
        [abut.Pressure("a2.top", 10.0), abut.Pressure("b2.top", light)],
        [
            abut.Contact(contactor="a1.top", target="a2.bottom", name="a"),
            abut.Contact(contactor="b1.top", target="b2.bottom", name="b"),
        ],
        plane="strain",
    )


def light_fit(heavy: bool, around: tuple[int, int] = (26, 24)) -> abut.Model:
    """A fit of polygons with hardly any interference; ``heavy``: beside blocks whose pressure is the model's headline."""
    light = fit(around, "quad4", 2e-4)
    parts = {"foot": rectangle((40, 50), (-10, 0), (6, 6)), "block": rectangle((40, 50), (0, 10), (5, 5))}
    mesh = join({"fit": light.mesh, **parts})
    return abut.Model(
        mesh,
        [abut.Solid(body, steel()) for body in mesh.bodies],
        [replace(s, on=f"fit.{s.on}") for s in light.supports]
        + [abut.Support(f"{b}.left", x=0) for b in parts]
        + [abut.Support("foot.bottom", y=0)],
        [abut.Pressure("block.top", 2000.0 if heavy else 1e-3)],
        [
            abut.Contact(contactor="foot.top", target="block.bottom", name="blocks"),
            abut.Contact(contactor="fit.hub.inner", target="fit.shaft.outer", offset=-2e-4, name="fit"),
        ],
        plane="stress",
    )


def moved(down: float, gap: float = 0.01, unit: float = 1.0) -> abut.Model:
    """Blocks with a gap between them, the upper moved down; ``unit``: of the motion only, by mistake."""
    mesh = join({"lower": rectangle((0, 1), (0, 1), (3, 3)), "upper": rectangle((0, 1), (1 + gap, 2 + gap), (2, 2))})
    sides = [abut.Support(f"{b}.left", x=0) for b in mesh.bodies]
    return abut.Model(
        mesh,
        [abut.Solid(body, abut.LinearElastic(1000.0, 0.0)) for body in mesh.bodies],
        [abut.Support("lower.bottom", y=0), abut.Support("upper.top", y=-down * unit), *sides],
        contacts=[abut.Contact(contactor="lower.top", target="upper.bottom")],
        plane="strain",
    )


def held_load() -> abut.Model:
    """The load is put on the surface that the support holds."""
    built = squares(4, 3, down=0.0)
    supports = [abut.Support("lower.bottom", x=0, y=0), abut.Support("upper.top", x=0, y=0)]
    return replace(built, supports=supports, loads=[abut.Force("upper.top", (0.0, -1.0))])


def washer(swap: bool, cells: int = 8) -> abut.Model:
    """Axisymmetric: a bolt's head (radius 1 to 2) on a plate (0.6 to 6); ``swap``: the plate's whole face carries the
    pressure."""
    mesh = join(
        {
            "plate": rectangle((0.6, 6.6), (0, 2), (cells, 3), "quad4"),
            "head": rectangle((1.0, 2.0), (2, 3), (12, 8), "quad4"),
        }
    )
    sides = ("plate.top", "head.bottom") if swap else ("head.bottom", "plate.top")
    return abut.Model(
        mesh,
        [abut.Solid(body, steel()) for body in mesh.bodies],
        [abut.Support("plate.bottom", y=0)],
        [abut.Force("head.top", (0.0, -1000.0))],
        [abut.Contact(contactor=sides[0], target=sides[1])],
        plane="axisymmetric",
    )


def sleeve(swap: bool, cell: str = "quad4", cells: tuple[int, int] = (4, 30)) -> abut.Model:
    """Axisymmetric: a short hub (length 4) on a long shaft (20); ``swap``: the shaft, which hangs over,
    carries the pressure."""
    mesh = join(
        {
            "hub": rectangle((10, 20), (0, 4), (6, cells[0]), cell),
            "shaft": rectangle((5, 10), (-8, 12), (3, cells[1]), cell),
        }
    )
    sides = ("shaft.right", "hub.left") if swap else ("hub.left", "shaft.right")
    return abut.Model(
        mesh,
        [abut.Solid(body, steel()) for body in mesh.bodies],
        [abut.Support("shaft.bottom", y=0), abut.Support("hub.bottom", y=0)],
        contacts=[abut.Contact(contactor=sides[0], target=sides[1], offset=-0.02)],
        plane="axisymmetric",
    )


def two_blocks(pressure: str = "auto") -> abut.Model:
    """The example of the tour: P0 gives a checkerboard."""
    from pathlib import Path

    from abut.job import load_job

    model = load_job(Path(__file__).parents[2] / "examples" / "two-blocks" / "job.toml").model
    return replace(model, contacts=[replace(model.contacts[0], pressure=pressure)])


def bar(cells: int = 8) -> abut.Model:
    """A pin in the sleeve of a plate, 3D: a solid pin pulled up in a whole tube; contact on half of the turn."""
    mesh = join(
        {
            "pin": cylinder(9.99, (0, 2), (cells, 1), "hex8"),
            "sleeve": cylinder(20.0, (0, 2), (4, 4 * cells, 1), "hex8", inner=10.0),
        }
    )
    supports = [abut.Support(f"{b}.{s}", z=0) for b in mesh.bodies for s in ("bottom", "top")]
    return abut.Model(
        mesh,
        [abut.Solid(body, abut.LinearElastic(210e3, NU)) for body in mesh.bodies],
        [*supports, abut.Support("sleeve.round", x=0, y=0), abut.Support("pin.top", x=0)],
        [abut.Force("pin.top", (0.0, -2e4, 0.0))],
        [abut.Contact(contactor="pin.round", target="sleeve.inner")],
    )


def punch(cell: str, cells: tuple[int, int], stiff: float = 1e4) -> abut.Model:
    """A flat punch of half width 1 with sharp edges on a wide block, ``stiff`` times as stiff, as contactor. cells: of half
    of it, and about as many of the block over the same length, so that nodes do not meet."""
    n, m = cells
    lower = rectangle((-40, 40), (-40, 0), (2 * round(2.5 * m), m), cell, {"x": [-2.5, 2.5], "y": [-1, 0]})
    mesh = join({"punch": rectangle((-1, 1), (0, 2), (2 * n, 2 * n), cell), "block": lower})
    return abut.Model(
        mesh,
        [abut.Solid(body, abut.LinearElastic(e, NU)) for body, e in zip(mesh.bodies, (1000.0 * stiff, 1000.0))],
        [abut.Support("block.bottom", x=0, y=0), abut.Support("punch.top", x=0)],
        [abut.Pressure("punch.top", 1.0)],
        [abut.Contact(contactor="punch.bottom", target="block.top")],
        plane="strain",
    )


def pushed_along(model: abut.Model, on: str, by: float) -> abut.Model:
    """With the points of a support moved along x."""
    return replace(model, supports=[replace(s, x=by) if s.on == on else s for s in model.supports])


def nearly_incompressible(model: abut.Model) -> abut.Model:
    """With a Poisson's ratio of 0.49999 all over, and cells that were asked to be fully integrated."""
    solids = [
        replace(s, material=abut.LinearElastic(s.material.young, 0.49999), integration="full") for s in model.solids
    ]
    return replace(model, solids=solids)

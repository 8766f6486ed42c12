"""Gaps that open as a parabola from an edge at which both sides end: leaves in contact all the way up to a common clamp."""

from __future__ import annotations

from dataclasses import replace
from itertools import pairwise
from typing import Any

import numpy as np
import pytest

import abut
from abut.mesh.make import box, join, rectangle
from models.beam_theory import bent_leaves

TWO, FIVE = (20.0, 10.0), (50.0, 40.0, 30.0, 20.0, 10.0)  # lengths of leaves of thickness 1
SHORT, WIDE, LOAD = 10.0, 2.0, 1.0  # load by width
STEEL = abut.LinearElastic(210e3, 0.0)
BENDING = 210e3 / 12.0


def leaves(
    cell: str, count: int, clamp: str, lengths: tuple[float, ...] = TWO, finer: tuple[int, int] = (1, 1), swap: bool = False,
    **contact: Any,
) -> abut.Model:  # fmt: skip
    """Leaves one below the other, ``count`` facets along the shortest one, clamped in the mean of their section, which may
    swell, or tied to a block; a force at the end of the longest. finer: cells that take the place of one along the first,
    third ... leaf and along the others; swap: whether the longer one of two is the contactor; contact: keywords."""
    solid = cell == "hex20"

    def part(x: tuple[float, float], z: tuple[float, float], along: int, high: int = 1) -> abut.Mesh:
        if solid:
            return box(x, (0.0, WIDE), z, (along, 2, high), cell)
        return rectangle(x, z, (along, high), cell)

    names = [f"leaf {k}" for k in range(len(lengths))]
    parts = {
        name: part((0.0, length), (-float(k), 1.0 - k), round(count * finer[k % 2] * length / SHORT))
        for k, (name, length) in enumerate(zip(names, lengths))
    }
    if clamp == "block":
        parts["block"] = part((-3.0, 0.0), (1.0 - len(lengths), 1.0), 6, 2 * len(lengths))
    mesh, up = join(parts), "z" if solid else "y"
    contacts = []
    for upper, lower in pairwise(names):
        sides = (f"{upper}.bottom", f"{lower}.top")
        contacts.append(abut.Contact(contactor=sides[not swap], target=sides[swap], name=f"on {lower}", **contact))
    if clamp == "block":
        supports = [abut.Support("block.left", **dict.fromkeys("xyz" if solid else "xy", 0.0))]
        contacts += [abut.Contact(f"{name}.left", "block.right", kind="tied") for name in names]
    else:
        x = mesh.points
        sets = {
            f"{name} middle": np.flatnonzero((x[:, 0] == 0.0) & (x[:, -1] == 0.5 - k)) for k, name in enumerate(names)
        }
        mesh = replace(mesh, node_sets={**mesh.node_sets, **sets})
        supports = [abut.Support(f"{name}.left", x=0.0) for name in names]
        supports += [abut.Support(name, **{up: 0.0}, **({"y": 0.0} if solid else {})) for name in sets]
    pull = (0.0, 0.0, -LOAD) if solid else (0.0, -LOAD)
    solids, loads = [abut.Solid(name, STEEL) for name in mesh.bodies], [abut.Traction(f"{names[0]}.right", pull)]
    return abut.Model(mesh, solids, supports, loads, contacts, plane=None if solid else "stress")


def between(solution: abut.Solution) -> list[float]:
    """Forces across, by width, between the leaves."""
    wide = WIDE if solution.model.dim == 3 else 1.0
    return [abs(float(each.force[-1])) / wide for each in solution.contacts if each.name.startswith("on ")]


def at_clamp(solution: abut.Solution) -> float:
    """Largest pressure on the half of the shortest leaf at the clamp."""
    seen = [each for each in solution.contacts if each.name.startswith("on ")]
    x = solution.model.mesh.points
    return max(float(np.abs(each.nodal_pressure[x[each.nodes, 0] < 0.5 * SHORT]).max()) for each in seen)


def at_ends(solution: abut.Solution) -> list[float]:
    """Forces across, by width, on the outer halves of the leaves below the first one."""
    wide = WIDE if solution.model.dim == 3 else 1.0
    result = []
    for each in solution.contacts:
        x = solution.model.mesh.points[each.contactor.node_ids, 0]
        last = min(x.max(), solution.model.mesh.points[each.target.node_ids, 0].max())
        result.append(abs(float(each.contactor_forces[x > 0.5 * last, -1].sum())) / wide)
    return result


def moved(solution: abut.Solution | abut.Step, mesh: abut.Mesh) -> float:
    """Way of the end of the longest leaf."""
    end = mesh.points[:, 0] == mesh.points[:, 0].max()
    return -float(solution.displacement.reshape(mesh.points.shape)[end, -1].mean())


@pytest.mark.parametrize("clamp", ["section", "block"])
@pytest.mark.parametrize(("cell", "count"), [("quad8", 5), ("quad8", 10), ("tri6", 10), ("hex20", 5)])
def test_no_force_where_leaves_part(cell: str, count: int, clamp: str) -> None:
    """Between them acts the force of beam theory, at the end of the shorter one, which bends more: none at the clamp, from
    where the gap opens as a parabola. 1 %; a block that gives way takes 4 % off."""
    solution = abut.solve(leaves(cell, count, clamp))
    exact = bent_leaves(list(TWO), BENDING, LOAD).forces
    assert between(solution) == pytest.approx(exact, rel=0.01 if clamp == "section" else 0.05)
    assert at_clamp(solution) == 0.0


@pytest.mark.parametrize("swap", [False, True])
@pytest.mark.parametrize("given", [{"pressure": "dual"}, {"friction": 0.1}, {"friction": 0.3}], ids=str)
@pytest.mark.parametrize(
    ("cell", "finer"), [("quad8", (1, 1)), ("hex20", (1, 1)), ("quad8", (1, 3)), ("quad8", (3, 1))]
)
def test_neither_with_friction_nor_where_all_functions_are_dual(
    cell: str, finer: tuple[int, int], given: dict[str, Any], swap: bool
) -> None:
    """The same, whichever side is the contactor and with cells a third as long on either. Leaves of one thickness are bent
    back alike by their friction, which the force does not feel, but how far the end moves: 1 %, of which shear takes .6."""
    model = leaves(cell, 5, "section", finer=finer, swap=swap, **given)
    solution = abut.solve(model)
    exact = bent_leaves(list(TWO), BENDING, LOAD, given.get("friction", 0.0), 1.0)
    assert between(solution) == pytest.approx(exact.forces, rel=0.01)
    assert at_clamp(solution) == 0.0
    assert moved(solution, model.mesh) == pytest.approx(exact.moved, rel=0.01)


@pytest.mark.parametrize("swap", [False, True])
def test_friction_turns_when_leaves_go_back(swap: bool) -> None:
    """Loaded, and half of it taken away: friction then acts the other way round, which 3.5 % of the end's way tell."""
    model = leaves("quad8", 5, "section", swap=swap, friction=0.3)
    way = abut.Amplitude([(0.0, 0.0), (0.5, 1.0), (1.0, 0.5)])
    model = replace(
        model, loads=[replace(each, amplitude=way) for each in model.loads], solve=abut.SolveOptions(steps=4)
    )
    for step, load, mu in zip(abut.solve(model).steps, (0.5, 1.0, 0.75, 0.5), (0.3, 0.3, -0.3, -0.3)):
        exact = bent_leaves(list(TWO), BENDING, load * LOAD, mu, 1.0)
        assert abs(step.contacts[0].force[1]) == pytest.approx(exact.forces[0], rel=0.01)
        assert moved(step, model.mesh) == pytest.approx(exact.moved, rel=0.01)


@pytest.mark.parametrize("given", [{}, {"friction": 0.3}], ids=str)
@pytest.mark.parametrize("pressure", ["auto", "dual", "dual-P1"])
@pytest.mark.parametrize("swap", [False, True])
def test_at_large_sliding(pressure: str, given: dict[str, Any], swap: bool) -> None:
    """The same, small as the motion is. What the end of the shorter leaf presses may stand up to half a facet from it: there
    it is the larger force of a leaf so much shorter. Dual functions put it at the end where that leaf has them: 1 %."""
    model = replace(leaves("quad8", 5, "section", swap=swap, pressure=pressure, **given), kinematics="finite")
    solution = abut.solve(model)
    force = between(solution)[0]
    exact, shorter = (
        bent_leaves([TWO[0], end], BENDING, LOAD, given.get("friction", 0.0), 1.0).forces[0]
        for end in (SHORT, SHORT - 0.5 * SHORT / 5)
    )
    assert 0.99 * exact < force < (1.01 * exact if pressure != "auto" and not swap else shorter)
    assert at_clamp(solution) == 0.0


@pytest.mark.parametrize("pressure", ["dual", "dual-P1"])
def test_a_plane_of_symmetry_at_large_sliding(pressure: str) -> None:
    """A half of a crowned block that touches at its plane of symmetry alone, held there as the sections of leaves are: half
    the force of the whole, whose function in the middle is at no edge."""

    def force(left: int) -> float:
        low = rectangle((2.0 * left, 2.0), (-2.0, 0.0), (2 * (1 - left), 2), "quad8")
        high = rectangle((2.0 * left, 2.0), (0.0, 2.0), (2 * (1 - left), 2), "quad8")
        x = high.points.copy()
        x[:, 1] += (1.0 - 0.5 * x[:, 1]) * x[:, 0] ** 2 / 20.0
        mesh = join({"low": low, "high": replace(high, points=x)})
        held = [] if left else [abut.Support(f"{name}.left", x=0.0) for name in mesh.bodies]
        supports = [abut.Support("low.bottom", x=0.0, y=0.0), abut.Support("high.top", x=0.0, y=-0.002)]
        model = abut.Model(
            mesh, [abut.Solid(name, abut.LinearElastic(1000.0, 0.3)) for name in mesh.bodies], [*supports, *held],
            contacts=[abut.Contact(contactor="high.bottom", target="low.top", pressure=pressure)], plane="strain",
            kinematics="finite",
        )  # fmt: skip
        contact = abut.solve(model).contacts[0]
        assert contact.active == 1
        return float(contact.force[1])

    assert force(0) == pytest.approx(0.5 * force(-1), rel=1e-6)


@pytest.mark.parametrize("given", [{}, {"pressure": "dual"}, {"friction": 0.1}, {"friction": 0.3}], ids=str)
def test_five_leaves(given: dict[str, Any]) -> None:
    """At their ends the forces of beam theory (1 %). Four of them bend so much alike that shear, which beam theory leaves
    out, presses them on each other within two thicknesses of the clamp, a little."""
    solution = abut.solve(leaves("quad8", 5, "section", FIVE, **given))
    exact = bent_leaves(list(FIVE), BENDING, LOAD, given.get("friction", 0.0), 1.0).forces
    assert at_ends(solution) == pytest.approx(exact, rel=0.01)
    assert at_clamp(solution) < 0.05 * LOAD


def glued(cell: str, kinematics: str = "small", swap: bool = False, **given: Any) -> abut.Model:
    """Two leaves glued together behind x = 0, where the gap opens as a parabola, on a target that goes on there; swap:
    whether the longer one is the contactor."""
    mesh = join(
        {
            name: rectangle((-5.0, end), (y, y + 1.0), (round(end + 5.0), 1), cell)
            for name, end, y in (("long", TWO[0], 0.0), ("short", SHORT, -1.0))
        }
    )
    surfaces, parts = dict(mesh.surfaces), ("long.bottom", "short.top")
    for name in parts:
        surface = mesh.surface(name)
        free = surface.points[surface.nodes[:, :2], 0].mean(axis=1) > 0.0
        surfaces |= {f"{name} free": surfaces[name][free], f"{name} glued": surfaces[name][~free]}
    contactor, target = (f"{parts[0]} free", parts[1]) if swap else (f"{parts[1]} free", parts[0])
    return abut.Model(
        replace(mesh, surfaces=surfaces), [abut.Solid(name, STEEL) for name in mesh.bodies],
        [abut.Support(f"{name}.left", x=0.0, y=0.0) for name in mesh.bodies], [abut.Traction("long.right", (0.0, -LOAD))],
        [abut.Contact(contactor=contactor, target=target, name="on short", **given),
         abut.Contact("short.top glued", "long.bottom glued", kind="tied")],
        plane="stress", kinematics=kinematics,
    )  # fmt: skip


@pytest.mark.parametrize("given", [{}, {"friction": 0.3}], ids=str)
@pytest.mark.parametrize("cell", ["quad8", "tri6"])
def test_beside_glue(cell: str, given: dict[str, Any]) -> None:
    """The force of beam theory, 5 % for how the glued part gives way."""
    solution = abut.solve(glued(cell, **given))
    assert between(solution) == pytest.approx(bent_leaves(list(TWO), BENDING, LOAD).forces, rel=0.05)
    assert at_clamp(solution) == 0.0


@pytest.mark.parametrize("given", [{}, {"friction": 0.3}], ids=str)
@pytest.mark.parametrize("pressure", ["dual", "dual-P1"])
@pytest.mark.parametrize("swap", [False, True])
@pytest.mark.parametrize("cell", ["quad8", "tri6"])
def test_beside_glue_at_large_sliding(cell: str, swap: bool, pressure: str, given: dict[str, Any]) -> None:
    """The same. The end of the shorter leaf as target presses within the longer one's function there, on average nearer to
    the clamp by up to half a facet, .5, which takes 9 % more."""
    solution = abut.solve(glued(cell, "finite", swap, pressure=pressure, **given))
    exact, shorter = (
        bent_leaves([TWO[0], end], BENDING, LOAD, given.get("friction", 0.0), 1.0).forces[0]
        for end in (SHORT, SHORT - 0.5)
    )
    assert 0.95 * exact < between(solution)[0] < (shorter if swap else 1.01 * exact)
    assert at_clamp(solution) == 0.0


@pytest.mark.parametrize(("wide", "narrow"), [(2.0, 1.0), (4.0, 2.0)])
@pytest.mark.parametrize("swap", [False, True])
def test_leaves_of_different_width(wide: float, narrow: float, swap: bool) -> None:
    """A narrow leaf under a wide one, which goes on beside it; both bend by as much at its end, 1 %."""
    model = leaves("hex20", 5, "section")
    mesh = join(
        {
            name: box((0.0, end), (-0.5 * w, 0.5 * w), (z, z + 1.0), (round(0.5 * end), round(w), 1), "hex20")
            for name, end, w, z in (("leaf 0", TWO[0], wide, 0.0), ("leaf 1", SHORT, narrow, -1.0))
        }
    )
    x = mesh.points
    sets = {f"leaf {k} middle": np.flatnonzero((x[:, 0] == 0.0) & (x[:, 2] == 0.5 - k)) for k in (0, 1)}
    sides = ("leaf 0.bottom", "leaf 1.top")
    contact = replace(model.contacts[0], contactor=sides[not swap], target=sides[swap])
    mesh = replace(mesh, node_sets={**mesh.node_sets, **sets})
    solution = abut.solve(replace(model, mesh=mesh, contacts=[contact]))
    force = LOAD * wide * narrow / (wide + narrow) * (3.0 * TWO[0] - SHORT) / (2.0 * SHORT)
    assert WIDE * between(solution)[0] == pytest.approx(force, rel=0.01)
    assert at_clamp(solution) == 0.0


def test_contact_at_an_edge_alone() -> None:
    """Two blocks, flush, of which one turns and comes in by .006 at one end, which opens by .025 within a facet: in the
    mean it is open there, but the ends would lie in each other, so that dual functions stay."""
    mesh = join(
        {name: rectangle((0.0, 4.0), y, (8, 4), "quad8") for name, y in (("low", (-2.0, 0.0)), ("high", (0.0, 2.0)))}
    )

    def turned(x: np.ndarray) -> np.ndarray:
        return 0.05 * x[..., 0] - 0.006

    def force(pressure: str) -> float:
        model = abut.Model(
            mesh, [abut.Solid(name, abut.LinearElastic(1000.0, 0.3)) for name in mesh.bodies],
            [abut.Support("low.bottom", x=0.0, y=0.0), abut.Support("high.top", x=0.0, y=turned)],
            contacts=[abut.Contact("low.top", "high.bottom", pressure=pressure)], plane="strain",
        )  # fmt: skip
        contact = abut.solve(model).contacts[0]
        assert contact.active == 1
        return float(contact.force[1])

    assert force("auto") == pytest.approx(force("dual"), rel=1e-9)

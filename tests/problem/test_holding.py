"""Bodies with free rigid-body modes are named, before anything is solved: contact carries no tension."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

import abut
from abut.diagnosis import check
from abut.mesh import make
from abut.solution import Iteration
from models.search import beam

UNITS = {"mm": 1.0, "m": 1e-3, "um": 1e3}  # a millimetre in the unit; newtons stay
SPACES = ("strain", "axisymmetric", "3D")


def steel(unit: float) -> abut.LinearElastic:
    return abut.LinearElastic(210e3 / unit**2, 0.3)


def side_by_side(space: str, blocks: dict[str, tuple[float, float, float]], unit: float) -> abut.Mesh:
    """Blocks one over the other: half width, lower and upper end of each."""
    parts = {}
    for i, (name, (width, low, high)) in enumerate(blocks.items()):
        n, left = 3 + i, 0.0 if space == "axisymmetric" else -width
        if space == "3D":
            parts[name] = make.box(x=(left, width), y=(left, width), z=(low, high), cells=(n, n, 2), cell="hex8")
        else:
            parts[name] = make.rectangle(x=(left, width), y=(low, high), cells=(n, 2), cell="quad4")
    mesh = make.join(parts)
    return replace(mesh, points=unit * mesh.points)


def assembled(
    space: str, mesh: abut.Mesh, supports: list[abut.Support], loads: list[object], unit: float
) -> abut.Model:
    """Neighbours in the order of the bodies touch."""
    names = list(mesh.bodies)
    contacts = [abut.Contact(contactor=f"{a}.top", target=f"{b}.bottom") for a, b in zip(names[1:], names)]
    plane = {} if space == "3D" else {"plane": space}
    return abut.Model(mesh, [abut.Solid(b, steel(unit)) for b in names], supports, loads, contacts, **plane)


def across(space: str) -> dict[str, float]:
    """Directions other than that of the stack."""
    return {"3D": {"x": 0.0, "y": 0.0}, "strain": {"x": 0.0}, "axisymmetric": {}}[space]


def up(space: str) -> str:
    return "z" if space == "3D" else "y"


def fails_with(model: abut.Model, message: str) -> None:
    """`check` and the run say the same, with exit status 4."""
    report = check(model)
    assert report.status == 4
    assert any(message in finding.line for finding in report.findings if finding.severity == "error")
    with pytest.raises(abut.SingularModelError) as error:
        abut.solve(model)
    assert message in str(error.value)


@pytest.mark.long
@pytest.mark.parametrize("unit", UNITS)
@pytest.mark.parametrize("space", SPACES)
@pytest.mark.parametrize("gap", [0.0, 0.01])
def test_block_pushed_with_nothing_behind_it(space: str, unit: str, gap: float) -> None:
    """A punch that is moved pushes it ahead; with a floor, or a force that pushes back, the same model is sound."""
    size = UNITS[unit]
    loose = {"punch": (1.0, 0.0, 1.0), "block": (2.0, -1.0, -gap)}
    supports = [abut.Support("punch.top", **{up(space): -0.02 * size}, **across(space))]
    model = assembled(space, side_by_side(space, loose, size), supports, [], size)
    axis = "the axis -y" if space == "axisymmetric" else f"-{up(space)}"
    fails_with(model, f"body 'block' is free to translate along {axis}: contact can only push it that way")

    floored = side_by_side(space, {**loose, "floor": (3.0, -2.0, -1.0 - gap)}, size)
    floor = abut.Support("floor.bottom", **{up(space): 0.0}, **across(space))
    held = assembled(space, floored, [*supports, floor], [], size)
    assert check(held).status == 0
    assert abut.solve(held).converged

    back = np.zeros(2 if space != "3D" else 3)
    back[-1] = 0.1
    pressed = assembled(space, model.mesh, supports, [abut.Force("block.bottom", tuple(back))], size)
    assert check(pressed).status == 0
    assert abut.solve(pressed).converged


def test_pushed_at_large_displacements() -> None:
    """Functions of the block's side that have no punch opposite count for nothing."""
    mesh = side_by_side("strain", {"punch": (1.0, 0.0, 1.0), "block": (4.0, -1.0, 0.0)}, 1.0)
    supports = [abut.Support("punch.top", y=-0.02, x=0.0)]
    model = replace(assembled("strain", mesh, supports, [], 1.0), kinematics="finite")
    with np.errstate(all="raise"):
        fails_with(model, "body 'block' is free to translate along -y: contact can only push it that way")


@pytest.mark.parametrize("space", SPACES)
def test_blocks_one_behind_the_other(space: str) -> None:
    """Each of them can go, and both together; only what stands behind the last one helps."""
    mesh = side_by_side(space, {"punch": (1, 0, 1), "near": (2, -1, 0), "far": (2, -2, -1)}, 1.0)
    supports = [abut.Support("punch.top", **{up(space): -0.02}, **across(space))]
    fails_with(assembled(space, mesh, supports, [], 1.0), "contact can only push it that way")


def test_pushed_along_a_floor() -> None:
    """Weight holds a block on its floor, but not against a punch from the side; a wall does."""
    parts = {
        "block": make.rectangle(x=(0, 2), y=(0, 1), cells=(4, 2), cell="quad4"),
        "punch": make.rectangle(x=(-1, 0), y=(0.2, 0.8), cells=(2, 3), cell="quad4"),
        "floor": make.rectangle(x=(-2, 6), y=(-1, 0), cells=(16, 2), cell="quad4"),
    }
    wall = {"wall": make.rectangle(x=(2, 3), y=(0.1, 0.9), cells=(2, 3), cell="quad4")}

    def model(walled: bool) -> abut.Model:
        mesh = make.join({**parts, **(wall if walled else {})})
        supports = [abut.Support("floor.bottom", x=0, y=0), abut.Support("punch.left", x=0.01, y=0)]
        contacts = [
            abut.Contact(contactor="block.bottom", target="floor.top"),
            abut.Contact(contactor="punch.right", target="block.left"),
        ]
        if walled:
            supports.append(abut.Support("wall.right", x=0, y=0))
            contacts.append(abut.Contact(contactor="block.right", target="wall.left"))
        solids = [abut.Solid(body, steel(1.0)) for body in mesh.bodies]
        return abut.Model(mesh, solids, supports, [abut.Pressure("block.top", 1.0)], contacts, plane="strain")

    fails_with(model(False), "body 'block' is free to translate along x: contact can only push it that way")
    assert check(model(True)).status == 0
    assert abut.solve(model(True)).converged


@pytest.mark.parametrize("unit", UNITS)
def test_beam_pulled_off_at_its_tip(unit: str) -> None:
    """Above half its weight the force at one end turns it over the other."""
    scale = UNITS[unit]

    def scaled(lift: float) -> abut.Model:
        model = beam(40, "quad4", lift=lift)
        solids = [abut.Solid(s.body, abut.LinearElastic(s.material.young / scale, 0.3)) for s in model.solids]
        loads = [abut.Pressure("beam.top", 1.0 / scale), model.loads[1]]  # plane strain: forces per unit of thickness
        return replace(model, mesh=replace(model.mesh, points=scale * model.mesh.points), solids=solids, loads=loads)

    seen: list[object] = []
    model = scaled(10.01)
    with pytest.raises(abut.SingularModelError, match=r"body 'beam' is free to .*: the loads pull it off its contact"):
        abut.solve(model, seen.append)
    assert not [row for row in seen if isinstance(row, Iteration)]
    fails_with(model, "body 'beam' is free to")
    assert check(scaled(9.99)).status == 0
    assert abut.solve(scaled(9.99)).converged


def test_pulled_off_in_a_later_step() -> None:
    """The steps before it are solved."""
    mesh = side_by_side("strain", {"floor": (2.0, -1.0, 0.0), "block": (1.0, 0.0, 1.0)}, 1.0)
    supports = [abut.Support("floor.bottom", x=0, y=0), abut.Support("block.top", x=0)]
    lift = abut.Amplitude(((0.0, -1.0), (0.5, -0.1), (1.0, 1.0)))
    model = abut.Model(
        mesh,
        [abut.Solid(b, steel(1.0)) for b in mesh.bodies],
        supports,
        [abut.Force("block.top", (0.0, 1.0), amplitude=lift)],
        [abut.Contact(contactor="block.bottom", target="floor.top")],
        plane="strain",
        solve=abut.SolveOptions(steps=4),
    )
    done: list[int] = []
    with pytest.raises(
        abut.SingularModelError, match=r"body 'block' is free to translate along y: the loads pull it off .* in step 3"
    ):
        abut.solve(model, on_step=lambda so_far, _: done.append(len(so_far.steps)))
    assert done == [1, 2]
    fails_with(replace(model, solve=abut.SolveOptions(steps=1)), "body 'block' is free to translate along y")


@pytest.mark.long
@pytest.mark.parametrize("unit", UNITS)
@pytest.mark.parametrize("space", ["strain", "3D"])
@pytest.mark.parametrize("load", ["displacement", "force"])
def test_ball_between_plates_may_spin(space: str, unit: str, load: str) -> None:
    """Nothing resists its spin, and nothing drives it: neither plates that are moved nor a force on one of them. (Only a
    force that acts on the ball itself, sideways, pushes it out.)"""
    size = UNITS[unit]
    if space == "3D":
        ball = make.cylinder(1.0, (-0.5, 0.5), (6, 2), "hex8")  # a roller that lies across
        ball = replace(ball, points=ball.points[:, [0, 2, 1]] * [1, -1, 1])
        plates = {
            name: make.box(x=(-1, 1), y=(-1, 1), z=z, cells=(5, 5, 2), cell="hex8")
            for name, z in (("upper", (1.0, 1.5)), ("lower", (-1.5, -1.0)))
        }
    else:
        ball = make.disc(1.0, fine=0.3, cells=4, cell="quad8")
        plates = {
            name: make.rectangle(x=(-1, 1), y=y, cells=(9, 3), cell="quad8")
            for name, y in (("upper", (1.0, 1.5)), ("lower", (-1.5, -1.0)))
        }
    mesh = make.join({"ball": ball, **plates})
    mesh = replace(mesh, points=size * mesh.points)
    axis, others = up(space), across(space)
    supports = [abut.Support("lower.bottom", **{axis: 0.0}, **others)]
    loads = []
    if load == "displacement":
        supports.append(abut.Support("upper.top", **{axis: -0.1 * size}, **others))
    else:
        supports.append(abut.Support("upper.top", **others))
        loads.append(abut.Force("upper.top", (*(0.0 for _ in others), -1e3)))

    def model(extra: list[object]) -> abut.Model:
        contacts = [
            abut.Contact(contactor="upper.bottom", target="ball.round"),
            abut.Contact(contactor="lower.top", target="ball.round"),
        ]
        plane = {} if space == "3D" else {"plane": "strain"}
        solids = [abut.Solid(b, steel(size)) for b in mesh.bodies]
        return abut.Model(mesh, solids, supports, [*loads, *extra], contacts, **plane)

    report = check(model([]))
    assert report.status == 0
    assert not any("push it that way" in finding.line for finding in report.findings)
    assert abut.solve(model([])).converged
    sideways = abut.Force("ball.round", (1.0, *(0.0 for _ in others)))
    fails_with(model([sideways]), "body 'ball' is free to translate along x")


def test_about_to_tip_is_held() -> None:
    """A force right above the edge of a foot leaves one row to carry all: neutral, but contact is not left."""
    mesh = side_by_side("strain", {"block": (1.0, 0.0, 1.0), "floor": (3.0, -1.0, 0.0)}, 1.0)
    supports = [abut.Support("floor.bottom", x=0, y=0), abut.Support("block.top", x=0)]
    loads = [abut.Force("block.right", (0.0, -0.02))]
    assert check(assembled("strain", mesh, supports, loads, 1.0)).status == 0

"""A job cut in two at the end of a step gives what the whole gives: rigid bodies, couplings, equations, preloads,
connectors, large displacements. Newton's method leaves 1e-9 of the forces; both jobs go the same way, so that no more than
that differs."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import abut
from abut.benchmarks.preloads import sleeve
from abut.errors import InputError
from abut.mesh.make import box, join, rectangle
from models.cut_jobs import assert_alike, first_part, whole_and_cut
from models.mechanisms import flat, lever_and_block, solid

NEAR = 1e-8  # ten times what Newton's method leaves
KINDS = ("small", "small-strain", "finite")


def way(*points: tuple[float, float]) -> abut.Amplitude:
    return abut.Amplitude(points)


DOWN_ACROSS = {"y": way((0.0, 0.0), (0.25, 1.0), (1.0, 1.0)), "x": way((0.0, 0.0), (0.25, 0.0), (1.0, 1.0))}


def tool(kinematics: str, **rigid: Any) -> abut.Model:
    """A rigid tool pressed into a block, then drawn across it with friction."""
    block, above = rectangle((-2, 2), (-2, 0), (8, 3), "quad4"), rectangle((-1, 1), (0, 1), (4, 2), "quad4")
    law = abut.Hencky(1000.0, 0.3) if kinematics == "finite" else abut.LinearElastic(1000.0, 0.3)
    given = {"y": -0.05, "x": 0.1, "rz": 0.0, "amplitudes": DOWN_ACROSS, **rigid}
    return abut.Model(
        join({"block": block, "tool": above}),
        [abut.Solid("block", law)],
        [abut.Support("block.bottom", x=0, y=0)],
        contacts=[abut.Contact(contactor="block.top", target="tool.bottom", friction=0.2)],
        plane="strain",
        rigid=[abut.Rigid("tool", **given)],
        kinematics=kinematics,
        solve=abut.SolveOptions(times=(0.25, 0.5, 0.75, 1.0)),
    )


@pytest.mark.parametrize("kinematics", KINDS)
@pytest.mark.parametrize("turns", [0.0, None], ids=["upright", "free to turn"])
def test_rigid_bodies_with_friction(kinematics: str, turns: float | None, tmp_path: Path) -> None:
    """Cut while the tool slips: slip goes on from where it was."""
    whole, cut = whole_and_cut(tool(kinematics, rz=turns), 0.5, tmp_path)
    assert abs(whole.steps[-1].contacts[0].force[0]) > 1.0  # it drags
    assert_alike(whole, cut, NEAR)


def test_a_rigid_body_let_go_across(tmp_path: Path) -> None:
    """Held across in the first job only, where nothing pushed it: another number of unknowns in the second one."""
    model = replace(tool("small", x=None, amplitudes={"y": DOWN_ACROSS["y"]}), loads=[
        abut.Force("tool", (1.0, 0.0), way((0.0, 0.0), (0.5, 0.0), (1.0, 1.0)))
    ])  # fmt: skip
    first = first_part(replace(model, rigid=[replace(model.rigid[0], x=0.0)], loads=()), 0.5)
    whole, cut = whole_and_cut(model, 0.5, tmp_path, first)
    assert_alike(whole, cut, NEAR)


def test_a_rigid_body_elsewhere_is_told(tmp_path: Path) -> None:
    model = tool("finite")
    body = replace(model.rigid[0], y=-0.04)
    with pytest.raises(InputError, match=r"supports of this job put points up to 0\.01 .*'tool'"):
        whole_and_cut(replace(model, rigid=[body]), 0.5, tmp_path, first_part(model, 0.5))


@pytest.mark.parametrize("lock", [0.25, 0.5, 0.75, None])
@pytest.mark.parametrize("kinematics", ["small", "finite"])
def test_bolts(kinematics: str, lock: float | None, tmp_path: Path) -> None:
    """Tightened, locked before, at or after the cut (or never), and loaded."""
    model = sleeve(kinematics, cells=2)
    tight = way((0.0, 0.0), (0.25, 1.0), (1.0, 1.0))
    later = way((0.0, 0.0), (0.5, 0.0), (1.0, 1.0))
    model = replace(
        model,
        preloads=[replace(model.preloads[0], amplitude=tight, lock=lock)],
        loads=[abut.Pressure("sleeve.top", 5.0, later)],
        solve=abut.SolveOptions(times=(0.25, 0.5, 0.75, 1.0)),
    )
    whole, cut = whole_and_cut(model, 0.5, tmp_path)
    tension = [next(iter(step.preloads.values())).tension for step in whole.steps]
    assert (abs(tension[-1] / tension[0] - 1.0) > 1e-4) == (lock is not None)  # locked, it takes part of the load
    assert_alike(whole, cut, NEAR)


@pytest.mark.parametrize("turn", [0.6, 7.0])
def test_a_crank(turn: float, tmp_path: Path) -> None:
    """Slider and crank, cut on the way, beyond a whole turn too."""
    steps = tuple(np.linspace(0.0, 1.0, 13)[1:])
    joints = [
        abut.Connector("axle", "hinge", "crank", at=(0, 0), motion=turn),
        abut.Connector("pin", "hinge", "rod", "crank", at=(3, 0)),
        abut.Connector("eye", "slot", "rod", at=(13, 0), axis=(1, 0), load=-5.0),
    ]
    bars = {"crank": ((0, 0), (3, 0)), "rod": ((3, 0), (13, 0))}
    model = flat(bars, joints, kinematics="finite", solve=abut.SolveOptions(times=steps))
    whole, cut = whole_and_cut(model, steps[-2], tmp_path)
    assert_alike(whole, cut, 1e-7)  # conditions are met to 1e-9 of a bar's length


@pytest.mark.parametrize("kinematics", ["small", "finite"])
def test_joints_in_space(kinematics: str, tmp_path: Path) -> None:
    """A universal joint, its driven shaft against a torsion spring; and a slider that meets its limit after the cut."""
    axis = np.array([0.0, np.sin(0.3), np.cos(0.3)])
    across = tuple(np.cross(axis, [1, 0, 0]))
    joints = [
        abut.Connector("cross", "universal", "out", "in", at=(0, 0, 0), axis=(1, 0, 0), axis2=across),
        abut.Connector("bearing", "slot", "out", at=tuple(8.0 * axis), axis=tuple(axis)),
        abut.Connector("guide", "slider", "block2", at=(0, 0, 20), axis=(1, 0, 0), stiffness=10.0, limits=(-1.0, 0.3)),
    ]  # fmt: skip
    given = {"in": {"reference": (0, 0, 0), "x": 0, "y": 0, "z": 0, "rx": 0, "ry": 0, "rz": 0.6}}
    bars = {"in": ((0, 0, -8), (0, 0, 0)), "out": ((0, 0, 0), tuple(8.0 * axis)), "block2": ((0, 0, 20), (4, 0, 20))}
    loads = [abut.Force("block2", (4.0, 0.0, 0.0)), abut.Moment("out", tuple(2.0 * axis))]
    model = solid(bars, joints, given, loads=loads, kinematics=kinematics, solve=abut.SolveOptions(steps=4))
    whole, cut = whole_and_cut(model, 0.5, tmp_path)
    assert whole.steps[1].connectors["guide"].motion["travel"] == pytest.approx(0.2, rel=1e-7)
    assert whole.steps[-1].connectors["guide"].motion["travel"] == pytest.approx(0.3, rel=1e-7)
    assert_alike(whole, cut, 1e-7)


def test_a_lever_on_contact(tmp_path: Path) -> None:
    """A hinge, contact and a free turn together."""
    for kinematics in ("small", "finite"):
        model = replace(lever_and_block(kinematics, -60.0), solve=abut.SolveOptions(steps=4))
        whole, cut = whole_and_cut(model, 0.5, tmp_path / kinematics)
        assert_alike(whole, cut, NEAR)


@pytest.mark.parametrize("kinematics", ["small", "finite"])
@pytest.mark.parametrize("kind", ["kinematic", "distributing"])
def test_couplings_and_equations(kind: str, kinematics: str, tmp_path: Path) -> None:
    """A bar bent by a coupling at its end, whose middle points move alike."""
    mesh = join({"bar": box((0, 4), (0, 1), (0, 1), (8, 2, 2), "hex8")})
    law = abut.Hencky(1000.0, 0.3) if kinematics == "finite" else abut.LinearElastic(1000.0, 0.3)
    alike = [int(np.linalg.norm(mesh.points - np.array(p), axis=1).argmin()) for p in ((2, 0, 1), (2, 1, 1))]
    equation = abut.Equation([abut.Term(alike[0], "z", 1.0), abut.Term(alike[1], "z", -1.0)])
    coupling = abut.Coupling("end", "bar.right", reference=(5.0, 0.5, 0.5), kind=kind)
    twisted = way((0.0, 0.0), (0.5, 0.0), (1.0, 1.0))
    model = abut.Model(
        mesh, [abut.Solid("bar", law)], [abut.Support("bar.left", x=0, y=0, z=0)], couplings=[coupling],
        equations=[equation], loads=[abut.Force("end", (0, 0, -2.0)), abut.Moment("end", (3.0, 0, 0), twisted)],
        kinematics=kinematics, solve=abut.SolveOptions(steps=4),
    )  # fmt: skip
    whole, cut = whole_and_cut(model, 0.5, tmp_path)
    assert_alike(whole, cut, NEAR)


def test_turned_surfaces(tmp_path: Path) -> None:
    """The end of a bar turned far about an axis, further in the second job."""
    mesh = join({"bar": box((0, 4), (0, 1), (0, 1), (6, 2, 2), "hex8")})
    model = abut.Model(
        mesh, [abut.Solid("bar", abut.Hencky(1000.0, 0.3))], [abut.Support("bar.left", x=0, y=0, z=0)],
        rotations=[abut.Rotation("bar.right", 1.0, (4.0, 0.5, 0.5), axis=(1.0, 0.0, 0.0))],
        kinematics="finite", solve=abut.SolveOptions(steps=4),
    )  # fmt: skip
    whole, cut = whole_and_cut(model, 0.5, tmp_path)
    assert_alike(whole, cut, NEAR)
    turned = replace(model, rotations=[replace(model.rotations[0], angle=1.2)])
    with pytest.raises(InputError, match="not in balance"):
        whole_and_cut(turned, 0.5, tmp_path / "other", first_part(model, 0.5))


def test_glue_of_the_first_job_lets_go_in_the_second(tmp_path: Path) -> None:
    """What the first job knows as a tie: its force is there when the second job takes it off."""
    mesh = join({"low": box((0, 1), (0, 1), (0, 1), (2, 2, 2)), "top": box((0, 1), (0, 1), (1, 2), (3, 3, 2))})
    pulled = way((0.0, 0.0), (0.5, 0.1), (1.0, 0.1))
    model = abut.Model(
        mesh, [abut.Solid(body, abut.LinearElastic(1000.0, 0.0)) for body in ("low", "top")],
        [abut.Support("low.bottom", x=0, y=0, z=0), abut.Support("top.top", x=0, y=0, z=1.0, amplitude=pulled)],
        contacts=[abut.Contact("top.bottom", "low.top", name="glue", kind="tied", until=0.5, released=1.0)],
        solve=abut.SolveOptions(times=(0.25, 0.5, 0.75, 1.0)),
    )  # fmt: skip
    whole, cut = whole_and_cut(model, 0.5, tmp_path)
    assert [-float(step.reactions["low.bottom"][2]) for step in cut.steps] == pytest.approx([25, 50, 25, 0], abs=1e-7)
    assert_alike(whole, cut, NEAR)
    early = replace(model, contacts=[replace(model.contacts[0], until=0.25)])
    with pytest.raises(InputError, match="not in balance"):
        whole_and_cut(early, 0.5, tmp_path / "other", first_part(model, 0.5))

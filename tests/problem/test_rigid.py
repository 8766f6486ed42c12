"""Rigid bodies: what moves them, what they press, what is refused."""

from __future__ import annotations

import csv
import json
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

import abut
from abut.errors import InputError, SingularModelError
from abut.job import load_job
from abut.job.convert import write_job
from abut.mesh.make import box, join, rectangle
from abut.mesh.mesh import Mesh
from abut.output.results import write
from abut.problem.constraints import supports
from models.constrained import EXACT, SOFT, at, equal
from models.rigid import pressed

DOWN = {"x": 0.0, "y": -0.01, "rz": 0.0}


def test_a_rigid_tool_is_one_with_all_points_moved() -> None:
    rigid = abut.solve(pressed(**DOWN)).steps[-1]
    other = pressed(young=1e3)
    points = other.mesh.nodes_of("tool")
    other = replace(other, mesh=replace(other.mesh, node_sets={"points": points}))
    other = replace(other, supports=[*other.supports, abut.Support("points", x=0, y=-0.01)])
    moved = abut.solve(other).steps[-1]
    largest = moved.contacts[0].max_pressure
    assert np.nanmax(np.abs(rigid.contacts[0].pressure - moved.contacts[0].pressure)) < EXACT * largest
    assert rigid.rigid["tool"].force == pytest.approx(moved.reactions["points"], rel=EXACT, abs=EXACT)
    assert rigid.rigid["tool"].force == pytest.approx(-rigid.reactions["block.bottom"], rel=EXACT, abs=1e-7)
    assert rigid.rigid["tool"].displacement == pytest.approx([0.0, -0.01], abs=1e-15)
    assert abs(rigid.rigid["tool"].moment[0]) < 1e-9 * abs(rigid.rigid["tool"].force[1])  # symmetry
    assert rigid.balance_error < 1e-11


def test_a_very_stiff_block_tends_to_a_rigid_one() -> None:
    rigid = abut.solve(pressed(**DOWN)).steps[-1]
    stiff = pressed(young=1e8)
    stiff = replace(stiff, supports=[*stiff.supports, abut.Support("tool.top", x=0, y=-0.01)])
    assert abut.solve(stiff).contacts[0].force == pytest.approx(rigid.contacts[0].force, rel=1e-4, abs=1e-6)


@pytest.mark.parametrize("condensed", [True, False])
def test_a_free_tool_finds_its_place(condensed: bool, monkeypatch: pytest.MonkeyPatch) -> None:
    """Pushed off its centre, free to sink and tilt: nothing holds it but contact. Moved to the same place it needs the same
    force and moment."""
    if not condensed:
        monkeypatch.setattr("abut.linear.static_condensation.LARGEST", 0)
    reference = (0.3, 1.0)
    model = pressed(x=0.0, reference=reference)
    handle = at(model.mesh, "tool", 0.2, 1.0)
    arm = model.mesh.points[handle, 0] - reference[0]
    model = replace(model, mesh=replace(model.mesh, node_sets={"handle": np.array([handle])}))
    pushed = replace(model, loads=[abut.NodalForce("handle", (0.0, -7.0))])
    free = abut.solve(pushed).steps[-1]
    tool = free.rigid["tool"]
    assert free.contacts[0].force == pytest.approx([0.0, -7.0], abs=1e-8)
    assert np.abs(tool.force).max() < 1e-8
    assert abs(tool.moment[0]) < 1e-8
    assert tool.rotation[0] < 0.0 < -tool.displacement[1]
    again = replace(model, rigid=[abut.Rigid("tool", reference, 0.0, tool.displacement[1], rz=tool.rotation[0])])
    moved = abut.solve(again).steps[-1]
    assert moved.rigid["tool"].force == pytest.approx([0.0, -7.0], abs=1e-7)
    assert moved.rigid["tool"].moment == pytest.approx([-7.0 * arm], rel=1e-7)
    assert np.abs(moved.displacement - free.displacement).max() < 1e-8 * np.abs(free.displacement).max()


def test_a_rigid_plate_in_space() -> None:
    """Flush with a block, nu = 0, sinking by d and turned about x: its force by Betti's theorem, and where its points go."""
    depth, turn, young = 2e-3, 1e-3, 1000.0
    block = box((0, 1), (0, 1), (-1, 0), (2, 3, 2), "hex20")
    tool = box((0, 1), (0, 1), (0, 0.5), (1, 1, 1), "hex20")
    mesh = join({"block": block, "tool": tool})
    model = abut.Model(
        mesh, [abut.Solid("block", abut.LinearElastic(young, 0.0))],
        [abut.Support("block.bottom", x=0, y=0, z=0)],
        contacts=[abut.Contact(contactor="block.top", target="tool.bottom")],
        rigid=[abut.Rigid("tool", (0.5, 0.5, 0.0), 0.0, 0.0, -depth, rx=turn, ry=0.0, rz=0.0)],
    )  # fmt: skip
    step = abut.solve(model).steps[-1]
    tool_result = step.rigid["tool"]
    turned = step.displacement[mesh.nodes_of("tool")]
    arm = mesh.points[mesh.nodes_of("tool")] - [0.5, 0.5, 0.0]
    expected = np.array([0.0, 0.0, -depth]) + np.cross(np.broadcast_to([turn, 0, 0], arm.shape), arm)
    assert np.abs(turned - expected).max() < 1e-15
    assert tool_result.rotation == pytest.approx([turn, 0.0, 0.0], abs=1e-14)
    # The mean displacement of the block's top is -d: with uniform compression as the other state the force is E d / H.
    assert tool_result.force == pytest.approx([0.0, 0.0, -young * depth], rel=1e-8, abs=1e-8)
    assert tool_result.moment[0] > 0.0
    assert tool_result.force == pytest.approx(-step.reactions["block.bottom"], rel=1e-8, abs=1e-8)


def test_a_rigid_tool_free_in_space() -> None:
    """A force off the centre, statically determinate: contact balances force and moment."""
    block = box((-2, 2), (-2, 2), (-2, 0), (6, 6, 3), "hex8")
    tool = box((-1, 1), (-1, 1), (0, 1), (2, 3, 1), "hex8")
    mesh = join({"block": block, "tool": tool})
    handle = at(mesh, "tool", 1.0, 1 / 3, 1.0)
    mesh = replace(mesh, node_sets={"handle": np.array([handle])})
    model = abut.Model(
        mesh, [abut.Solid("block", SOFT)], [abut.Support("block.bottom", x=0, y=0, z=0)],
        [abut.NodalForce("handle", (0.0, 0.0, -3.0)), abut.Force("tool.top", (0.0, 0.0, -6.0))],
        [abut.Contact(contactor="block.top", target="tool.bottom")],
        rigid=[abut.Rigid("tool", x=0, y=0, rz=0)],
    )  # fmt: skip
    step = abut.solve(model).steps[-1]
    tool_result = step.rigid["tool"]
    assert step.contacts[0].force == pytest.approx([0.0, 0.0, -9.0], abs=1e-8)
    assert np.abs(tool_result.force).max() < 1e-8
    assert np.abs(tool_result.moment).max() < 1e-8
    assert tool_result.rotation[0] < 0.0 < tool_result.rotation[1]  # down at +x, and at +y


def test_an_axisymmetric_rigid_punch() -> None:
    """Free along the axis, pushed by F: the pressure carries F; far from its edge Sneddon's p(0) = F / (2 pi a^2)."""
    block = rectangle((0, 4), (-4, 0), (48, 24), "quad8")
    punch = rectangle((0, 1), (0, 1), (2, 1), "quad4")
    mesh = join({"block": block, "punch": punch})
    model = abut.Model(
        mesh, [abut.Solid("block", SOFT)], [abut.Support("block.bottom", x=0, y=0)],
        [abut.Force("punch.top", (0.0, -5.0))], [abut.Contact(contactor="block.top", target="punch.bottom")],
        plane="axisymmetric", rigid=[abut.Rigid("punch")],
    )  # fmt: skip
    step = abut.solve(model).steps[-1]
    assert step.contacts[0].force[1] == pytest.approx(-5.0, rel=1e-9)
    assert abs(step.rigid["punch"].force[1]) < 1e-8
    contact = step.contacts[0]
    x = contact.contactor.points[np.maximum(contact.contactor.nodes, 0), 0]
    centre = contact.pressure[(x == 0.0) & (contact.contactor.nodes >= 0)]
    assert centre == pytest.approx(
        5.0 / (2 * np.pi), rel=0.05
    )  # twelve facets across the radius, a block of finite depth


def test_supports_on_a_rigid_body() -> None:
    """A support on its points says the same as components do, once for every point; one that differs is an error."""
    by_components = abut.solve(pressed(**DOWN)).steps[-1]
    model = pressed()
    by_support = replace(model, supports=[*model.supports, abut.Support("tool.top", x=0, y=-0.01)])
    step = abut.solve(by_support).steps[-1]
    assert np.abs(step.displacement - by_components.displacement).max() < EXACT * 0.01
    assert step.reactions["tool.top"] == pytest.approx(by_components.rigid["tool"].force, rel=EXACT, abs=1e-9)
    twice = pressed(**DOWN)
    with pytest.raises(SingularModelError, match=r"rigid body 'tool' and support on 'tool\.top' contradict"):
        abut.solve(replace(twice, supports=[*twice.supports, abut.Support("tool.top", y=-0.02)]))


def test_what_nothing_holds_is_named() -> None:
    with pytest.raises(SingularModelError, match="body 'tool' is free to translate along x"):
        abut.solve(replace(pressed(y=-0.01, rz=0.0), loads=[abut.Force("tool.top", (1.0, 0.0))]))


def test_a_tool_comes_and_goes() -> None:
    model = pressed(**DOWN, amplitude=abut.Amplitude(((0, 0), (0.5, 1), (1, 0))))
    steps = abut.solve(replace(model, solve=abut.SolveOptions(steps=4))).steps
    force = [step.rigid["tool"].force[1] for step in steps]
    assert force[1] < force[0] < 0.0
    assert force[2] == pytest.approx(force[0], rel=1e-9)
    assert abs(force[3]) < 1e-9 * abs(force[1])
    assert np.abs(steps[-1].displacement).max() < 1e-12 * 0.01


FIRST, THEN = ((0, 0), (0.5, 1), (1, 1)), ((0, 0), (0.5, 0), (1, 1))
TURNED = {"y": abut.Amplitude(FIRST), "rz": abut.Amplitude(THEN)}


@pytest.mark.parametrize("kinematics", ["small", "finite"])
def test_a_tool_comes_down_and_turns_then(kinematics: str) -> None:
    """Components with amplitudes of their own, beside one that follows the ramp."""
    model = pressed(x=0.004, y=-0.01, rz=0.002, reference=(0.0, 1.0), amplitudes=TURNED)
    steps = abut.solve(
        replace(model, kinematics=kinematics, solve=abut.SolveOptions(times=(0.25, 0.5, 0.75, 1.0)))
    ).steps
    moved = [[*step.rigid["tool"].displacement, *step.rigid["tool"].rotation] for step in steps]
    expected = [[0.001, -0.005, 0.0], [0.002, -0.01, 0.0], [0.003, -0.01, 0.001], [0.004, -0.01, 0.002]]
    assert np.allclose(moved, expected, rtol=0.0, atol=1e-9)


def glue(mesh: Mesh, body: str, surface: str) -> Mesh:
    """Points of a surface become those of a body at the same place."""
    twins = {n: at(mesh, body, *mesh.points[n]) for n in mesh.nodes_of(surface)}
    number = np.arange(len(mesh.points))
    number[list(twins)] = list(twins.values())
    kept, new = np.unique(number, return_inverse=True)
    blocks = tuple(replace(b, nodes=new[b.nodes].astype(np.int32)) for b in mesh.blocks)
    return replace(mesh, points=mesh.points[kept], blocks=blocks)


def test_a_body_glued_to_a_rigid_one() -> None:
    """Shared points follow the rigid body: a bar clamped in a rigid end that turns by theta is bent by M = E I theta / L,
    with stresses -E (y - h / 2) theta / L all along, also at the clamp."""
    bar_ = rectangle((0, 10), (0, 1), (20, 2), "quad8")
    end = rectangle((10, 11), (0, 1), (2, 2), "quad8")
    mesh = glue(join({"bar": bar_, "end": end}), "bar", "end.left")
    foot = at(mesh, "bar", 0.0, 0.5)
    mesh = replace(mesh, node_sets={"foot": np.array([foot])})
    model = abut.Model(
        mesh, [abut.Solid("bar", abut.LinearElastic(1000.0, 0.0))],
        [abut.Support("bar.left", x=0), abut.Support("foot", y=0)], plane="stress",
        rigid=[abut.Rigid("end", (10.0, 0.5), rz=0.01)],
    )  # fmt: skip
    step = abut.solve(model).steps[-1]
    tool, bar_nodes = step.rigid["end"], mesh.nodes_of("bar")
    stress = -1000.0 * (mesh.points[bar_nodes, 1] - 0.5) * 0.01 / 10
    assert np.abs(step.stress[bar_nodes, 0] - stress).max() < 1e-9
    assert tool.moment[0] == pytest.approx(1000.0 / 12 * 0.01 / 10, rel=1e-8)
    assert np.abs(tool.force).max() < 1e-9
    assert tool.displacement[1] == pytest.approx(0.01 * 10 / 2, rel=1e-8)


@pytest.mark.parametrize(
    ("condensed", "law"), [(True, "complementarity"), (False, "complementarity"), (True, "constraint-function")]
)
def test_a_rigid_back_on_a_free_pad(condensed: bool, law: str, monkeypatch: pytest.MonkeyPatch) -> None:
    """A pad glued to a rigid back, pressed on a block: both are free to sink, and contact alone holds them."""
    if not condensed:
        monkeypatch.setattr("abut.linear.static_condensation.LARGEST", 0)
    parts = {
        "block": rectangle((0, 1), (-1, 0), (4, 3), "quad8"),
        "pad": rectangle((0, 1), (0, 1), (3, 2), "quad8"),
        "back": rectangle((0, 1), (1, 2), (3, 7), "quad8"),
    }
    mesh = glue(join(parts), "pad", "back.bottom")
    model = abut.Model(
        mesh, [abut.Solid("block", abut.LinearElastic(1e3, 0.0)), abut.Solid("pad", abut.LinearElastic(1e3, 0.0))],
        [abut.Support("block.bottom", x=0, y=0)], [abut.Force("back.top", (0.0, -2.0))],
        [abut.Contact(contactor="block.top", target="pad.bottom", law=law)],
        plane="strain", rigid=[abut.Rigid("back", x=0.0)],
    )  # fmt: skip
    step = abut.solve(model).steps[-1]
    tolerance = EXACT if law == "complementarity" else 1e-6  # smoothed
    assert step.converged
    assert np.nanmax(np.abs(step.contacts[0].pressure / 2.0 - 1.0)) < tolerance
    assert step.rigid["back"].displacement[1] == pytest.approx(-2.0 * 2.0 / 1e3, rel=tolerance)


def test_amplitudes_of_what_is_not_given() -> None:
    with pytest.raises(InputError, match="rigid 'tool': amplitudes: 'rz' is none of the components that are given: y"):
        pressed(y=-0.01, amplitudes=TURNED)


@pytest.mark.parametrize(
    ("change", "message"),
    [
        ({"solids": [abut.Solid("block", SOFT), abut.Solid("tool", SOFT)]}, "is rigid and has a material"),
        ({"rigid": []}, "no material for body 'tool'"),
        ({"rigid": [abut.Rigid("tool"), abut.Rigid("tool")]}, "given twice"),
        ({"rigid": [abut.Rigid("tool", rx=0.1)]}, r"rigid\[0\].rx: the model is 2D"),
        ({"rigid": [abut.Rigid("tool", (0, 0, 0))]}, "expected 2 numbers"),
        ({"rigid": [abut.Rigid("toll")]}, "did you mean 'tool'"),
        ({"rigid": [abut.Rigid("tool"), abut.Rigid("block")], "solids": []}, "at least one must deform"),
        ({"loads": [abut.Gravity((0, -1), on="tool")]}, "has no density"),
        ({"loads": [abut.Temperature("tool", 1.0)]}, "does not expand"),
        ({"contacts": [abut.Contact(contactor="tool.bottom", target="block.top")]}, "swap contactor and target"),
        ({"contacts": [abut.Contact(contactor="tool.bottom", target="tool.top")]}, "both sides"),
        ({"equations": [abut.Equation((abut.Term(10**6, "x", 1.0),))]}, "no point 1000000"),
        ({"equations": [abut.Equation((abut.Term(0, "z", 1.0),))]}, "z does not exist"),
        ({"equations": [abut.Equation((abut.Term("none", "x", 1.0),))]}, "no node set named 'none'"),
    ],
)
def test_bad_models_are_refused(change: dict[str, object], message: str) -> None:
    with pytest.raises(InputError, match=message):
        replace(pressed(**DOWN), **change)


JOB = """
schema = 1
[mesh.bodies.block]
kind = "rectangle"
x = [-2, 2]
y = [-2, 0]
cells = [8, 4]
cell = "quad8"
[mesh.bodies.tool]
kind = "rectangle"
x = [-1, 1]
y = [0, 1]
cells = [2, 2]
cell = "quad4"
[model]
plane = "strain"
[materials.soft]
kind = "linear-elastic"
young = 1000
poisson = 0.3
[[solids]]
body = "block"
material = "soft"
[[supports]]
on = "block.bottom"
x = 0
y = 0
[[rigid]]
body = "tool"
reference = [0, 1]
x = 0
y = -0.01
rz = 0
amplitude = [[0, 0], [1, 0.5]]
[[equations]]
terms = [{ on = 0, component = "x", coefficient = 2.0 }, { on = 1, component = "x", coefficient = -1.0 }]
[[contacts]]
name = "touch"
contactor = "block.top"
target = "tool.bottom"
"""


def test_job_with_rigid_body_and_equation(tmp_path: Path) -> None:
    job = tmp_path / "job.toml"
    job.write_text(JOB)
    solution = abut.solve(load_job(job).model)
    tool = solution.steps[-1].rigid["tool"]
    assert tool.displacement == pytest.approx([0.0, -0.005], abs=1e-15)
    write(solution, tmp_path / "results")
    (written,) = json.loads((tmp_path / "results" / "summary.json").read_text())["steps"]
    assert written["rigid"]["tool"]["force"] == tool.force.tolist()
    with (tmp_path / "results" / "history.csv").open() as file:
        contact, body = csv.DictReader(file)
    assert contact["contact"] == "touch"
    assert contact["rigid"] == ""
    assert body["rigid"] == "tool"
    assert [float(body[f"force_{a}"]) for a in "xy"] == tool.force.tolist()
    assert float(body["moment_z"]) == tool.moment[0]
    job.write_text(JOB.replace('body = "tool"\nreference = [0, 1]', 'body = "tool"\nreference = [0, 1]\nrz_ = 1'))
    with pytest.raises(InputError, match=r"rigid\[0\].rz_: unknown key"):
        load_job(job)
    single = "amplitudes = { y = [[0, 0], [1, 0.25]] }\n[[equations]]"
    job.write_text(JOB.replace("[[equations]]", single))
    assert load_job(job).model.rigid[0].history("y") == abut.Amplitude(((0, 0), (1, 0.25)))
    assert load_job(job).model.rigid[0].history("rz") == abut.Amplitude(((0, 0), (1, 0.5)))
    again = write_job(tmp_path / "again.toml", load_job(job))[0]
    assert load_job(again).model.rigid == load_job(job).model.rigid
    job.write_text(JOB.replace("[[equations]]", single.replace("[0, 0]", "[0]")))
    with pytest.raises(InputError, match=r"rigid\[0\].amplitudes"):
        load_job(job)
    job.write_text(JOB.replace("[[equations]]", single.replace("[0, 0]", "[2, 0]")))
    with pytest.raises(InputError, match=r"rigid\[0\].amplitudes.y: "):
        load_job(job)
    job.write_text(JOB.replace('component = "x", coefficient = 2.0', 'component = "w", coefficient = 2.0'))
    with pytest.raises(InputError, match=r"equations\[0\].terms\[0\].component"):
        load_job(job)


def test_what_is_held_at_a_point() -> None:
    """1 along a direction that a point cannot move in, whoever holds it, 0 where it can."""
    model = pressed(**DOWN)
    far = [int(n) for n in model.mesh.nodes_of("block.top")[:4]]
    equations = [
        equal((far[0], "x"), (far[1], "x")),
        abut.Equation((abut.Term(far[2], "x", 0.5), abut.Term(far[2], "y", 0.5))),
        abut.Equation((abut.Term(far[3], "y", 3.0),), 0.1),
    ]
    held = supports(replace(model, equations=equations))
    tool, foot = int(model.mesh.nodes_of("tool")[0]), int(model.mesh.nodes_of("block.bottom")[0])
    root = np.sqrt(0.5)
    cases = [
        (far[0], (1, 0), 0.0), (far[2], (root, root), 1.0), (far[2], (root, -root), 0.0), (far[2], (1, 0), 0.5),
        (far[3], (0, 1), 1.0), (far[3], (1, 0), 0.0), (tool, (0, 1), 1.0), (foot, (1, 0), 1.0),
    ]  # fmt: skip
    points, directions, expected = (np.array(column) for column in zip(*cases))
    assert held.held_share(points, directions.astype(float)) == pytest.approx(expected, abs=1e-12)
    loose = supports(pressed(x=0.0))
    assert loose.held_share(np.array([tool]), np.array([[0.0, 1.0]])) == pytest.approx([0.0], abs=1e-12)

"""Equations and rigid bodies: exact changes of variables, held against supports that do the same and against statics."""

from __future__ import annotations

import csv
import json
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
import scipy.sparse as sp

import abut
from abut.discretization.elimination import eliminate
from abut.errors import InputError, SingularModelError
from abut.io.results import write
from abut.job import load_job
from abut.mesh.make import box, join, rectangle
from abut.mesh.mesh import Mesh

EXACT = 1e-9
SOFT = abut.LinearElastic(1000.0, 0.3)


def at(mesh: Mesh, body: str, *where: float) -> int:
    nodes = mesh.nodes_of(body)
    return int(nodes[np.abs(mesh.points[nodes] - where).sum(axis=1).argmin()])


def equal(a: tuple[int, str], b: tuple[int, str], value: float = 0.0) -> abut.Equation:
    """One displacement less another is ``value``."""
    return abut.Equation((abut.Term(a[0], a[1], 1.0), abut.Term(b[0], b[1], -1.0)), value)


@pytest.mark.parametrize("seed", range(5))
def test_elimination_spans_the_solutions(seed: int) -> None:
    """Against dense linear algebra: rows @ y = values for every z, and as many z as the rank leaves."""
    rng = np.random.default_rng(seed)
    rows = rng.standard_normal((12, 30)) * (rng.random((12, 30)) < 0.2)
    rows[8:] = rng.standard_normal((4, 8)) @ rows[:8]  # repeated
    y = rng.standard_normal((30, 2))
    done = eliminate(sp.csr_matrix(rows), rows @ y, [str(i) for i in range(12)])
    free, prescribed = done.free, done.prescribed
    size = np.abs(rows).max()
    assert np.abs(rows @ free.toarray()).max() < 1e-11 * size
    assert np.abs(rows @ prescribed - rows @ y).max() < 1e-11 * size
    assert np.linalg.matrix_rank(free.toarray()) == free.shape[1] == 30 - np.linalg.matrix_rank(rows)


def test_elimination_follows_chains_and_names_contradictions() -> None:
    links = sp.csr_matrix(np.eye(6, 7) - np.eye(6, 7, 1))
    done = eliminate(links, np.arange(6.0)[:, None], list("abcdef"))
    free, prescribed = done.free, done.prescribed
    assert free.shape == (7, 1)
    assert np.ptp(free.toarray()) == 0.0
    assert np.abs(links @ prescribed - np.arange(6.0)[:, None]).max() < 1e-14
    around = sp.vstack([links, sp.csr_matrix(np.eye(7)[:1] - np.eye(7)[2:3])])
    eliminate(around, np.append(np.arange(6.0), 1.0)[:, None], list("abcdefg"))  # 0 + 1 = 1: repeated
    with pytest.raises(SingularModelError, match=r"^a, b, g contradict"):
        eliminate(around, np.append(np.arange(6.0), 1.1)[:, None], list("abcdefg"))


def bar(cell: str = "quad8", **options: object) -> abut.Model:
    mesh = join({"bar": rectangle((0, 2), (0, 1), (5, 3), cell)})
    held = [abut.Support("bar.left", x=0), abut.Support("bar.bottom", y=0)]
    return abut.Model(mesh, [abut.Solid("bar", SOFT)], held, plane="strain", **options)


def test_an_end_moved_through_one_node() -> None:
    """All nodes of an end equal to one, which is moved: the same as moving the end, also its total force."""
    model = bar()
    end = [int(n) for n in model.mesh.nodes_of("bar.right")]
    sets = {"handle": np.array(end[:1])}
    moved = replace(
        model,
        mesh=replace(model.mesh, node_sets=sets),
        supports=[*model.supports],
        equations=[equal((n, "x"), (end[0], "x")) for n in end[1:]],
    )
    moved = replace(moved, supports=[*model.supports, abut.Support("handle", x=0.01)])
    whole = replace(model, supports=[*model.supports, abut.Support("bar.right", x=0.01)])
    ours, theirs = abut.solve(moved).steps[-1], abut.solve(whole).steps[-1]
    assert np.abs(ours.displacement - theirs.displacement).max() < EXACT * 0.01
    assert ours.reactions["bar.left"] == pytest.approx(theirs.reactions["bar.left"], rel=EXACT)
    assert ours.reactions["handle"][0] == pytest.approx(theirs.reactions["bar.right"][0], rel=EXACT)
    assert np.abs(ours.reaction).max() < EXACT * abs(ours.reactions["bar.left"][0])


def test_a_mean_displacement() -> None:
    """The mean of an end with the weights of a uniform traction: uniform strain, nu = 0."""
    model = replace(bar("quad4"), solids=[abut.Solid("bar", abut.LinearElastic(1000.0, 0.0))])
    end = model.mesh.nodes_of("bar.right")
    height = model.mesh.points[end, 1]
    weight = np.where((height == 0.0) | (height == 1.0), 1 / 6, 1 / 3)
    mean = abut.Equation(tuple(abut.Term(int(n), "x", w) for n, w in zip(end, weight)), 0.02)
    ramp_down = abut.Amplitude(((0.5, 1.0), (1.0, -1.0)))
    model = replace(model, equations=[replace(mean, amplitude=ramp_down)], solve=abut.SolveOptions(times=(0.5, 1.0)))
    for step, sign in zip(abut.solve(model).steps, (1.0, -1.0)):
        assert np.abs(step.displacement[:, 0] - sign * 0.01 * model.mesh.points[:, 0]).max() < EXACT * 0.02
        assert step.reactions["bar.left"][0] == pytest.approx(-sign * 10.0, rel=EXACT)


@pytest.mark.parametrize("cell", ["quad4", "tri6", "quad9"])
def test_periodic_faces_give_uniform_strain(cell: str) -> None:
    """u(right) - u(left) = F L and the like on top and bottom, corners repeated: strain and stress are uniform."""
    mesh = join({"body": rectangle((0, 1), (0, 1), (4, 4), cell)})
    slope = np.array([[1e-3, 4e-4], [4e-4, -2e-3]])
    rng = np.random.default_rng(0)
    inside = (np.abs(mesh.points - 0.5) < 0.49).all(axis=1)
    corner = np.isin(np.arange(len(mesh.points)), np.concatenate([b.nodes[:, :4].ravel() for b in mesh.blocks]))
    if cell == "quad4":  # keep quadratic edges straight
        mesh = replace(
            mesh, points=mesh.points + 0.05 * (inside & corner)[:, None] * rng.uniform(-1, 1, mesh.points.shape)
        )
    equations = []
    for axis in (0, 1):
        for far in np.flatnonzero(mesh.points[:, axis] == 1.0):
            near = at(mesh, "body", *np.where(np.arange(2) == axis, 0.0, mesh.points[far]))
            equations += [equal((int(far), "xy"[a]), (near, "xy"[a]), slope[a, axis]) for a in (0, 1)]
    mesh = replace(mesh, node_sets={"origin": np.array([at(mesh, "body", 0.0, 0.0)])})
    model = abut.Model(
        mesh, [abut.Solid("body", SOFT)], [abut.Support("origin", x=0, y=0)], plane="strain", equations=equations
    )
    step = abut.solve(model).steps[-1]
    assert np.abs(step.displacement - mesh.points @ slope.T).max() < EXACT * 1e-3
    mu, lam = 1000.0 / 2.6, 1000.0 * 0.3 / (1.3 * 0.4)
    stress = 2 * mu * slope + lam * np.trace(slope) * np.eye(2)
    assert np.abs(step.stress[:, [0, 1, 3]] - [stress[0, 0], stress[1, 1], stress[0, 1]]).max() < EXACT


def test_a_hinge_is_a_symmetry_plane() -> None:
    """Two mirrored cantilevers, hinged together at one point: by symmetry that point keeps its x, and no force crosses
    along y; a support at the point of one of them does the same."""
    left = rectangle((0, 1), (0, 0.5), (4, 2), "quad8")
    right = rectangle((1, 2), (0, 0.5), (4, 2), "quad8")
    mesh = join({"left": left, "right": right})
    a, b = at(mesh, "left", 1.0, 0.5), at(mesh, "right", 1.0, 0.5)
    model = abut.Model(
        mesh, [abut.Solid("left", SOFT), abut.Solid("right", SOFT)],
        [abut.Support("left.left", x=0, y=0), abut.Support("right.right", x=0, y=0)],
        [abut.Pressure("left.top", 1.0), abut.Pressure("right.top", 1.0)],
        plane="strain", equations=[equal((a, "x"), (b, "x")), equal((a, "y"), (b, "y"))],
    )  # fmt: skip
    alone = join({"left": left})
    alone = replace(alone, node_sets={"hinge": np.array([at(alone, "left", 1.0, 0.5)])})
    half = abut.Model(
        alone, [abut.Solid("left", SOFT)],
        [abut.Support("left.left", x=0, y=0), abut.Support("hinge", x=0)], [abut.Pressure("left.top", 1.0)], plane="strain",
    )  # fmt: skip
    ours, theirs = abut.solve(model).displacement, abut.solve(half).displacement
    assert np.abs(ours[mesh.nodes_of("left")] - theirs).max() < EXACT * np.abs(theirs).max()
    assert abs(ours[a, 1]) > 0.1 * np.abs(theirs).max()


@pytest.mark.parametrize("with_contact", [False, True])
def test_an_oblique_equation_is_an_oblique_support(with_contact: bool) -> None:
    """n . u = 0 at every node of a plane that is turned by 30 degrees, also under contact."""
    turn = np.array([[np.cos(np.pi / 6), -0.5], [0.5, np.cos(np.pi / 6)]])
    parts = {"lower": rectangle((0, 1), (0, 1), (3, 2), "quad8"), "upper": rectangle((0, 1), (1, 2), (4, 2), "quad8")}
    mesh = join(parts if with_contact else {"lower": parts["lower"]})
    mesh = replace(mesh, points=mesh.points @ turn.T)
    last = "upper" if with_contact else "lower"
    model = abut.Model(
        mesh, [abut.Solid(body, SOFT) for body in mesh.bodies],
        [abut.Support(f"{body}.left", normal=0) for body in mesh.bodies], [abut.Pressure(f"{last}.top", 5.0)],
        [abut.Contact("lower.top", "upper.bottom")] if with_contact else [], plane="strain",
    )  # fmt: skip
    normal = turn @ [0.0, -1.0]
    terms = [
        (abut.Term(int(n), "x", 2 * normal[0]), abut.Term(int(n), "y", 2 * normal[1]))
        for n in mesh.nodes_of("lower.bottom")
    ]
    ours = abut.solve(replace(model, equations=[abut.Equation(pair) for pair in terms])).steps[-1]
    theirs = abut.solve(replace(model, supports=[*model.supports, abut.Support("lower.bottom", normal=0)])).steps[-1]
    assert np.abs(ours.displacement - theirs.displacement).max() < EXACT * np.abs(theirs.displacement).max()
    assert ours.reaction == pytest.approx(theirs.reaction, rel=EXACT)
    if with_contact:
        assert np.nanmax(np.abs(ours.contacts[0].pressure / 5.0 - 1.0)) < 1e-9


def test_repeated_equations_do_no_harm_and_contradictions_are_named() -> None:
    model = bar(solve=abut.SolveOptions(linear="auto"))
    far = [int(n) for n in model.mesh.nodes_of("bar.right")]
    near = int(model.mesh.nodes_of("bar.left")[0])
    base = [equal((far[0], "x"), (far[1], "x")), equal((far[1], "x"), (far[2], "x"))]
    load = [abut.Traction("bar.right", (1.0, 0.0))]
    once = abut.solve(replace(model, equations=base, loads=load)).displacement
    twice = abut.solve(replace(model, equations=[*base, base[0], equal((far[2], "x"), (far[0], "x"))], loads=load))
    assert np.abs(once - twice.displacement).max() < EXACT * np.abs(once).max()
    with pytest.raises(SingularModelError, match=r"equations\[0\], equations\[1\], equations\[2\] contradict"):
        abut.solve(replace(model, equations=[*base, equal((far[2], "x"), (far[0], "x"), 0.1)]))
    with pytest.raises(SingularModelError, match=r"equations\[0\] contradicts what is prescribed at its points"):
        abut.solve(replace(model, equations=[abut.Equation((abut.Term(near, "x", 1.0),), 0.1)]))
    with pytest.raises(InputError, match='"amg" takes the unknowns point by point'):
        abut.solve(replace(model, equations=base, solve=abut.SolveOptions(linear="amg")))


def test_bodies_joined_by_equations_move_together() -> None:
    """A body that only equations tie to another is held; without one of them it can turn."""
    mesh = join({"a": rectangle((0, 1), (0, 1), (2, 2), "quad4"), "b": rectangle((1, 2), (0, 1), (2, 2), "quad4")})
    model = abut.Model(
        mesh, [abut.Solid("a", SOFT), abut.Solid("b", SOFT)], [abut.Support("a.left", x=0, y=0)],
        [abut.Traction("b.right", (0.0, 1.0))], plane="strain",
    )  # fmt: skip
    top = (at(mesh, "a", 1.0, 1.0), at(mesh, "b", 1.0, 1.0))
    low = (at(mesh, "a", 1.0, 0.0), at(mesh, "b", 1.0, 0.0))
    joint = [equal((p, c), (q, c)) for p, q in (top, low) for c in "xy"]
    assert abut.solve(replace(model, equations=joint)).converged
    with pytest.raises(SingularModelError, match="body 'b'"):
        abut.solve(replace(model, equations=joint[:2]))


def pressed(young: float | None = None, **rigid: object) -> abut.Model:
    """A flat tool on a wider block; rigid, or with a material."""
    block = rectangle((-2, 2), (-2, 0), (16, 6), "quad8")
    tool = rectangle((-1, 1), (0, 1), (5, 2), "quad4")
    mesh = join({"block": block, "tool": tool})
    solids = [abut.Solid("block", SOFT)]
    held = [abut.Support("block.bottom", x=0, y=0)]
    if young:
        solids.append(abut.Solid("tool", abut.LinearElastic(young, 0.0)))
    return abut.Model(
        mesh, solids, held, contacts=[abut.Contact("block.top", "tool.bottom")], plane="strain",
        rigid=() if young else [abut.Rigid("tool", **rigid)],
    )  # fmt: skip


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
        monkeypatch.setattr("abut.solvers.condensed.LARGEST", 0)
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
        contacts=[abut.Contact("block.top", "tool.bottom")],
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
        [abut.Contact("block.top", "tool.bottom")],
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
        [abut.Force("punch.top", (0.0, -5.0))], [abut.Contact("block.top", "punch.bottom")],
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
    with pytest.raises(SingularModelError, match=r"rigid body 'tool', support on 'tool\.top' contradict"):
        abut.solve(replace(twice, supports=[*twice.supports, abut.Support("tool.top", y=-0.02)]))


def test_what_nothing_holds_is_named() -> None:
    with pytest.raises(SingularModelError, match="body 'tool' can shift along x"):
        abut.solve(replace(pressed(y=-0.01, rz=0.0), loads=[abut.Force("tool.top", (1.0, 0.0))]))


def test_a_tool_comes_and_goes() -> None:
    model = pressed(**DOWN, amplitude=abut.Amplitude(((0, 0), (0.5, 1), (1, 0))))
    steps = abut.solve(replace(model, solve=abut.SolveOptions(steps=4))).steps
    force = [step.rigid["tool"].force[1] for step in steps]
    assert force[1] < force[0] < 0.0
    assert force[2] == pytest.approx(force[0], rel=1e-9)
    assert abs(force[3]) < 1e-9 * abs(force[1])
    assert np.abs(steps[-1].displacement).max() < 1e-12 * 0.01


def test_a_body_glued_to_a_rigid_one() -> None:
    """Shared points follow the rigid body: a bar clamped in a rigid end that turns by theta is bent by M = E I theta / L."""
    bar_ = rectangle((0, 10), (0, 1), (20, 2), "quad8")
    end = rectangle((10, 11), (0, 1), (2, 2), "quad8")
    both = join({"bar": bar_, "end": end})
    # glue: points of the end at x = 10 become those of the bar
    twins = {n: at(both, "bar", *both.points[n]) for n in both.nodes_of("end.left")}
    number = np.arange(len(both.points))
    number[list(twins)] = list(twins.values())
    kept, new = np.unique(number, return_inverse=True)
    mesh = replace(
        both, points=both.points[kept],
        blocks=tuple(replace(b, nodes=new[b.nodes].astype(np.int32)) for b in both.blocks),
    )  # fmt: skip
    foot = at(mesh, "bar", 0.0, 0.5)
    mesh = replace(mesh, node_sets={"foot": np.array([foot])})
    model = abut.Model(
        mesh, [abut.Solid("bar", abut.LinearElastic(1000.0, 0.0))],
        [abut.Support("bar.left", x=0), abut.Support("foot", y=0)], plane="stress",
        rigid=[abut.Rigid("end", (10.0, 0.5), rz=0.01)],
    )  # fmt: skip
    tool = abut.solve(model).steps[-1].rigid["end"]
    assert tool.moment[0] == pytest.approx(1000.0 / 12 * 0.01 / 10, rel=1e-8)
    assert np.abs(tool.force).max() < 1e-9
    assert tool.displacement[1] == pytest.approx(0.01 * 10 / 2, rel=1e-8)


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
        ({"contacts": [abut.Contact("tool.bottom", "block.top")]}, "swap contactor and target"),
        ({"contacts": [abut.Contact("tool.bottom", "tool.top")]}, "both sides"),
        ({"equations": [abut.Equation((abut.Term(10**6, "x", 1.0),))]}, "no point 1000000"),
        ({"equations": [abut.Equation((abut.Term(0, "z", 1.0),))]}, "z does not exist"),
        ({"equations": [abut.Equation((abut.Term("none", "x", 1.0),))]}, "no node set named 'none'"),
    ],
)
def test_bad_models_are_refused(change: dict[str, object], message: str) -> None:
    with pytest.raises(InputError, match=message):
        replace(pressed(**DOWN), **change)


def test_bad_equations_are_refused() -> None:
    with pytest.raises(InputError, match="no term"):
        abut.Equation(())
    with pytest.raises(InputError, match="expected one of x, y, z"):
        abut.Term(0, "w", 1.0)
    with pytest.raises(InputError, match="node set or a point"):
        abut.Term(0.5, "x", 1.0)  # type: ignore[arg-type]


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
    job.write_text(JOB.replace('component = "x", coefficient = 2.0', 'component = "w", coefficient = 2.0'))
    with pytest.raises(InputError, match=r"equations\[0\].terms\[0\].component"):
        load_job(job)

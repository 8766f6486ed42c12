"""Couplings: beams held, bent and twisted at a reference point, against closed forms, equations and rigid bodies."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

import abut
from abut.errors import InputError, SingularModelError
from abut.mesh.make import box, join, rectangle
from abut.problem.constraints import supports

YOUNG, LENGTH, HEIGHT, WIDTH = 210e3, 40.0, 4.0, 3.0
BENDING = YOUNG * WIDTH * HEIGHT**3 / 12.0
EXACT = 1e-9


def beam(coupling, loads=(), kinematics="small", steps=1, cell="hex20", cells=(8, 1, 1)):
    mesh = join(
        {"beam": box([0, LENGTH], [-HEIGHT / 2, HEIGHT / 2], [-WIDTH / 2, WIDTH / 2], cells=list(cells), cell=cell)}
    )
    return abut.Model(
        mesh,
        [abut.Solid("beam", abut.LinearElastic(YOUNG, 0.0))],
        [abut.Support("beam.left", x=0, y=0, z=0)],
        loads,
        couplings=[coupling],
        kinematics=kinematics,
        solve=abut.SolveOptions(steps=steps),
    )


def tip(kind="kinematic", reference=(LENGTH, 0.0, 0.0), **motion):
    return abut.Coupling("tip", "beam.right", kind, reference, **motion)


def end(model):
    step = abut.solve(model).steps[-1]
    assert step.converged
    return step, step.rigid["tip"]


@pytest.mark.parametrize("kind", ["kinematic", "distributing"])
def test_a_beam_bent_by_a_moment(kind):
    """Curvature M / (E I): quadratic cells hold it exactly, and the end stays plane."""
    moment = 1e-3 * BENDING / LENGTH
    _, result = end(beam(tip(kind), [abut.Moment("tip", (0, 0, moment))]))
    assert result.displacement == pytest.approx([0.0, 0.5e-3 * LENGTH, 0.0], rel=1e-7, abs=1e-8)
    if kind == "kinematic":
        assert result.rotation == pytest.approx([0.0, 0.0, 1e-3], rel=1e-7, abs=1e-9)
        _, turned = end(beam(tip(rz=1e-3)))
        assert turned.moment[2] == pytest.approx(moment, rel=1e-7)


def test_a_bar_twisted_by_a_moment():
    """The end turns by T L / (G J), J of a square with the sides a 0.1406 a^4 (Timoshenko and Goodier), but that held
    ends do not warp: so much stiffer, a few hundredths for a bar of ten widths."""
    side, torque = 2.0, 100.0
    mesh = join({"beam": box([0, 20.0], [-1, 1], [-1, 1], cells=[10, 4, 4], cell="hex20")})
    model = replace(
        beam(tip(reference=None), [abut.Moment("tip", (torque, 0, 0))]),
        mesh=mesh,
        supports=[abut.Support("beam.left", x=0, y=0, z=0)],
    )
    _, result = end(model)
    assert result.rotation[0] == pytest.approx(torque * 20.0 / (0.5 * YOUNG * 0.1406 * side**4), rel=0.04)


@pytest.mark.parametrize("kind", ["kinematic", "distributing"])
def test_a_force_beside_the_points_is_a_force_and_a_moment_at_them(kind):
    away = (LENGTH + 7.0, 2.0, -1.0)
    force = np.array([20.0, -30.0, 15.0])
    moment = np.cross(np.array(away) - (LENGTH, 0.0, 0.0), force)
    one, there = end(beam(tip(kind, away), [abut.Force("tip", force)]))
    two, here = end(beam(tip(kind), [abut.Force("tip", force), abut.Moment("tip", moment)]))
    largest = np.abs(two.displacement).max()
    assert np.abs(one.displacement - two.displacement).max() < EXACT * largest
    moved = here.displacement + np.cross(here.rotation, np.array(away) - (LENGTH, 0.0, 0.0))
    assert there.displacement == pytest.approx(moved, rel=1e-9, abs=EXACT * largest)
    assert one.load == pytest.approx(force, rel=1e-12)
    assert one.reaction == pytest.approx(-force, rel=1e-6)


def test_what_follows_is_rigid_and_what_shares_is_not():
    """Poisson's ratio and a force across: a kinematic end keeps its shape, a distributing one does not."""
    for kind, small in (("kinematic", True), ("distributing", False)):
        model = beam(tip(kind), [abut.Force("tip", (1e4, 1e3, 0))])
        step, result = end(replace(model, solids=[abut.Solid("beam", abut.LinearElastic(YOUNG, 0.3))]))
        nodes = model.mesh.nodes_of("beam.right")
        arms = model.mesh.points[nodes] - (LENGTH, 0.0, 0.0)
        rigid = result.displacement + np.cross(result.rotation, arms)
        assert (np.abs(step.displacement[nodes] - rigid).max() < EXACT * np.abs(rigid).max()) == small


@pytest.mark.parametrize("kind", ["kinematic", "distributing"])
def test_a_prescribed_motion_needs_the_force_that_gives_it(kind):
    """Work by reciprocity: the force that a motion needs, put on as a load, gives that motion."""
    motion = {"x": 0.01, "y": 0.2, "rx": 1e-3, "rz": -2e-3}
    moved, result = end(beam(tip(kind, (LENGTH + 5, 0, 0), **motion)))
    assert result.displacement[:2] == pytest.approx([0.01, 0.2], rel=1e-9)
    assert result.rotation[[0, 2]] == pytest.approx([1e-3, -2e-3], rel=1e-9)
    loads = [abut.Force("tip", result.force), abut.Moment("tip", result.moment)]
    loaded, _ = end(beam(tip(kind, (LENGTH + 5, 0, 0)), loads))
    assert np.abs(moved.displacement - loaded.displacement).max() < 1e-7 * np.abs(moved.displacement).max()


def test_points_that_follow_in_some_displacements():
    """Across only: the end slides along freely, as the equations say that make the points' y one with the reference's."""
    model = beam(
        tip(follow=("y", "z"), rx=0.0, ry=0.0, rz=0.0),
        [abut.Force("tip", (0, 100.0, 0)), abut.Pressure("beam.top", 5.0)],
    )
    step, result = end(model)
    nodes = model.mesh.nodes_of("beam.right")
    assert np.ptp(step.displacement[nodes, 1]) < EXACT * abs(result.displacement[1])
    assert np.ptp(step.displacement[nodes, 0]) > 0.1 * abs(result.displacement[1]) * HEIGHT / LENGTH
    first = int(nodes[0])
    equal = [
        abut.Equation((abut.Term(int(n), c, 1.0), abut.Term(first, c, -1.0)))
        for n in nodes[1:].tolist()
        for c in ("y", "z")
    ]
    sets = {"one": np.array([first])}
    loads = [abut.NodalForce("one", (0, 100.0, 0)), model.loads[1]]
    bound = replace(model, couplings=[], equations=equal, mesh=replace(model.mesh, node_sets=sets), loads=loads)
    other = abut.solve(bound).steps[-1]
    assert np.abs(step.displacement - other.displacement).max() < EXACT * np.abs(step.displacement).max()


@pytest.mark.long
@pytest.mark.parametrize("kind", ["kinematic", "distributing"])
@pytest.mark.parametrize("turns", [1.0, 4.0])
def test_a_moment_bends_a_beam_into_an_arc(kind, turns):
    """Pure bending: M = E I angle / L on a circle of radius L / angle. Beam theory leaves out (angle h / L)^2."""
    length, height, young, angle = 10.0, 0.1, 1.2e4, 2.0 * np.pi / turns
    mesh = join({"beam": rectangle((0, length), (-height / 2, height / 2), (40, 1), "quad8")})
    moment = angle * young * height**3 / 12.0 / length
    model = abut.Model(
        mesh,
        [abut.Solid("beam", abut.LinearElastic(young, 0.0))],
        [abut.Support("beam.left", x=0, y=0)],
        [abut.Moment("tip", moment)],
        plane="stress",
        kinematics="finite",
        couplings=[abut.Coupling("tip", "beam.right", kind, (length, 0.0))],
        solve=abut.SolveOptions(steps=round(8 / turns)),
    )
    solution = abut.solve(model)
    assert all(step.converged for step in solution.steps)
    radius = length / angle
    exact = np.array([radius * np.sin(angle) - length, radius * (1.0 - np.cos(angle))])
    assert solution.steps[-1].rigid["tip"].displacement == pytest.approx(exact, abs=5e-3 * length)
    if kind == "kinematic":  # whose turn is an unknown; that of positions is known up to whole turns
        assert solution.steps[-1].rigid["tip"].rotation[0] == pytest.approx(angle, rel=5e-3)
    largest = [min(i.residual for i in step.iterations[-3:-1]) for step in solution.steps]
    assert max(largest) < 1e-2  # the last iterations converge quadratically: an inexact tangent needs many more
    assert max(len(step.iterations) for step in solution.steps) < 20


@pytest.mark.parametrize("loads", [{"force": (0.0, -900.0, 600.0)}, {"moment": (6e3, 4e3, 8e3)}])
def test_kinematic_and_rigid_are_one(loads):
    """At large turns the coupled end moves as one that is glued to a rigid body, and loads act on either alike."""
    load = [abut.Force("tip", loads["force"])] if "force" in loads else [abut.Moment("tip", loads["moment"])]
    coupled = beam(tip(reference=(LENGTH + 2, 1.0, 0.0)), load, "finite", 2, cells=(8, 2, 2), cell="hex8")
    longer = join({"beam": box([0, LENGTH + 5], [-2, 2], [-1.5, 1.5], cells=[9, 2, 2], cell="hex8")})
    middle = longer.points[longer.blocks[0].nodes].mean(axis=1)[:, 0]
    bodies = {"beam": np.flatnonzero(middle < LENGTH), "tip": np.flatnonzero(middle > LENGTH)}
    glued = replace(
        coupled,
        mesh=replace(longer, bodies=bodies),
        couplings=[],
        rigid=[abut.Rigid("tip", (LENGTH + 2, 1.0, 0.0))],
    )
    one, two = (abut.solve(model).steps[-1] for model in (coupled, glued))
    assert one.converged
    assert two.converged
    assert np.linalg.norm(one.rigid["tip"].rotation) > 0.1
    assert one.rigid["tip"].displacement == pytest.approx(two.rigid["tip"].displacement, rel=1e-6, abs=1e-7)
    assert one.rigid["tip"].rotation == pytest.approx(two.rigid["tip"].rotation, rel=1e-6, abs=1e-9)


@pytest.mark.long
@pytest.mark.parametrize("kinematics", ["small", "finite"])
@pytest.mark.parametrize("kind", ["kinematic", "distributing"])
def test_a_flange_pressed_and_bent(kind, kinematics):
    """Columns on each other under a force N and a moment M that leaves all in contact: pressure N / A + M x / I, which
    quadratic cells and pressures hold exactly below a plane end; what shares is no plane end, and right in its resultant."""
    width, depth, force, moment = 4.0, 2.0, 100.0, 40.0
    x, y = [-width / 2, width / 2], [-depth / 2, depth / 2]
    mesh = join(
        {"low": box(x, y, [-3, 0], [3, 1, 2], cell="hex20"), "flange": box(x, y, [0, 3], [4, 2, 2], cell="hex20")}
    )
    steel = abut.LinearElastic(YOUNG, 0.0)
    motion = {"x": 0.0, "y": 0.0, "rx": 0.0, "rz": 0.0} if kind == "kinematic" else {}
    held = [] if kind == "kinematic" else [abut.Support("flange.top", x=0.0, y=0.0)]
    model = abut.Model(
        mesh,
        [abut.Solid("low", steel), abut.Solid("flange", steel)],
        [abut.Support("low.bottom", x=0, y=0, z=0), *held],
        [abut.Force("bolt", (0, 0, -force)), abut.Moment("bolt", (0, -moment, 0))],
        contacts=[abut.Contact(contactor="flange.bottom", target="low.top")],
        couplings=[abut.Coupling("bolt", "flange.top", kind, (0, 0, 9.0), **motion)],
        kinematics=kinematics,
    )
    (contact,) = abut.solve(model).steps[-1].contacts
    facets = mesh.surface("flange.bottom")
    there = facets.nodes >= 0
    exact = force / (width * depth) - moment * mesh.points[facets.nodes[there], 0] * 12.0 / (depth * width**3)
    off = np.abs(contact.pressure[there] - exact).max()
    assert contact.force[2] == pytest.approx(force, rel=1e-7)
    assert contact.resultant.moment[1] == pytest.approx(
        moment, rel=1e-6 if kinematics == "small" else 2e-3
    )  # N times its shift
    near = 1e-6 if kinematics == "small" else 1e-2
    assert off < (near if kind == "kinematic" else 0.5) * exact.max()


def test_weights_and_areas():
    """The mean of a surface is by area, that of a node set even, or by weights: the force on each point says which."""
    model = beam(tip("distributing"))
    nodes = model.mesh.nodes_of("beam.right")
    sets = {"end": nodes}
    model = replace(model, mesh=replace(model.mesh, node_sets=sets))
    assert tip("distributing").shares(model.mesh).min() < 0.0  # corners of 8-node faces
    even = abut.Coupling("tip", "end", "distributing")
    assert even.shares(model.mesh) == pytest.approx(np.full(8, 0.125))
    weights = tuple(range(1, 9))
    given = abut.Coupling("tip", "end", "distributing", weights=weights)
    assert given.shares(model.mesh) == pytest.approx(np.arange(1, 9) / 36.0)
    _, result = end(replace(model, couplings=[given], loads=[abut.Force("tip", (0, 1, 0))]))
    _, other = end(replace(model, couplings=[even], loads=[abut.Force("tip", (0, 1, 0))]))
    assert result.displacement != pytest.approx(other.displacement, rel=1e-4)


def test_points_on_a_line_leave_the_turn_about_it():
    """An edge follows; the turn about it moves nothing, is zero, and takes no moment."""
    model = beam(tip())
    edge = [n for n in model.mesh.nodes_of("beam.right") if model.mesh.points[n, 1] == HEIGHT / 2]
    model = replace(model, mesh=replace(model.mesh, node_sets={"edge": np.array(edge)}), couplings=[])
    edge_tip = abut.Coupling("tip", "edge")
    assert (
        np.abs(supports(replace(model, couplings=[edge_tip])).free).sum(axis=0).min() > 0.0
    )  # all unknowns move points
    _, result = end(
        replace(model, couplings=[edge_tip], loads=[abut.Force("tip", (0, 5.0, 0)), abut.Moment("tip", (0, 30.0, 0))])
    )
    assert result.displacement[1] > 0.0
    assert abs(result.rotation[2]) < 1e-12
    lost = replace(model, couplings=[edge_tip], loads=[abut.Moment("tip", (0, 0, 5.0))])
    with pytest.raises(
        InputError, match="coupling 'tip': they act on a motion of the reference that moves none of its points"
    ):
        abut.solve(lost)
    with pytest.raises(InputError, match="its points lie on one line, which leaves the turn about it open"):
        abut.solve(replace(lost, kinematics="finite", loads=[abut.Moment("tip", (0, 1.0, 0))]))


@pytest.mark.parametrize(
    ("change", "message"),
    [
        ({"on": "beam.end"}, r"couplings\[0\]\.on: no surface or node set named 'beam\.end'"),
        ({"name": "beam"}, r"couplings\[0\]\.name: 'beam' is a body of the mesh; give the coupling a name of its own"),
        ({"name": "beam.left"}, "'beam.left' is a surface of the mesh"),
        ({"reference": (1.0, 2.0)}, r"couplings\[0\]\.reference: expected 3 numbers, got 2"),
        ({"kind": "rigid"}, "coupling 'tip': kind: expected"),
        ({"follow": ()}, "coupling 'tip': follow: expected"),
        ({"follow": ("rx",)}, "coupling 'tip': follow: expected"),
        ({"kind": "distributing", "follow": ("x",)}, 'follow goes with kind = "kinematic"; take it out'),
        ({"weights": (1.0,)}, 'weights go with kind = "distributing"'),
        ({"kind": "distributing", "weights": (-1.0, 2.0)}, "are >= 0, not all of them 0"),
        (
            {"kind": "distributing", "weights": (1.0,)},
            r"couplings\[0\]\.weights: expected 8 numbers, one for each point, got 1",
        ),
        ({"amplitudes": {"x": abut.Amplitude(((0, 1),))}}, "coupling 'tip': amplitudes: 'x' is none of the components"),
        ({"x": float("nan")}, "coupling 'tip': x: expected a finite number"),
    ],
)
def test_what_is_no_coupling_is_refused(change, message):
    with pytest.raises(InputError, match=message):
        beam(replace_all(**change))


def replace_all(**change):
    given = {"name": "tip", "on": "beam.right", **change}
    return abut.Coupling(**given)


@pytest.mark.parametrize(
    ("coupling", "message"),
    [
        (
            tip(follow=("x",)),
            r"couplings\[0\]\.follow: points that follow in some displacements only need small turns; .*rz = 0",
        ),
        (tip("distributing", rz=0.1), "a mean motion can be prescribed with small turns only"),
        (tip("distributing", (LENGTH, 0.0, 1.0), y=0.1), "but for translations at the mean of the points"),
    ],
)
def test_what_only_small_displacements_allow(coupling, message):
    with pytest.raises(InputError, match=message):
        beam(coupling, kinematics="finite")


def test_what_large_displacements_allow_of_it():
    """Without turns, and at the mean, the equations are linear: the points are where they say."""
    for coupling in (tip(follow=("y",), y=8.0, rx=0.0, ry=0.0, rz=0.0), tip("distributing", y=8.0)):
        model = beam(coupling, kinematics="finite", steps=4)
        step, result = end(model)
        assert result.displacement[1] == pytest.approx(8.0, rel=1e-9)
        assert result.force[1] > 0.0
        moved = step.displacement[model.mesh.nodes_of("beam.right"), 1]
        assert coupling.shares(model.mesh) @ moved == pytest.approx(8.0, rel=1e-9)


def test_loads_that_nothing_carries_are_refused():
    model = beam(tip())
    for load, message in (
        (abut.Moment("beam", (0, 0, 1)), r"loads\[0\]\.on: no rigid body or coupling named 'beam'"),
        (abut.Force("tap", (0, 0, 1)), r"loads\[0\]\.on: no surface, rigid body or coupling named 'tap'"),
        (abut.Force("tip", (0, 1)), r"loads\[0\]\.value: expected 3 components, got 2"),
        (abut.Moment("tip", 1.0), r"loads\[0\]\.value: expected 3 components, got 1"),
    ):
        with pytest.raises(InputError, match=message):
            replace(model, loads=[load])
    with pytest.raises(InputError, match="moment on 'tip': value: expected 3 numbers, in the plane 1, got 2"):
        abut.Moment("tip", (1.0, 2.0))
    with pytest.raises(InputError, match="'tip' is used twice; give each coupling its own name"):
        replace(model, couplings=[tip(), tip()])
    with pytest.raises(InputError, match=r"point \d+ of 'beam.right' belongs to coupling 'tip' too"):
        replace(model, couplings=[tip(), replace_all(name="other")])
    with pytest.raises(InputError, match=r"supports\[0\]\.on: 'beam.bottom' has points of coupling 'tip'"):
        replace(beam(tip(), kinematics="finite"), supports=[abut.Support("beam.bottom", x=0)])


def test_contradictions_name_the_coupling():
    model = beam(tip(y=0.1))
    model = replace(model, supports=[*model.supports, abut.Support("beam.right", y=0.0)])
    with pytest.raises(SingularModelError, match="coupling 'tip'"):
        abut.solve(model)


def test_rings_move_along_their_axis_only():
    mesh = join({"ring": rectangle((1, 2), (0, 1), (2, 2), "quad4")})
    model = abut.Model(
        mesh,
        [abut.Solid("ring", abut.LinearElastic(1e3, 0.0))],
        [abut.Support("ring.bottom", y=0)],
        [abut.Force("cap", (0, 30.0))],
        plane="axisymmetric",
        couplings=[abut.Coupling("cap", "ring.top")],
    )
    step = abut.solve(model).steps[-1]
    assert step.rigid["cap"].displacement[1] == pytest.approx(30.0 / (1e3 * np.pi * 3.0), rel=0.05)  # ends stay round
    shared = abut.solve(replace(model, couplings=[abut.Coupling("cap", "ring.top", "distributing")])).steps[-1]
    assert shared.rigid["cap"].displacement[1] == pytest.approx(30.0 / (1e3 * np.pi * 3.0), rel=1e-9)
    large = abut.solve(replace(model, kinematics="finite")).steps[-1]
    assert large.rigid["cap"].displacement[1] == pytest.approx(step.rigid["cap"].displacement[1], rel=1e-2)
    with pytest.raises(InputError, match="nothing turns in an axisymmetric model; take the moment out"):
        replace(model, loads=[abut.Moment("cap", 1.0)])
    with pytest.raises(InputError, match="the model is axisymmetric; leave rz out"):
        replace(model, couplings=[abut.Coupling("cap", "ring.top", rz=0.1)])


def test_supports_of_points_that_follow():
    """What holds points in a displacement in which they follow moves the reference; what holds them in another is no
    force on it."""
    model = beam(tip(follow=("y", "z"), rx=0.0, ry=0.0, rz=0.0))
    held = [abut.Support("beam.left", x=0, y=0, z=0), abut.Support("beam.right", x=0.05, y=0.1)]
    step, result = end(replace(model, supports=held))
    assert result.displacement[1] == pytest.approx(0.1, rel=1e-12)
    assert step.reactions["beam.right"][0] == pytest.approx(YOUNG * 0.05 * HEIGHT * WIDTH / LENGTH, rel=0.02)
    assert result.force[0] == 0.0
    both = replace(model, supports=held, couplings=[replace(model.couplings[0], y=0.1)])
    assert np.abs(abut.solve(both).displacement - step.displacement).max() < EXACT * np.abs(step.displacement).max()


def test_a_reference_beside_its_points_is_where_it_is_prescribed():
    """However far the points turn about it, which nothing prescribes."""
    model = beam(
        tip(reference=(LENGTH + 7.0, 0.0, 0.0), y=6.0, z=-2.0),
        kinematics="finite",
        steps=2,
        cell="hex8",
        cells=(8, 2, 2),
    )
    _, result = end(model)
    assert np.linalg.norm(result.rotation) > 0.1
    assert result.displacement[1:] == pytest.approx([6.0, -2.0], rel=1e-9)


def test_supports_of_points_that_share():
    """Without a prescribed motion nothing holds the points together: each support has its own reaction."""
    model = beam(tip("distributing"))
    points = model.mesh.points
    right = model.mesh.nodes_of("beam.right")
    sets = {"up": right[points[right, 1] > 0], "down": right[points[right, 1] < 0]}
    held = [*model.supports, abut.Support("up", x=0.1), abut.Support("down", x=-0.1)]
    step, result = end(replace(model, supports=held, mesh=replace(model.mesh, node_sets=sets)))
    assert step.reactions["up"][0] == pytest.approx(-step.reactions["down"][0], rel=1e-9)
    assert step.reactions["up"][0] > 1e3
    assert not result.force.any()


def test_sides_whose_points_follow_have_the_smallest_pressure():
    """Many pressures have the resultants that two couplings feel: the smallest is taken, and a note says so."""
    mesh = join({"low": box([-1, 3], [-1, 3], [-2, 0], [4, 4, 2]), "flange": box([0, 2], [0, 2], [0, 1], [2, 2, 1])})
    steel = abut.LinearElastic(YOUNG, 0.3)
    model = abut.Model(
        mesh,
        [abut.Solid("low", steel), abut.Solid("flange", steel)],
        [abut.Support("low.bottom", x=0, y=0, z=0)],
        [abut.Force("foot", (0, 0, -100.0))],
        contacts=[abut.Contact(contactor="flange.bottom", target="low.top")],
        couplings=[abut.Coupling("foot", "flange.bottom", x=0.0, y=0.0, rz=0.0), abut.Coupling("seat", "low.top")],
    )
    solution = abut.solve(model)
    assert solution.contacts[0].force[2] == pytest.approx(100.0, rel=1e-9)
    assert any("the smallest is taken" in note for note in solution.notes)

"""Connectors between rigid bodies and to the ground: closed forms of mechanisms, in the plane and in space, at small and at
large turns; derivatives; what repeats itself and what nothing holds."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np
import pytest

import abut
from abut.errors import ConvergenceError, InputError, SingularModelError
from abut.jets import Jet, angle, cross, dot
from abut.problem.assembly import connected
from abut.problem.constraints import supports
from abut.problem.terms import Motion
from models.mechanisms import flat, solid

FINITE = {"kinematics": "finite"}
Joint = abut.Connector


def solved(model: abut.Model) -> abut.solution.Step:
    step = abut.solve(model).steps[-1]
    assert step.converged
    return step


def lever(*joints: Joint, **options: Any) -> abut.Model:
    """Of the length 10, along x from the origin."""
    return flat({"lever": ((0.0, 0.0), (10.0, 0.0))}, joints, **options)


@pytest.mark.parametrize("kinematics", ["small", "finite", "small-strain"])
def test_a_lever_on_a_spring(kinematics: str) -> None:
    """Moment M about the hinge, a spring k across at the end, at the distance L: M = k L^2 sin a cos a, and the hinge takes
    the spring's force k L sin a; at small turns M = k L^2 a. Rounding: 1e-9."""
    moment, k, length = 60.0, 2.0, 10.0
    turn = moment / (k * length**2) if kinematics == "small" else 0.5 * np.arcsin(2.0 * moment / (k * length**2))
    way = length * (turn if kinematics == "small" else np.sin(turn))
    spring = abut.Spring("spring", "lever 1", y=k)
    step = solved(lever(Joint("h", "hinge", "lever", at=(0, 0), load=moment), springs=[spring], kinematics=kinematics))
    hinge = step.connectors["h"]
    assert hinge.motion["turn"] == pytest.approx(turn, rel=1e-9)
    assert hinge.force == pytest.approx([0.0, k * way], abs=1e-9 * k * way)
    assert hinge.moment == pytest.approx([moment], rel=1e-9)
    assert step.springs["spring"] == pytest.approx([0.0, -k * way], abs=1e-9 * k * way)


@pytest.mark.parametrize("axis", [(0.0, 1.0, 0.0), (1.0, 2.0, -2.0)])
def test_a_weight_on_a_torsion_spring(axis: tuple[float, ...]) -> None:
    """A lever from a hinge whose axis is a: k t = (r x F) . a with r the end, turned by t about a (Rodrigues). The hinge
    carries the weight F, and its moment across the axis is that of the weight."""
    force, k = np.array([0.0, 0.0, -3.0]), 40.0
    direction = np.array(axis) / np.linalg.norm(axis)
    arm = np.array([10.0, 0.0, 0.0])

    def turned(t: float) -> np.ndarray:
        along = direction * (direction @ arm)
        return along + np.cos(t) * (arm - along) + np.sin(t) * np.cross(direction, arm)

    load = abut.Force("lever", tuple(force))
    joint = Joint("h", "hinge", "lever", at=(0, 0, 0), axis=axis, stiffness=k)
    given = {"lever": {"reference": (10.0, 0.0, 0.0)}}
    step = solved(solid({"lever": ((0, 0, 0), (10, 0, 0))}, [joint], given, loads=[load], **FINITE))
    hinge = step.connectors["h"]
    t = hinge.motion["turn"]
    assert abs(t) > 0.3  # large
    assert k * t == pytest.approx(np.cross(turned(t), force) @ direction, rel=1e-9)
    assert step.rigid["lever"].displacement == pytest.approx(turned(t) - arm, abs=1e-9)
    assert hinge.force == pytest.approx(-force, abs=1e-9)
    assert hinge.moment == pytest.approx(-np.cross(turned(t), force), abs=1e-8)


@pytest.mark.parametrize("crank_angle", [0.4, 2.0, 7.0])
def test_slider_crank(crank_angle: float) -> None:
    """The eye is at r cos a + sqrt(l^2 - r^2 sin^2 a); a force F against it takes the moment F dx/da of the crank."""
    r, long, force = 3.0, 10.0, 5.0
    joints = [
        Joint("axle", "hinge", "crank", at=(0, 0), motion=crank_angle),
        Joint("pin", "hinge", "rod", "crank", at=(r, 0)),
        Joint("eye", "slot", "rod", at=(r + long, 0), axis=(1, 0), load=-force),
    ]
    step = solved(flat({"crank": ((0, 0), (r, 0)), "rod": ((r, 0), (r + long, 0))}, joints, **FINITE))
    s, c = np.sin(crank_angle), np.cos(crank_angle)
    along = np.sqrt(long**2 - (r * s) ** 2)
    slope = -r * s - r**2 * s * c / along
    assert step.connectors["axle"].motion["turn"] == pytest.approx(crank_angle, rel=1e-12)
    met = 1e-8  # conditions are met to 1e-9 of a bar's length
    assert step.connectors["eye"].motion["travel"] == pytest.approx(r * c + along - r - long, abs=met)
    assert step.connectors["axle"].drive == pytest.approx(force * slope, rel=1e-8)
    rod = -np.arcsin(r * s / long)
    assert step.connectors["pin"].motion["turn"] == pytest.approx(rod - crank_angle, abs=met)
    assert step.connectors["pin"].force == pytest.approx([force, force * np.tan(rod)], rel=1e-8)


@pytest.mark.parametrize("turn", [0.7, 1.2, 2.5])
@pytest.mark.parametrize("bend", [0.2, 0.5])
def test_universal_joint(turn: float, bend: float) -> None:
    """Shafts with an angle phi between them, the axis of the driving fork across both: tan b = tan a cos phi, and a moment M
    on the driven shaft takes M db/da of the driving one."""
    axis = np.array([0.0, np.sin(bend), np.cos(bend)])
    end, moment = tuple(8.0 * axis), 4.0
    joints = [
        Joint("cross", "universal", "out", "in", at=(0, 0, 0), axis=(1, 0, 0), axis2=tuple(np.cross(axis, [1, 0, 0]))),
        Joint("bearing", "slot", "out", at=end, axis=tuple(axis)),
    ]
    given = {"in": {"reference": (0, 0, 0), "x": 0, "y": 0, "z": 0, "rx": 0, "ry": 0, "rz": turn}}
    bars = {"in": ((0, 0, -8), (0, 0, 0)), "out": ((0, 0, 0), end)}
    step = solved(solid(bars, joints, given, **FINITE))
    driven = step.rigid["out"].rotation
    assert np.cross(driven, axis) == pytest.approx(np.zeros(3), abs=1e-9)
    wanted = np.arctan2(np.sin(turn) * np.cos(bend), np.cos(turn))
    assert driven @ axis == pytest.approx(wanted, rel=1e-9)
    loaded = replace(solid(bars, joints, given, **FINITE), loads=[abut.Moment("out", tuple(moment * axis))])
    resisted = solved(loaded).rigid["in"].moment[2]
    ratio = np.cos(bend) / (np.cos(turn) ** 2 + (np.sin(turn) * np.cos(bend)) ** 2)
    # the load is a dead moment about the shaft, which keeps its axis
    assert resisted == pytest.approx(-moment * ratio, rel=1e-8)


def test_free_motions_of_sliders() -> None:
    """A slider and a slot along an axis across the bar go as they are driven, far and back; a cylindrical joint reports both
    its motions where another one makes it turn."""
    axis, way = np.array([0.0, 0.6, 0.8]), 3.0
    for kind in ("slider", "slot"):
        joints = [Joint("s", kind, "bar", at=(0, 0, 0), axis=tuple(axis), motion=way)]
        if kind == "slot":
            joints.append(Joint("far", "slider", "bar", at=(10, 0, 0), axis=tuple(axis)))
            continue
        step = solved(solid({"bar": ((0, 0, 0), (10, 0, 0))}, joints, **FINITE))
        assert step.rigid["bar"].displacement == pytest.approx(way * axis, abs=1e-10)
        assert step.rigid["bar"].rotation == pytest.approx(np.zeros(3), abs=1e-10)
    pitch = 0.5  # a ball in a slot leads the end on a ramp: z = pitch (10 - x) where it is
    joints = [
        Joint("c", "cylindrical", "bar", at=(0, 0, 0), axis=(0, 0, 1), motion=1.0),
        Joint("ramp", "slot", "bar", at=(10, 0, 0), axis=(1.0, 1.0, pitch)),
    ]
    with pytest.raises((SingularModelError, ConvergenceError)):
        abut.solve(solid({"bar": ((0, 0, 0), (10, 0, 0))}, joints, **FINITE))  # a line leaves the cylinder


@pytest.mark.parametrize("kinematics", ["small", "finite"])
@pytest.mark.parametrize(("moment", "limits", "turn"), [
    (30.0, (-1.0, 0.1), 0.1), (30.0, (-1.0, 0.5), 0.3), (-30.0, (-0.05, 0.1), -0.05), (30.0, (-np.inf, 0.1), 0.1),
])  # fmt: skip
def test_limits(kinematics: str, moment: float, limits: tuple[float, float], turn: float) -> None:
    """A torsion spring of 100 takes 100 t, the stop the rest of the moment, and nothing before it is reached."""
    joint = Joint("h", "hinge", "lever", at=(0, 0), limits=limits, stiffness=100.0, load=moment)
    hinge = solved(lever(joint, kinematics=kinematics)).connectors["h"]
    assert hinge.motion["turn"] == pytest.approx(turn, rel=1e-12)
    assert hinge.stop == pytest.approx(100.0 * turn - moment, abs=1e-9)


@pytest.mark.parametrize("kinematics", ["small", "finite"])
@pytest.mark.parametrize(("push", "moment", "travel", "turn"), [
    (4.0, 6.0, 0.2, 0.3), (-2.0, 6.0, -0.1, 0.3), (4.0, -6.0, 0.2, -0.1),
])  # fmt: skip
def test_limits_of_both_motions(kinematics: str, push: float, moment: float, travel: float, turn: float) -> None:
    """A bar on a cylindrical joint: a spring of 20 takes 20 t of the push, up to the stop, which has the rest; the moment
    about the axis drives the turn, which nothing else holds, to the limit on its side, which has all of it."""
    joint = Joint(
        "c", "cylindrical", "bar", at=(0, 0, 0), axis=(0, 0, 1), limits=(-1.0, 0.2), limits2=(-0.1, 0.3), stiffness=20.0
    )
    loads = [abut.Force("bar", (0.0, 0.0, push)), abut.Moment("bar", (0.0, 0.0, moment))]
    model = solid({"bar": ((0, 0, 0), (10, 0, 0))}, [joint], {"bar": {"reference": (0, 0, 0)}}, kinematics=kinematics)
    found = solved(replace(model, loads=loads)).connectors["c"]
    assert found.motion == pytest.approx({"travel": travel, "turn": turn}, rel=1e-9)
    assert found.stop == pytest.approx(20.0 * travel - push, abs=1e-8)
    assert found.stop2 == pytest.approx(-moment, abs=1e-8)
    assert found.force == pytest.approx([0.0, 0.0, -push], abs=1e-8)
    assert found.moment == pytest.approx([0.0, 0.0, -moment], abs=1e-8)


def test_limits_of_a_prescribed_joint() -> None:
    """A universal joint between shafts in line: one arm of the cross is driven, the other is bent up to its limit."""
    joint = Joint(
        "u", "universal", "bar", at=(0, 0, 0), axis=(0, 1, 0), axis2=(0, 0, 1), motion=0.2, limits2=(-0.1, 0.15)
    )
    model = solid({"bar": ((0, 0, 0), (10, 0, 0))}, [joint], {"bar": {"reference": (0, 0, 0)}}, **FINITE)
    found = solved(replace(model, loads=[abut.Moment("bar", (0.0, 0.0, 5.0))])).connectors["u"]
    assert found.motion == pytest.approx({"turn": 0.2, "turn2": 0.15}, rel=1e-9)
    assert found.drive is not None
    assert found.stop is None
    # the moment along the second arm, which the first one has turned by 0.2 from z
    assert found.stop2 == pytest.approx(-5.0 * np.cos(0.2), rel=1e-8)


@pytest.mark.parametrize("kinematics", ["small", "finite"])
@pytest.mark.parametrize("moment", [30.0, -30.0])
def test_limits_alone(kinematics: str, moment: float) -> None:
    """What only limits hold lies at that to which loads drive it, at once; also where these turn round."""
    there_and_back = abut.Amplitude(((0.0, 0.0), (0.5, 1.0), (1.0, -1.0)))
    joint = Joint("h", "hinge", "lever", at=(0, 0), limits=(-0.15, 0.1), load=moment, amplitude=there_and_back)
    model = lever(joint, kinematics=kinematics, solve=abut.SolveOptions(steps=4))
    steps = abut.solve(model).steps
    half = next(step for step in steps if step.factor == pytest.approx(0.5))
    for step, sign in ((half, np.sign(moment)), (steps[-1], -np.sign(moment))):
        assert step.connectors["h"].motion["turn"] == pytest.approx(0.1 if sign > 0 else -0.15, rel=1e-9)
        assert step.connectors["h"].stop == pytest.approx(-sign * 30.0, rel=1e-9)


def test_a_stop_at_the_end_of_a_way() -> None:
    """A bar on a slider is pulled by F against a spring k up to a stop at d: the stop has F - k d."""
    joint = Joint("s", "slider", "bar", axis=(0, 0, 1), limits=(-np.inf, 2.0), stiffness=3.0)
    for force in (5.0, 20.0):
        load = abut.Force("bar", (1.0, 0.0, force))
        step = solved(solid({"bar": ((0, 0, 0), (10, 0, 0))}, [joint], loads=[load], **FINITE))
        slider = step.connectors["s"]
        assert slider.motion["travel"] == pytest.approx(min(force / 3.0, 2.0), rel=1e-9)
        assert slider.stop == pytest.approx(-max(force - 6.0, 0.0), abs=1e-9)
        assert slider.force == pytest.approx([-1.0, 0.0, -force], abs=1e-9)


@pytest.mark.parametrize(("kind", "keys"), [
    ("hinge", {"axis": (1, 2, 3)}), ("slider", {"axis": (1, 2, 3)}), ("cylindrical", {"axis": (1, 2, 3)}),
    ("universal", {"axis": (1, 2, 3), "axis2": (3, 0, -1)}), ("ball", {}), ("slot", {"axis": (1, 2, 3)}),
])  # fmt: skip
def test_tangents(kind: str, keys: dict[str, Any]) -> None:
    """The tangent is the derivative of forces and conditions, central differences at a state that meets neither: 1e-7."""
    more = {} if kind == "ball" else {"stiffness": 30.0, "load": 7.0, "limits": (-9.0, 1e-3)}
    more |= {"limits2": (-9.0, 1e-3)} if kind in ("cylindrical", "universal") else {}
    bars = {"a": ((0, 0, 0), (10, 0, 0)), "b": ((10, 0, 0), (10, 7, 0))}
    model = solid(bars, [Joint("j", kind, "b", "a", at=(9, 1, 2), **keys, **more)], **FINITE)
    term = connected(model, supports(model))
    assert term is not None
    rng = np.random.default_rng(0)
    n = model.mesh.points.size
    values = np.concatenate([rng.normal(size=n), rng.normal(size=model.dofs.size - n)])
    if more:  # at its stop
        values[-len(term.joints[0].connector.limited) :] = 50.0

    def force(x: np.ndarray) -> np.ndarray:
        motion = Motion(1.0, x[:n], fields={"connectors": x[n:, None]})
        return term.evaluate(motion, motion).force

    motion = Motion(1.0, values[:n], fields={"connectors": values[n:, None]})
    tangent = term.evaluate(motion, motion).tangent.matrix
    assert abs(tangent - tangent.T).max() <= 1e-12 * abs(tangent).max()
    for _ in range(4):
        way = rng.normal(size=len(values))
        slope = (force(values + 1e-6 * way) - force(values - 1e-6 * way)) / 2e-6
        assert tangent @ way == pytest.approx(slope, abs=1e-7 * np.abs(slope).max())


def test_jets() -> None:
    """First and second derivatives of products and angles, against central differences."""
    rng = np.random.default_rng(1)
    slopes = rng.normal(size=(2, 3, 6))
    start = rng.normal(size=(2, 3))

    def value(x: np.ndarray) -> Jet:
        a, b = (Jet.linear(start[k] + slopes[k] @ x, slopes[k]) for k in range(2))
        c = cross(a, b)
        return angle(dot(c, a + b) + dot(a, b), dot(a, a) - dot(c, b).times(0.3))

    here, step = value(np.zeros(6)), 1e-5
    there = [[value(sign * step * e) for sign in (1, -1)] for e in np.eye(6)]
    assert here.slope == pytest.approx(np.array([(p.value - m.value) / (2 * step) for p, m in there]), abs=1e-8)
    bend = np.array([(p.slope - m.slope) / (2 * step) for p, m in there])
    assert here.bend == pytest.approx(bend, abs=1e-7 * np.abs(bend).max())


def four_bars(kinds: tuple[str, ...]) -> abut.Model:
    """A parallelogram: ground, two cranks, a coupler."""
    bars = {"a": ((0, 0, 0), (0, 4, 0)), "b": ((0, 4, 0), (9, 4, 0)), "c": ((9, 0, 0), (9, 4, 0))}
    places = [("a", "", (0, 0, 0)), ("b", "a", (0, 4, 0)), ("c", "b", (9, 4, 0)), ("c", "", (9, 0, 0))]
    joints = [
        Joint(f"j{i}", kind, on, to, at=at, axis=None if kind == "ball" else (0, 0, 1), motion=0.8 if i == 0 else None)
        for i, (kind, (on, to, at)) in enumerate(zip(kinds, places))
    ]
    return solid(bars, joints, **FINITE)


def test_what_repeats_itself_is_named() -> None:
    """Four hinges hold a loop in space three times too often: 20 motions and the drive, of 18, one left free."""
    model = four_bars(("hinge",) * 4)
    with pytest.raises(SingularModelError, match=r"connector 'j3' \(hinge\) between 'c' and the ground holds what"):
        abut.solve(model)
    finding = abut.check(model).findings[0]
    assert (finding.severity, finding.where) == ("error", "connectors")


def test_a_parallelogram() -> None:
    """Both cranks turn by the same angle and the coupler not at all: 5 + 5 + 2 + 5 motions held, and the drive, of 18."""
    step = solved(four_bars(("hinge", "hinge", "slot", "hinge")))
    assert step.rigid["c"].rotation == pytest.approx([0, 0, 0.8], abs=1e-9)
    assert step.rigid["b"].rotation == pytest.approx(np.zeros(3), abs=1e-9)


def test_prescribed_twice() -> None:
    hinges = Joint("h", "hinge", "lever", at=(0, 0)), Joint("s", "slot", "lever", at=(10, 0), axis=(1, 1), motion=0.5)
    with pytest.raises(SingularModelError, match="connector 's': motion is prescribed, but supports or other"):
        abut.solve(lever(*hinges))


def test_what_nothing_holds_is_named() -> None:
    hinge = Joint("h", "hinge", "lever", at=(0, 0), load=1.0)
    for kinematics in ("small", "finite"):
        model = lever(hinge, kinematics=kinematics)
        with pytest.raises(SingularModelError, match=r"nothing resists the turn of connector 'h', and the loads act"):
            abut.solve(model)
        assert "nothing resists the turn of connector 'h'" in abut.check(model).findings[0].what
    idle = abut.check(lever(replace(hinge, load=None)))
    assert [f.where for f in idle.findings if "the turn of connector 'h'" in f.what] == ["connectors"]
    away = lever(replace(hinge, load=-1.0, limits=(-np.inf, 0.1)))
    with pytest.raises((SingularModelError, ConvergenceError), match="drive its free motion away from its limit"):
        abut.solve(away)


@pytest.mark.parametrize(("keys", "said"), [
    ({"kind": "weld"}, "connector 'h': kind: expected one of hinge"),
    ({"to": "lever"}, "'lever' is on both sides"),
    ({"limits": (0.1, 0.2)}, "expected lower <= 0 <= upper"),
    ({"limits": (0.1,)}, r"expected \[lower, upper\]"),
    ({"motion": 1.0, "load": 2.0}, "the free motion is prescribed by motion"),
    ({"stiffness": -1.0}, "stiffness: expected a number > 0"),
    ({"axis2": (0, 0, 1)}, 'axis2 goes with kind = "universal"'),
    ({"kind": "ball", "limits": (-1, 1)}, 'kind = "ball" has no single free motion'),
    ({"limits2": (-1, 1)}, 'limits2: kind = "hinge" has no second free motion'),
])  # fmt: skip
def test_refused(keys: dict[str, Any], said: str) -> None:
    with pytest.raises(InputError, match=said):
        Joint(**{"name": "h", "kind": "hinge", "on": "lever", **keys})


@pytest.mark.parametrize(("keys", "said"), [
    ({"on": "lefer"}, r"connectors\[0\]\.on: no rigid body or coupling named 'lefer'.* mean 'lever'"),
    ({"kind": "ball"}, "the model is 2D, where hinge, slider, slot, distance"),
    ({"kind": "slider"}, "axis: it is missing"),
    ({"axis": (0, 0, 1)}, "a hinge is about its normal"),
    ({"at": (0, 0, 0)}, r"connectors\[0\]\.at: expected 2 numbers"),
])  # fmt: skip
def test_refused_by_the_model(keys: dict[str, Any], said: str) -> None:
    with pytest.raises(InputError, match=said):
        lever(Joint(**{"name": "h", "kind": "hinge", "on": "lever", **keys}))


def test_a_mechanism_that_nothing_drives_stays() -> None:
    """At large displacements, where forces are rounding alone; a small moment turns it as it should."""
    joint = Joint("h", "hinge", "lever", at=(0, 0), stiffness=4.0)
    step = solved(lever(joint, **FINITE))
    assert np.abs(step.displacement).max() < 1e-12
    step = solved(lever(replace(joint, load=4e-6), **FINITE))
    assert step.connectors["h"].motion["turn"] == pytest.approx(1e-6, rel=1e-6)

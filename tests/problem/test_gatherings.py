"""Connectors between points of a set: distances, lines, planes and mean turns, at small and at large displacements."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np
import pytest

import abut
from abut.errors import InputError
from abut.mesh.make import box, join
from abut.problem.assembly import connected
from abut.problem.constraints import supports
from abut.problem.terms import Motion
from models.mechanisms import flat

Joint = abut.Connector
FINITE = {"kinematics": "finite"}


def lever(*joints: Joint, **options: Any) -> abut.Model:
    """From a hinge at the origin, of the length 10, and a bar that is held, from (10, 8) on; "tie" their ends."""
    bars = {"lever": ((0.0, 0.0), (10.0, 0.0)), "post": ((10.0, 8.0), (14.0, 8.0))}
    model = flat(bars, [Joint("h", "hinge", "lever", at=(0, 0))], {"post": {"x": 0, "y": 0, "rz": 0}}, **options)
    sets = model.mesh.node_sets
    both = np.concatenate([sets["lever 1"], sets["post 0"]])
    bar = model.mesh.nodes_of("lever")
    bar = bar[np.linalg.norm(model.mesh.points[bar] - (5.0, 0.0), axis=1) > 0.1]  # not the one on the axis
    mesh = replace(model.mesh, node_sets={**sets, "tie": both, "bar": bar})
    return replace(model, mesh=mesh, connectors=[*model.connectors, *joints])


def gap(turn: float) -> float:
    return float(np.hypot(10.0 * np.cos(turn) - 10.0, 10.0 * np.sin(turn) - 8.0))


def test_a_spring_that_turns_with_its_ends() -> None:
    """M = d/da k (l - l0)^2 / 2 with l the distance of both ends, which turns by far."""
    k, moment = 5.0, 200.0
    tie = Joint("spring", "distance", "tie", stiffness=k)
    model = lever(tie, loads=[abut.Moment("lever", (moment,))], **FINITE)
    step = abut.solve(model).steps[-1]
    turn, slight = step.connectors["h"].motion["turn"], 1e-5
    assert turn > 0.4
    assert step.connectors["spring"].motion["travel"] == pytest.approx(gap(turn) - 8.0, abs=1e-8)
    energy = [0.5 * k * (gap(turn + sign * slight) - 8.0) ** 2 for sign in (1, -1)]
    assert (energy[0] - energy[1]) / (2 * slight) == pytest.approx(moment, rel=1e-6)


@pytest.mark.parametrize("loose", [0.0, 1.5])
def test_a_rope(loose: float) -> None:
    """It holds the end at most that much farther away; until then it carries nothing, a torsion spring all."""
    rope = (
        Joint("rope", "distance", "tie", limits=(-np.inf, loose))
        if loose
        else Joint("rod", "distance", "tie", motion=0)
    )
    hinge = Joint("h", "hinge", "lever", at=(0, 0), stiffness=100.0, load=-60.0)
    model = replace(lever(rope, **FINITE), connectors=[hinge, rope])
    step = abut.solve(model).steps[-1]
    turn, joint = step.connectors["h"].motion["turn"], step.connectors[rope.name]
    assert gap(turn) - 8.0 == pytest.approx(loose, abs=1e-8)
    slope = (gap(turn + 1e-6) - gap(turn - 1e-6)) / 2e-6
    pull = joint.stop if loose else joint.drive
    assert pull * slope == pytest.approx(60.0 + 100.0 * turn, abs=1e-5)
    free = replace(model, connectors=[replace(hinge, load=-1.0), replace(rope, limits=(-np.inf, 1.5), motion=None)])
    assert abut.solve(free).steps[-1].connectors[rope.name].stop == 0.0


@pytest.mark.parametrize("kinematics", ["small", "finite"])
def test_a_mean_turn(kinematics: str) -> None:
    """Of the points of a rigid bar it is the bar's, and its moment turns the bar against a torsion spring."""
    hinge = Joint("h", "hinge", "lever", at=(0, 0), stiffness=100.0)
    turn = Joint("t", "mean-turn", "bar", motion=0.6)
    model = lever(turn, kinematics=kinematics)
    step = abut.solve(replace(model, connectors=[hinge, turn])).steps[-1]
    assert step.connectors["h"].motion["turn"] == pytest.approx(0.6, rel=1e-9)
    assert step.connectors["t"].drive == pytest.approx(60.0, rel=1e-8)
    pushed = replace(model, connectors=[hinge, replace(turn, motion=None, load=60.0)])
    assert abut.solve(pushed).steps[-1].connectors["t"].motion["turn"] == pytest.approx(0.6, rel=1e-8)


def block(*joints: Joint, kinematics: str = "finite", push: float = 60.0) -> abut.Model:
    mesh = join({"b": box((0.0, 2.0), (0.0, 2.0), (0.0, 2.0), (2, 2, 2), "hex8")})
    edge = np.flatnonzero((mesh.points[:, 2] == 2.0) & (mesh.points[:, 0] == 2.0))
    pushed = np.flatnonzero((mesh.points == (2.0, 1.0, 2.0)).all(axis=1))
    mesh = replace(mesh, node_sets={"edge": edge, "pushed": pushed, "off": np.append(edge, 0)})
    return abut.Model(
        mesh,
        [abut.Solid("b", abut.LinearElastic(1000.0, 0.3))],
        [abut.Support("b.bottom", x=0, y=0, z=0)],
        [abut.NodalForce("pushed", (push, 0.0, -push))],
        connectors=joints,
        kinematics=kinematics,
    )


@pytest.mark.parametrize("kinematics", ["small", "finite"])
def test_points_stay_on_a_line_and_in_a_plane(kinematics: str) -> None:
    """What is left by the nearest line or plane; conditions do no work, so that the supports carry the loads. Small: but for
    squares of the displacements, a hundredth."""
    push = 0.5 if kinematics == "small" else 60.0
    for joint, kept in ((Joint("l", "straight", "edge"), 1), (Joint("p", "plane", "b.top"), 2)):
        model = block(joint, kinematics=kinematics, push=push)
        nodes = model.mesh.nodes_of(joint.on)
        left = {}
        for name, each in (("free", replace(model, connectors=[])), ("held", model)):
            step = abut.solve(each).steps[-1]
            assert step.converged
            there = (each.mesh.points + step.displacement)[nodes]
            left[name] = np.linalg.svd(there - there.mean(axis=0), compute_uv=False)[kept]
            assert step.reactions["b.bottom"] == pytest.approx([-push, 0.0, push], abs=1e-7 * push)
        assert left["free"] > 1e-4 * push
        assert left["held"] < (1e-8 if kinematics == "finite" else 1e-2 * left["free"])


@pytest.mark.parametrize(("kind", "on"), [
    ("straight", "edge"), ("plane", "b.top"), ("distance", "two"), ("mean-turn", "some"),
])  # fmt: skip
def test_tangents(kind: str, on: str) -> None:
    """As of joints: central differences at a state that meets nothing."""
    more: dict[str, Any] = {} if kind in ("straight", "plane") else {"stiffness": 30.0, "load": 7.0}
    if kind == "mean-turn":
        more["axis"] = (1.0, 0.5, 2.0)
    model = block()
    mesh = replace(
        model.mesh, node_sets={**model.mesh.node_sets, "two": np.array([0, 25]), "some": np.array([0, 5, 19])}
    )
    model = replace(model, mesh=mesh, connectors=[Joint("j", kind, on, **more)])
    term = connected(model, supports(model))
    assert term is not None
    rng, n = np.random.default_rng(0), model.mesh.points.size
    values = np.concatenate([0.3 * rng.normal(size=n), rng.normal(size=model.dofs.size - n)])

    def share(x: np.ndarray) -> Any:
        motion = Motion(1.0, x[:n], fields={"connectors": x[n:, None]})
        return term.evaluate(motion, motion)

    tangent = share(values).tangent.matrix
    way = rng.normal(size=len(values))
    slope = (share(values + 1e-6 * way).force - share(values - 1e-6 * way).force) / 2e-6
    assert tangent @ way == pytest.approx(slope, abs=1e-7 * np.abs(slope).max())


@pytest.mark.parametrize(("keys", "said"), [
    ({"kind": "straight", "on": "off"}, "do not lie on one line at the outset"),
    ({"kind": "plane", "on": "edge"}, "'edge' has 3 points; a plane has 4 or more"),
    ({"kind": "distance", "on": "edge"}, "'edge' has 3 points; a distance has 2"),
    ({"kind": "mean-turn", "on": "edge", "axis": (0, 1, 0)}, "lies on the axis"),
    ({"kind": "mean-turn", "on": "edge"}, "axis: it is missing"),
    ({"kind": "straight", "on": "egde"}, "no surface or node set named 'egde'"),
])  # fmt: skip
def test_refused(keys: dict[str, Any], said: str) -> None:
    with pytest.raises(InputError, match=said):
        abut.solve(block(Joint("j", **keys)))


def test_refused_keys() -> None:
    with pytest.raises(InputError, match="is between the points of on; leave to out"):
        Joint("j", "straight", "edge", to="b")
    with pytest.raises(InputError, match='axis: kind = "plane" has none'):
        Joint("j", "plane", "edge", axis=(1, 0, 0))

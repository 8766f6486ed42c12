"""Frequencies and vibrations of assemblies with connectors: levers, pendulums and sliders of rigid bodies in closed form.
Masses are lumped nowhere: linear cells have those of rigid motions exactly."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np
import pytest

import abut
from abut.errors import InputError
from models.mechanisms import flat, solid

RHO, LENGTH = 2e-3, 10.0
MASS = RHO * LENGTH
INERTIA = MASS * (LENGTH**2 / 3.0 + 1.0 / 12.0)  # of a bar of the width 1, about one end
Joint = abut.Connector
FIRST = abut.Frequencies(1)


def weighted(model: abut.Model, *modes: Any) -> abut.Model:
    """With masses, of which the block, which is stiff beside the levers' springs, has hardly any part in these modes."""
    block = replace(model.solids[0], material=abut.LinearElastic(1000.0, 0.3, density=RHO))
    rigid = [replace(body, density=RHO) for body in model.rigid]
    return replace(model, solids=[block], rigid=rigid, modes=modes or [FIRST])


def lever(*joints: Joint, **options: Any) -> abut.Model:
    return weighted(flat({"lever": ((0.0, 0.0), (LENGTH, 0.0))}, joints, **options))


def hertz(square: float) -> float:
    return float(np.sqrt(square) / (2.0 * np.pi))


def found(model: abut.Model) -> abut.solution.ModesResult:
    solution = abut.solve(model)
    assert solution.converged
    assert all(check.passed for check in solution.modes[0].certificate)
    return solution.modes[0]


@pytest.mark.parametrize("kinematics", ["small", "finite"])
def test_a_lever_on_a_torsion_spring(kinematics: str) -> None:
    """Square of the angular frequency k / J, J about the hinge, also where a moment has turned it."""
    model = lever(Joint("h", "hinge", "lever", at=(0, 0), stiffness=4.0, load=1.0), kinematics=kinematics)
    assert found(model).values[0] == pytest.approx(hertz(4.0 / INERTIA), rel=1e-7)


@pytest.mark.parametrize("kinematics", ["small", "finite"])
def test_a_slider_on_a_spring(kinematics: str) -> None:
    """k / m along the way; the rest is held."""
    model = lever(Joint("s", "slider", "lever", at=(0, 0), axis=(1, 0), stiffness=3.0, load=1.0), kinematics=kinematics)
    assert found(model).values[0] == pytest.approx(hertz(3.0 / MASS), rel=1e-7)


def test_a_pendulum() -> None:
    """A lever that hangs, by large displacements: m g l / 2 / J, from the force of the hinge as it turns; at the angle at
    which a torsion spring holds it, k + m g l / 2 cos a."""
    weight = 0.5
    hanging = weighted(
        flat(
            {"lever": ((0.0, 0.0), (0.0, -LENGTH))}, [Joint("h", "hinge", "lever", at=(0, 0))],
            {"lever": {"reference": (0.0, -LENGTH / 2)}}, loads=[abut.Force("lever", (0.0, -weight))], kinematics="finite",
        )
    )  # fmt: skip
    assert found(hanging).values[0] == pytest.approx(hertz(weight * LENGTH / 2.0 / INERTIA), rel=1e-7)
    model = lever(Joint("h", "hinge", "lever", at=(0, 0), stiffness=4.0), kinematics="finite")
    model = replace(
        model, rigid=[replace(model.rigid[0], reference=(LENGTH / 2, 0.0))], loads=[abut.Force("lever", (0.0, -weight))]
    )
    solution = abut.solve(model)
    turn = solution.steps[-1].connectors["h"].motion["turn"]
    assert turn < -0.3
    square = (4.0 + weight * LENGTH / 2.0 * np.sin(-turn)) / INERTIA  # d/da of M = k a + w l/2 cos a
    assert solution.modes[0].values[0] == pytest.approx(hertz(square), rel=1e-7)


def test_a_limit_holds_what_it_stops() -> None:
    """Open it does nothing; reached it holds the lever, and what is left is the block, as without a lever."""
    joint = Joint("h", "hinge", "lever", at=(0, 0), stiffness=4.0, limits=(-1.0, 0.05), load=0.1)
    assert found(lever(joint)).values[0] == pytest.approx(hertz(4.0 / INERTIA), rel=1e-7)
    stopped = found(lever(replace(joint, load=1.0))).values[0]
    block = found(replace(lever(joint), rigid=[abut.Rigid("lever", x=0, y=0, rz=0)], connectors=())).values[0]
    assert stopped == pytest.approx(block, rel=1e-7)
    assert stopped > 10.0 * hertz(4.0 / INERTIA)


def test_two_shafts_by_a_universal_joint() -> None:
    """In line, the second one against a torsion spring: both turn as one, k / 2 J, J of squares of side 1."""
    joints = [
        Joint("cross", "universal", "out", "in", at=(0, 0, 0), axis=(1, 0, 0), axis2=(0, 1, 0)),
        Joint("bearing", "slot", "out", at=(0, 0, 8), axis=(0, 0, 1)),
        Joint("spring", "hinge", "in", at=(0, 0, -8), axis=(0, 0, 1), stiffness=2.0),
    ]
    bars = {"in": ((0, 0, -8), (0, 0, 0)), "out": ((0, 0, 0), (0, 0, 8))}
    model = weighted(solid(bars, joints))
    inertia = 2.0 * (8.0 * RHO) / 6.0
    assert found(model).values[0] == pytest.approx(hertz(2.0 / inertia), rel=1e-6)


def test_a_lever_that_is_shaken() -> None:
    """One oscillator: amplitude M / (k - J w^2) of the turn, times the length at its end, at a third of its frequency."""
    base = hertz(4.0 / INERTIA)
    model = lever(Joint("h", "hinge", "lever", at=(0, 0), stiffness=4.0))
    third = (base / 3.0, base / 2.0)
    load = abut.NodalForce("lever 1", (0.0, 0.01))
    shaken = replace(model, modes=[FIRST, abut.Harmonic(between=third, loads=[load], fields=third[:1])])
    answer = abut.solve(shaken).responses[0]
    end = int(model.mesh.node_sets["lever 1"][0])
    turn = 0.01 * LENGTH / (4.0 * (1.0 - 1.0 / 9.0))
    assert abs(answer.fields[0][end, 1]) == pytest.approx(turn * LENGTH, rel=1e-5)


@pytest.mark.parametrize(
    ("modes", "said"),
    [
        ([abut.Buckling(1)], "joints let bodies turn"),
        ([abut.Frequencies(1, complex=True)], "frequencies: complex: not known of assemblies with connectors"),
    ],
)
def test_what_is_not_known_is_told(modes: list[Any], said: str) -> None:
    model = lever(Joint("h", "hinge", "lever", at=(0, 0), stiffness=4.0))
    with pytest.raises(InputError, match=said):
        abut.solve(replace(model, modes=modes))


def test_multigrid_is_told() -> None:
    model = lever(Joint("h", "hinge", "lever", at=(0, 0), stiffness=4.0), solve=abut.SolveOptions(linear="amg"))
    with pytest.raises(InputError, match='"amg" knows displacements alone; connectors need "direct"'):
        abut.solve(model)

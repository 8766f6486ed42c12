"""Connectors between couplings of bodies that deform: beams on hinges and sliders, with contact, with a fresh start."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np
import pytest

import abut
from abut.errors import InputError, SingularModelError
from abut.mesh.make import box, join, rectangle
from models.mechanisms import lever_and_block

YOUNG, LENGTH, HEIGHT = 1000.0, 20.0, 1.0
INERTIA = HEIGHT**3 / 12.0
Joint = abut.Connector


def halves(kind: str, joints: tuple[Joint, ...], kinematics: str = "small", **options: Any) -> abut.Model:
    """Two beams in a row, held at their far ends, each with a coupling at the end where they meet."""
    parts = {
        "a": rectangle((0.0, LENGTH), (-0.5, 0.5), (20, 2), "quad8"),
        "b": rectangle((LENGTH, 2 * LENGTH), (-0.5, 0.5), (20, 2), "quad8"),
    }
    return abut.Model(
        join(parts),
        [abut.Solid(name, abut.LinearElastic(YOUNG, 0.0)) for name in parts],
        [abut.Support("a.left", x=0, y=0), abut.Support("b.right", x=0, y=0)],
        couplings=[abut.Coupling("left", "a.right", kind), abut.Coupling("right", "b.left", kind)],
        connectors=joints,
        plane="stress",
        kinematics=kinematics,
        **options,
    )


@pytest.mark.parametrize("kind", ["kinematic", "distributing"])
def test_two_cantilevers_with_a_hinge(kind: str) -> None:
    """Each takes half of a force at the hinge, w = (F / 2) (L^3 / 3 E I + 1.2 L / G A), G = E / 2; the hinge has F / 2, no
    moment. An end that stays plane holds back a share of order (h / L)^3: 1e-3."""
    force = 0.02
    model = halves(kind, (Joint("h", "hinge", "right", "left"),), loads=[abut.Force("left", (0.0, force))])
    step = abut.solve(model).steps[-1]
    exact = 0.5 * force * (LENGTH**3 / (3.0 * YOUNG * INERTIA) + 1.2 * LENGTH / (0.5 * YOUNG * HEIGHT))
    assert step.rigid["left"].displacement[1] == pytest.approx(exact, rel=1e-3)
    assert step.rigid["right"].displacement == pytest.approx(step.rigid["left"].displacement, abs=1e-9)
    joint = step.connectors["h"]
    assert joint.force[1] == pytest.approx(0.5 * force, rel=1e-8)
    assert joint.moment == pytest.approx([0.0], abs=1e-9)
    assert joint.motion["turn"] == pytest.approx(step.rigid["right"].rotation[0] - step.rigid["left"].rotation[0])
    assert step.balance_error <= step.balance_limit


def test_a_stop_in_the_hinge_makes_one_beam() -> None:
    """Once the hinge's limit is reached, both halves are one beam held at both ends for what is added: stiffness
    192 E I / (2 L)^3 = 24 E I / L^3 after 6 E I / L^3. Without shear (long beams): 1 %."""
    limit = 0.1
    before = 6.0 * YOUNG * INERTIA / LENGTH**3
    tip = limit / 2.0 * LENGTH * 2.0 / 3.0  # each end turns by 3 w / 2 L
    force = before * tip + 24.0 * YOUNG * INERTIA / LENGTH**3 * 0.5
    joint = Joint("h", "hinge", "right", "left", limits=(-limit, limit))
    step = abut.solve(halves("kinematic", (joint,), loads=[abut.Force("left", (0.0, force))])).steps[-1]
    assert step.rigid["left"].displacement[1] == pytest.approx(tip + 0.5, rel=1e-2)
    assert abs(step.connectors["h"].motion["turn"]) == pytest.approx(limit, rel=1e-9)
    middle = YOUNG * INERTIA * 6.0 * 0.5 / LENGTH**2  # moment in the middle of a clamped beam sunk by 0.5
    assert abs(step.connectors["h"].stop) == pytest.approx(middle, rel=1e-2)


@pytest.mark.parametrize("kinematics", ["small", "finite"])
def test_a_fixed_slider_between_couplings_is_one_beam(kinematics: str) -> None:
    """A slider whose travel is prescribed as 0 holds all: the same as one beam, here against a tied contact."""
    force = abut.Force("left", (0.0, 0.5))
    model = halves("kinematic", (Joint("s", "slider", "right", "left", axis=(1, 0), motion=0.0),), kinematics)
    joined = abut.solve(replace(model, loads=[force])).steps[-1].rigid["left"].displacement
    tie = abut.Contact("a.right", "b.left", kind="tied", name="tie")
    # without couplings at all points of both ends the tie has the same plane ends by symmetry
    tied = (
        abut.solve(
            replace(model, connectors=(), couplings=[abut.Coupling("left", "a.right")], contacts=[tie], loads=[force])
        )
        .steps[-1]
        .rigid["left"]
        .displacement
    )
    assert joined == pytest.approx(tied, rel=2e-3, abs=2e-3 * np.abs(tied).max())


def test_a_shaft_through_a_universal_joint() -> None:
    """Elastic shafts in space at small turns: both in line, the joint passes the torque on, T L / G J each (round is square
    here: J = 0.1406 a^4, Saint-Venant; ends that stay plane hold warping back over a width or so: 4 %)."""
    parts = {
        "in": box((-0.5, 0.5), (-0.5, 0.5), (0.0, 10.0), (4, 4, 10), "hex20"),
        "out": box((-0.5, 0.5), (-0.5, 0.5), (10.0, 20.0), (4, 4, 10), "hex20"),
    }
    turn = 1e-3
    model = abut.Model(
        join(parts),
        [abut.Solid(name, abut.LinearElastic(YOUNG, 0.0)) for name in parts],
        [abut.Support("out.top", x=0, y=0, z=0)],
        couplings=[
            abut.Coupling("drive", "in.bottom", x=0, y=0, z=0, rx=0, ry=0, rz=turn),
            abut.Coupling("fork", "in.top"),
            abut.Coupling("other", "out.bottom"),
        ],
        connectors=[Joint("cross", "universal", "other", "fork", axis=(1, 0, 0), axis2=(0, 1, 0))],
    )
    step = abut.solve(model).steps[-1]
    torque = 0.1406 * 0.5 * YOUNG * turn / 20.0
    assert step.rigid["drive"].moment[2] == pytest.approx(torque, rel=0.04)
    assert step.connectors["cross"].moment[2] == pytest.approx(step.rigid["drive"].moment[2], rel=1e-8)
    assert step.connectors["cross"].moment[:2] == pytest.approx([0.0, 0.0], abs=1e-9)


@pytest.mark.parametrize("kinematics", ["small", "finite"])
def test_a_lever_presses_a_block(kinematics: str) -> None:
    """A moment M on a lever whose end lies on a block: the block's force has that moment about the hinge, whose own is the
    opposite. At small turns the arm is that of the contact's resultant at the outset."""
    model = lever_and_block(kinematics, moment=-6.0)
    solution = abut.solve(model)
    step, contact = solution.steps[-1], solution.contacts[0]
    hinge = step.connectors["h"]
    assert step.converged
    force = np.array(contact.force)  # on the block
    assert hinge.force == pytest.approx(force, abs=1e-6 * np.abs(force).max())
    assert force[1] < 0.0
    assert step.reactions["block.bottom"] == pytest.approx(-force, abs=1e-6 * np.abs(force).max())
    arm = -6.0 / force[1]
    assert 9.0 < arm < 10.0 + 1e-6  # within the face of the block
    assert step.balance_error <= step.balance_limit


@pytest.mark.parametrize("friction", [0.0, 0.2])
@pytest.mark.parametrize("kinematics", ["small", "finite"])
def test_a_lever_is_driven_onto_a_block(kinematics: str, friction: float) -> None:
    """A prescribed turn presses the end down by about 9.5 times the angle, before any force acts that residuals could be
    judged by: few iterations, and the hinge has the contact's force."""
    drive = Joint("h", "hinge", "lever", at=(0, 2), motion=-0.002)
    model = lever_and_block(kinematics, moment=0.0)
    model = replace(model, connectors=[drive], contacts=[replace(model.contacts[0], friction=friction)])
    solution = abut.solve(model)
    step, force = solution.steps[-1], np.array(solution.contacts[0].force)
    assert step.converged
    assert sum(len(each.iterations) for each in solution.steps) <= 15
    assert step.connectors["h"].force == pytest.approx(force, abs=1e-6 * np.abs(force).max())
    assert step.connectors["h"].drive == pytest.approx(9.5 * force[1], rel=0.02)
    work = next((check for check in solution.certificate if check.name == "energy balance"), None)
    assert work is None or work.passed


def test_steps_that_go_on() -> None:
    """A run that goes on after its second step ends as the whole one, turns beyond half a turn included."""
    model = lever_and_block("finite", moment=0.0)
    joint = Joint("h", "hinge", "lever", at=(0, 2), motion=9.0)
    model = replace(model, connectors=[joint], contacts=(), solve=abut.SolveOptions(steps=8))
    saved: list[abut.solution.Saved] = []
    whole = abut.solve(model, on_step=lambda _, end: saved.append(end))
    again = abut.solve(model, resume=saved[:5])
    assert whole.steps[-1].connectors["h"].motion["turn"] == pytest.approx(9.0, rel=1e-10)
    assert again.steps[-1].connectors["h"].motion["turn"] == pytest.approx(9.0, rel=1e-10)
    assert again.steps[-1].displacement == pytest.approx(whole.steps[-1].displacement, abs=1e-9)


def test_what_does_not_go_together() -> None:
    model = halves("distributing", (Joint("h", "hinge", "right", "left"),))
    with pytest.raises(InputError, match=r"connectors\[0\].on: coupling 'right' is distributing"):
        replace(model, kinematics="finite")
    with pytest.raises(InputError, match=r"connectors need \"direct\""):
        abut.solve(replace(model, solve=abut.SolveOptions(linear="amg")))
    with pytest.raises(InputError, match=r"buckling: joints let bodies turn"):
        abut.solve(replace(model, modes=[abut.Buckling(1)]))
    partly = [abut.Coupling("left", "a.right", follow=("x",)), model.couplings[1]]
    with pytest.raises(InputError, match=r"connectors\[0\].to: coupling 'left' follows in some displacements only"):
        replace(model, couplings=partly)
    held = [abut.Coupling("left", "a.right", x=0, y=0, rz=0), abut.Coupling("right", "b.left", x=0, y=0)]
    with pytest.raises(SingularModelError, match=r"connector 'h' \(hinge\) between 'right' and 'left' holds what"):
        abut.solve(replace(model, couplings=held))

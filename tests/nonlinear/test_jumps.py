"""Jumps that Newton's method makes by itself, theory (G25): told where an arch snaps through, and nowhere else."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np
import pytest

import abut
from abut.diagnosis.cures import cures
from abut.mesh import make
from abut.solution import Solution
from abut.solution.run_checks import JUMPED
from models.arches import PUNCH, RISE, arch

FORCE, STEPS = 5.5, 6  # dead; the arch's limit point is at about 3.6, in the fourth step
SOFT = abut.LinearElastic(1e3, 0.3)
CYCLE = abut.Amplitude(((0.0, 0.0), (0.4, 1.0), (0.7, 0.0), (1.0, 0.6)))
RISING = abut.Amplitude(((0.0, 0.0), (0.3, 1.0)))
LATER = abut.Amplitude(((0.3, 0.0), (1.0, 1.0)))


@pytest.fixture(scope="module")
def snapped() -> Solution:
    return abut.solve(arch(FORCE, steps=STEPS))


def top_goes_down(solution: Solution, step: int) -> float:
    """Mean way of the punch's top down: what an even traction on it does work along (Simpson's rule of each edge)."""
    mesh, top = solution.model.mesh, solution.model.mesh.nodes_of("punch.top")
    top = top[np.argsort(mesh.points[top, 0])]
    weights = np.zeros(len(top))
    for first in range(0, len(top) - 2, 2):
        length = mesh.points[top[first + 2], 0] - mesh.points[top[first], 0]
        weights[first : first + 3] += length * np.array([1.0, 4.0, 1.0]) / 6.0
    return -float(weights @ solution.steps[step].displacement[top, 1]) / PUNCH


def jumps(solution: Solution) -> list[abut.solution.Check]:
    return [check for check in solution.certificate if check.name == "jumps"]


def test_an_arch_that_snaps_through_without_a_drag(snapped: Solution) -> None:
    """Newton's method alone finds the state beyond, whose potential under the force before is lower: what the force before
    does on the way less what is stored."""
    assert snapped.converged
    assert not any(step.energy is not None and step.energy.stabilisation for step in snapped.steps)
    ways = [0.0, *(top_goes_down(snapped, i) for i in range(len(snapped.steps)))]
    (at,) = np.flatnonzero(np.diff(ways) > RISE)
    before, step = snapped.steps[at - 1], snapped.steps[at]
    assert step.energy is not None
    assert before.energy is not None
    assert step.energy.elastic is not None
    set_free = FORCE * before.factor * (ways[at + 1] - ways[at]) - (
        step.energy.elastic - (before.energy.elastic or 0.0)
    )
    assert set_free > 1.0
    assert step.energy.unexplained == pytest.approx(set_free, rel=1e-9)
    (line,) = jumps(snapped)
    assert not line.passed
    assert line.value == step.energy.jumped
    assert line.meaning.endswith(f"steps to time {step.factor:.6g}")
    (told,) = [note for note in snapped.notes if "jumps to another equilibrium" in note]
    assert told.startswith(f"step {step.number} to time {step.factor:.6g} ")
    assert "prescribe a displacement instead of the force" in {c.name: text for c, text in cures(snapped)}["jumps"]


def test_the_steps_before_and_after_it_are_sound(snapped: Solution) -> None:
    """The arch lies still on either branch."""
    (line,) = jumps(snapped)
    others = [step.energy for step in snapped.steps if step.energy is not None and step.energy.jumped != line.value]
    assert len(others) == len(snapped.steps) - 1
    assert all(energy.unexplained is not None and energy.unexplained < 0.0 for energy in others)


def block(cell: str = "quad8") -> abut.mesh.Mesh:
    return make.join({"block": make.rectangle([0, 1], [0, 1], cells=[2, 2], cell=cell)})


def pulled(loads: list[Any], **options: Any) -> abut.Model:
    """A block on its bottom."""
    given = {"plane": "strain", "kinematics": "finite", "solve": abut.SolveOptions(steps=4), **options}
    supports = [abut.Support("block.bottom", x=0, y=0), *given.pop("supports", [])]
    return abut.Model(block(given.pop("cell", "quad8")), [abut.Solid("block", SOFT, integration=given.pop("how", "auto"))],
                      supports, loads, **given)  # fmt: skip


def test_what_is_stored_lies_in_the_middle() -> None:
    """Of a body that stays linear: forces grow in proportion, F q / 2 at the end, and in the k-th of n equal steps
    (2 k - 1) F q / (2 n^2) is stored, half of F q / n^2 from the work of either end."""
    solution = abut.solve(pulled([abut.Traction("block.top", (1e-3, 1e-3))]))
    count, last = len(solution.steps), solution.steps[-1].energy
    assert last is not None
    assert last.elastic is not None
    assert count == 4
    for step in solution.steps:
        assert step.energy is not None
        assert step.energy.unexplained == pytest.approx(-last.elastic / count**2, rel=1e-4)


def pressed(material: Any = SOFT, traction: float = 150.0, **options: Any) -> abut.Model:
    """A block with a round bottom, pressed on a slab by a dead force."""
    cell, friction, history = options.get("cell", "quad8"), options.get("friction", 0.0), options.get("amplitude")
    upper = make.rectangle([0.9, 2.7], [1.0, 2.0], cells=[4, 3], cell=cell)
    points = upper.points.copy()
    points[:, 1] += np.where(points[:, 1] < 1.0001, 0.08 * (points[:, 0] - 1.8) ** 2, 0.0)
    mesh = make.join(
        {"low": make.rectangle([0, 4], [0, 1], cells=[9, 3], cell=cell), "up": replace(upper, points=points)}
    )
    how = options.get("how", "auto")
    return abut.Model(
        mesh, [abut.Solid(name, material, integration=how) for name in mesh.bodies],
        [abut.Support("low.bottom", x=0, y=0), abut.Support("up.top", x=0)],
        [abut.Traction("up.top", (0.0, -traction), amplitude=history)],
        [abut.Contact(contactor="up.bottom", target="low.top", friction=friction)], plane="strain",
        kinematics="finite", solve=abut.SolveOptions(steps=options.get("steps", "auto")),
    )  # fmt: skip


def drawn(steps: int | str) -> abut.Model:
    """A strip held at its left end, pressed on a wavy slab and drawn along it by dead forces."""
    low = make.rectangle([2, 8], [-1, 0], cells=[23, 2], cell="quad8")
    points = low.points.copy()
    points[:, 1] += np.where(points[:, 1] > -0.01, 0.15 * np.sin(3.0 * points[:, 0]), 0.0)
    strip = make.rectangle([0, 4], [0.17, 0.57], cells=[20, 2], cell="quad8")
    mesh = make.join({"low": replace(low, points=points), "strip": strip})
    return abut.Model(
        mesh, [abut.Solid(name, SOFT) for name in mesh.bodies],
        [abut.Support("low.bottom", x=0, y=0), abut.Support("strip.left", x=0, y=0)],
        [
            abut.Traction("strip.top", (0.0, -2.0), amplitude=RISING),
            abut.Traction("strip.right", (400.0, 0.0), amplitude=LATER),
        ],
        [abut.Contact(contactor="strip.bottom", target="low.top")], plane="strain", kinematics="finite",
        solve=abut.SolveOptions(steps=steps),
    )  # fmt: skip


YIELDS = abut.Plastic(1e4, 0.3, 200.0, 50.0)
SOUND = {
    "few steps": lambda: pressed(steps=3),
    "opens and closes": lambda: pressed(amplitude=CYCLE, steps=4),
    "sticks": lambda: pressed(friction=2.0, steps=2),
    "rubber": lambda: pressed(abut.LinearElastic(1e3, 0.499), 100.0, how="mixed"),
    "flows, is unloaded and loaded": lambda: pressed(YIELDS, 250.0, amplitude=CYCLE, steps=4),
    "slides over waves": lambda: drawn(4),
}


@pytest.mark.parametrize("name", SOUND)
def test_sound_models(name: str) -> None:
    """What is stored lies between the works of the loads at the step's ends, in steps of any length."""
    solution = abut.solve(SOUND[name]())
    assert solution.converged
    known = [step.energy.unexplained for step in solution.steps if step.energy is not None]
    told = [value for value in known if value is not None]
    assert len(told) >= len(known) / 2
    assert max(told) < 0.0
    assert not jumps(solution)


TRACTION = [abut.Traction("block.top", (10.0, 10.0))]
SILENT = {
    "a support that moves": pulled([abut.Traction("block.right", (9.0, 0.0))], supports=[abut.Support("block.top", y=0.01)]),
    "a turn": pulled([abut.Traction("block.left", (-10.0, 0.0))], rotations=[abut.Rotation("block.top", 0.01, (0.5, 1.0))]),
    "a pressure that follows": pulled([abut.Pressure("block.top", 10.0), *TRACTION]),
    "a spring": pulled(TRACTION, springs=[abut.Spring("spring", "block.top", x=10.0)]),
    "F-bar": pulled(TRACTION, how="b-bar", cell="quad4"),
}  # fmt: skip


@pytest.mark.parametrize("name", SILENT)
def test_nothing_is_said_where_there_is_no_potential(name: str) -> None:
    solution = abut.solve(SILENT[name])
    assert solution.converged
    assert all(step.energy is not None and step.energy.unexplained is None for step in solution.steps)
    assert not jumps(solution)


def test_nothing_is_said_where_surfaces_slip() -> None:
    solution = abut.solve(pressed(friction=0.02, steps=2))
    assert solution.converged
    slipping = [step for step in solution.steps if step.contacts[0].friction.work > 0.0]  # type: ignore[union-attr]
    assert slipping
    assert all(step.energy.unexplained is None for step in slipping)  # type: ignore[union-attr]


def test_nothing_is_said_of_steps_at_rest() -> None:
    """A fit that is closed in the first step: what the others store is rounding of what that has stored."""
    rings = {
        name: make.ring(radii, cells=(2, 8), cell="quad4") for name, radii in (("hub", (10, 20)), ("shaft", (5, 10)))
    }
    held = [abut.Support(f"{name}.{end}", **{a: 0}) for name in rings for end, a in (("start", "y"), ("end", "x"))]
    solution = abut.solve(
        abut.Model(
            make.join(rings), [abut.Solid(name, SOFT) for name in rings], held, plane="strain", kinematics="finite",
            contacts=[abut.Contact(contactor="hub.inner", target="shaft.outer", offset=-0.02)],
            solve=abut.SolveOptions(steps=8),
        )
    )  # fmt: skip
    first, *others = [step.energy for step in solution.steps]
    assert first is not None
    assert all(energy is not None and abs(energy.stored) < 1e-12 * first.stored for energy in others)
    assert not jumps(solution)


def test_little_is_no_jump(snapped: Solution) -> None:
    """What pressures or the tolerance of equilibrium may leave open is none, and a hundredth of the work is the limit."""
    energy = next(step.energy for step in snapped.steps if step.energy is not None and step.energy.jumped > 0.0)
    work = max(abs(energy.loads), abs(energy.stored))
    assert replace(energy, unexplained=0.5 * work, contact=-0.6 * work).jumped == 0.0
    assert replace(energy, unexplained=0.5 * work, left=0.6 * work).jumped == 0.0
    assert replace(energy, unexplained=2.0 * JUMPED * work, contact=0.0, left=0.0).jumped == pytest.approx(2.0 * JUMPED)
    assert replace(energy, unexplained=None).jumped == 0.0

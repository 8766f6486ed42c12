"""Energy over load steps with friction, and moments of tractions on curved surfaces: what the certificate says of both."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from typing import Any

import numpy as np
import pytest

import abut
from abut.analysis import friction as analysed
from abut.mesh import make
from abut.problem import load_steps
from models.friction import FRICTION, PRESSURE, Hooke, cattaneo, on_a_slope, pushed, sheared
from models.patch import two_blocks
from models.twisted import twisted

BALANCED = 1e-11  # rounding of sums over some hundred points, through the linear solution
SLIDE = 1e-3


def checks(solution: abut.Solution) -> dict[tuple[str, str], abut.solution.Check]:
    return {(check.contact, check.name): check for check in solution.certificate}


def heated() -> abut.Model:
    """A block that is pressed, pushed and heated at once."""
    model = pushed()
    warm = [replace(own, material=replace(own.material, expansion=1e-4)) for own in model.solids]
    return replace(model, solids=warm, loads=[*model.loads, abut.Temperature("upper", 10.0)])


def by_a_rigid_tool() -> abut.Model:
    """A rigid tool pressed on a block, then moved and turned, with an equation that holds two points together."""
    tool, block = make.rectangle([0.5, 1.5], [1, 2], cells=[3, 2]), make.rectangle([0, 2], [0, 1], cells=[9, 4])
    mesh = make.join({"block": block, "tool": tool})
    down, along = abut.Amplitude([(0, 0), (0.5, 1)]), abut.Amplitude([(0.5, 0), (1, 1)])
    one, other = (int(np.flatnonzero(np.abs(mesh.points - at).max(axis=1) < 1e-9)[0]) for at in ([0, 1], [2, 1]))
    return abut.Model(
        mesh,
        [abut.Solid("block", abut.LinearElastic(1e3, 0.3))],
        [abut.Support("block.bottom", x=0, y=0)],
        [abut.NodalForce("tool.top", (0.0, -2.0), amplitude=down)],
        [abut.Contact(contactor="block.top", target="tool.bottom", friction=0.3)],
        rigid=[abut.Rigid("tool", x=0.01, rz=0.0, amplitude=along)],
        equations=[abut.Equation([abut.Term(one, "y", 1.0), abut.Term(other, "y", -1.0)], 1e-3, amplitude=along)],
        plane="strain",
        solve=abut.SolveOptions(times=[0.5, 0.75, 1.0]),
    )


def round_an_axis() -> abut.Model:
    """A ring pressed on a disc and drawn outwards, axisymmetric; the contact closes only in the second step."""
    parts = {
        "disc": make.rectangle([1, 4], [0, 1], cells=[9, 3], cell="quad8"),
        "ring": make.rectangle([2, 3], [1.001, 2], cells=[4, 3], cell="quad8"),
    }
    down, out = abut.Amplitude([(0, 0), (0.5, 1)]), abut.Amplitude([(0.5, 0), (1, 1)])
    return abut.Model(
        make.join(parts),
        [abut.Solid(name, abut.LinearElastic(1e3, 0.3)) for name in parts],
        [
            abut.Support("disc.bottom", y=0),
            abut.Support("ring.top", y=-0.004, amplitude=down),
            abut.Support("ring.top", x=0.02, amplitude=out),
        ],
        contacts=[abut.Contact(contactor="ring.bottom", target="disc.top", friction=0.2)],
        plane="axisymmetric",
        solve=abut.SolveOptions(times=[0.1, 0.4, 0.5, 0.75, 1.0]),
    )


MODELS: dict[str, Callable[[], abut.Model]] = {
    "pushed to and fro": pushed,
    "sliding": lambda: pushed(far=0.05),
    "held by friction": lambda: on_a_slope(0.2),
    "cylinders that close": lambda: cattaneo("quad4", 8),
    "heated": heated,
    "rigid tool": by_a_rigid_tool,
    "axisymmetric": round_an_axis,
    "twisted 2D": lambda: twisted(2),
    "twisted 3D": lambda: twisted(3),
}


@pytest.mark.parametrize("name", MODELS)
def test_energy_is_balanced_exactly(name: str) -> None:
    """Theory (R10) is an identity of the discrete problem: nothing but rounding is left, whatever loads, slips or closes."""
    solution = abut.solve(MODELS[name]())
    assert solution.converged
    own = [step.energy for step in solution.steps if step.energy is not None]
    assert max(energy.error for energy in own) < BALANCED
    assert any(energy.friction > 1e-6 * energy.size for energy in own)
    assert all(energy.limit <= 1e-6 for energy in own)  # what equilibrium leaves open, 1e-9 of forces, beside work done
    assert checks(solution)["", "energy balance"].passed
    for check in solution.certificate:
        if check.name in ("force balance", "moment balance"):
            assert check.value < 1e-12, check


def test_materials_of_ones_own_too() -> None:
    """What is stored is then the work of the stresses along the straight way between the two states."""
    model = pushed()
    solution = abut.solve(replace(model, solids=[abut.Solid(solid.body, Hooke()) for solid in model.solids]))
    assert max(step.energy.error for step in solution.steps) < 1e-9  # of equilibrium


def test_parts_of_the_energy() -> None:
    """A uniform slip s in one step: friction takes mu p A s with the traction at its end, half of it with one that grows in
    proportion; supports and loads bring that and what is stored."""
    own = abut.solve(sheared(two_blocks("hex8", "hex8", ((2, 3, 2), (3, 2, 2))), FRICTION, SLIDE)).steps[0].energy
    taken = FRICTION * PRESSURE * SLIDE  # on the area one
    assert own.friction == pytest.approx(taken, rel=1e-9)
    assert own.stepping == pytest.approx(-0.5 * taken, rel=1e-9)
    assert own.loads + own.supports == pytest.approx(own.stored + 0.5 * taken, rel=1e-9)
    assert own.contact == pytest.approx(0.0, abs=1e-9 * taken)


@pytest.mark.long
def test_smaller_steps_leave_less() -> None:
    """What stepping leaves open is of second order in a step, of first in all: four times as many steps leave a quarter."""
    far = []
    for count in (8, 32):
        times = [0.2, *(0.2 + 0.4 * np.arange(1, count + 1) / count)]
        model = replace(pushed(), solve=abut.SolveOptions(times=[*times, 1.0]))
        steps = abut.solve(model).steps[1 : count + 1]
        far.append(sum(step.energy.stepping for step in steps))
    assert far[1] / far[0] == pytest.approx(0.25, abs=0.1)


def test_nothing_happens_for_a_while() -> None:
    """Loads taken off, then nothing: rounding beside rounding is no error."""
    model = pushed()
    off = abut.Amplitude([(0, 0), (0.2, 1), (0.4, 0), (1, 0)])
    still = replace(
        model,
        loads=[replace(model.loads[0], amplitude=off)],
        supports=[*model.supports[:1], abut.Support("upper.top", x=0)],
    )
    solution = abut.solve(still)
    assert solution.converged
    assert checks(solution)["", "energy balance"].passed


def test_a_slip_that_is_none_fails(monkeypatch: pytest.MonkeyPatch) -> None:
    """Slip that is a hundredth larger than the displacements say: no other line sees it."""
    honest = load_steps.slips

    def wrong(*given: Any) -> dict[str, np.ndarray]:
        return {name: 1.01 * slip for name, slip in honest(*given).items()}

    monkeypatch.setattr(load_steps, "slips", wrong)
    failed = {check.name for check in abut.solve(pushed(far=0.05)).certificate if not check.passed}
    assert failed == {"energy balance"}


def test_forces_out_of_balance_fail(monkeypatch: pytest.MonkeyPatch) -> None:
    """Displacements a ten-thousandth off, inside the bodies: sums of forces do not see it, the energy does."""
    honest = abut.analysis.run.step_result

    def wrong(assembled, attempt, *rest):
        unknowns = attempt.state.unknowns * (1.0 + 1e-4 * np.arange(len(attempt.state.unknowns)) / 1000.0)
        return honest(assembled, replace(attempt, state=replace(attempt.state, unknowns=unknowns)), *rest)

    monkeypatch.setattr("abut.analysis.run.step_result", wrong)
    assert not checks(abut.solve(pushed()))["", "energy balance"].passed


@pytest.mark.parametrize("dim", [2, 3])
def test_moments_of_tractions_across_a_gap(dim: int, monkeypatch: pytest.MonkeyPatch) -> None:
    """The two sides lie 0.04 apart before the offset closes them: with the couple of that arm moments balance to rounding,
    and without it not."""
    model = twisted(dim)
    assert checks(abut.solve(model))[model.contacts[0].name, "moment balance"].value < 1e-12

    honest = analysed.friction_balance

    def without(pair, multipliers):
        operators = replace(pair.slip.operators, arms=0.0 * pair.slip.operators.arms)
        return honest(replace(pair, slip=replace(pair.slip, operators=operators)), multipliers)

    monkeypatch.setattr("abut.analysis.contact_results.friction_balance", without)
    line = checks(abut.solve(model))[model.contacts[0].name, "moment balance"]
    assert line.value > 1e-3
    assert not line.passed

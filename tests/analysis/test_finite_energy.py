"""Energy over load steps with finite kinematics: what balances exactly, and what is left open by the size of the steps."""

from __future__ import annotations

import csv
import json
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest

import abut
from abut.mesh import make

BALANCED = 1e-9  # forces are in equilibrium to 1e-9 of the largest
ALONG = abut.Amplitude([(0.5, 0.0), (1.0, 1.0)])


def bent(steps: int = 8) -> abut.Model:
    """A strip that a pressure bends by a third of its length."""
    return abut.Model(
        make.join({"strip": make.rectangle([0, 5], [0, 1], cells=[5, 1], cell="quad8")}),
        plane="stress",
        solids=[abut.Solid("strip", abut.LinearElastic(1e3, 0.3))],
        supports=[abut.Support("strip.left", x=0, y=0)],
        loads=[abut.Pressure("strip.top", 2.0)],
        kinematics="finite",
        solve=abut.SolveOptions(steps=steps),
    )


def rubbing(steps: int = 8) -> abut.Model:
    """A soft block pressed on another, then drawn along by its own width."""
    parts = {
        "low": make.rectangle([0, 4], [0, 1], cells=[8, 2]),
        "up": make.rectangle([0.5, 1.5], [1, 2], cells=[3, 2]),
    }
    return abut.Model(
        make.join(parts),
        plane="strain",
        solids=[abut.Solid("low", abut.LinearElastic(1e3, 0.3)), abut.Solid("up", abut.NeoHooke(500.0, 0.3))],
        supports=[
            abut.Support("low.bottom", x=0, y=0),
            abut.Support("up.top", y=-0.1, amplitude=abut.Amplitude([(0.0, 0.0), (0.5, 1.0)])),
            abut.Support("up.top", x=1.0, amplitude=ALONG),
        ],
        contacts=[abut.Contact(contactor="up.bottom", target="low.top", friction=0.3)],
        kinematics="finite",
        solve=abut.SolveOptions(steps=steps),
    )


def turned(steps: int = 4) -> abut.Model:
    """A heated strip whose end a rigid body turns by one radian, free to move: its points go round on arcs."""
    parts = {
        "strip": make.rectangle([0, 4], [0, 1], cells=[4, 1]),
        "grip": make.rectangle([4, 5], [0, 1], cells=[1, 1]),
    }
    return abut.Model(
        make.join(parts),
        plane="strain",
        solids=[abut.Solid("strip", abut.LinearElastic(1e3, 0.3, expansion=1e-3))],
        supports=[abut.Support("strip.left", x=0, y=0)],
        loads=[abut.Temperature("strip", 20.0), abut.Pressure("strip.top", 5.0)],
        contacts=[abut.Contact(contactor="strip.right", target="grip.left", kind="tied")],
        rigid=[abut.Rigid("grip", reference=(5.0, 0.5), rz=1.0)],
        kinematics="finite",
        solve=abut.SolveOptions(steps=steps),
    )


def energies(model: abut.Model) -> list[abut.solution.energy.Energy]:
    solution = abut.solve(model)
    assert solution.converged
    own = [step.energy for step in solution.steps if step.energy is not None]
    assert len(own) == len(solution.steps)
    return own


def total(own: list[abut.solution.energy.Energy], name: str) -> float:
    return float(sum(getattr(energy, name) for energy in own))


@pytest.mark.parametrize("model", [bent, rubbing, turned])
def test_energy_is_balanced_exactly(model: Callable[[], abut.Model]) -> None:
    """Theory (G13) is an identity of states in equilibrium: nothing but what this leaves is left."""
    own = energies(model())
    assert max(energy.error for energy in own) < BALANCED
    assert all(energy.error <= energy.limit <= 1e-5 for energy in own)
    assert total(own, "stored") == pytest.approx(own[-1].elastic, rel=1e-12)


def test_what_the_steps_leave_open_falls_with_their_square() -> None:
    coarse, fine = (total(energies(bent(steps)), "stepping") for steps in (8, 16))
    assert coarse / fine == pytest.approx(4.0, rel=0.02)
    assert abs(fine) < 1e-3 * total(energies(bent(8)), "stored")


@pytest.mark.long
def test_friction_takes_what_tractions_do() -> None:
    """What is left open beside friction goes to zero with the steps; that of one falls with its square or so, the first
    in which everything slips only in proportion."""
    coarse, fine = (energies(rubbing(steps)) for steps in (16, 32))
    assert total(fine, "friction") > 0.5 * total(fine, "supports") > 0.0
    assert abs(total(fine, "stepping")) < 0.6 * abs(total(coarse, "stepping"))
    assert abs(total(fine, "stepping")) < 5e-3 * total(fine, "friction")


def test_strain_energy_is_that_of_theory() -> None:
    """A bar stretched to twice its length in plane strain without moving sideways: F = diag(2, 1, 1), C_11 = 4."""
    lame, shear = 600.0, 400.0
    model = abut.Model(
        make.join({"bar": make.rectangle([0, 1], [0, 1], cells=[2, 1])}),
        plane="strain",
        solids=[abut.Solid("bar", abut.NeoHooke(lame=lame, shear=shear))],
        supports=[abut.Support("bar.left", x=0), abut.Support("bar.right", x=1.0), abut.Support("bar.bottom", y=0),
                  abut.Support("bar.top", y=0)],
        kinematics="finite",
        solve=abut.SolveOptions(steps=20),
    )  # fmt: skip
    own = energies(model)
    expected = 0.5 * shear * 3.0 - shear * np.log(2.0) + 0.5 * lame * (1.5 - np.log(2.0))
    assert own[-1].elastic == pytest.approx(expected, rel=1e-12)
    assert total(own, "supports") == pytest.approx(expected, rel=1e-3)  # second order in twentieths
    assert total(own, "supports") - expected == pytest.approx(total(own, "stepping"), rel=1e-6)


def test_files_hold_the_energies(tmp_path: Path) -> None:
    solution = abut.solve(bent(2))
    folder = abut.write(solution, tmp_path)
    steps = json.loads((folder / "summary.json").read_text())["steps"]
    rows = list(csv.DictReader((folder / "history.csv").read_text().splitlines()))
    assert len(rows) == len(steps) == 2
    for step, row, own in zip(steps, rows, solution.steps, strict=True):
        assert own.energy is not None
        for name in ("loads", "supports", "contact", "stored", "friction", "stepping", "elastic"):
            assert step["energy"][name] == float(row[f"energy_{name}"]) == getattr(own.energy, name)
    assert any(check.name == "energy balance" and check.passed for check in solution.certificate)

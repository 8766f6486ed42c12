"""Users' own materials under finite strains: those of `examples/own-material`, and laws that abut has as well."""

from __future__ import annotations

import sys
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

import abut
from abut.bodies.assemble import respond
from abut.bodies.solids import Solids, TemperatureChange
from abut.bodies.stress import point_stress
from abut.materials.material import OwnMaterial
from abut.mesh.make import box, join, rectangle
from abut.verify.tangents import differences

sys.path.insert(0, str(Path(__file__).parents[2] / "examples" / "own-material"))

import softening_rubber


class SaintVenant(OwnMaterial):
    """Linear elasticity's own law under finite strains, in Python."""

    modulus = 1.0
    expansion = 1e-2

    def evaluate_finite(self, strain: np.ndarray, history: np.ndarray) -> tuple:
        return abut.LinearElastic(1.0, 0.3).evaluate(strain, history)

    evaluate = evaluate_finite


class Telling(SaintVenant):
    """The same, which tells its energy, too."""

    def stored(self, strain: np.ndarray, history: np.ndarray) -> np.ndarray:
        return 0.5 * (self.evaluate_finite(strain, history)[0] * strain).sum(axis=1)


@pytest.mark.parametrize("plane", [None, "strain", "stress", "axisymmetric"])
@pytest.mark.parametrize("rule", ["full", "b-bar"])
def test_energy_told(plane: str | None, rule: str) -> None:
    """Of each cell, as the core has it; of a warm one it is not known."""
    if (plane, rule) == ("stress", "b-bar"):
        return
    mesh = box(cells=(2, 1, 1), cell="hex8") if plane is None else rectangle((1.0, 2.0), (0.0, 1.0), (2, 1), "quad4")
    if plane == "axisymmetric":
        mesh = replace(mesh, axisymmetric=True)
    moved = 0.1 * np.random.default_rng(1).standard_normal(mesh.points.shape)
    ours, theirs = (
        Solids(mesh, {"body": law}, plane, {"body": rule}, "finite")
        for law in (abut.LinearElastic(1.0, 0.3), Telling())
    )
    known = respond(ours, moved).energy
    assert respond(theirs, moved).energy == pytest.approx(known, rel=1e-12)
    assert (known > 0.0).all()
    assert np.isnan(respond(theirs, moved, TemperatureChange({"body": 15.0})).energy).all()


def test_energy_balance_of_own_law() -> None:
    """A strip bent by a pressure that follows it: what a law tells is stored, as of the compiled law."""
    stored = []
    for law in (abut.LinearElastic(1.0, 0.3), Telling()):
        strip = abut.Model(
            join({"strip": rectangle((0.0, 4.0), (0.0, 1.0), (4, 1), "quad8")}),
            [abut.Solid("strip", law)],
            [abut.Support("strip.left", x=0, y=0)],
            [abut.Pressure("strip.top", 2e-3)],
            plane="strain",
            kinematics="finite",
            solve=abut.SolveOptions(steps=3),
        )
        solution = abut.solve(strip)
        stored.append([step.energy.elastic for step in solution.steps])
        assert all(check.passed for check in solution.certificate if check.name == "energy balance")
    assert stored[1] == pytest.approx(stored[0], rel=1e-9)
    assert stored[0][-1] > stored[0][0] > 0.0


@pytest.mark.parametrize("plane", [None, "strain", "stress", "axisymmetric"])
@pytest.mark.parametrize("rule", ["full", "b-bar"])
def test_python_and_core_agree(plane: str | None, rule: str) -> None:
    """Forces, tangent and Cauchy stresses under heat, with F-bar and without."""
    if (plane, rule) == ("stress", "b-bar"):
        return
    mesh = box(cells=(2, 1, 1), cell="hex8") if plane is None else rectangle((1.0, 2.0), (0.0, 1.0), (2, 1), "quad4")
    if plane == "axisymmetric":
        mesh = replace(mesh, axisymmetric=True)
    moved = 0.1 * np.random.default_rng(0).standard_normal(mesh.points.shape)
    hot = TemperatureChange({"body": 15.0})
    both = [
        Solids(mesh, {"body": law}, plane, {"body": rule}, "finite")
        for law in (abut.LinearElastic(1.0, 0.3, expansion=1e-2), SaintVenant())
    ]
    ours, theirs = (respond(solids, moved, hot) for solids in both)
    assert np.abs(ours.force - theirs.force).max() < 1e-12
    assert np.abs((ours.tangent - theirs.tangent).toarray()).max() < 1e-12
    assert np.isnan(theirs.energy).all()  # this law does not tell
    stresses = [point_stress(solids, moved, hot)[0] for solids in both]
    assert np.abs(stresses[0] - stresses[1]).max() < 1e-12


def test_softening_rubber() -> None:
    """Its tangent, on the way and below the largest energy; what was stretched is softer, and does not forget."""
    material, rng = softening_rubber.SofteningRubber(shear=1.0, bulk=20.0), np.random.default_rng(0)
    strain = rng.uniform(-0.1, 0.1, (20, 6))
    stress, _, history = material.evaluate_finite(strain, material.initial(20))
    for before in (material.initial(20), 2.0 * history):
        _, tangent, _ = material.evaluate_finite(strain, before)
        found = differences(lambda x, before=before: material.evaluate_finite(x, before)[0], strain)
        assert np.abs(tangent - found).max() < 1e-7 * np.abs(tangent).max()
    again, _, after = material.evaluate_finite(strain, 2.0 * history)
    assert np.array_equal(after, 2.0 * history)
    assert np.abs(again - stress).max() > 0.01


@pytest.mark.long
def test_softening_rubber_under_a_punch() -> None:
    """Pressed, let go by half and pressed again: back at the same force, and softer in between."""
    solution = abut.solve(softening_rubber.model(softening_rubber.SofteningRubber(shear=1.0, bulk=20.0)))
    force = {round(step.factor, 3): float(step.contacts[0].force[2]) for step in solution.steps}
    assert force[1.0] == pytest.approx(force[0.5], rel=1e-6)
    assert force[0.75] < 0.9 * force[0.25]  # at the same depth

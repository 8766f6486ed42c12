"""Metal that yields, against references: `abut.benchmarks.plastic`; and runs that go on from a restart file."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

import abut
from abut.benchmarks import necking, plastic_joints
from abut.benchmarks.plastic import BENCHMARKS
from abut.benchmarks.record import Benchmark, run
from abut.materials.plastic import EQUIVALENT
from abut.output.restart import load_steps, save_step

QUICK = [one for one in BENCHMARKS if one.name.startswith(("plastic-cylinder", "plastic-sphere", "plastic-press"))]
JOINTS = [*plastic_joints.BENCHMARKS, *necking.BENCHMARKS]
QUICK += [one for one in JOINTS if one.name.startswith(("plastic-stack", "plastic-press", "considere"))]
SLOW = [one for one in (*BENCHMARKS, *JOINTS) if one not in QUICK]


@pytest.mark.parametrize("benchmark", QUICK, ids=lambda one: one.name)
def test_quick(benchmark: Benchmark) -> None:
    for outcome in run(benchmark):
        assert outcome.passed, outcome


@pytest.mark.long
@pytest.mark.parametrize("benchmark", SLOW, ids=lambda one: one.name)
def test_slow(benchmark: Benchmark) -> None:
    for outcome in run(benchmark):
        assert outcome.passed, outcome


@pytest.mark.long
def test_a_neck_is_followed() -> None:
    """A bar beyond its largest load, whose tangent takes all of it to flow on while most of it unloads: by extrapolation
    30 steps take some 400 iterations (from the tangent 4 100)."""
    solution = abut.solve(necking.bar(necking.THINNER, (5, 15), necking.DRAWN, 30))
    assert solution.converged
    assert len(solution.steps) == 30
    assert sum(len(step.iterations) for step in solution.steps) <= 600


def test_finite_strains_meet_small_ones() -> None:
    """Small plastic strains: logarithmic ones give the same forces, but for their size."""
    (benchmark,) = (one for one in BENCHMARKS if one.name == "plastic-cylinder-0.2")
    model = benchmark.model(0)
    small, finite = (benchmark.measure(abut.solve(replace(model, kinematics=k))) for k in ("small", "finite"))
    assert finite == pytest.approx(small, rel=4e-3)  # strains are .2 %
    assert finite != pytest.approx(small, rel=1e-7)


@pytest.mark.parametrize("kinematics", ["small", "finite"])
def test_restart(kinematics: str, tmp_path: Path) -> None:
    """Unloading from a restart file leaves the same plastic strains and displacements; energies balance on the way."""
    (benchmark,) = (one for one in BENCHMARKS if one.name == "plastic-cylinder-unloaded")
    model = replace(benchmark.model(0), kinematics=kinematics)
    kept: list[abut.solution.Saved] = []
    whole = abut.solve(model, on_step=lambda _, saved: kept.append(saved))
    half = len(kept) // 2
    for saved in kept[:half]:
        save_step(tmp_path, {}, saved)
    rest = abut.solve(model, resume=load_steps(tmp_path, {}))
    last, other = whole.steps[-1], rest.steps[-1]
    assert np.abs(other.displacement - last.displacement).max() < 1e-12
    assert np.abs(other.remembered[EQUIVALENT] - last.remembered[EQUIVALENT]).max() < 1e-12
    assert last.flow is not None
    assert last.flow.work == pytest.approx(sum(step.energy.plastic for step in whole.steps if step.energy), rel=1e-12)
    assert all(step.energy.error <= step.energy.limit for step in whole.steps if step.energy)

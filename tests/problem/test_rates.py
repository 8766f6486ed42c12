"""Terms with rates: a mass on a spring and a dashpot that a user's physics adds; velocities and accelerations are in the
state."""

from __future__ import annotations

import dataclasses
from pathlib import Path

import numpy as np
import pytest

import abut
from abut.errors import InputError
from abut.mesh.make import join, rectangle
from abut.model.rates import BackwardEuler, Newmark, integration_of
from abut.output.restart import load_steps, save_step
from models.inertia import Inertia

YOUNG, FORCE, COUNT, MASS = 2000.0, 6.0, 12, 0.7
STIFFNESS = YOUNG / 2.0  # of a bar of unit width and length 2, in uniaxial strain
PERIOD = 2.0 * np.pi * np.sqrt(MASS / STIFFNESS)


def oscillator(physics: list[object], kinematics: str = "small") -> abut.Model:
    """A bar as a spring, a force at its end from the start on; the end's two nodes share mass and dashpot."""
    mesh = join({"bar": rectangle((0.0, 2.0), (0.0, 1.0), (1, 1), "quad4")})
    mesh = dataclasses.replace(mesh, node_sets={"all": np.arange(len(mesh.points))})
    at_once = abut.Amplitude(((0.0, 1.0), (1.0, 1.0)))
    return abut.Model(
        mesh,
        [abut.Solid("bar", abut.LinearElastic(YOUNG, 0.0))],
        [abut.Support("all", y=0.0), abut.Support("bar.left", x=0.0)],
        [abut.Traction("bar.right", (FORCE, 0.0), amplitude=at_once)],
        plane="strain",
        kinematics=kinematics,
        solve=abut.SolveOptions(steps=COUNT),
        physics=physics,
    )


def starting(duration: float) -> Newmark:
    """The trapezoidal rule, from the acceleration that the force causes at the start."""
    nodes = oscillator([]).mesh.surface("bar.right").node_ids
    accelerations = np.zeros((4, 2))
    accelerations[nodes, 0] = FORCE / MASS
    return Newmark(duration, accelerations=accelerations.ravel())


def ends(solution: abut.Solution, model: abut.Model, name: str | None = None) -> np.ndarray:
    nodes = model.mesh.surface("bar.right").node_ids
    values = [step.displacement if name is None else step.remembered[name] for step in solution.steps]
    return np.array([each[nodes, 0].mean() for each in values])


@pytest.mark.parametrize("kinematics", ["small", "small-strain"])
def test_an_oscillator(kinematics: str, tmp_path: Path) -> None:
    """The trapezoidal rule turns the state (u, v / omega) of an undamped oscillator by phi a step, tan(phi / 2) =
    omega h / 2, about its rest F / k (Hughes, The Finite Element Method, section 9.1): u_n = F / k
    (1 - cos n phi), v_n = omega F / k sin n phi. A run that goes on from restart files ends likewise."""
    duration = 3.0 * PERIOD
    model = oscillator([starting(duration), Inertia("bar.right", MASS / 2.0)], kinematics)
    saved: list[abut.solution.Saved] = []
    solution = abut.solve(model, on_step=lambda _, step: saved.append(step))
    phi = 2.0 * np.arctan(0.5 * 2.0 * np.pi / PERIOD * duration / COUNT) * np.arange(1, COUNT + 1)
    rest = FORCE / STIFFNESS
    assert ends(solution, model) == pytest.approx(rest * (1.0 - np.cos(phi)), abs=1e-9 * rest)
    quickest = 2.0 * np.pi / PERIOD * rest
    assert ends(solution, model, "velocity") == pytest.approx(quickest * np.sin(phi), abs=1e-8 * quickest)
    acceleration = (FORCE - STIFFNESS * ends(solution, model)) / MASS
    assert ends(solution, model, "acceleration") == pytest.approx(acceleration, abs=1e-8 * FORCE / MASS)
    for step in saved[:5]:
        save_step(tmp_path, {}, step)
    again = abut.solve(model, resume=load_steps(tmp_path, {}))
    assert ends(again, model) == pytest.approx(ends(solution, model), abs=1e-12 * rest)


@pytest.mark.parametrize("mass", [MASS, 0.0], ids=["mass", "dashpot alone"])
def test_a_dashpot(mass: float) -> None:
    """Backward Euler's method for u' = v, m v' = F - k u - c v multiplies in each step
    (u - F / k, v) by (1 - h A)^-1, A = [[0, 1], [-k / m, -c / m]]; without mass u - F / k by 1 / (1 + h k / c)."""
    damping, duration = 0.6 * np.sqrt(STIFFNESS * MASS), PERIOD
    physics = [BackwardEuler(duration), Inertia("bar.right", mass / 2.0, damping / 2.0)]
    model, h = oscillator(physics), duration / COUNT
    solution, rest, here, exact = abut.solve(model), FORCE / STIFFNESS, np.array([-1.0, 0.0]), []
    for _ in range(COUNT):
        if mass:
            here = np.linalg.solve(np.eye(2) - h * np.array([[0.0, 1.0], [-STIFFNESS / mass, -damping / mass]]), here)
        else:
            here = here / (1.0 + h * STIFFNESS / damping)
        exact.append(rest * (1.0 + here[0]))
    assert ends(solution, model) == pytest.approx(np.array(exact), abs=1e-9 * rest)


def test_inertia_is_among_the_forces() -> None:
    """What supports take is the spring's force, not the load: the balance of a step has the inertia."""
    model = oscillator([starting(1.0), Inertia("bar.right", MASS / 2.0)])
    solution = abut.solve(model)
    for step, moved in zip(solution.steps, ends(solution, model)):
        assert step.reactions["bar.left"][0] == pytest.approx(-STIFFNESS * moved, abs=1e-9 * FORCE)
        assert step.balance_error <= step.balance_limit


def test_what_is_wrong_is_told() -> None:
    with pytest.raises(InputError, match=r"duration = 0\.0: it has to be positive"):
        Newmark(0.0)
    with pytest.raises(InputError, match=r"beta = 0\.0: it has to be positive"):
        Newmark(1.0, beta=0.0)
    with pytest.raises(InputError, match="two time integrations"):
        integration_of([Newmark(1.0), BackwardEuler(2.0)])
    with pytest.raises(InputError, match=r"velocities of shape \(3,\); there are 8 values"):
        abut.solve(oscillator([Newmark(1.0, velocities=np.zeros(3))]))

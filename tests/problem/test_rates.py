"""Terms with rates: a mass on a spring that a user's physics adds, which keeps velocity and acceleration in its history."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

import abut
from abut.mesh.make import join, rectangle
from models.inertia import Inertia

YOUNG, FORCE, COUNT = 2000.0, 6.0, 12
STIFFNESS = YOUNG / 2.0  # of a bar of unit width and length 2, in uniaxial strain


def oscillator(mass: float, duration: float, kinematics: str = "small") -> abut.Model:
    """A bar as a spring, a force at its end from the start on; the end's two nodes share the mass."""
    mesh = join({"bar": rectangle((0.0, 2.0), (0.0, 1.0), (1, 1), "quad4")})
    mesh = replace(mesh, node_sets={"all": np.arange(len(mesh.points))})
    at_once = abut.Amplitude(((0.0, 1.0), (1.0, 1.0)))
    begins = (FORCE / mass, 0.0)
    return abut.Model(
        mesh,
        [abut.Solid("bar", abut.LinearElastic(YOUNG, 0.0))],
        [abut.Support("all", y=0.0), abut.Support("bar.left", x=0.0)],
        [abut.Traction("bar.right", (FORCE, 0.0), amplitude=at_once)],
        plane="strain",
        kinematics=kinematics,
        solve=abut.SolveOptions(steps=COUNT),
        physics=[Inertia("bar.right", mass / 2.0, duration, begins)],
    )


def ends(solution: abut.Solution, model: abut.Model) -> np.ndarray:
    nodes = model.mesh.surface("bar.right").node_ids
    return np.array([step.displacement[nodes, 0].mean() for step in solution.steps])


@pytest.mark.parametrize("kinematics", ["small", "small-strain"])
def test_an_oscillator(kinematics: str) -> None:
    """The trapezoidal rule turns the state (u, v / omega) of an undamped oscillator by phi a step, tan(phi / 2) =
    omega h / 2, about its rest F / k (Hughes, The Finite Element Method, section 9.1): u_n = F / k
    (1 - cos n phi). A run that goes on after some steps ends likewise: the history has the rates."""
    mass, duration = 0.7, 3.0 * 2.0 * np.pi * np.sqrt(0.7 / STIFFNESS)
    model = oscillator(mass, duration, kinematics)
    saved: list[abut.solution.Saved] = []
    solution = abut.solve(model, on_step=lambda _, step: saved.append(step))
    phi = 2.0 * np.arctan(0.5 * np.sqrt(STIFFNESS / mass) * duration / COUNT)
    exact = FORCE / STIFFNESS * (1.0 - np.cos(phi * np.arange(1, COUNT + 1)))
    assert ends(solution, model) == pytest.approx(exact, abs=1e-9 * FORCE / STIFFNESS)
    again = abut.solve(model, resume=saved[:5])
    assert ends(again, model) == pytest.approx(ends(solution, model), abs=1e-12 * FORCE / STIFFNESS)


def test_inertia_is_among_the_forces() -> None:
    """What supports take is the spring's force, not the load: the balance of a step has the inertia."""
    model = oscillator(0.7, 1.0)
    solution = abut.solve(model)
    for step, moved in zip(solution.steps, ends(solution, model)):
        assert step.reactions["bar.left"][0] == pytest.approx(-STIFFNESS * moved, abs=1e-9 * FORCE)
        assert step.balance_error <= step.balance_limit

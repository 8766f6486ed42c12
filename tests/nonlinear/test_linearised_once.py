"""No state is linearised twice: results, certificate and energies are made of what the last iteration knew."""

from __future__ import annotations

from collections import Counter
from collections.abc import Callable
from dataclasses import replace

import pytest

import abut
from abut.problem.frame import Frame
from abut.problem.linearised import Linearised
from abut.problem.problem import ContactProblem
from abut.solution.state import State
from models.friction import Hooke
from models.sliding import arched


@pytest.mark.parametrize("friction", [0.0, 0.3])
def test_at_large_displacements(friction: float, monkeypatch: pytest.MonkeyPatch) -> None:
    seen = counted(monkeypatch)
    solution = abut.solve(arched(friction, solve=abut.SolveOptions(steps=4)))
    assert solution.converged
    assert len(seen) > len(solution.steps) > 3
    assert max(seen.values()) == 1


def test_of_materials_of_ones_own(monkeypatch: pytest.MonkeyPatch) -> None:
    seen = counted(monkeypatch)
    model = replace(arched(0.0, slide=0.0, solve=abut.SolveOptions(steps=3)), kinematics="small")
    solids = [replace(solid, material=Hooke(young=100.0, poisson=0.3)) for solid in model.solids]
    solution = abut.solve(replace(model, solids=solids))
    assert solution.converged
    assert len(seen) > len(solution.steps) > 2
    assert max(seen.values()) == 1


def counted(monkeypatch: pytest.MonkeyPatch) -> Counter[tuple[bytes | float, ...]]:
    """How often each state is linearised, with what is fixed during the step."""
    seen: Counter[tuple[bytes | float, ...]] = Counter()
    frames: list[Frame] = []
    own: Callable[..., Linearised] = ContactProblem.linearise

    def linearise(problem: ContactProblem, before: State, frame: Frame, now: State, *path: object) -> Linearised:
        if not any(frame is known for known in frames):
            frames.append(frame)  # kept, so that no other has its place in memory
        seen[(now.time, now.unknowns.tobytes(), now.multipliers.tobytes(), float(id(frame)))] += 1
        return own(problem, before, frame, now, *path)

    monkeypatch.setattr(ContactProblem, "linearise", linearise)
    return seen
